//! The one-step map of a splitting on a part whose modes damping couples, as a matrix.

use super::Limit;
use super::part::Part;
use super::spectrum::Spectrum;
use crate::integrators::{Amplification, DampingTreatment, Stage, bisect};
use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use nalgebra::DMatrix;

/// A part over (ξ, v), in the basis of its damping's eigenvectors where that is symmetric: ξ are the displacements
/// that change some force.
pub(super) struct StepMap {
    /// The change of ξ with the velocities, and the force of ξ over the masses.
    drift: Mat<f64>,
    force: Mat<f64>,
    material: Mat<f64>,
    damping: Damping,
    /// How many modes grow in truth: a step follows them.
    unstable: usize,
}

/// C, 1/s.
enum Damping {
    /// Its eigenvalues, where it is symmetric.
    Apart(Vec<f64>),
    /// C itself: a magnetic field turns velocities.
    Turning(DMatrix<f64>),
}

/// A modulus beyond 1 by more than this is growth. The eigenvalues of an unsymmetric matrix carry some
/// rounding, and where the limit is, they grow linearly in h at least.
const GROWING: f64 = 1e-10;
/// The scan's steps, in parts of h, and how far it goes, in units of the guess.
const CELL: f64 = 0.02;
const FAR: f64 = 1e4;
/// A limit is confirmed by steps this much inside and outside it, relative.
const BESIDE: f64 = 1e-4;

impl Damping {
    /// Multiplies velocities and `force` by the two factors of a kick over `step`, and subtracts.
    fn kick(&self, treatment: DampingTreatment, step: f64, force: &Mat<f64>, v: &mut Mat<f64>) {
        match self {
            Self::Apart(rates) => {
                for (i, c) in rates.iter().enumerate() {
                    let (kept, pushed) = treatment.kick(step, *c);
                    for j in 0..v.ncols() {
                        v[(i, j)] = kept * v[(i, j)] - pushed * force[(i, j)];
                    }
                }
            }
            Self::Turning(c) => {
                let factors = treatment.kick_matrices(step, c);
                let [kept, pushed] =
                    factors.map(|by| Mat::from_fn(c.nrows(), c.nrows(), |i, j| by[(i, j)]));
                *v = kept * &*v - pushed * force;
            }
        }
    }
}

impl StepMap {
    /// None where the eigenvectors of a symmetric damping are not found.
    pub fn new(spectrum: &Spectrum) -> Option<Self> {
        let Part {
            stiffness,
            damping,
            material,
            ..
        } = &spectrum.part;
        let felt = spectrum.part.felt()?;
        let n = damping.n();
        let (u, damping) = if damping.skewness() > 0.0 {
            let turning = DMatrix::from_fn(n, n, |i, j| damping.at(i, j));
            (Mat::identity(n, n), Damping::Turning(turning))
        } else {
            let eigen = damping.dense().self_adjoint_eigen(Side::Lower).ok()?;
            let values = eigen.S().column_vector();
            let values = (0..n).map(|i| values[i]).collect();
            (eigen.U().to_owned(), Damping::Apart(values))
        };
        Some(Self {
            drift: felt.transpose() * &u,
            force: u.transpose() * stiffness.dense() * &felt,
            material: u.transpose() * material.dense() * &u,
            damping,
            unstable: spectrum.left_out.map_or(0, |left_out| left_out.unstable),
        })
    }

    /// The step's matrix on (ξ, h v).
    fn matrix(&self, amplification: Amplification, h: f64) -> Option<Mat<f64>> {
        let (n, rank) = (self.force.nrows(), self.force.ncols());
        let size = rank + n;
        let one = |from: usize| move |i, j| f64::from(u8::from(i + from == j));
        let mut x = Mat::<f64>::from_fn(rank, size, one(0));
        let mut v = Mat::<f64>::from_fn(n, size, one(rank));
        // Velocities in units of ξ / h: balanced.
        let drift = |part: f64| faer::Scale(part) * &self.drift;
        let force = faer::Scale(h) * &self.force;
        match amplification {
            // Eigenvalues alone decide, wherever damping couples.
            Amplification::Rational(_) => return None,
            Amplification::Composition(stages, treatment) => {
                for stage in stages {
                    match *stage {
                        Stage::Drift(part) => x += drift(part) * &v,
                        Stage::Kick(part) => {
                            let force = &force * &x;
                            self.damping.kick(treatment, part * h, &force, &mut v);
                        }
                    }
                }
            }
            Amplification::MaterialImplicit => {
                let mut matrix = faer::Scale(h * h) * &self.material;
                for i in 0..n {
                    matrix[(i, i)] += 1.0;
                    match &self.damping {
                        Damping::Apart(rates) => matrix[(i, i)] += h * rates[i],
                        Damping::Turning(c) => (0..n).for_each(|j| matrix[(i, j)] += h * c[(i, j)]),
                    }
                }
                v -= faer::Scale(h) * (&force * &x);
                v = matrix.partial_piv_lu().solve(&v);
                x += drift(1.0) * &v;
            }
        }
        let map = Mat::from_fn(size, size, |i, j| {
            if i < rank {
                x[(i, j)]
            } else {
                v[(i - rank, j)]
            }
        });
        let finite = |j| (0..size).all(|i: usize| map[(i, j)].is_finite());
        (0..size).all(finite).then_some(map)
    }

    /// The modulus of the eigenvalue that is farthest out, of those that are the method's doing: as many may
    /// lie outside the unit circle as there are modes that grow in truth. None where the map is not finite.
    fn radius(&self, amplification: Amplification, h: f64) -> Option<f64> {
        let all = self.matrix(amplification, h)?.eigenvalues().ok()?;
        let mut moduli: Vec<f64> = all.iter().map(|z| z.re.hypot(z.im)).collect();
        moduli.sort_by(|a, b| b.total_cmp(a));
        let outside = moduli.iter().filter(|m| **m > 1.0 + GROWING).count();
        let skipped = if outside > self.unstable { 0 } else { outside };
        Some(moduli.get(skipped).copied().unwrap_or(0.0))
    }

    fn is_stable(&self, amplification: Amplification, h: f64) -> bool {
        let radius = self.radius(amplification, h);
        radius.is_some_and(|radius| radius <= 1.0 + GROWING)
    }

    /// ln |eigenvalue| / h, 1/s; None where the map is not finite.
    pub fn growth(&self, amplification: Amplification, h: f64) -> Option<f64> {
        let radius = self.radius(amplification, h)?;
        Some(radius.clamp(f64::MIN_POSITIVE, f64::MAX).ln() / h)
    }

    /// Whether a limit holds just inside and no longer just outside.
    pub fn confirms(&self, amplification: Amplification, limit: &Limit) -> bool {
        match limit {
            Limit::At(h) => {
                self.is_stable(amplification, h * (1.0 - BESIDE))
                    && !self.is_stable(amplification, h * (1.0 + BESIDE))
            }
            _ => true,
        }
    }

    /// The limit near `guess`, s: a scan from a twentieth of it upwards.
    pub fn limit(&self, amplification: Amplification, guess: f64) -> Limit {
        let stable = |h: f64| self.is_stable(amplification, h);
        let mut low = 0.05 * guess;
        while !stable(low) {
            low *= 0.1;
            if low < 1e-6 * guess {
                return Limit::Unknown(
                    "no step of the linearised scene is seen to be stable".into(),
                );
            }
        }
        let mut high = low;
        while stable(high) {
            low = high;
            // Coarse where nothing is expected.
            let expected = (0.5..4.0).contains(&(high / guess));
            high *= 1.0 + if expected { CELL } else { 5.0 * CELL };
            if high > FAR * guess {
                return Limit::Unknown(format!(
                    "stable up to {high:.1e} s; larger steps were not looked at"
                ));
            }
        }
        Limit::At(bisect(low, high, 1e-10, stable))
    }
}
