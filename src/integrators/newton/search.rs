//! The stage equation M (u - b) = γ f(t, y + γ u, u), a trial solution, and the line search: it takes the full
//! step, or the part of it that descends, and goes further where the direction is not Newton's own and the
//! descent continues.
//!
//! The search minimises the incremental potential
//! Φ(u) = ½ (u - b)ᵀ M (u - b) + U(y + γ u) - W(γ u) - ½ γ uᵀ D u, whose gradient is minus the
//! residual. W is the work of forces without a potential and D(x) the damping, both taken where the search
//! begins. Without dampers and driven forces Φ is the same in every iteration, so it never rises. With axial
//! dampers D turns with x, and with a magnetic field it is not symmetric: no Φ exists then, so its change is that
//! along the line of the search alone, and a halved residual is accepted as well. (Armijo's rule; where
//! rounding hides the decrease of Φ its slope decides, as in Hager & Zhang 2005, SIAM J. Optim. 16.)

use super::{Newton, fit, worst_particle};
use crate::physics::{Derivative, ForceKinds, Jacobian, Power, System};

/// The fraction of the decrease predicted by its slope that Φ has to achieve (Armijo).
const ARMIJO: f64 = 1e-4;
/// The relative rounding error of Φ, in units of its potential energy: springs whose lengths differ by 1e-6
/// from their rest length already lose six digits.
const HIDDEN: f64 = 1e-10;
/// Where the slope decides, the largest upward slope that is accepted, in units of the initial one.
const STEEP: f64 = 0.9;
/// The number of trials along one direction.
const TRIALS: u32 = 40;
/// A step is lengthened while the downward slope is at least this fraction of the initial one.
const STILL_STEEP: f64 = 0.5;

/// The stage equation, which is solved for u.
#[derive(Clone, Copy)]
pub(super) struct StageEquation<'a> {
    pub system: &'a dyn System,
    pub t: f64,
    pub gamma: f64,
    /// The velocity from which u departs.
    pub b: &'a [f64],
    /// The position to which γ u is added.
    pub y: &'a [f64],
}

/// A trial solution u, with everything computed at it.
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
    /// U(x), once it is computed.
    potential: Option<f64>,
    /// The norm |r|.
    pub norm: f64,
    /// |r| / (|M (u - b)| + |γ f|); 0 where both norms are 0.
    pub relative: f64,
}

impl Trial {
    /// Evaluates the equation at `alpha` times `d` from another trial.
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
        self.norm = off.sqrt();
        self.relative = if !scale.is_finite() {
            f64::NAN
        } else if scale > 0.0 {
            self.norm / scale
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
        self.norm.is_finite() && self.relative.is_finite()
    }

    /// The particle with the largest residual, or the first that is not finite.
    pub(super) fn particle(&self) -> usize {
        worst_particle(&self.residual)
    }
}

/// The criterion by which a trial is accepted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Merit {
    Potential,
    /// The slope of Φ along the direction, -r·d, which needs no potential.
    Slope,
}

/// Φ along one direction d from one u, without its constant.
struct Line {
    slope: f64,
    potential: f64,
    /// dᵀ (M - γ D) d.
    curvature: f64,
    /// dᵀ (M (u - b) - γ D u) - W(γ d): the slope without the part of the potential.
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
            curvature -= dot(&damping, d);
            // D need not be symmetric, and d is 0 where a coordinate is fixed.
            damping.fill(0.0);
            jacobian.add_product(Derivative::Velocity, gamma, &from.u, &mut damping);
            rest -= dot(&damping, d);
        }
        if system.kinds().has(ForceKinds::DRIVEN) {
            let displacement: Vec<f64> = d.iter().map(|d| gamma * d).collect();
            // The force of a damper on what is free is the mirror image of that on its driven end.
            let work = system.injected(stage.t, &from.x, &displacement, 0.0);
            rest -= work.forces - work.dampers;
        }
        Self {
            slope,
            potential: from.potential(stage),
            curvature,
            rest,
        }
    }

    /// Whether the trial at α, where the slope is `slope`, is accepted. `before` is the norm of the residual at
    /// the start.
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
            || (stage.system.kinds().depends_on_velocity() && to.norm <= 0.5 * before)
    }

    /// Φ(u + α d) - Φ(u), and a bound for its rounding error.
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
    /// Leaves in `self.next` the first accepted trial along `self.d`, a descent direction that is 0 on fixed
    /// coordinates. The full step is tried first, and with `extend` longer ones after it. A trial that solves
    /// the equation, or leaves a residual of a few roundings, is accepted. False if none is.
    pub(super) fn advance(&mut self, stage: &StageEquation, merit: Merit, extend: bool) -> bool {
        let (mut line, mut floor, mut cancelled, mut alpha) = (None, None, None, 1.0);
        for _ in 0..TRIALS {
            self.next.step(stage, &self.at, alpha, &self.d);
            if !self.next.is_finite() {
                alpha *= 0.1;
                continue;
            }
            if self.next.relative <= self.settings.tolerance {
                return true;
            }
            let line = line.get_or_insert_with(|| self.line(stage));
            let slope = -dot(&self.next.residual, &self.d);
            let (before, off) = (self.at.norm, self.next.norm);
            let accepted = line.accepts(stage, merit, before, &mut self.next, [alpha, slope]);
            let mut rounding = || {
                let floor = *floor.get_or_insert_with(|| self.floor(stage));
                off <= floor
                    || (alpha < 1.0
                        && off - floor <= *cancelled.get_or_insert_with(|| self.cancelled(stage)))
            };
            self.rounded = !accepted && rounding();
            if accepted || self.rounded {
                if extend && merit == Merit::Potential && alpha == 1.0 {
                    self.lengthen(stage, line, slope);
                }
                return true;
            }
            // The next trial is where the secant of the slopes vanishes, within bounds.
            let secant = line.slope / (line.slope - slope);
            alpha *= if slope > 0.0 {
                secant.clamp(0.1, 0.5)
            } else {
                0.5
            };
        }
        false
    }

    fn line(&mut self, stage: &StageEquation) -> Line {
        Line::new(stage, &mut self.at, &self.d, &self.jacobian)
    }

    /// Doubles the step while Φ keeps falling steeply.
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

    /// Leaves the full step in `self.next`. True if Φ does not rise and at most a tenth of the residual is left.
    pub(super) fn try_full_step(&mut self, stage: &StageEquation) -> bool {
        self.next.step(stage, &self.at, 1.0, &self.d);
        if !self.next.is_finite() || self.next.norm > 0.1 * self.at.norm {
            return false;
        }
        let (change, hidden) = self.line(stage).change(stage, 1.0, &mut self.next);
        change <= hidden
    }
}
