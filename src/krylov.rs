//! Krylov spaces of a matrix that is known by its products only (Lanczos, Arnoldi).

use crate::vector::axpy;

/// A Krylov space by a basis that is orthonormal to rounding, in an inner product of one's own.
pub(crate) struct Space<D> {
    pub basis: Vec<Vec<f64>>,
    /// Of each vector's image, its components along the basis so far and the length of the rest: the
    /// columns of a Hessenberg matrix.
    pub columns: Vec<Vec<f64>>,
    /// The length of the last image.
    pub image: f64,
    /// Of a self-adjoint matrix the diagonal, each entry taken before anything is orthogonalised.
    alphas: Vec<f64>,
    /// What of the last image is not in the space.
    rest: Vec<f64>,
    dot: D,
}

impl<D: Fn(&[f64], &[f64]) -> f64> Space<D> {
    /// Of one vector, of length 1 in the inner product.
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

    /// Multiplies the last vector of the basis; returns the length of what of its image is new.
    /// `product` overwrites its second argument.
    pub fn multiply(&mut self, product: impl Fn(&[f64], &mut [f64])) -> f64 {
        let last = &self.basis[self.basis.len() - 1];
        product(last, &mut self.rest);
        self.image = (self.dot)(&self.rest, &self.rest).sqrt();
        self.alphas.push((self.dot)(&self.rest, last));
        let mut column = vec![0.0; self.basis.len()];
        // Twice is enough (Parlett), to stay orthogonal to rounding.
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

    /// Takes what is new into the basis; None where there is nothing, or nothing finite.
    pub fn extend(&mut self) -> Option<()> {
        let beta = *self.columns.last()?.last()?;
        (beta.is_finite() && beta > 0.0).then(|| {
            let next = self.rest.iter().map(|x| x / beta);
            self.basis.push(next.collect());
        })
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
