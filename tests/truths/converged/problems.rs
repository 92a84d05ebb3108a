//! Systems whose motion is known, and scenes with none of that.

use crate::testkit::scenes::{empty, free, spring};
use crate::testkit::{Conservative, Oscillator};
use springcheck::physics::{ParticleSystem, Power, State, System};
use springcheck::scene::{GravitationalPair, Particle, Scene};
use springcheck::truth::converged::SharedSystem;
use std::sync::Arc;

/// A system, its start, and where it is at a time, all coordinates.
pub struct Known {
    pub name: &'static str,
    pub system: SharedSystem,
    pub start: State,
    pub until: f64,
    pub size: f64,
    pub truth: Box<dyn Fn(f64) -> Vec<f64>>,
}

/// Unit masses under a force of the positions.
pub fn closure(
    dim: usize,
    acceleration: impl Fn(&[f64], &mut [f64]) + Send + Sync + 'static,
) -> SharedSystem {
    Arc::new(Conservative {
        inverse_mass: vec![1.0; dim],
        acceleration,
        potential: |_: &[f64]| 0.0,
    })
}

/// Two unit masses between walls, three springs of k = 4: modes of w = 2 and w = 2 sqrt(3).
pub fn chain() -> Known {
    let system = closure(2, |x, a| {
        a[0] = 4.0 * (x[1] - 2.0 * x[0]);
        a[1] = 4.0 * (x[0] - 2.0 * x[1]);
    });
    Known {
        name: "chain",
        system,
        start: State::new(vec![1.0, 0.25], vec![0.0, 0.0]),
        until: 20.0,
        size: 1.0,
        truth: Box::new(|t| {
            let slow = 0.625 * (2.0 * t).cos();
            let fast = 0.375 * (12.0_f64.sqrt() * t).cos();
            vec![slow + fast, slow - fast]
        }),
    }
}

/// x'' = -w² x - 2 ζ w x' with w = 5 and ζ = 0.1, released at 1.
pub fn damped() -> Known {
    let (w, zeta) = (5.0_f64, 0.1_f64);
    Known {
        name: "damped oscillator",
        system: Arc::new(Oscillator { w, zeta }),
        start: State::new(vec![1.0], vec![0.0]),
        until: 6.0,
        size: 1.0,
        truth: Box::new(move |t| {
            let own = w * (1.0 - zeta * zeta).sqrt();
            let phase = own * t;
            vec![(-zeta * w * t).exp() * (phase.cos() + zeta * w / own * phase.sin())]
        }),
    }
}

/// Two equal masses on Kepler ellipses of eccentricity 0.6 about their centre, in a scene with
/// `gravitational`: semi-major axis 1.25, mean motion 0.8, every number of the start a double.
pub fn kepler() -> Known {
    let scene = bodies(&[
        (0.625, [-0.25, 0.0, 0.0], [0.0, -1.0, 0.0]),
        (0.625, [0.25, 0.0, 0.0], [0.0, 1.0, 0.0]),
    ]);
    Known {
        name: "Kepler",
        system: Arc::new(ParticleSystem::new(&scene)),
        start: ParticleSystem::initial_state(&scene),
        until: 20.0,
        size: 0.5,
        truth: Box::new(|t| {
            let (e, mean) = (0.6, 0.8 * t);
            let mut anomaly: f64 = mean;
            for _ in 0..50 {
                let residual = anomaly - e * anomaly.sin() - mean;
                anomaly -= residual / (1.0 - e * anomaly.cos());
            }
            let x = 0.625 * (anomaly.cos() - e);
            let y = 0.625 * 0.8 * anomaly.sin();
            vec![-x, -y, 0.0, x, y, 0.0]
        }),
    }
}

/// A unit mass that always falls towards the origin with acceleration 1, from 1: parabolas of
/// duration 2 sqrt(2) between kinks.
pub fn kinked() -> Known {
    Known {
        name: "kinked",
        system: closure(1, |x, a| {
            a[0] = if x[0] == 0.0 { 0.0 } else { -x[0].signum() }
        }),
        start: State::new(vec![1.0], vec![0.0]),
        until: 5.0,
        size: 1.0,
        truth: Box::new(|t| {
            let quarter = 2.0_f64.sqrt();
            let half = ((t - quarter) / (2.0 * quarter)).floor() + 1.0;
            let since = t - quarter * 2.0 * half;
            let side = if half % 2.0 == 0.0 { 1.0 } else { -1.0 };
            vec![side * (1.0 - 0.5 * since * since)]
        }),
    }
}

/// Thrown through nothing but gravity; one particle, so the scene has no size.
pub fn thrown() -> Known {
    let mut scene = bodies(&[(2.0, [0.0, 0.0, 3.0], [1.0, 0.0, 4.0])]);
    scene.solver.gravity = -9.81;
    Known {
        name: "thrown",
        system: Arc::new(ParticleSystem::new(&scene)),
        start: ParticleSystem::initial_state(&scene),
        until: 5.0,
        size: 0.0,
        truth: Box::new(|t| vec![t, 0.0, 3.0 + 4.0 * t - 4.905 * t * t]),
    }
}

/// q'' = -sin q from q = 0 with q' = 2k: q = 2 asin(k sn(t, k)).
pub fn pendulum(k: f64) -> (SharedSystem, State) {
    let system = closure(1, |q, a| a[0] = -q[0].sin());
    (system, State::new(vec![0.0], vec![2.0 * k]))
}

/// Masses, positions and velocities under mutual attraction with G = 1 and nothing else.
pub fn bodies(of: &[(f64, [f64; 3], [f64; 3])]) -> Scene {
    let pairs = (0..of.len()).flat_map(|i| (i + 1..of.len()).map(move |j| [i, j]));
    Scene {
        name: "bodies".into(),
        duration: 3.0,
        particles: of
            .iter()
            .map(|&(mass, position, velocity)| Particle {
                velocity,
                ..free(position, mass)
            })
            .collect(),
        gravitational: pairs
            .map(|ends| GravitationalPair { ends, g: 1.0 })
            .collect(),
        ..empty()
    }
}

/// The seven stars of Hairer, Nørsett, Wanner, II.10, as the IVP test set states them.
pub fn pleiades() -> Scene {
    let x = [3.0, 3.0, -1.0, -3.0, 2.0, -2.0, 2.0];
    let y = [3.0, -3.0, 2.0, 0.0, 0.0, -4.0, 4.0];
    let u = [0.0, 0.0, 0.0, 0.0, 0.0, 1.75, -1.5];
    let v = [0.0, 0.0, 0.0, -1.25, 1.0, 0.0, 0.0];
    let stars: Vec<_> = (0..7)
        .map(|i| ((i + 1) as f64, [x[i], y[i], 0.0], [u[i], v[i], 0.0]))
        .collect();
    bodies(&stars)
}

/// A mass on a spring of rest length 1 that is shot at the other, fixed end and misses it by
/// `miss`, m.
pub fn shot(miss: f64) -> Scene {
    let mut scene = bodies(&[
        (1.0, [0.0, 0.0, 0.0], [0.0; 3]),
        (1.0, [1.5, miss, 0.0], [-12.0, 0.0, 0.0]),
    ]);
    scene.particles[0].fixed = true;
    scene.gravitational.clear();
    scene.springs.push(spring([0, 1], 50.0, 1.0));
    scene
}

/// An oscillator whose force is off by a millionth, by an amount every position draws anew: no two
/// methods can agree on it.
pub struct Rough;

impl System for Rough {
    fn dim(&self) -> usize {
        1
    }
    fn inverse_mass(&self) -> &[f64] {
        &[1.0]
    }
    fn acceleration(&self, _t: f64, x: &[f64], _v: &[f64], a: &mut [f64]) -> Power {
        let drawn = x[0].to_bits().wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
        a[0] = -x[0] + 1e-3 * (drawn as f64 / (1_u64 << 23) as f64 - 1.0);
        Power::default()
    }
    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        0.5 * x[0] * x[0]
    }
}
