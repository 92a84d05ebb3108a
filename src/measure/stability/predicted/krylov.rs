//! Extreme eigenvalues of large matrices that are known by their products only: Lanczos where they
//! are symmetric, Arnoldi where not, both with full reorthogonalisation, from a fixed start.
//!
//! Sequential, so that the same bits come out on any number of threads. (Saad, Numerical Methods for
//! Large Eigenvalue Problems, 2nd ed., algorithms 6.2 and 6.5.)

use super::Effort;
use super::matrix::{dot, norm};
use faer::Mat;
use nalgebra::Complex;

/// y = A x, y overwritten.
pub(super) type Product<'a> = &'a dyn Fn(&[f64], &mut [f64]);

/// Up to this size a matrix is formed and solved whole.
const SMALL: usize = 48;

/// The largest eigenvalue (not magnitude) of a symmetric matrix and its unit vector. None where it
/// does not converge.
pub(super) fn top(n: usize, product: Product, effort: &Effort) -> Option<(f64, Vec<f64>)> {
    if n <= SMALL {
        let dense = formed(n, product)?;
        let eigen = dense.self_adjoint_eigen(faer::Side::Lower).ok()?;
        let value = eigen.S().column_vector()[n - 1];
        let vector = eigen.U().col(n - 1);
        return Some((value, (0..n).map(|i| vector[i]).collect()));
    }
    let mut start = noise(n);
    for _ in 0..=effort.restarts {
        let (value, vector, residual, size) = lanczos(n, product, &start, effort)?;
        if residual <= effort.found * size {
            return Some((value, vector));
        }
        start = vector;
    }
    None
}

/// As [`top`], but the best there is where it does not converge: an eigenvalue from below.
pub(super) fn top_estimate(n: usize, product: Product, effort: &Effort) -> Option<(f64, Vec<f64>)> {
    if n <= SMALL {
        return top(n, product, effort);
    }
    let mut start = noise(n);
    let mut best = None;
    for _ in 0..=effort.restarts {
        let (value, vector, residual, size) = lanczos(n, product, &start, effort)?;
        start.clone_from(&vector);
        best = Some((value, vector));
        if residual <= ESTIMATE * size {
            break;
        }
    }
    best
}

/// Residual of an estimate; the eigenvalue is then good to its square, times the gap.
const ESTIMATE: f64 = 1e-5;

/// Best top pair of one space: value, vector, residual, and the size of the spectrum seen.
fn lanczos(
    n: usize,
    product: Product,
    start: &[f64],
    effort: &Effort,
) -> Option<(f64, Vec<f64>, f64, f64)> {
    let (mut alphas, mut betas) = (Vec::new(), Vec::new());
    let mut basis = vec![unit(start)?];
    let mut check = 16;
    loop {
        let k = basis.len();
        let mut next = vec![0.0; n];
        product(&basis[k - 1], &mut next);
        alphas.push(dot(&next, &basis[k - 1]));
        orthogonalise(&mut next, &basis);
        let beta = norm(&next);
        let last = alphas.last().map_or(0.0, |a: &f64| a.abs());
        let closed = beta <= 1e-14 * (last + betas.last().copied().unwrap_or(0.0));
        if closed || k == check || k == n || k >= effort.space {
            check += check / 2;
            let (values, vectors) = tridiagonal(&alphas, &betas)?;
            let size = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            let ritz = vectors.col(k - 1);
            let residual = if closed {
                0.0
            } else {
                beta * ritz[k - 1].abs()
            };
            if residual <= effort.found * size || k == n || k >= effort.space {
                let mut vector = vec![0.0; n];
                for (i, q) in basis.iter().enumerate() {
                    for (sum, q) in vector.iter_mut().zip(q) {
                        *sum += ritz[i] * q;
                    }
                }
                return Some((*values.last()?, unit(&vector)?, residual, size));
            }
        }
        betas.push(beta);
        basis.push(unit(&next)?);
    }
}

/// Nodes θ and weights w, summing to |q|², with qᵀ f(A) q = Σ w f(θ) exactly for polynomials f of a
/// degree below twice their number (Golub, Meurant 1994); and what f(A) q needs: [`Nodes::action`].
pub(super) struct Nodes {
    pub nodes: Vec<f64>,
    /// Of each node, with the length of q.
    pub weights: Vec<f64>,
    vectors: Mat<f64>,
    basis: Vec<Vec<f64>>,
    length: f64,
}

/// Of a symmetric matrix and q: a space of at most `most` vectors.
pub(super) fn nodes(product: Product, q: &[f64], most: usize) -> Option<Nodes> {
    let n = q.len();
    let (mut alphas, mut betas) = (Vec::<f64>::new(), Vec::<f64>::new());
    let mut basis = vec![unit(q)?];
    loop {
        let k = basis.len();
        let mut next = vec![0.0; n];
        product(&basis[k - 1], &mut next);
        let image = norm(&next);
        alphas.push(dot(&next, &basis[k - 1]));
        orthogonalise(&mut next, &basis);
        let beta = norm(&next);
        if beta <= 1e-13 * image || k == n || k >= most {
            break;
        }
        betas.push(beta);
        basis.push(unit(&next)?);
    }
    let (nodes, vectors) = tridiagonal(&alphas, &betas)?;
    let length = norm(q);
    let first = |k: usize| length * length * vectors[(0, k)] * vectors[(0, k)];
    Some(Nodes {
        weights: (0..nodes.len()).map(first).collect(),
        nodes,
        vectors,
        basis,
        length,
    })
}

impl Nodes {
    /// y += a f(A) q.
    pub(super) fn action(&self, a: f64, f: &dyn Fn(f64) -> f64, y: &mut [f64]) {
        for (row, q) in self.basis.iter().enumerate() {
            let terms = self.nodes.iter().enumerate();
            let sum: f64 = terms
                .map(|(k, &node)| self.vectors[(row, k)] * self.vectors[(0, k)] * f(node))
                .sum();
            for (y, q) in y.iter_mut().zip(q) {
                *y += a * self.length * sum * q;
            }
        }
    }
}

/// Eigenvalues of largest magnitude of any real matrix, those with Im >= 0, largest first: down to
/// `inner` times the largest, or as many as one space of the effort's size finds.
pub(super) fn outermost(
    n: usize,
    product: Product,
    inner: f64,
    effort: &Effort,
) -> Vec<Complex<f64>> {
    arnoldi(n, product, inner, effort).unwrap_or_default()
}

fn arnoldi(n: usize, product: Product, inner: f64, effort: &Effort) -> Option<Vec<Complex<f64>>> {
    let mut basis = vec![unit(&noise(n))?];
    let mut columns: Vec<Vec<f64>> = Vec::new();
    let mut check = 32;
    loop {
        let k = basis.len();
        let mut next = vec![0.0; n];
        product(&basis[k - 1], &mut next);
        let mut column = orthogonalise(&mut next, &basis);
        let beta = norm(&next);
        column.push(beta);
        columns.push(column);
        let size = columns.iter().map(|c| norm(c)).fold(0.0, f64::max);
        let last = beta <= 1e-14 * size || k == n || k >= effort.space;
        if last || k == check {
            check += check / 2;
            let mut projected = Mat::<f64>::zeros(k, k);
            for (j, column) in columns.iter().enumerate() {
                for (i, value) in column.iter().enumerate().take(k) {
                    projected[(i, j)] = *value;
                }
            }
            let eigen = projected.eigen().ok()?;
            let mut order: Vec<usize> = (0..k).collect();
            let value = |i: usize| {
                let value = eigen.S().column_vector()[i];
                Complex::new(value.re, value.im)
            };
            order.sort_by(|&a, &b| {
                let (a, b) = (value(a), value(b));
                b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im))
            });
            let converged = |&&i: &&usize| {
                let vector = eigen.U().col(i);
                let length = (0..k).map(|r| vector[r].norm_sqr()).sum::<f64>().sqrt();
                last && k == n || beta * vector[k - 1].norm() <= effort.found * size * length
            };
            let found: Vec<_> = order
                .iter()
                .take_while(converged)
                .map(|&i| value(i))
                .collect();
            let moduli = found.first().zip(found.last());
            let enough = moduli.is_some_and(|(first, last)| last.norm() <= inner * first.norm());
            if last || enough {
                let upper = found.into_iter().filter(|root| root.im >= 0.0);
                return Some(upper.collect());
            }
        }
        basis.push(unit(&next)?);
    }
}

/// Takes the components along the basis out of `x`, twice; returns them.
fn orthogonalise(x: &mut [f64], basis: &[Vec<f64>]) -> Vec<f64> {
    let mut taken = vec![0.0; basis.len()];
    for _ in 0..2 {
        for (taken, q) in taken.iter_mut().zip(basis) {
            let overlap = dot(x, q);
            *taken += overlap;
            for (x, q) in x.iter_mut().zip(q) {
                *x -= overlap * q;
            }
        }
    }
    taken
}

fn unit(x: &[f64]) -> Option<Vec<f64>> {
    let length = norm(x);
    (length.is_finite() && length > 0.0).then(|| x.iter().map(|x| x / length).collect())
}

/// Eigenvalues, ascending, and vectors of a symmetric tridiagonal matrix.
fn tridiagonal(alphas: &[f64], betas: &[f64]) -> Option<(Vec<f64>, Mat<f64>)> {
    let m = alphas.len();
    let mut matrix = Mat::<f64>::zeros(m, m);
    for i in 0..m {
        matrix[(i, i)] = alphas[i];
        if i + 1 < m {
            matrix[(i + 1, i)] = betas[i];
            matrix[(i, i + 1)] = betas[i];
        }
    }
    let eigen = matrix.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let values = (0..m).map(|i| eigen.S().column_vector()[i]).collect();
    Some((values, eigen.U().to_owned()))
}

/// The matrix itself, column by column; None where it is not finite.
pub(super) fn formed(n: usize, product: Product) -> Option<Mat<f64>> {
    let mut dense = Mat::zeros(n, n);
    let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
    for j in 0..n {
        x[j] = 1.0;
        product(&x, &mut y);
        x[j] = 0.0;
        for (i, y) in y.iter().enumerate() {
            if !y.is_finite() {
                return None;
            }
            dense[(i, j)] = *y;
        }
    }
    Some(dense)
}

/// A fixed vector with a part along everything.
fn noise(n: usize) -> Vec<f64> {
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..n).map(|_| next()).collect()
}
