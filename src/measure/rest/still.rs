//! The forces on particles that do not move.

use crate::physics::effects::EffectRow;
use crate::physics::{
    Derivative, ForceKinds, Jacobian, Linearization, ParticleSystem, Power, System,
};
use crate::scene::Scene;

/// Roundings of positions, times the slopes of the forces, that may be left of these.
const ROUNDINGS: f64 = 8.0;

/// The forces on particles that do not move: what a rest balances.
pub(super) struct Still {
    /// What has a potential.
    potential: ParticleSystem,
    /// What has none at rest: wind, moving air.
    other: ParticleSystem,
    /// The forces of that where the last step ended, N.
    kept: Vec<f64>,
    /// How they change with the positions about there, the symmetric part: what a potential can have.
    slopes: Jacobian,
    /// Where the last step ended, m.
    at: Vec<f64>,
    zero: Vec<f64>,
}

/// What is left of the forces.
#[derive(Clone, Copy)]
pub(super) struct Left {
    /// The largest on a free particle, N.
    pub force: f64,
    /// That particle.
    pub particle: usize,
    /// Whether it is no more than roundings of positions and of what cancels, where these are largest.
    pub rounded: bool,
}

impl Still {
    pub(super) fn new(scene: &Scene) -> Self {
        let does_work = ForceKinds::DRIVEN | ForceKinds::NON_LINEAR;
        let of = |potential: bool| {
            let build = |row: &EffectRow| {
                let effect = (row.build)(scene)?;
                (effect.kinds().has(does_work) != potential).then_some(effect)
            };
            ParticleSystem::with(scene, &build)
        };
        let potential = of(true);
        let zero = vec![0.0; potential.dim()];
        Self {
            potential,
            other: of(false),
            kept: zero.clone(),
            slopes: Jacobian::default(),
            at: zero.clone(),
            zero,
        }
    }

    /// What is left of all forces here. Those without a potential are kept from now on.
    pub(super) fn left(&mut self, x: &[f64]) -> Left {
        self.other.forces(0.0, x, &self.zero, &mut self.kept);
        self.at.copy_from_slice(x);
        let mut exact = Jacobian::default();
        let kept = Linearization::Exact;
        self.other.jacobian(0.0, x, &self.zero, kept, &mut exact);
        self.slopes.clear();
        for (row, column, value) in exact.position {
            self.slopes.position.push((row, column, 0.5 * value));
            self.slopes.position.push((column, row, 0.5 * value));
        }
        let mut a = self.zero.clone();
        self.acceleration(0.0, x, &self.zero, &mut a);
        let mut rounding = self.zero.clone();
        self.rounding(0.0, x, &self.zero, &mut rounding);
        let mut floor = 0.0_f64;
        let mut left = Left {
            force: 0.0,
            particle: 0,
            rounded: false,
        };
        for (i, &w) in self.inverse_mass().iter().enumerate() {
            let force = a[i].abs() / w;
            if w > 0.0 {
                floor = floor.max(rounding[i] / w);
            }
            if w > 0.0 && (force > left.force || force.is_nan()) {
                (left.force, left.particle) = (force, i / 3);
            }
        }
        // A solve is as precise as its largest entries.
        left.rounded = left.force <= ROUNDINGS * floor;
        left
    }

    /// Whether something without a potential acts.
    pub(super) fn is_pulled(&self) -> bool {
        !self.other.effects().is_empty()
    }

    /// Whether what has no potential depends on the positions.
    pub(super) fn changes(&self) -> bool {
        !self.slopes.position.is_empty()
    }

    /// The forces without a potential here, as they change from where the last step ended, N.
    fn pulled(&self, x: &[f64]) -> Vec<f64> {
        let mut forces = self.kept.clone();
        if self.is_pulled() {
            let moved: Vec<f64> = x.iter().zip(&self.at).map(|(x, at)| x - at).collect();
            let by = Derivative::Position;
            self.slopes.add_product(by, 1.0, &moved, &mut forces);
        }
        forces
    }

    /// The largest acceleration, m/s²; the smallest number above 0 where there is none.
    pub(super) fn fastest(&self, x: &[f64]) -> f64 {
        let mut a = self.zero.clone();
        self.acceleration(0.0, x, &self.zero, &mut a);
        a.iter()
            .fold(f64::MIN_POSITIVE, |most, a| most.max(a.abs()))
    }

    /// The largest force of one effect on a free particle, N: what the forces that cancel consist of.
    pub(super) fn largest_share(&self, x: &[f64]) -> f64 {
        let mut most = 0.0_f64;
        for (_, effect) in self.potential.effects().iter().chain(self.other.effects()) {
            let mut f = self.zero.clone();
            effect.add_force(0.0, x, &self.zero, &mut f);
            let forces = f.iter().zip(self.inverse_mass());
            let free = forces.filter(|(_, w)| **w > 0.0);
            most = free.fold(most, |most, (f, _)| most.max(f.abs()));
        }
        most
    }
}

impl System for Still {
    fn inverse_mass(&self) -> &[f64] {
        self.potential.inverse_mass()
    }

    fn acceleration(&self, t: f64, x: &[f64], _: &[f64], a: &mut [f64]) -> Power {
        self.potential.acceleration(t, x, &self.zero, a);
        let other = self.pulled(x);
        for ((a, f), w) in a.iter_mut().zip(other).zip(self.inverse_mass()) {
            *a += f * w;
        }
        Power::default()
    }

    /// Some last bits of the positions, and of what cancels, effect by effect. Not to be confused with what other programs'
    /// forces may differ by, which is far more at hinges.
    fn rounding(&self, t: f64, x: &[f64], _: &[f64], a: &mut [f64]) {
        a.fill(0.0);
        let effects = self.potential.effects().iter().chain(self.other.effects());
        for (_, effect) in effects {
            let mut f = self.zero.clone();
            effect.add_force(t, x, &self.zero, &mut f);
            for (a, f) in a.iter_mut().zip(f) {
                *a += 4.0 * f64::EPSILON * f.abs();
            }
        }
        let mut slopes = Jacobian::default();
        self.jacobian(t, x, &self.zero, Linearization::Exact, &mut slopes);
        slopes.add_magnitudes(Derivative::Position, f64::EPSILON, x, a);
        for (a, w) in a.iter_mut().zip(self.inverse_mass()) {
            *a *= w;
        }
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        let pulls = self.kept.iter().zip(self.pulled(x));
        let moved = x.iter().zip(&self.at);
        let work = pulls
            .zip(moved)
            .map(|((from, to), (x, at))| 0.5 * (from + to) * (x - at));
        self.potential.potential(t, x) - work.sum::<f64>()
    }

    fn jacobian(&self, t: f64, x: &[f64], _: &[f64], kept: Linearization, out: &mut Jacobian) {
        self.potential.jacobian(t, x, &self.zero, kept, out);
        // Whatever its sign: masses are added until the matrix is definite.
        if kept == Linearization::Exact {
            out.position.extend(&self.slopes.position);
        }
        out.forget(Derivative::Velocity);
    }
}
