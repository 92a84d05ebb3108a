//! The system a scene describes: particles and the effects that act on them.

use super::{
    Dampers, Derivative, ForceKinds, Injected, Jacobian, Linearization, Power, Refused, State,
    Sweep, System,
};
use crate::physics::constraints::contact::Obstacles;
use crate::physics::constraints::{RodError, Rods, StrainLimiter};
use crate::physics::effects::{self, Effect, EffectRow, Scaled};
use crate::scene::{Drive, Scene};
use crate::vector;
use std::sync::Arc;

/// The effects a scene calls for, each with its registry row, in registry order.
pub type Effects = Vec<(&'static EffectRow, Box<dyn Effect>)>;

/// Particles under a scene's effects. Cloning shares the effects; the data is read-only.
#[derive(Clone)]
pub struct ParticleSystem {
    inverse_mass: Arc<[f64]>,
    effects: Arc<Effects>,
    drives: Arc<[Drive]>,
    /// The times at which a derivative of a drive jumps, s, ascending.
    jumps: Arc<[f64]>,
    kinds: ForceKinds,
    dampers: Dampers,
    rods: Option<Arc<Rods>>,
    limiter: Option<Arc<StrainLimiter>>,
    obstacles: Option<Arc<Obstacles>>,
}

impl ParticleSystem {
    /// Builds only the effects the scene calls for.
    pub fn new(scene: &Scene) -> Self {
        Self::scaled(scene, &|_| 1.0)
    }

    /// The same with the forces of each effect multiplied by a factor; 0 leaves the effect out. A program
    /// that forgets an effect, flips its sign or applies it twice computes this.
    pub fn scaled(scene: &Scene, factor: &dyn Fn(&EffectRow) -> f64) -> Self {
        Self::with(scene, &|row| {
            let effect = (row.build)(scene)?;
            match factor(row) {
                0.0 => None,
                1.0 => Some(effect),
                factor => Some(Box::new(Scaled::new(effect, factor)) as _),
            }
        })
    }

    /// The same with each effect as `build` makes it; None leaves it out.
    pub fn with(scene: &Scene, build: &dyn Fn(&EffectRow) -> Option<Box<dyn Effect>>) -> Self {
        let inverse_mass = scene
            .particles
            .iter()
            .flat_map(|p| [if p.fixed { 0.0 } else { 1.0 / p.mass }; 3])
            .collect();
        let effects = effects::REGISTRY.iter();
        let effects = effects.filter_map(|row| Some((row, build(row)?)));
        Self {
            rods: Rods::new(scene).map(Arc::new),
            limiter: StrainLimiter::new(scene).map(Arc::new),
            obstacles: Obstacles::new(scene).map(Arc::new),
            ..Self::of(inverse_mass, effects.collect())
        }
    }

    /// The same with other motions of driven particles.
    pub fn driven_as(self, change: impl Fn(&Drive) -> Drive) -> Self {
        Self {
            drives: self.drives.iter().map(change).collect(),
            ..self
        }
    }

    /// The same with other rods; None leaves them out.
    pub fn with_rods(self, change: impl FnOnce(&Rods) -> Option<Rods>) -> Self {
        Self {
            rods: self.rods.as_deref().and_then(change).map(Arc::new),
            ..self
        }
    }

    /// The same with another strain limit, where it has one; None takes it away.
    pub fn limited_as(self, change: impl Fn(&StrainLimiter) -> Option<StrainLimiter>) -> Self {
        let limiter = self.limiter.as_deref().and_then(change);
        Self {
            limiter: limiter.map(Arc::new),
            ..self
        }
    }

    /// The same with other obstacles; None leaves them out.
    pub fn with_obstacles(self, change: impl FnOnce(&Obstacles) -> Option<Obstacles>) -> Self {
        Self {
            obstacles: self.obstacles.as_deref().and_then(change).map(Arc::new),
            ..self
        }
    }

    /// The motions of driven particles.
    pub fn drives(&self) -> &[Drive] {
        &self.drives
    }

    /// A system of any effects, with 1/m of each coordinate, 1/kg; 0 for a fixed one.
    pub fn of(inverse_mass: Vec<f64>, effects: Effects) -> Self {
        let drives: Vec<Drive> = effects
            .iter()
            .flat_map(|(_, e)| e.drives().to_vec())
            .collect();
        let mut jumps: Vec<f64> = drives.iter().flat_map(Drive::knots).collect();
        jumps.sort_by(f64::total_cmp);
        jumps.dedup();
        Self {
            kinds: ForceKinds::union(effects.iter().map(|(_, effect)| effect.kinds())),
            dampers: dampers(&inverse_mass, &effects),
            inverse_mass: inverse_mass.into(),
            effects: Arc::new(effects),
            drives: drives.into(),
            jumps: jumps.into(),
            rods: None,
            limiter: None,
            obstacles: None,
        }
    }

    /// Checks that a method of this name, which accepts these kinds, accepts all forces.
    ///
    /// # Errors
    /// [`Refused`], with the effects it does not accept.
    pub fn admits(&self, method: &str, taken: ForceKinds) -> Result<(), Refused> {
        let kinds = self.kinds().without(taken);
        if kinds == ForceKinds::NONE {
            return Ok(());
        }
        let refused = self.effects.iter().filter(|(_, e)| e.kinds().has(kinds));
        Err(Refused {
            method: method.to_owned(),
            kinds,
            effects: refused.map(|(row, _)| row.id).collect(),
        })
    }

    /// The same forces with every free mass 1. A program that never divides by the mass computes this.
    pub fn with_unit_masses(&self) -> Self {
        let whole = |w: &f64| if *w > 0.0 { 1.0 } else { 0.0 };
        Self {
            inverse_mass: self.inverse_mass.iter().map(whole).collect(),
            rods: self
                .rods
                .as_ref()
                .map(|rods| Arc::new(rods.with_unit_masses())),
            limiter: self
                .limiter
                .as_ref()
                .map(|limiter| Arc::new(limiter.with_unit_masses())),
            ..self.clone()
        }
    }

    /// The state the scene starts from, at t = 0; fixed particles at rest, unless they are driven.
    pub fn initial_state(scene: &Scene) -> State {
        let mut x: Vec<f64> = scene.particles.iter().flat_map(|p| p.position).collect();
        let mut v: Vec<f64> = scene
            .particles
            .iter()
            .flat_map(|p| if p.fixed { [0.0; 3] } else { p.velocity })
            .collect();
        place(&scene.drives(), 0.0, &mut x, &mut v);
        State::new(x, v)
    }

    /// The effects that act, in registry order.
    pub fn effects(&self) -> &[(&'static EffectRow, Box<dyn Effect>)] {
        &self.effects
    }

    /// Overwrites `f` with the forces, N, those of rods included, and returns the powers, W. Forces on fixed particles,
    /// such as a spring's pull, are included; they move nothing. Where tensions of rods are not determined, all are NaN.
    pub fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        self.sum_of_forces(t, x, v, f, self.rods.as_deref())
    }

    fn sum_of_forces(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        f: &mut [f64],
        rods: Option<&Rods>,
    ) -> Power {
        vector::clear(f);
        self.placed(t, x, v, |x, v| {
            let mut power = Power::default();
            for (_, effect) in self.effects.iter() {
                power += effect.add_force(t, x, v, f);
            }
            if let Some(rods) = rods
                && rods.add_forces(t, x, v, f, &self.drives).is_err()
            {
                f.fill(f64::NAN);
            }
            power.injected -= self.along_drives(f, v);
            power
        })
    }

    /// *Adds* the forces of rods alone, N, on fixed particles too; NaN to all where tensions are not determined.
    pub fn add_rod_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let Some(rods) = &self.rods else {
            return;
        };
        let mut without = vec![0.0; f.len()];
        self.sum_of_forces(t, x, v, &mut without, None);
        let mut all = without.clone();
        let found = self.placed(t, x, v, |x, v| {
            rods.add_forces(t, x, v, &mut all, &self.drives)
        });
        for (f, (all, without)) in f.iter_mut().zip(all.iter().zip(&without)) {
            *f += if found.is_ok() {
                all - without
            } else {
                f64::NAN
            };
        }
    }

    /// The tension of each rod, N, positive where it pulls; empty without rods.
    ///
    /// # Errors
    /// [`RodError`] where they are not determined.
    pub fn rod_tensions(&self, t: f64, x: &[f64], v: &[f64]) -> Result<Vec<f64>, RodError> {
        let Some(rods) = &self.rods else {
            return Ok(Vec::new());
        };
        let mut a = vec![0.0; x.len()];
        self.free_acceleration(t, x, v, &mut a);
        self.placed(t, x, v, |x, v| rods.tensions(t, x, v, &a, &self.drives))
    }

    /// Calls `see` with driven particles where they are at this time. Without any, the vectors pass as they are.
    fn placed<T>(&self, t: f64, x: &[f64], v: &[f64], see: impl FnOnce(&[f64], &[f64]) -> T) -> T {
        if self.drives.is_empty() {
            return see(x, v);
        }
        let (mut x, mut v) = (x.to_vec(), v.to_vec());
        self.place(t, &mut x, &mut v);
        see(&x, &v)
    }

    /// Sum of f v over the driven particles.
    fn along_drives(&self, f: &[f64], v: &[f64]) -> f64 {
        let mut sum = 0.0;
        for drive in self.drives.iter() {
            for at in 3 * drive.particle..3 * drive.particle + 3 {
                sum += f[at] * v[at];
            }
        }
        sum
    }

    /// *Adds* what a rounding of the time does to forces through driven particles, N.
    fn add_rounding_of_drives(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        if self.drives.is_empty() {
            return;
        }
        let late = 4.0 * f64::EPSILON * t.abs();
        let mut off = [vec![0.0; x.len()], vec![0.0; x.len()]];
        for drive in self.drives.iter() {
            let [_, velocity, acceleration] = drive.at(t);
            for axis in 0..3 {
                let at = 3 * drive.particle + axis;
                off[0][at] = late * velocity[axis].abs() + 4.0 * f64::EPSILON * x[at].abs();
                off[1][at] = late * acceleration[axis].abs() + 4.0 * f64::EPSILON * v[at].abs();
            }
        }
        let mut slopes = Jacobian::default();
        for (_, effect) in self.effects.iter() {
            effect.add_jacobian(t, x, v, Linearization::Exact, &mut slopes);
        }
        for (by, off) in [Derivative::Position, Derivative::Velocity]
            .iter()
            .zip(&off)
        {
            slopes.add_magnitudes(*by, 1.0, off, f);
        }
    }

    /// Potential energy of the springs alone, J, for the energy scale and the divergence test.
    pub fn elastic(&self, t: f64, x: &[f64]) -> f64 {
        self.placed(t, x, &[], |x, _| {
            let elastic = self.effects.iter().filter(|(row, _)| row.elastic);
            elastic.map(|(_, effect)| effect.potential(t, x)).sum()
        })
    }
}

/// Overwrites positions, and velocities where there are any, of driven particles.
fn place(drives: &[Drive], t: f64, x: &mut [f64], v: &mut [f64]) {
    for drive in drives {
        let [position, velocity, _] = drive.at(t);
        let at = 3 * drive.particle..3 * drive.particle + 3;
        for (all, own) in [(&mut *x, position), (&mut *v, velocity)] {
            if let Some(place) = all.get_mut(at.clone()) {
                place.copy_from_slice(&own);
            }
        }
    }
}

/// How the dampers of these effects can be applied.
fn dampers(inverse_mass: &[f64], effects: &Effects) -> Dampers {
    let mut at = vec![0; inverse_mass.len() / 3];
    let damped = |(_, effect): &&(_, Box<dyn Effect>)| effect.kinds().depends_on_velocity();
    if !(effects.iter().filter(damped)).all(|(_, effect)| effect.count_dampers(&mut at)) {
        return Dampers::Whole;
    }
    let mut free = at.iter().zip(inverse_mass.iter().step_by(3));
    if free.any(|(count, w)| *count > 1 && *w > 0.0) {
        Dampers::Shared
    } else {
        Dampers::Apart
    }
}

impl System for ParticleSystem {
    fn inverse_mass(&self) -> &[f64] {
        &self.inverse_mass
    }

    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let power = self.forces(t, x, v, a);
        vector::multiply(a, &self.inverse_mass);
        power
    }

    fn free_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let power = self.sum_of_forces(t, x, v, a, None);
        vector::multiply(a, &self.inverse_mass);
        power
    }

    fn rods(&self) -> Option<&Rods> {
        self.rods.as_deref()
    }

    fn strain_limiter(&self) -> Option<&StrainLimiter> {
        self.limiter.as_deref()
    }

    fn obstacles(&self) -> Option<&Obstacles> {
        self.obstacles.as_deref()
    }

    fn rounding(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        vector::clear(a);
        self.placed(t, x, v, |x, v| {
            for (_, effect) in self.effects.iter() {
                effect.add_rounding(t, x, v, a);
            }
            self.add_rounding_of_drives(t, x, v, a);
        });
        vector::multiply(a, &self.inverse_mass);
        if let Some(rods) = &self.rods {
            let mut free = vec![0.0; a.len()];
            self.free_acceleration(t, x, v, &mut free);
            self.placed(t, x, v, |x, v| {
                rods.add_rounding(t, x, v, (&free, &self.drives), a);
            });
        }
    }

    fn kinds(&self) -> ForceKinds {
        match self.rods {
            Some(_) => self.kinds | ForceKinds::CONSTRAINED,
            None => self.kinds,
        }
    }

    fn place(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        place(&self.drives, t, x, v);
    }

    fn jumps(&self) -> &[f64] {
        &self.jumps
    }

    fn damping(&self, _t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        vector::clear(a);
        for (_, effect) in self.effects.iter() {
            if effect.kinds().depends_on_velocity() {
                effect.add_damping(x, w, a);
            }
        }
        vector::multiply(a, &self.inverse_mass);
    }

    fn dampers(&self) -> Dampers {
        self.dampers
    }

    fn sweep(&self, sweep: &mut Sweep) {
        let damped = |(_, effect): &&(_, Box<dyn Effect>)| effect.kinds().depends_on_velocity();
        let effects = self.effects.iter().filter(damped);
        if sweep.backward {
            effects.rev().for_each(|(_, effect)| effect.sweep(sweep));
        } else {
            effects.for_each(|(_, effect)| effect.sweep(sweep));
        }
    }

    fn injected(&self, t: f64, x: &[f64], moved: &[f64], h: f64) -> Injected {
        let external = self.effects.iter().map(|(_, e)| e.injected_power(t, moved));
        let mut injected = Injected {
            forces: external.sum(),
            dampers: 0.0,
        };
        if self.drives.is_empty() {
            return injected;
        }
        let rest = vec![0.0; x.len()];
        self.placed(t, x, &rest, |x, given| {
            let mut f = rest.clone();
            if h != 0.0 {
                for (_, effect) in self.effects.iter() {
                    effect.add_force(t, x, &rest, &mut f);
                }
                injected.forces -= h * self.along_drives(&f, given);
                f.fill(0.0);
            }
            if self.kinds.depends_on_velocity() {
                let mut moved = moved.to_vec();
                for drive in self.drives.iter() {
                    for at in 3 * drive.particle..3 * drive.particle + 3 {
                        moved[at] = h * given[at];
                    }
                }
                for (_, effect) in self.effects.iter() {
                    effect.add_damping(x, &moved, &mut f);
                }
                injected.dampers = -self.along_drives(&f, given);
            }
        });
        injected
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.placed(t, x, &[], |x, _| {
            self.effects.iter().map(|(_, e)| e.potential(t, x)).sum()
        })
    }

    fn jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        self.placed(t, x, v, |x, v| {
            for (_, effect) in self.effects.iter() {
                effect.add_jacobian(t, x, v, linearization, out);
            }
        });
    }
}
