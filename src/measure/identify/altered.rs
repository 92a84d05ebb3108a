//! Systems that are not quite the scene's: one particle among others that stand still, forces that are held over a
//! step, or off by their rounding.

use super::step::acceleration;
use crate::integrators::StepError;
use crate::physics::constraints::contact::Obstacles;
use crate::physics::constraints::{Rods, StrainLimiter};
use crate::physics::{Dampers, ForceKinds, Jacobian, Linearization, Power, State, Sweep, System};
use crate::vector::axpy;
use std::cell::Cell;

/// Applies a step to a state over h, in this many substeps where it has some.
pub type Around = fn(&OneStep, &dyn System, f64, u32, &mut State) -> Result<(), StepError>;
/// A step of h from a state in place.
pub type OneStep<'a> = dyn Fn(&dyn System, f64, &mut State) -> Result<(), StepError> + 'a;

/// One particle of a system, the others where they are.
pub(super) struct Alone<'a> {
    pub(super) inner: &'a dyn System,
    pub(super) others: &'a State,
    /// Its first coordinate.
    pub(super) at: usize,
}

impl System for Alone<'_> {
    fn inverse_mass(&self) -> &[f64] {
        &self.inner.inverse_mass()[self.at..self.at + 3]
    }

    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let own = self.at..self.at + 3;
        let (mut all_x, mut all_v) = (self.others.x.clone(), self.others.v.clone());
        all_x[own.clone()].copy_from_slice(x);
        all_v[own.clone()].copy_from_slice(v);
        a.copy_from_slice(&acceleration(self.inner, t, &all_x, &all_v)[own]);
        Power::default()
    }

    fn kinds(&self) -> ForceKinds {
        self.inner.kinds()
    }

    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        let own = self.at..self.at + 3;
        let mut all_x = self.others.x.clone();
        let mut all_w = vec![0.0; all_x.len()];
        let mut all_a = all_w.clone();
        all_x[own.clone()].copy_from_slice(x);
        all_w[own.clone()].copy_from_slice(w);
        self.inner.damping(t, &all_x, &all_w, &mut all_a);
        a.copy_from_slice(&all_a[own]);
    }

    fn potential(&self, _t: f64, _x: &[f64]) -> f64 {
        0.0
    }
}

/// A system with other forces.
pub(super) struct Altered<'a> {
    inner: &'a dyn System,
    force: Altering,
}

pub(super) enum Altering {
    /// This acceleration, wherever the particles are.
    Held(Vec<f64>),
    /// The forces at these positions, wherever the particles are.
    PositionsHeld(Vec<f64>),
    /// The forces of this time, whenever they are asked for.
    TimeHeld(f64),
    /// So much more acceleration.
    Shifted(Vec<f64>),
    /// Every acceleration off by its rounding, in a direction of its own for each coordinate.
    Rounded {
        pattern: u64,
        /// The step: rounding that always pushed the same way would leave out what grows by alternating.
        step: u64,
        /// The evaluations of the step so far, of a scheme that does not iterate: rounding that pushed the same way
        /// in all of them might cancel. An iteration converges only if it is the same in all.
        evaluations: Option<Cell<u64>>,
    },
}

impl Altering {
    pub(super) fn rounded(pattern: u64, step: u64, iterates: bool) -> Self {
        let evaluations = (!iterates).then(Cell::default);
        Self::Rounded {
            pattern,
            step,
            evaluations,
        }
    }
}

impl<'a> Altered<'a> {
    pub(super) fn new(inner: &'a dyn System, force: Altering) -> Self {
        Self { inner, force }
    }

    /// An acceleration that `take` gives at a time, off by its rounding.
    fn rounded(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        a: &mut [f64],
        take: impl Fn(f64, &mut [f64]) -> Power,
    ) -> Power {
        let Altering::Rounded {
            pattern,
            step,
            evaluations,
        } = &self.force
        else {
            return take(t, a);
        };
        let mut off = vec![0.0; a.len()];
        self.inner.rounding(t, x, v, &mut off);
        let evaluations = evaluations.as_ref();
        let evaluation = evaluations.map_or(0, |all| all.replace(all.get() + 1));
        let first = evaluation as usize * a.len();
        // A running sum of the time is off by up to half a rounding a step: FIT times this.
        let late = *step as f64 * t.abs() * f64::EPSILON / 16.0;
        let power = take(t + sign((0, *pattern), 0) * late, a);
        for (i, (a, off)) in a.iter_mut().zip(off).enumerate() {
            *a += sign((!step, *pattern), first + i) * off;
        }
        power
    }
}

impl System for Altered<'_> {
    fn inverse_mass(&self) -> &[f64] {
        self.inner.inverse_mass()
    }

    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        match &self.force {
            Altering::Held(held) => a.copy_from_slice(held),
            Altering::PositionsHeld(at) => {
                self.inner.acceleration(t, at, v, a);
            }
            Altering::TimeHeld(t) => return self.inner.acceleration(*t, x, v, a),
            Altering::Shifted(shift) => {
                self.inner.acceleration(t, x, v, a);
                axpy(a, 1.0, shift);
            }
            Altering::Rounded { .. } => {
                return self.rounded(t, x, v, a, |t, a| self.inner.acceleration(t, x, v, a));
            }
        }
        Power::default()
    }

    fn rods(&self) -> Option<&Rods> {
        self.inner.rods()
    }

    fn free_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let Some(_) = self.rods() else {
            return self.acceleration(t, x, v, a);
        };
        match &self.force {
            Altering::TimeHeld(t) => self.inner.free_acceleration(*t, x, v, a),
            Altering::Rounded { .. } => {
                self.rounded(t, x, v, a, |t, a| self.inner.free_acceleration(t, x, v, a))
            }
            _ => self.acceleration(t, x, v, a),
        }
    }

    fn kinds(&self) -> ForceKinds {
        match self.force {
            Altering::Held(_) => ForceKinds::NONE,
            _ => self.inner.kinds(),
        }
    }

    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.inner.place(t, x, v);
    }

    fn obstacles(&self) -> Option<&Obstacles> {
        self.inner.obstacles()
    }

    fn strain_limiter(&self) -> Option<&StrainLimiter> {
        self.inner.strain_limiter()
    }

    fn dampers(&self) -> Dampers {
        self.inner.dampers()
    }

    fn sweep(&self, sweep: &mut Sweep) {
        self.inner.sweep(sweep);
    }

    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        self.inner.damping(t, x, w, a);
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.inner.potential(t, x)
    }

    fn jacobian(&self, t: f64, x: &[f64], v: &[f64], by: Linearization, out: &mut Jacobian) {
        match &self.force {
            Altering::Held(_) => {}
            Altering::PositionsHeld(at) => {
                let mut own = Jacobian::default();
                self.inner.jacobian(t, at, v, by, &mut own);
                out.velocity.extend(own.velocity);
            }
            _ => self.inner.jacobian(t, x, v, by, out),
        }
    }
}

/// 1 or -1, the same in every run (SplitMix64's mixing, Steele et al. 2014).
pub(super) fn sign((row, pattern): (u64, u64), at: usize) -> f64 {
    let mut z = row
        .wrapping_mul(0x9E37_79B9_7F4A_7C15)
        .wrapping_add(pattern << 40)
        .wrapping_add(at as u64)
        .wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    if (z ^ (z >> 31)) & 1 == 0 { 1.0 } else { -1.0 }
}
