//! Singular values by one-sided Jacobi rotations.

use nalgebra::{DMatrix, SymmetricEigen};

/// Sweeps over all pairs before giving up; from an eigenbasis two or three are enough.
const SWEEPS: usize = 40;

/// Right singular vectors V (columns) and singular values of `b`, largest first.
///
/// The eigenbasis of bᵀb starts it off and Jacobi's rotations (Hestenes 1958) finish it. A singular
/// value is then off by a few eps of the *largest one*, where the root of an eigenvalue of bᵀb is
/// off by a few eps of the largest times largest / own. None if it does not converge.
pub(super) fn singular(b: &DMatrix<f64>) -> Option<(DMatrix<f64>, Vec<f64>)> {
    let n = b.ncols();
    let mut v = if n > 1 {
        SymmetricEigen::try_new(b.tr_mul(b), f64::EPSILON, 1000 * n)?.eigenvectors
    } else {
        DMatrix::identity(n, n)
    };
    let mut bv = b * &v;
    let mut settled = n < 2;
    for _ in 0..SWEEPS {
        if settled {
            break;
        }
        settled = true;
        let noise = f64::EPSILON * bv.norm();
        for p in 0..n {
            for q in p + 1..n {
                let (alpha, beta) = (bv.column(p).norm(), bv.column(q).norm());
                let gamma = bv.column(p).dot(&bv.column(q));
                // Columns that are rounding themselves have no direction to be orthogonal in.
                let limit = f64::EPSILON * alpha.max(noise) * beta.max(noise);
                if gamma.abs() > (n as f64).sqrt() * limit {
                    settled = false;
                    let turn = rotation(alpha, beta, gamma);
                    rotate(&mut bv, p, q, turn);
                    rotate(&mut v, p, q, turn);
                }
            }
        }
    }
    if !settled {
        return None;
    }
    let values: Vec<f64> = bv.column_iter().map(|c| c.norm()).collect();
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| values[j].total_cmp(&values[i]));
    let sorted = DMatrix::from_fn(n, n, |i, j| v[(i, order[j])]);
    Some((sorted, order.iter().map(|&j| values[j]).collect()))
}

/// Cosine and sine that make two columns of these lengths and this product orthogonal.
fn rotation(alpha: f64, beta: f64, gamma: f64) -> (f64, f64) {
    let zeta = (beta - alpha) * (beta + alpha) / (2.0 * gamma);
    let tan = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
    let cos = 1.0 / tan.hypot(1.0);
    (cos, cos * tan)
}

fn rotate(m: &mut DMatrix<f64>, p: usize, q: usize, (cos, sin): (f64, f64)) {
    for i in 0..m.nrows() {
        let (a, b) = (m[(i, p)], m[(i, q)]);
        m[(i, p)] = cos * a - sin * b;
        m[(i, q)] = sin * a + cos * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// [[1, 1], [0, 1e-8]] has singular values with the sum of squares 2 and the product 1e-8; its
    /// bᵀb is singular in doubles.
    #[test]
    fn small_values_keep_their_digits() {
        let b = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 1e-8]);
        let (v, values) = singular(&b).expect("converges");
        let root = 2f64.sqrt();
        // A few eps of the largest.
        assert!((values[0] - root).abs() < 4.0 * f64::EPSILON);
        assert!((values[1] - 1e-8 / root).abs() < 4.0 * f64::EPSILON);
        let found = (&b * &v).column(1).norm();
        assert!((found - values[1]).abs() < 4.0 * f64::EPSILON);
        assert!((v.tr_mul(&v) - DMatrix::identity(2, 2)).amax() < 4.0 * f64::EPSILON);
        // What the eigenvalues of bᵀb alone would give.
        let least = SymmetricEigen::new(b.tr_mul(&b)).eigenvalues.min();
        assert!((least.max(0.0).sqrt() - 1e-8 / root).abs() > 1e6 * f64::EPSILON);
    }
}
