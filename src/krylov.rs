//! Krylov spaces of a matrix known only by its products with vectors (Lanczos, Arnoldi).

use crate::vector::axpy;

/// A Krylov space with a basis that is orthonormal to rounding in the caller's inner product.
pub(crate) struct Space<D> {
    pub basis: Vec<Vec<f64>>,
    /// The columns of the Hessenberg matrix: for each basis vector, the components of its image along
    /// the basis so far, then the norm of the rest.
    pub columns: Vec<Vec<f64>>,
    /// The norm of the last image.
    pub image: f64,
    /// The diagonal of a self-adjoint matrix. Each entry is taken before orthogonalisation.
    alphas: Vec<f64>,
    /// The part of the last image that is orthogonal to the space.
    rest: Vec<f64>,
    dot: D,
}

impl<D: Fn(&[f64], &[f64]) -> f64> Space<D> {
    /// The space of one vector, which has norm 1 in the inner product.
    pub fn new(start: Vec<f64>, dot: D) -> Self {
        Self {
            rest: vec![0.0; start.len()],
            basis: vec![start],
            columns: Vec::new(),
            image: 0.0,
            alphas: Vec::new(),
            dot,
        }
    }

    /// Multiplies the last vector of the basis; returns the norm of the part of its image that is new.
    /// `product` overwrites its second argument.
    pub fn multiply(&mut self, product: impl Fn(&[f64], &mut [f64])) -> f64 {
        let last = &self.basis[self.basis.len() - 1];
        product(last, &mut self.rest);
        self.image = (self.dot)(&self.rest, &self.rest).sqrt();
        self.alphas.push((self.dot)(&self.rest, last));
        let mut column = vec![0.0; self.basis.len()];
        // Two passes keep the basis orthogonal to rounding (Parlett).
        for _ in 0..2 {
            for (taken, q) in column.iter_mut().zip(&self.basis) {
                let overlap = (self.dot)(&self.rest, q);
                *taken += overlap;
                axpy(&mut self.rest, -overlap, q);
            }
        }
        let beta = (self.dot)(&self.rest, &self.rest).sqrt();
        column.push(beta);
        self.columns.push(column);
        beta
    }

    /// Adds the new part to the basis, normalised; None where it is zero or not finite.
    pub fn extend(&mut self) -> Option<()> {
        let beta = *self.columns.last()?.last()?;
        (beta.is_finite() && beta > 0.0).then(|| {
            let next = self.rest.iter().map(|x| x / beta);
            self.basis.push(next.collect());
        })
    }

    /// An entry of the matrix projected onto the space; its last column is that of the last image.
    pub fn entry(&self, row: usize, column: usize) -> f64 {
        self.columns[column].get(row).copied().unwrap_or(0.0)
    }

    /// An entry of a self-adjoint matrix projected onto the space.
    pub fn tridiagonal(&self, row: usize, column: usize) -> f64 {
        match row.abs_diff(column) {
            0 => self.alphas[row],
            1 => self.columns[row.min(column)][row.max(column)],
            _ => 0.0,
        }
    }
}
