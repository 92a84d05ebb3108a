//! Where modes are coupled, by damping or by stiffness a method leaves out: limits from a definite matrix,
//! or else from the one-step map as a matrix.

use super::definite::{self, Definite};
use super::parts::Part;
use super::spectrum::Solved;
use super::verdict::Verdict;
use super::{Effort, Limit};
use crate::integrators::{Amplification, Stage, bisect};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::Complex;

/// What a method does to a part at `h`, s.
pub(super) fn verdict(
    amplification: Amplification,
    solved: &Solved,
    h: f64,
    effort: &Effort,
) -> Verdict {
    let part = &solved.part;
    let n = part.n();
    let by_theory =
        Definite::of(amplification).and_then(|kind| definite::limit(kind, part, effort));
    let map = (n <= effort.map).then(|| Coupled::new(solved)).flatten();
    let mut verdict = match (by_theory, &map) {
        (Some(found), None) => found,
        (Some(found), Some(_)) if part.symmetric => found,
        // For stiffnesses that are not symmetric the theory is about their symmetric part only.
        (found, Some(map)) => {
            let rate = part.stiffness.norm().sqrt().max(part.damping.norm());
            let mut verdict = found.unwrap_or(Verdict::only(Limit::Unconditional));
            let guess = match verdict.limit {
                Limit::At(guess) => guess,
                _ => 2.0 / rate,
            };
            let limit = map.limit(amplification, guess);
            verdict.limit = limit.map_or(Limit::Unconditional, Limit::At);
            verdict
        }
        (None, None) => {
            return Verdict::unknown(&format!(
                "damping couples {n} coordinates: too many for this method's one-step map"
            ));
        }
    };
    let growth = map.and_then(|map| map.growth(amplification, h));
    let stable = verdict.limit.allows(h);
    verdict.growth = growth.map(|growth| if stable { growth.min(0.0) } else { growth });
    verdict
}

/// A part in the basis of its damping's eigenvectors, where that is symmetric.
struct Coupled {
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
    fn new(solved: &Solved) -> Option<Self> {
        let Part {
            stiffness,
            damping,
            material,
            ..
        } = &solved.part;
        if damping.skewness() > 1e-13 * damping.norm() {
            return None;
        }
        let eigen = damping.dense().self_adjoint_eigen(Side::Lower).ok()?;
        let u = eigen.U();
        let turned = |m: Mat<f64>| u.transpose() * m * u;
        let values = eigen.S().column_vector();
        Some(Self {
            stiffness: turned(stiffness.dense()),
            material: turned(material.dense()),
            damping: (0..damping.n()).map(|i| values[i]).collect(),
            at_rest: solved.left_out.is_none_or(|left_out| left_out.at_rest > 0),
            unstable: solved.left_out.is_none_or(|left_out| left_out.unstable > 0),
        })
    }

    /// The eigenvalue of one step that is farthest out, of those that count.
    fn farthest(&self, amplification: Amplification, h: f64) -> Option<Complex<f64>> {
        let n = self.damping.len();
        let mut x = Mat::<f64>::from_fn(n, 2 * n, |i, j| f64::from(u8::from(i == j)));
        let mut v = Mat::<f64>::from_fn(n, 2 * n, |i, j| f64::from(u8::from(i + n == j)));
        match amplification {
            // Eigenvalues alone decide, wherever damping couples.
            Amplification::Rational(_) => return None,
            Amplification::Composition(stages, treatment) => {
                for stage in stages {
                    match *stage {
                        Stage::Drift(part) => x += faer::Scale(part * h) * &v,
                        Stage::Kick(part) => {
                            let force = &self.stiffness * &x;
                            for (i, c) in self.damping.iter().enumerate() {
                                let (kept, pushed) = treatment.kick(part * h, *c);
                                for j in 0..2 * n {
                                    v[(i, j)] = kept * v[(i, j)] - pushed * force[(i, j)];
                                }
                            }
                        }
                    }
                }
            }
            Amplification::MaterialImplicit => {
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
    fn growth(&self, amplification: Amplification, h: f64) -> Option<f64> {
        let farthest = self.farthest(amplification, h)?;
        Some(farthest.norm().clamp(f64::MIN_POSITIVE, f64::MAX).ln() / h)
    }

    /// The limit near `guess`, s: a scan from a twentieth of it upwards. None where nothing crosses
    /// before a hundred times it.
    fn limit(&self, amplification: Amplification, guess: f64) -> Option<f64> {
        let stable = |h: f64| {
            let farthest = self.farthest(amplification, h);
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
        Some(bisect(low, high, 1e-12, stable))
    }
}
