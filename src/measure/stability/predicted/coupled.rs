//! Any method's one-step map as a matrix, where damping couples modes and no theory gives the limit.

use super::assembly::Component;
use super::composition::phi1;
use crate::integrators::{DampingTreatment, Stage};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::Complex;

/// What is stepped.
#[derive(Debug, Clone, Copy)]
pub(super) enum Scheme<'a> {
    Composition(&'a [Stage], DampingTreatment),
    MaterialImplicit,
}

/// A part in the basis of its damping's eigenvectors, where that is symmetric.
pub(super) struct Coupled {
    stiffness: Mat<f64>,
    material: Mat<f64>,
    /// Eigenvalues of C, 1/s.
    damping: Vec<f64>,
    /// Something is without restoring force, or grows in truth.
    at_rest: bool,
    unstable: bool,
}

/// Beyond 1 by this is growth. The eigenvalues of an unsymmetric matrix carry some rounding, and where
/// the limit is, they grow linearly in h at least.
const GROWING: f64 = 1e-10;
/// What is at rest has the eigenvalue 1 twice: about the root of rounding away from it.
const AT_REST: f64 = 1e-5;
/// The scan's steps, in parts of h.
const CELL: f64 = 0.02;

impl Coupled {
    /// None where the damping is not symmetric.
    pub(super) fn new(component: &Component, at_rest: bool, unstable: bool) -> Option<Self> {
        let symmetric = component.damping.skewness() <= 1e-13 * component.damping.norm();
        if !symmetric {
            return None;
        }
        let n = component.n();
        let eigen = component
            .damping
            .dense()
            .self_adjoint_eigen(Side::Lower)
            .ok()?;
        let u = eigen.U();
        let turned = |m: Mat<f64>| u.transpose() * m * u;
        Some(Self {
            stiffness: turned(component.stiffness.dense()),
            material: turned(component.material.dense()),
            damping: (0..n).map(|i| eigen.S().column_vector()[i]).collect(),
            at_rest,
            unstable,
        })
    }

    /// The eigenvalue of one step that is farthest out, of those that count.
    fn farthest(&self, scheme: Scheme, h: f64) -> Option<Complex<f64>> {
        let n = self.damping.len();
        let mut x = Mat::<f64>::from_fn(n, 2 * n, |i, j| f64::from(u8::from(i == j)));
        let mut v = Mat::<f64>::from_fn(n, 2 * n, |i, j| f64::from(u8::from(i + n == j)));
        match scheme {
            Scheme::Composition(stages, treatment) => {
                for stage in stages {
                    match *stage {
                        Stage::Drift(part) => x += faer::Scale(part * h) * &v,
                        Stage::Kick(part) => {
                            let step = part * h;
                            let force = &self.stiffness * &x;
                            for (i, c) in self.damping.iter().enumerate() {
                                let (kept, pushed) = match treatment {
                                    DampingTreatment::Explicit => (1.0 - step * c, step),
                                    DampingTreatment::ExactFlow => {
                                        ((-step * c).exp(), step * phi1(-step * c))
                                    }
                                };
                                for j in 0..2 * n {
                                    v[(i, j)] = kept * v[(i, j)] - pushed * force[(i, j)];
                                }
                            }
                        }
                    }
                }
            }
            Scheme::MaterialImplicit => {
                let mut matrix = faer::Scale(h * h) * &self.material;
                for (i, c) in self.damping.iter().enumerate() {
                    matrix[(i, i)] += 1.0 + h * c;
                }
                v -= faer::Scale(h) * (&self.stiffness * &x);
                v = matrix.partial_piv_lu().solve(&v);
                x += faer::Scale(h) * &v;
            }
        }
        // v in units of x / h: balanced.
        let map = Mat::<f64>::from_fn(2 * n, 2 * n, |i, j| {
            let across = if j < n { 1.0 } else { 1.0 / h };
            if i < n {
                x[(i, j)] * across
            } else {
                v[(i - n, j)] * h * across
            }
        });
        if (0..2 * n).any(|j| (0..2 * n).any(|i| !map[(i, j)].is_finite())) {
            return None;
        }
        let all = map.eigenvalues().ok()?;
        let all = all.into_iter().map(|z| Complex::new(z.re, z.im));
        let counts = |z: &Complex<f64>| {
            let rests = self.at_rest && (z - 1.0).norm() <= AT_REST;
            let grows = self.unstable && z.im == 0.0 && z.re > 1.0;
            !rests && !grows
        };
        all.filter(counts)
            .max_by(|a, b| a.norm().total_cmp(&b.norm()))
    }

    /// ln |eigenvalue| / h; None where the map is not finite.
    pub(super) fn growth(&self, scheme: Scheme, h: f64) -> Option<f64> {
        let farthest = self.farthest(scheme, h)?;
        Some(farthest.norm().clamp(f64::MIN_POSITIVE, f64::MAX).ln() / h)
    }

    /// The limit near `guess`, s: a scan from a twentieth of it upwards. None where nothing crosses
    /// before a hundred times it.
    pub(super) fn limit(&self, scheme: Scheme, guess: f64) -> Option<f64> {
        let stable = |h: f64| {
            let farthest = self.farthest(scheme, h);
            farthest.is_some_and(|z| z.norm() <= 1.0 + GROWING)
        };
        let mut low = 0.05 * guess;
        if !stable(low) {
            low = 0.0;
        }
        let mut high = low.max(1e-3 * guess);
        while stable(high) {
            low = high;
            // Coarse where nothing is expected.
            let cell = if high < 0.5 * guess { 5.0 * CELL } else { CELL };
            high *= 1.0 + cell;
            if high > 100.0 * guess {
                return None;
            }
        }
        while high - low > 1e-12 * high {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                break;
            }
            if stable(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(low)
    }
}
