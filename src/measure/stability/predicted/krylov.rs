//! Extreme eigenvalues of large matrices that are known by their products only: Lanczos where they
//! are symmetric, Arnoldi where not, both with full reorthogonalisation, from a fixed start.
//!
//! Sequential, so that the same bits come out on any number of threads. (Saad, Numerical Methods for
//! Large Eigenvalue Problems, 2nd ed., algorithms 6.2 and 6.5.)

use super::Effort;
use super::part::{dot, norm};
use crate::krylov::Space;
use faer::Mat;
use nalgebra::Complex;

/// y = A x, y overwritten.
pub(super) type Product<'a> = &'a dyn Fn(&[f64], &mut [f64]);

/// Up to this size a matrix is formed and solved whole.
const SMALL: usize = 48;

/// The largest eigenvalue (not magnitude) of a symmetric matrix and its unit vector. None where it
/// does not converge.
pub(super) fn top(n: usize, product: Product, effort: &Effort) -> Option<(f64, Vec<f64>)> {
    let (value, vector, found) = best(n, product, effort, effort.found)?;
    found.then_some((value, vector))
}

/// The relative error of the root of an eigenvalue that [`top`] finds: an eigenvalue is at most its residual
/// off, and better where no other is near.
pub(super) fn error(n: usize, effort: &Effort) -> f64 {
    if n <= SMALL { 0.0 } else { 0.5 * effort.found }
}

/// As [`top`], by Lanczos begun anew from its best vector until the residual is at most `enough` of the
/// spectrum's size, and whether it came to that. Where it did not, the eigenvalue is a lower bound.
pub(super) fn best(
    n: usize,
    product: Product,
    effort: &Effort,
    enough: f64,
) -> Option<(f64, Vec<f64>, bool)> {
    if n <= SMALL {
        let dense = formed(n, product)?;
        let eigen = dense.self_adjoint_eigen(faer::Side::Lower).ok()?;
        let vector = eigen.U().col(n - 1);
        let vector = (0..n).map(|i| vector[i]).collect();
        return Some((eigen.S().column_vector()[n - 1], vector, true));
    }
    let mut start = noise(n);
    let mut value = 0.0;
    for _ in 0..=effort.restarts {
        let (found, vector, residual, size) = lanczos(product, &start, effort)?;
        (value, start) = (found, vector);
        if residual <= enough * size {
            return Some((value, start, true));
        }
    }
    Some((value, start, false))
}

/// Best top pair of one space: value, vector, residual, and the size of the spectrum seen.
fn lanczos(product: Product, start: &[f64], effort: &Effort) -> Option<(f64, Vec<f64>, f64, f64)> {
    let mut space = Space::new(unit(start)?, dot);
    let mut before = 0.0;
    let mut check = 16;
    loop {
        let beta = space.multiply(product);
        let k = space.basis.len();
        let closed = beta <= 1e-14 * (space.tridiagonal(k - 1, k - 1).abs() + before);
        let full = k == start.len() || k >= effort.space;
        if closed || k == check || full {
            check += check / 2;
            let (values, vectors) = projected(&space)?;
            let size = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            let ritz = vectors.col(k - 1);
            let residual = if closed {
                0.0
            } else {
                beta * ritz[k - 1].abs()
            };
            if residual <= effort.found * size || full {
                let mut vector = vec![0.0; start.len()];
                for (i, q) in space.basis.iter().enumerate() {
                    for (sum, q) in vector.iter_mut().zip(q) {
                        *sum += ritz[i] * q;
                    }
                }
                return Some((*values.last()?, unit(&vector)?, residual, size));
            }
        }
        before = beta;
        space.extend()?;
    }
}

/// Eigenvalues, ascending, and vectors of a symmetric matrix projected onto a space.
fn projected<D: Fn(&[f64], &[f64]) -> f64>(space: &Space<D>) -> Option<(Vec<f64>, Mat<f64>)> {
    let m = space.basis.len();
    let matrix = Mat::from_fn(m, m, |i, j| space.tridiagonal(i, j));
    let eigen = matrix.self_adjoint_eigen(faer::Side::Lower).ok()?;
    let values = (0..m).map(|i| eigen.S().column_vector()[i]).collect();
    Some((values, eigen.U().to_owned()))
}

/// A function f of a symmetric matrix A at a vector q, from one Krylov space.
pub(super) struct Nodes {
    /// θ and weights w, summing to |q|², with qᵀ f(A) q = Σ w f(θ) exactly for polynomials f of a degree
    /// below twice their number (Golub, Meurant 1994).
    pub nodes: Vec<(f64, f64)>,
    vectors: Mat<f64>,
    basis: Vec<Vec<f64>>,
    length: f64,
}

impl Nodes {
    /// y += a f(A) q.
    pub fn action(&self, a: f64, f: &dyn Fn(f64) -> f64, y: &mut [f64]) {
        for (row, q) in self.basis.iter().enumerate() {
            let terms = self.nodes.iter().enumerate();
            let sum: f64 = terms
                .map(|(k, (node, _))| self.vectors[(row, k)] * self.vectors[(0, k)] * f(*node))
                .sum();
            for (y, q) in y.iter_mut().zip(q) {
                *y += a * self.length * sum * q;
            }
        }
    }
}

/// The nodes of a symmetric matrix and q, from a space of at most `most` vectors.
pub(super) fn nodes(product: Product, q: &[f64], most: usize) -> Option<Nodes> {
    let mut space = Space::new(unit(q)?, dot);
    loop {
        let beta = space.multiply(product);
        let k = space.basis.len();
        if beta <= 1e-13 * space.image || k == q.len() || k >= most {
            break;
        }
        space.extend()?;
    }
    let (values, vectors) = projected(&space)?;
    let length = norm(q);
    let weight = |k: usize| length * length * vectors[(0, k)] * vectors[(0, k)];
    let nodes = values.into_iter().enumerate();
    Some(Nodes {
        nodes: nodes.map(|(k, node)| (node, weight(k))).collect(),
        vectors,
        basis: space.basis,
        length,
    })
}

/// Eigenvalues of largest magnitude of any real matrix, those with Im >= 0, largest first: down to
/// `inner` times the largest, or as many as one space of the effort's size finds. None where one cannot be
/// built.
pub(super) fn outermost(
    n: usize,
    product: Product,
    inner: f64,
    effort: &Effort,
) -> Option<Vec<Complex<f64>>> {
    let mut space = Space::new(unit(&noise(n))?, dot);
    let mut check = 32;
    loop {
        let beta = space.multiply(product);
        let k = space.basis.len();
        let size = space.columns.iter().map(|c| norm(c)).fold(0.0, f64::max);
        let last = beta <= 1e-14 * size || k == n || k >= effort.space;
        if last || k == check {
            check += check / 2;
            let entry = |i: usize, j: usize| space.columns[j].get(i).copied().unwrap_or(0.0);
            let eigen = Mat::from_fn(k, k, entry).eigen().ok()?;
            let mut pairs: Vec<_> = (0..k)
                .map(|i| {
                    let (value, vector) = (eigen.S().column_vector()[i], eigen.U().col(i));
                    let length = (0..k).map(|r| vector[r].norm_sqr()).sum::<f64>().sqrt();
                    let converged = last && k == n
                        || beta * vector[k - 1].norm() <= effort.found * size * length;
                    (Complex::new(value.re, value.im), converged)
                })
                .collect();
            pairs.sort_by(|(a, _), (b, _)| {
                b.norm().total_cmp(&a.norm()).then(b.im.total_cmp(&a.im))
            });
            let found: Vec<_> = pairs
                .into_iter()
                .take_while(|(_, converged)| *converged)
                .map(|(value, _)| value)
                .collect();
            let moduli = found.first().zip(found.last());
            let enough = moduli.is_some_and(|(first, last)| last.norm() <= inner * first.norm());
            if last || enough {
                let upper = found.into_iter().filter(|root| root.im >= 0.0);
                return Some(upper.collect());
            }
        }
        space.extend()?;
    }
}

fn unit(x: &[f64]) -> Option<Vec<f64>> {
    let length = norm(x);
    (length.is_finite() && length > 0.0).then(|| x.iter().map(|x| x / length).collect())
}

/// The matrix itself, column by column; None where it is not finite.
fn formed(n: usize, product: Product) -> Option<Mat<f64>> {
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
