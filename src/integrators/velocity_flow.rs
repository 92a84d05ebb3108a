//! The exact flow of v' = a0 + G v at frozen positions, where G = M⁻¹ D(x) is the damping.
//!
//! v(h) = v + h φ1(hG) r with r = a0 + G v, and the integral of the velocity is
//! ∫ v = h v + h² φ2(hG) r. Both actions come from one Krylov space: by Taylor series where h G is small,
//! else by Lanczos in the mass metric, in which damping is self-adjoint. A magnetic field is not: with one, the
//! projected matrix is Arnoldi's, and its functions come from one exponential of a matrix two rows larger.
//! (Hochbruck & Lubich 1997, SIAM J. Numer. Anal. 34; φ functions as in Niesen & Wright 2012, ACM TOMS 38; the
//! exponential is that of Sidje 1998, ACM TOMS 24; the stopping rule is that of Saad 1992, SIAM J. Numer. Anal. 29.)
//!
//! Where only damping acts, a0 = 0, and h G is large, v(h) = e^(hG) v is computed directly. The sum
//! v + h φ1 r has an error of a last bit of v, which a later substep backward would amplify.

use super::{StepError, axpy, fit, largest, worst_particle};
use crate::krylov::Space;
use crate::physics::{ForceKinds, State, System, phi1, phi2};
use nalgebra::{DMatrix, Dyn, SymmetricEigen};

/// The number of Taylor terms before Lanczos takes over.
const TAYLOR_TERMS: usize = 12;
/// The largest dimension of the Krylov space. A flow that needs more is taken in two halves.
const KRYLOV: usize = 60;
/// Convergence is tested after every this many vectors, since each test solves an eigenproblem.
const TESTED_EVERY: usize = 6;
/// The number of halvings, 4,096 pieces, after which the damping counts as too stiff.
pub(super) const HALVINGS: u32 = 12;

/// Scratch memory of the flow.
#[derive(Debug, Clone, Default)]
pub(super) struct VelocityFlow {
    r: Vec<f64>,
    term: Vec<f64>,
    next: Vec<f64>,
    /// φ1(hG) r and φ2(hG) r; for damping alone e^(hG) v and φ1(hG) v.
    phi1: Vec<f64>,
    phi2: Vec<f64>,
}

impl VelocityFlow {
    /// Advances `state.v` and the work over `h` at frozen `state.x`; `a0` is the acceleration at
    /// rest, length n. What is driven is in its place. A flow that needs too large a Krylov space is halved, up to `halvings` times.
    ///
    /// # Errors
    /// [`StepError::DampingTooStiff`] when even the smallest pieces need too large a space. The state is
    /// then somewhere within the step.
    pub(super) fn advance(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        a0: &[f64],
        state: &mut State,
        halvings: u32,
    ) -> Result<(), StepError> {
        let n = a0.len();
        let Self { r, term, next, .. } = self;
        for buffer in [r, term, next, &mut self.phi1, &mut self.phi2] {
            fit(buffer, n);
        }
        system.damping(t, &state.x, &state.v, &mut self.r);
        axpy(&mut self.r, 1.0, a0);
        let speed = largest(&state.v);
        let summed = self.taylor(system, t, h, &state.x, speed);
        let driven = system.kinds().has(ForceKinds::DRIVEN);
        // A driven end pulls through its damper, so damping is not alone.
        let alone = !(summed || driven) && a0.iter().all(|a| *a == 0.0);
        let done = if alone {
            self.r.copy_from_slice(&state.v);
            self.lanczos(system, t, h, &state.x, speed, VELOCITY)
        } else {
            summed || self.lanczos(system, t, h, &state.x, speed, CHANGE)
        };
        if !done {
            let Some(halvings) = halvings.checked_sub(1) else {
                let particle = worst_particle(&self.r);
                return Err(StepError::DampingTooStiff { particle });
            };
            self.advance(system, t, 0.5 * h, a0, state, halvings)?;
            return self.advance(system, t, 0.5 * h, a0, state, halvings);
        }
        // First the displacement ∫ v, then the work of a0 along it. The dissipated energy is this work less
        // the gain in kinetic energy.
        let displacement = &mut self.term;
        for ((d, v), phi) in displacement.iter_mut().zip(&state.v).zip(&self.phi2) {
            *d = if alone { h * phi } else { h * (v + h * phi) };
        }
        let mut dissipated = 0.0;
        for (i, w) in system.inverse_mass().iter().enumerate() {
            if *w > 0.0 {
                let old = state.v[i];
                let change = if alone {
                    self.phi1[i] - old
                } else {
                    h * self.phi1[i]
                };
                state.v[i] = if alone { self.phi1[i] } else { old + change };
                dissipated += (a0[i] * displacement[i] - change * (old + 0.5 * change)) / w;
            }
        }
        // A magnetic field alone leaves the rounding of a difference that is 0.
        if system.kinds().damps() {
            state.work.dissipated += dissipated;
        }
        if driven {
            let work = system.injected(t, &state.x, displacement, h);
            state.work.injected += work.forces + work.dampers;
            state.work.dissipated += work.dampers;
        }
        Ok(())
    }

    /// Replaces `state.v` by (1 - hG/2)⁻¹ (1 + hG/2) v, the midpoint rule of damping alone, and books what it takes: in the
    /// Krylov space of v, until the residual of the linear system is below its last bit.
    ///
    /// # Errors
    /// [`StepError::DampingTooStiff`] when it needs too large a space; the state is then as it was.
    pub(super) fn midpoint(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        state: &mut State,
    ) -> Result<(), StepError> {
        let inverse_mass = system.inverse_mass();
        let scale = length(&state.v, inverse_mass);
        if scale == 0.0 || !scale.is_finite() {
            return Ok(());
        }
        let start = state.v.iter().map(|v| v / scale).collect();
        let mut space = Space::new(start, |u, w| weighted_dot(u, w, inverse_mass));
        for k in 0..KRYLOV {
            let beta = space.multiply(|q, image| system.damping(t, &state.x, q, image));
            let closed = beta <= 1e-13 * space.image || beta == 0.0;
            let one = |i, j| f64::from(u8::from(i == j));
            let matrix =
                DMatrix::from_fn(k + 1, k + 1, |i, j| one(i, j) - 0.5 * h * space.entry(i, j));
            let first = DMatrix::from_fn(k + 1, 1, |i, _| one(i, 0));
            if let Some(mean) = matrix.lu().solve(&first)
                && (closed || (0.5 * h * beta * mean[k]).abs() <= 0.25 * f64::EPSILON)
            {
                // The new velocity is twice the mean less the old.
                let before: f64 = weighted_dot(&state.v, &state.v, inverse_mass);
                for (v, w) in state.v.iter_mut().zip(inverse_mass) {
                    *v *= if *w > 0.0 { -1.0 } else { 1.0 };
                }
                for (row, q) in space.basis.iter().enumerate() {
                    axpy(&mut state.v, 2.0 * scale * mean[row], q);
                }
                if system.kinds().damps() {
                    let after = weighted_dot(&state.v, &state.v, inverse_mass);
                    state.work.dissipated += 0.5 * (before - after);
                }
                return Ok(());
            }
            if space.extend().is_none() {
                break;
            }
        }
        let particle = worst_particle(&state.v);
        Err(StepError::DampingTooStiff { particle })
    }

    /// Sums (hG)^k r / (k+1)! and / (k+2)! until a term is below the last bit of the sum, or of velocities of
    /// size `speed`, to which the sum is added; false if that takes too many terms.
    fn taylor(&mut self, system: &dyn System, t: f64, h: f64, x: &[f64], speed: f64) -> bool {
        self.term.copy_from_slice(&self.r);
        self.phi1.copy_from_slice(&self.r);
        for (phi2, r) in self.phi2.iter_mut().zip(&self.r) {
            *phi2 = 0.5 * r;
        }
        let mut weight1 = 1.0;
        let mut weight2 = 0.5;
        for k in 1..=TAYLOR_TERMS {
            system.damping(t, x, &self.term, &mut self.next);
            std::mem::swap(&mut self.term, &mut self.next);
            for term in &mut self.term {
                *term *= h;
            }
            weight1 /= (k + 1) as f64;
            weight2 /= (k + 2) as f64;
            axpy(&mut self.phi1, weight1, &self.term);
            axpy(&mut self.phi2, weight2, &self.term);
            let size = largest(&self.term) * weight1;
            if size <= 0.25 * f64::EPSILON * largest(&self.phi1).max(speed / h.abs()) {
                return true;
            }
            if !size.is_finite() || (k == 1 && size > 0.5 * largest(&self.r)) {
                return false;
            }
        }
        false
    }

    /// Lanczos, or Arnoldi where a magnetic field acts, with full reorthogonalisation in the inner product <u, w> = uᵀ M w; false if it would need
    /// too large a space. `speed` is the size of the velocities to which h φ1 r is added, or of v itself.
    fn lanczos(
        &mut self,
        system: &dyn System,
        t: f64,
        h: f64,
        x: &[f64],
        speed: f64,
        actions: Actions,
    ) -> bool {
        let inverse_mass = system.inverse_mass();
        let turns = system.kinds().has(ForceKinds::GYROSCOPIC);
        let scale = length(&self.r, inverse_mass);
        self.phi1.fill(0.0);
        self.phi2.fill(0.0);
        if scale == 0.0 || !scale.is_finite() {
            // r is 0, or the state is no longer finite, which the caller finds in the result.
            self.phi1.copy_from_slice(&self.r);
            return true;
        }
        let start = self.r.iter().map(|r| r / scale).collect();
        let mut space = Space::new(start, |u, w| weighted_dot(u, w, inverse_mass));
        for k in 0..KRYLOV {
            let beta = space.multiply(|q, image| system.damping(t, x, q, image));
            // Only rounding is left after orthogonalising: the space is invariant.
            let closed = beta <= 1e-13 * space.image || beta == 0.0;
            if closed || (k + 1) % TESTED_EVERY == 0 {
                let projected = |entry: &dyn Fn(usize, usize) -> f64| {
                    DMatrix::from_fn(k + 1, k + 1, |i, j| h * entry(i, j))
                };
                let acted = if turns {
                    by_exponential(projected(&|i, j| space.entry(i, j)), actions)
                } else {
                    by_eigenvectors(projected(&|i, j| space.tridiagonal(i, j)), actions)
                };
                let Some([c1, c2]) = acted else {
                    return false;
                };
                // The contribution of the next vector, estimated by the last component (Saad 1992, eq. 28).
                let missing = (h * beta).abs() * c1[k].abs();
                let per_step = if actions.whole { 1.0 } else { h.abs() };
                let beside = speed / (per_step * scale) * mass_root(inverse_mass);
                let enough = largest(&c1).max(beside);
                if closed || missing <= 0.25 * f64::EPSILON * enough {
                    for (row, q) in space.basis.iter().enumerate() {
                        axpy(&mut self.phi1, scale * c1[row], q);
                        axpy(&mut self.phi2, scale * c2[row], q);
                    }
                    return true;
                }
            }
            if space.extend().is_none() {
                return false;
            }
        }
        false
    }
}

/// The two functions of h G whose actions are computed.
#[derive(Clone, Copy)]
struct Actions {
    first: fn(f64) -> f64,
    second: fn(f64) -> f64,
    /// Whether the first is the new velocity itself, and not its change over h.
    whole: bool,
}

/// The functions applied to r.
const CHANGE: Actions = Actions {
    first: phi1,
    second: phi2,
    whole: false,
};
/// The functions applied to v, where only damping acts.
const VELOCITY: Actions = Actions {
    first: f64::exp,
    second: phi1,
    whole: true,
};
/// The largest exponent: e to a larger one may overflow. Half a step has half the exponent.
const EXPONENT: f64 = 700.0;

/// The actions on e1 for a projected matrix h T that is symmetric; None where they are not finite.
fn by_eigenvectors(projected: DMatrix<f64>, actions: Actions) -> Option<[Vec<f64>; 2]> {
    let small = eigen(projected)?;
    if actions.whole && small.eigenvalues.iter().any(|z| *z > EXPONENT) {
        return None;
    }
    Some([actions.first, actions.second].map(|phi| act(&small, phi)))
}

/// The same for any projected matrix H: of the exponential of [H e1 0; 0 0 1; 0 0 0], the first column begins with
/// e^H e1, and the last two with φ1(H) e1 and φ2(H) e1.
fn by_exponential(projected: DMatrix<f64>, actions: Actions) -> Option<[Vec<f64>; 2]> {
    let n = projected.nrows();
    let mut larger = projected.resize(n + 2, n + 2, 0.0);
    larger[(0, n)] = 1.0;
    larger[(n, n + 1)] = 1.0;
    // The exponential of what is not finite might not end.
    let exponential = larger.iter().all(|c| c.is_finite()).then(|| larger.exp())?;
    let columns = if actions.whole { [0, n] } else { [n, n + 1] };
    let found = columns.map(|column| {
        exponential
            .column(column)
            .rows(0, n)
            .iter()
            .copied()
            .collect::<Vec<f64>>()
    });
    found
        .iter()
        .flatten()
        .all(|c| c.is_finite())
        .then_some(found)
}

/// The eigenvalues and eigenvectors of the projected matrix h T, symmetric and tridiagonal. None if an entry
/// is not finite, since the eigensolver might then not end.
fn eigen(tridiagonal: DMatrix<f64>) -> Option<SymmetricEigen<f64, Dyn>> {
    let finite = tridiagonal.iter().all(|c| c.is_finite());
    let sweeps = 100 * tridiagonal.nrows();
    finite
        .then(|| SymmetricEigen::try_new(tridiagonal, f64::EPSILON, sweeps))
        .flatten()
}

/// The action of a function of h T on e1.
fn act(small: &SymmetricEigen<f64, Dyn>, phi: fn(f64) -> f64) -> Vec<f64> {
    let (values, vectors) = (&small.eigenvalues, &small.eigenvectors);
    let row = |row: usize| {
        let terms = values.iter().enumerate();
        terms
            .map(|(k, &z)| vectors[(row, k)] * vectors[(0, k)] * phi(z))
            .sum()
    };
    (0..values.len()).map(row).collect()
}

/// The square root of the least free mass: a speed times this bounds its norm in the mass metric from below.
fn mass_root(inverse_mass: &[f64]) -> f64 {
    let lightest = inverse_mass.iter().fold(0.0, |m: f64, w| m.max(*w));
    if lightest > 0.0 {
        (1.0 / lightest).sqrt()
    } else {
        0.0
    }
}

/// The norm of u in the mass metric, also where its square would overflow or underflow.
fn length(u: &[f64], inverse_mass: &[f64]) -> f64 {
    let plain = weighted_dot(u, u, inverse_mass).sqrt();
    let size = largest(u);
    if plain > 0.0 || !(size > 0.0 && size.is_finite()) {
        return plain;
    }
    let scaled: Vec<f64> = u.iter().map(|c| c / size).collect();
    size * weighted_dot(&scaled, &scaled, inverse_mass).sqrt()
}

/// The sum of u w m over the free coordinates.
fn weighted_dot(u: &[f64], w: &[f64], inverse_mass: &[f64]) -> f64 {
    u.iter()
        .zip(w)
        .zip(inverse_mass)
        .filter(|(_, inverse)| **inverse > 0.0)
        .map(|((u, w), inverse)| u * w / inverse)
        .sum()
}
