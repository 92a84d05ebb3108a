//! The stage equation M (u - b) = γ f(t, y + γ u, u), and one trial of it.

use crate::physics::{Power, System};

/// What is to be solved for u.
#[derive(Clone, Copy)]
pub(super) struct Stage<'a> {
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
    /// Evaluates the equation at `self.u`.
    pub(super) fn evaluate(&mut self, stage: &Stage) {
        let n = self.u.len();
        for buffer in [&mut self.x, &mut self.a, &mut self.residual] {
            super::super::fit(buffer, n);
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

    pub(super) fn potential(&mut self, stage: &Stage) -> f64 {
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
        super::super::worst_particle(&self.residual)
    }
}
