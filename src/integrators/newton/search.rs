//! How far to go along a direction: the full step, or as much of it as descends; further, where the
//! direction is not Newton's own and still falls there.
//!
//! What descends is the incremental potential
//! Φ(u) = ½ (u - b)ᵀ M (u - b) + U(y + γ u) - W(γ u) - ½ γ uᵀ D u, whose gradient is minus the
//! residual: W the work of forces without a potential and D(x) the damping, both as they are where
//! the search begins. Without dampers and driven forces Φ is the same in every iteration, so it
//! never rises; with dampers along their springs D turns with x, no Φ exists, and a halved residual
//! counts as well. (Armijo's rule; where rounding hides the decrease of Φ its slope decides, as in
//! Hager & Zhang 2005, SIAM J. Optim. 16.)

use super::stage::{Stage, Trial};
use crate::physics::{ForceKinds, Jacobian, Slope};

/// Share of the decrease its slope promises that Φ has to make (Armijo).
const ARMIJO: f64 = 1e-4;
/// Φ is known to no better than this share of its potential energy: lengths that differ by 1e-6
/// from their rest length already lose six digits of it.
const HIDDEN: f64 = 1e-10;
/// Where the slope decides, it may not be left steeper than this, upwards.
const STEEP: f64 = 0.9;
/// Trials along one direction.
const TRIALS: u32 = 40;
/// A step is lengthened while the slope is no less than this share of what it was.
const STILL_STEEP: f64 = 0.5;

/// What decides whether a trial is good.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Merit {
    Potential,
    /// Its slope along the direction, -r·d, which needs no potential.
    Slope,
}

/// Φ along one direction d from one u, without what is constant.
struct Line {
    slope: f64,
    potential: f64,
    /// dᵀ (M - γ D) d.
    curvature: f64,
    /// dᵀ (M (u - b) - γ D u) - W(γ d), the slope without the potential's part.
    rest: f64,
}

impl Line {
    fn new(stage: &Stage, from: &mut Trial, d: &[f64], jacobian: &Jacobian) -> Self {
        let (system, gamma) = (stage.system, stage.gamma);
        let (mut slope, mut curvature, mut rest) = (0.0, 0.0, 0.0);
        for (i, &w) in system.inverse_mass().iter().enumerate() {
            if w > 0.0 {
                slope -= from.residual[i] * d[i];
                curvature += d[i] * d[i] / w;
                rest += d[i] * (from.u[i] - stage.b[i]) / w;
            }
        }
        if system.kinds().depends_on_velocity() {
            let mut damping = vec![0.0; d.len()];
            jacobian.add_product(Slope::Velocity, gamma, d, &mut damping);
            // D is symmetric, and d is 0 where a coordinate is fixed.
            curvature -= dot(&damping, d);
            rest -= dot(&damping, &from.u);
        }
        if system.kinds().has(ForceKinds::DRIVEN) {
            let displacement: Vec<f64> = d.iter().map(|d| gamma * d).collect();
            rest -= system.injected_power(stage.t, &from.x, &displacement);
        }
        Self {
            slope,
            potential: from.potential(stage),
            curvature,
            rest,
        }
    }

    /// Φ(u + α d) - Φ(u), and how much of it may be rounding.
    fn change(&self, stage: &Stage, alpha: f64, to: &mut Trial) -> (f64, f64) {
        let potential = to.potential(stage);
        let change =
            alpha * (self.rest + 0.5 * alpha * self.curvature) + (potential - self.potential);
        (change, HIDDEN * (self.potential.abs() + potential.abs()))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What a search needs to know.
pub(super) struct Search<'a> {
    pub stage: &'a Stage<'a>,
    /// Of descent, and 0 on fixed coordinates.
    pub d: &'a [f64],
    /// ∂f/∂v at the start, among others.
    pub jacobian: &'a Jacobian,
    pub merit: Merit,
    /// Whether a good full step may be lengthened: a direction whose matrix had its negative part left
    /// out knows where to go, but not how far.
    pub extend: bool,
    /// A trial with this relative residual needs no further judgement.
    pub tolerance: f64,
}

impl Search<'_> {
    /// Leaves in `to` the first good trial from `from`: the full step, if it is one. What leaves a
    /// residual of no more than `floor`, a few roundings, is good. False if no trial is.
    pub(super) fn run(
        &self,
        from: &mut Trial,
        to: &mut Trial,
        mut floor: impl FnMut(&Trial) -> f64,
    ) -> bool {
        let (stage, d) = (self.stage, self.d);
        let mut line = None;
        let mut alpha = 1.0;
        for _ in 0..TRIALS {
            to.u.clear();
            to.u.extend(from.u.iter().zip(d).map(|(u, d)| u + alpha * d));
            to.evaluate(stage);
            if !to.is_finite() {
                alpha *= 0.1;
                continue;
            }
            if to.relative <= self.tolerance {
                return true;
            }
            let line = line.get_or_insert_with(|| Line::new(stage, from, d, self.jacobian));
            let slope = -dot(&to.residual, d);
            if self.is_good(from.off, to, line, alpha, slope) || to.off <= floor(from) {
                if self.extend && self.merit == Merit::Potential && alpha == 1.0 {
                    self.lengthen(from, to, line, slope);
                }
                return true;
            }
            // Where the secant of the slopes vanishes, within bounds.
            let share = line.slope / (line.slope - slope);
            alpha *= if slope > 0.0 {
                share.clamp(0.1, 0.5)
            } else {
                0.5
            };
        }
        false
    }

    /// Doubles the step while Φ falls as steeply as at the start.
    fn lengthen(&self, from: &Trial, to: &mut Trial, line: &Line, mut slope: f64) {
        let mut alpha = 1.0;
        let mut further = Trial::default();
        for _ in 0..TRIALS {
            if slope > STILL_STEEP * line.slope {
                return;
            }
            alpha *= 2.0;
            let steps = from.u.iter().zip(self.d);
            further.u.clear();
            further.u.extend(steps.map(|(u, d)| u + alpha * d));
            further.evaluate(self.stage);
            let fell = |to: &mut Trial, alpha: f64| line.change(self.stage, alpha, to).0;
            if !further.is_finite() || fell(&mut further, alpha) >= fell(to, 0.5 * alpha) {
                return;
            }
            slope = -dot(&further.residual, self.d);
            std::mem::swap(to, &mut further);
        }
    }

    /// Leaves the full step in `to`; false unless Φ does not rise and a tenth of the residual is left.
    pub(super) fn leaps(&self, from: &mut Trial, to: &mut Trial) -> bool {
        to.u.clear();
        to.u.extend(from.u.iter().zip(self.d).map(|(u, d)| u + d));
        to.evaluate(self.stage);
        if !to.is_finite() || to.off > 0.1 * from.off {
            return false;
        }
        let line = Line::new(self.stage, from, self.d, self.jacobian);
        let (change, hidden) = line.change(self.stage, 1.0, to);
        change <= hidden
    }

    fn is_good(&self, before: f64, to: &mut Trial, line: &Line, alpha: f64, slope: f64) -> bool {
        let flat = slope <= STEEP * line.slope.abs();
        if self.merit == Merit::Slope {
            return flat;
        }
        let (change, hidden) = line.change(self.stage, alpha, to);
        change <= ARMIJO * alpha * line.slope
            || (flat && alpha * line.slope.abs() <= hidden && change <= hidden)
            || (self.stage.system.kinds().depends_on_velocity() && to.off <= 0.5 * before)
    }
}
