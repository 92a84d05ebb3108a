//! The stage equation M (u - b) = γ f(t, y + γ u, u), one trial of it, and how far to go along a
//! direction: the full step, or as much of it as descends; further, where the
//! direction is not Newton's own and still falls there.
//!
//! What descends is the incremental potential
//! Φ(u) = ½ (u - b)ᵀ M (u - b) + U(y + γ u) - W(γ u) - ½ γ uᵀ D u, whose gradient is minus the
//! residual: W the work of forces without a potential and D(x) the damping, both as they are where
//! the search begins. Without dampers and driven forces Φ is the same in every iteration, so it
//! never rises; with dampers along their springs D turns with x, no Φ exists, and a halved residual
//! counts as well. (Armijo's rule; where rounding hides the decrease of Φ its slope decides, as in
//! Hager & Zhang 2005, SIAM J. Optim. 16.)

use super::{Newton, fit, worst_particle};
use crate::physics::{Derivative, ForceKinds, Jacobian, Power, System};

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

/// What is to be solved for u.
#[derive(Clone, Copy)]
pub(super) struct StageEquation<'a> {
    pub system: &'a dyn System,
    pub t: f64,
    pub gamma: f64,
    /// The velocity u departs from.
    pub b: &'a [f64],
    /// The position γ u is added to.
    pub y: &'a [f64],
}

/// Everything known of one u.
#[derive(Default)]
pub(super) struct Trial {
    pub u: Vec<f64>,
    /// y + γ u.
    pub x: Vec<f64>,
    a: Vec<f64>,
    /// r = γ f - M (u - b), kg m/s: minus the gradient of the incremental potential, where there
    /// is one. 0 on fixed coordinates.
    pub residual: Vec<f64>,
    pub power: Power,
    /// U(x), once it has been asked for.
    potential: Option<f64>,
    /// |r|.
    pub off: f64,
    /// |r| / (|M (u - b)| + |γ f|), 0 where both are.
    pub relative: f64,
}

impl Trial {
    /// Evaluates the equation `alpha` times `d` from another trial.
    fn step(&mut self, stage: &StageEquation, from: &Self, alpha: f64, d: &[f64]) {
        self.u.clear();
        let steps = from.u.iter().zip(d);
        self.u.extend(steps.map(|(u, d)| u + alpha * d));
        self.evaluate(stage);
    }

    /// Evaluates the equation at `self.u`.
    pub(super) fn evaluate(&mut self, stage: &StageEquation) {
        let n = self.u.len();
        for buffer in [&mut self.x, &mut self.a, &mut self.residual] {
            fit(buffer, n);
        }
        self.potential = None;
        let gamma = stage.gamma;
        for ((x, y), u) in self.x.iter_mut().zip(stage.y).zip(&self.u) {
            *x = y + gamma * u;
        }
        let system = stage.system;
        self.power = system.acceleration(stage.t, &self.x, &self.u, &mut self.a);
        let (mut left, mut right, mut off) = (0.0_f64, 0.0_f64, 0.0_f64);
        for (i, &w) in system.inverse_mass().iter().enumerate() {
            self.residual[i] = if w > 0.0 {
                let inertia = (self.u[i] - stage.b[i]) / w;
                let impulse = gamma * self.a[i] / w;
                left += inertia * inertia;
                right += impulse * impulse;
                off += (inertia - impulse) * (inertia - impulse);
                impulse - inertia
            } else {
                0.0
            };
        }
        let scale = left.sqrt() + right.sqrt();
        self.off = off.sqrt();
        self.relative = if !scale.is_finite() {
            f64::NAN
        } else if scale > 0.0 {
            self.off / scale
        } else {
            0.0
        };
    }

    fn potential(&mut self, stage: &StageEquation) -> f64 {
        let x = &self.x;
        *self
            .potential
            .get_or_insert_with(|| stage.system.potential(stage.t, x))
    }

    pub(super) fn is_finite(&self) -> bool {
        self.off.is_finite() && self.relative.is_finite()
    }

    /// The particle with the largest residual, or the first that is not finite.
    pub(super) fn particle(&self) -> usize {
        worst_particle(&self.residual)
    }
}

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
    fn new(stage: &StageEquation, from: &mut Trial, d: &[f64], jacobian: &Jacobian) -> Self {
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
            jacobian.add_product(Derivative::Velocity, gamma, d, &mut damping);
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

    /// Whether a trial is good: α from the start, where the residual was `before`, with this slope there.
    fn accepts(
        &self,
        stage: &StageEquation,
        merit: Merit,
        before: f64,
        to: &mut Trial,
        [alpha, slope]: [f64; 2],
    ) -> bool {
        let flat = slope <= STEEP * self.slope.abs();
        if merit == Merit::Slope {
            return flat;
        }
        let (change, hidden) = self.change(stage, alpha, to);
        change <= ARMIJO * alpha * self.slope
            || (flat && alpha * self.slope.abs() <= hidden && change <= hidden)
            || (stage.system.kinds().depends_on_velocity() && to.off <= 0.5 * before)
    }

    /// Φ(u + α d) - Φ(u), and how much of it may be rounding.
    fn change(&self, stage: &StageEquation, alpha: f64, to: &mut Trial) -> (f64, f64) {
        let potential = to.potential(stage);
        let change =
            alpha * (self.rest + 0.5 * alpha * self.curvature) + (potential - self.potential);
        (change, HIDDEN * (self.potential.abs() + potential.abs()))
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

impl Newton {
    /// Leaves in `self.next` the first good trial along `self.d`, a direction of descent that is 0 on fixed
    /// coordinates: the full step, if it is one, and further with `extend`. A trial that solves the equation,
    /// or leaves a residual of a few roundings, is good. False if no trial is.
    pub(super) fn advance(&mut self, stage: &StageEquation, merit: Merit, extend: bool) -> bool {
        let (mut line, mut floor, mut alpha) = (None, None, 1.0);
        for _ in 0..TRIALS {
            self.next.step(stage, &self.at, alpha, &self.d);
            if !self.next.is_finite() {
                alpha *= 0.1;
                continue;
            }
            if self.next.relative <= self.tolerance {
                return true;
            }
            let line = line.get_or_insert_with(|| self.line(stage));
            let slope = -dot(&self.next.residual, &self.d);
            let (before, off) = (self.at.off, self.next.off);
            if line.accepts(stage, merit, before, &mut self.next, [alpha, slope])
                || off <= *floor.get_or_insert_with(|| self.floor(stage))
            {
                if extend && merit == Merit::Potential && alpha == 1.0 {
                    self.lengthen(stage, line, slope);
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

    fn line(&mut self, stage: &StageEquation) -> Line {
        Line::new(stage, &mut self.at, &self.d, &self.jacobian)
    }

    /// Doubles the step while Φ falls as steeply as at the start.
    fn lengthen(&mut self, stage: &StageEquation, line: &Line, mut slope: f64) {
        let mut alpha = 1.0;
        let mut further = Trial::default();
        for _ in 0..TRIALS {
            if slope > STILL_STEEP * line.slope {
                return;
            }
            alpha *= 2.0;
            further.step(stage, &self.at, alpha, &self.d);
            let fell = |to: &mut Trial, alpha: f64| line.change(stage, alpha, to).0;
            if !further.is_finite()
                || fell(&mut further, alpha) >= fell(&mut self.next, 0.5 * alpha)
            {
                return;
            }
            slope = -dot(&further.residual, &self.d);
            std::mem::swap(&mut self.next, &mut further);
        }
    }

    /// Leaves the full step in `self.next`; false unless Φ does not rise and a tenth of the residual is left.
    pub(super) fn leaps(&mut self, stage: &StageEquation) -> bool {
        self.next.step(stage, &self.at, 1.0, &self.d);
        if !self.next.is_finite() || self.next.off > 0.1 * self.at.off {
            return false;
        }
        let (change, hidden) = self.line(stage).change(stage, 1.0, &mut self.next);
        change <= hidden
    }
}
