//! Deterministic perturbations of a scene's start, and their energy.

use crate::measure::energy_scale;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;

/// A displacement and a change of velocity of every coordinate, zero on fixed ones.
#[derive(Debug, Clone, Default)]
pub(super) struct Perturbation {
    /// m, length 3n.
    pub x: Vec<f64>,
    /// m/s, length 3n.
    pub v: Vec<f64>,
}

/// Fraction of the energy scale a non-linear scene is perturbed with.
const SLIGHT: f64 = 1e-2;
/// The same of a scene at rest on rods: 1e-9 of its size, where angles of 1e-3 are still small, and rounding a millionth.
const TINY: f64 = 1e-18;

/// Size, m, or energy, J, of a scene that has none of its own.
const UNIT: f64 = 1.0;

impl Perturbation {
    /// The perturbation of a linear scene, where the size changes nothing: as large as the scene, so
    /// that rounding is far below it, with half of its energy in velocities, so that stiff modes do not
    /// drown soft ones.
    pub fn large(scene: &Scene, system: &ParticleSystem, quadratic: &mut Quadratic) -> Self {
        let size = Some(scene.size()).filter(|l| *l > 0.0).unwrap_or(UNIT);
        let x = noise(system.inverse_mass(), 1, |_| size);
        let potential = quadratic.potential(&x);
        let energy = Some(potential)
            .filter(|u| *u > 0.0 && u.is_finite())
            .or_else(|| energy_scale(scene, system, None))
            .unwrap_or(UNIT);
        let v = kick(system, None, energy);
        Self { x, v }
    }

    /// The perturbation of other scenes: a kick of a hundredth of `scale`, J, shared by every free
    /// coordinate, so that motions across springs, which the scene's symmetry may hide, are there to grow.
    pub fn slight(system: &ParticleSystem, start: &State, scale: f64) -> Self {
        Self {
            x: vec![0.0; system.dim()],
            v: kick(system, Some(start), SLIGHT * scale),
        }
    }

    /// A kick from a rest on rods, so small that the motion is linear until it has grown a millionfold.
    pub fn tiny(system: &ParticleSystem, start: &State, scale: f64) -> Self {
        Self {
            x: vec![0.0; system.dim()],
            v: kick(system, Some(start), TINY * scale),
        }
    }

    /// Sets this to `b` - `a`.
    pub fn set_difference(&mut self, a: &State, b: &State) {
        let subtract = |to: &mut Vec<f64>, a: &[f64], b: &[f64]| {
            to.clear();
            to.extend(b.iter().zip(a).map(|(b, a)| b - a));
        };
        subtract(&mut self.x, &a.x, &b.x);
        subtract(&mut self.v, &a.v, &b.v);
    }

    /// `factor` times as large.
    pub fn scaled(&self, factor: f64) -> Self {
        self.zip(self, |own, _| factor * own)
    }

    pub fn plus(&self, other: &Self) -> Self {
        self.zip(other, |own, other| own + other)
    }

    pub fn minus(&self, other: &Self) -> Self {
        self.zip(other, |own, other| own - other)
    }

    fn zip(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Self {
        let each = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| of(*a, *b)).collect();
        Self {
            x: each(&self.x, &other.x),
            v: each(&self.v, &other.v),
        }
    }

    /// The scene with the perturbation added to its start: a scene, not a state, since rapier's
    /// worlds are made of it.
    pub fn apply(&self, scene: &Scene) -> Scene {
        let mut perturbed = scene.clone();
        let moved = self.x.chunks_exact(3).zip(self.v.chunks_exact(3));
        let particles = perturbed.particles.iter_mut().zip(moved);
        for (particle, (x, v)) in particles.filter(|(particle, _)| !particle.fixed) {
            for axis in 0..3 {
                particle.position[axis] += x[axis];
                particle.velocity[axis] += v[axis];
            }
        }
        perturbed
    }
}

/// The relative size of rounding in positions and velocities.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// K(dv) + the potential energy of dx under forces that are linear, or are so near a rest.
#[derive(Clone)]
pub(super) struct Quadratic {
    system: ParticleSystem,
    /// The rest; the origin where forces are linear everywhere.
    rest: Vec<f64>,
    /// Forces there, without velocities: the part that does not depend on the state.
    constant: Vec<f64>,
    zero: Vec<f64>,
    place: Vec<f64>,
    force: Vec<f64>,
}

impl Quadratic {
    /// The energy of differences under linear forces.
    pub fn new(system: &ParticleSystem) -> Self {
        Self::about(system, vec![0.0; system.dim()])
    }

    /// The energy of small differences along rods, near a rest.
    pub fn about(system: &ParticleSystem, rest: Vec<f64>) -> Self {
        let zero = vec![0.0; system.dim()];
        let mut constant = zero.clone();
        system.forces(0.0, &rest, &zero, &mut constant);
        Self {
            system: system.clone(),
            constant,
            place: rest.clone(),
            rest,
            force: zero.clone(),
            zero,
        }
    }

    /// -½ dx · (f(rest + dx) - f(rest)), J. Free coordinates only: `dx` is 0 on fixed ones.
    pub fn potential(&mut self, dx: &[f64]) -> f64 {
        for ((place, rest), dx) in self.place.iter_mut().zip(&self.rest).zip(dx) {
            *place = rest + dx;
        }
        (self.system).forces(0.0, &self.place, &self.zero, &mut self.force);
        let work = dx.iter().zip(self.force.iter().zip(&self.constant));
        -0.5 * work.map(|(dx, (f, f0))| dx * (f - f0)).sum::<f64>()
    }

    pub fn energy(&mut self, of: &Perturbation) -> f64 {
        self.potential(&of.x) + self.system.kinetic(&of.v)
    }

    /// The energy of the roundings of a state, with alternating signs, so that no translation hides it.
    pub fn rounding(&mut self, State { x, v, .. }: &State) -> f64 {
        let signs = [ROUNDING, -ROUNDING].into_iter().cycle();
        let free = x.iter().zip(self.system.inverse_mass());
        let x = free.zip(signs.clone());
        self.energy(&Perturbation {
            x: x.map(|((x, w), s)| if *w > 0.0 { x * s } else { 0.0 })
                .collect(),
            v: v.iter().zip(signs).map(|(v, s)| v * s).collect(),
        })
    }
}

/// Velocities of `energy` joules in all, about equally much in every free coordinate, and along the rods of a `start`.
fn kick(system: &ParticleSystem, start: Option<&State>, energy: f64) -> Vec<f64> {
    let free = system.inverse_mass();
    let count = free.iter().filter(|w| **w > 0.0).count().max(1) as f64;
    let mut v = noise(free, 2, |w| w.sqrt());
    if let Some((start, rods)) = start.zip(system.rods())
        && let Ok(mut at) = rods.at(&start.x)
    {
        at.still(&mut v);
    }
    let kinetic = system.kinetic(&v);
    let factor = if kinetic > 0.0 && kinetic.is_finite() {
        (energy / kinetic).sqrt()
    } else {
        (energy / count).sqrt()
    };
    v.iter_mut().for_each(|c| *c *= factor);
    v
}

/// Numbers of magnitude 0.5 to 1 of either sign, times `size` of the inverse mass; 0 where fixed.
fn noise(inverse_mass: &[f64], stream: u64, size: impl Fn(f64) -> f64) -> Vec<f64> {
    let draw = |(i, w): (usize, &f64)| {
        if *w == 0.0 {
            return 0.0;
        }
        let bits = scramble(stream << 32 | i as u64);
        let magnitude = 0.5 + 0.5 * (bits >> 11) as f64 / (1u64 << 53) as f64;
        size(*w) * if bits & 1 == 0 { magnitude } else { -magnitude }
    };
    inverse_mass.iter().enumerate().map(draw).collect()
}

/// SplitMix64's finaliser (Steele, Lea & Flood 2014).
pub(super) fn scramble(key: u64) -> u64 {
    let mut z = key.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
