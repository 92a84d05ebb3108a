//! RATTLE and SHAKE: velocity Verlet with impulses along rods, in one stepper.

use super::{
    Coefficients, DampingTreatment, Integrator, MethodRow, Splitting, Stage, StepError, refuse,
};
use crate::physics::constraints::{At, Rods};
use crate::physics::{Dampers, ForceKinds, Injected, Power, State, Sweep, System};
use crate::vector::axpy;

/// What a step leaves of the velocity along rods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Velocities {
    /// Nothing: RATTLE.
    Still,
    /// What the last half kick gave: SHAKE. The next step takes it out, so that positions are RATTLE's.
    Free,
}

pub(super) const RATTLE: MethodRow = MethodRow {
    id: "rattle",
    name: "RATTLE (velocity Verlet on rods)",
    coefficients: Coefficients::Rattle(Velocities::Still),
    energy: Some("[1 - z²/4, 1]"),
    source: "Andersen 1983, J. Comput. Phys. 52; Leimkuhler & Skeel 1994, J. Comput. Phys. 112; Hairer, Lubich, Wanner, \
             Geometric Numerical Integration, VII.1.4",
    not: "velocity_verlet with a projection after the step, which is not symplectic; without rods the two are the same",
};

pub(super) const SHAKE: MethodRow = MethodRow {
    id: "shake",
    name: "SHAKE (velocities off the rods)",
    coefficients: Coefficients::Rattle(Velocities::Free),
    energy: Some("[1 - z²/4, 1]"),
    source: "Ryckaert, Ciccotti, Berendsen 1977, J. Comput. Phys. 23, as a velocity Verlet",
    not: "rattle, whose positions are the same: its velocities are along the rods at rest",
};

/// The stepper of both. Without rods it is velocity Verlet.
#[derive(Debug, Clone)]
pub struct Rattle {
    velocities: Velocities,
    verlet: Splitting,
}

impl Rattle {
    pub fn new(velocities: Velocities) -> Self {
        Self {
            velocities,
            verlet: Splitting::new(Stage::VERLET, DampingTreatment::Sweeps),
        }
    }

    /// A half kick, a drift that ends on the rods, a half kick.
    fn constrained(
        &mut self,
        rods: &Rods,
        system: &dyn System,
        h: f64,
        state: &mut State,
    ) -> Result<(), StepError> {
        let end = state.t + h;
        let mut old = rods.at(&state.x)?;
        self.kick(&mut old, system, state.t, 0.5 * h, [true, false], state)?;
        // What is driven has its velocity at both ends, each for a half.
        let given = state.v.clone();
        let impulses = rods.drift(&mut old, h, &mut state.x, &mut state.v, |x| {
            system.place(end, x, &mut []);
        })?;
        state.work.injected -= old.on_driven(&impulses, &given);
        drop(old);
        let mut new = rods.at(&state.x)?;
        self.kick(&mut new, system, end, 0.5 * h, [false, true], state)?;
        if self.velocities == Velocities::Still {
            let impulses = new.still(&mut state.v);
            state.work.injected -= new.on_driven(&impulses, &state.v);
        }
        state.t = end;
        Ok(())
    }

    /// A kick without the forces of rods, which impulses make up for: at once, where no damper acts in between. Dampers
    /// would slow what has yet to be taken out, and cost an order. They act among the forces of rods instead, half
    /// before and half after, which leaves impulses little to do.
    fn kick(
        &mut self,
        at: &mut At,
        system: &dyn System,
        t: f64,
        h: f64,
        ends: [bool; 2],
        state: &mut State,
    ) -> Result<(), StepError> {
        let free = Free(system);
        if !system.kinds().depends_on_velocity() {
            return self.verlet.kick(&free, t, h, ends, state);
        }
        let [mut held, mut left] = [vec![0.0; state.x.len()], vec![0.0; state.x.len()]];
        system.acceleration(t, &state.x, &state.v, &mut held);
        free.acceleration(t, &state.x, &state.v, &mut left);
        for (held, left) in held.iter_mut().zip(&mut left) {
            *held -= *left;
            *left = -h * *held;
        }
        axpy(&mut state.v, 0.5 * h, &held);
        self.verlet.kick(&free, t, h, ends, state)?;
        axpy(&mut state.v, 0.5 * h, &held);
        let impulses = at.still(&mut left);
        state.work.injected -= at.on_driven(&impulses, &state.v);
        Ok(())
    }
}

impl Integrator for Rattle {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let Some(rods) = system.rods() else {
            return self.verlet.step(system, h, state);
        };
        refuse(self, system)?;
        let start = state.clone();
        let stepped = self.constrained(rods, system, h, state);
        if stepped.is_err() {
            *state = start;
        }
        stepped
    }

    fn takes(&self) -> ForceKinds {
        ForceKinds::LINEAR.with(ForceKinds::CONSTRAINED)
    }

    fn forget(&mut self) {
        self.verlet.forget();
    }

    fn keeps_rods(&self) -> bool {
        true
    }
}

/// A system without its rods.
struct Free<'a>(&'a dyn System);

impl System for Free<'_> {
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.free_acceleration(t, x, v, a)
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds().without(ForceKinds::CONSTRAINED)
    }
    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        self.0.place(t, x, v);
    }
    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        self.0.damping(t, x, w, a);
    }
    fn dampers(&self) -> Dampers {
        self.0.dampers()
    }
    fn sweep(&self, sweep: &mut Sweep) {
        self.0.sweep(sweep);
    }
    fn injected(&self, t: f64, x: &[f64], moved: &[f64], h: f64) -> Injected {
        self.0.injected(t, x, moved, h)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
}
