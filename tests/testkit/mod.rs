//! Systems and probes the law tests share.
#![allow(dead_code, unused_imports)] // each test binary uses its own part

pub mod cloth;
pub mod gauss;
pub mod line;
pub mod mutants;
pub mod program;
pub mod scenes;

pub use springcheck::conformance::Build;
pub use springcheck::conformance::systems::{Oscillator, free_triangle, swinging_triangle};
use springcheck::integrators::{Integrator, Method, Settings, fixed};
use springcheck::physics::effects::Effect;
use springcheck::physics::{ForceKinds, ParticleSystem, Power, State, System};
use springcheck::scene::model::{Ball, Plane};
use springcheck::scene::{
    Air, Bending, Collider, Contact, DampingModel, Driven, GravitationalPair, Magnetic, Penalty,
    Scene, Sine, Triangle, Wind,
};

/// All of these in a whole run, which `SPRINGCHECK_WHOLE=1` asks for as CI does; else one in `of`,
/// beginning with number `at`: what lies in a loop over at least `of` cases that hands in its own number
/// meets them all.
pub fn part<A>(all: &[A], of: usize, at: usize) -> Vec<&A> {
    let whole = std::env::var("SPRINGCHECK_WHOLE").is_ok_and(|value| value == "1");
    let (first, every) = if whole { (0, 1) } else { (at % of, of) };
    all.iter().skip(first).step_by(every).collect()
}

/// Every row with every one of `others` in a whole run, else with one of them in turn: see [`part`].
pub fn crossed<'a, A, B>(rows: &'a [A], others: &'a [B]) -> Vec<(&'a A, &'a B)> {
    let with = |(at, row)| {
        part(others, others.len(), at)
            .into_iter()
            .map(move |other| (row, other))
    };
    rows.iter().enumerate().flat_map(with).collect()
}

/// The row's own integrator.
pub fn own(method: &'static Method) -> impl Fn() -> Box<dyn Integrator> {
    move || method.build(&Settings::default())
}

/// Whether a method has steps of its own on a scene, and is not another row's map there.
pub fn is_its_own(scene: &Scene, method: &Method) -> bool {
    method.is_its_own(ParticleSystem::new(scene).kinds())
}

pub fn method(id: &str) -> &'static Method {
    fixed()
        .iter()
        .find(|m| m.id == id)
        .unwrap_or_else(|| panic!("no method {id}"))
}

/// Takes `n` steps.
pub fn advance(
    integrator: &mut dyn Integrator,
    system: &dyn System,
    h: f64,
    n: usize,
    state: &mut State,
) {
    for _ in 0..n {
        integrator.step(system, h, state).expect("a solvable step");
    }
}

/// A system of unit masses from closures: acceleration and potential, undamped.
pub struct Conservative<A, U> {
    pub inverse_mass: Vec<f64>,
    pub acceleration: A,
    pub potential: U,
}

impl<A, U> System for Conservative<A, U>
where
    A: Fn(&[f64], &mut [f64]),
    U: Fn(&[f64]) -> f64,
{
    fn dim(&self) -> usize {
        self.inverse_mass.len()
    }
    fn inverse_mass(&self) -> &[f64] {
        &self.inverse_mass
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }
    fn acceleration(&self, _t: f64, x: &[f64], _v: &[f64], a: &mut [f64]) -> Power {
        (self.acceleration)(x, a);
        Power::default()
    }
    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        (self.potential)(x)
    }
}

/// A small deterministic generator (xorshift64*), uniform in [-1, 1).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        bits as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// The system and start of a scene.
pub fn built(scene: &Scene) -> (ParticleSystem, State) {
    (
        ParticleSystem::new(scene),
        ParticleSystem::initial_state(scene),
    )
}

/// Largest difference between two vectors.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .fold(0.0, |m, (a, b)| f64::max(m, (a - b).abs()))
}

/// A scene that calls for every effect that every method takes.
pub fn everything(model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(0.7, model);
    scene.springs[1].cubic = 3.0;
    scene.springs[3].cubic = 5.0;
    scene.particles[1].drag = 0.3;
    scene.particles[3].drag = 0.1;
    scene.wind = Some(Wind {
        direction: [0.6, 0.0, 0.8],
        strength: 1.5,
    });
    for ends in [[1, 2], [2, 3], [0, 3]] {
        scene.gravitational.push(GravitationalPair { ends, g: 2.0 });
    }
    for (particles, rest_angle) in [([0, 1, 2], 0.0), ([1, 2, 3], 0.8)] {
        scene.bending.push(Bending {
            particles,
            stiffness: 0.01,
            rest_angle,
            damping: 0.02,
        });
    }
    scene.particles[1].charge = 0.8;
    scene.particles[2].charge = -0.5;
    scene.magnetic = Some(Magnetic {
        field: [0.4, -0.3, 0.6],
    });
    scene
}

/// The scene with its first fixed particle on a swing.
pub fn driven(mut scene: Scene) -> Scene {
    let particle = scene.particles.iter().position(|p| p.fixed);
    scene.driven.push(Driven {
        particle: particle.expect("a fixed particle"),
        sine: Some(Sine {
            amplitude: [0.3, -0.1, 0.2],
            omega: 5.0,
            phase: 0.4,
        }),
        ..Driven::default()
    });
    scene
}

/// The same and contact by penalty: every free particle is inside a plane and a ball.
pub fn pressed(model: DampingModel) -> Scene {
    let mut scene = all_effects(model);
    let plane = Plane {
        normal: [0.6, 0.0, 0.8],
        offset: 9.0,
    };
    let ball = Ball {
        center: [7.0, -5.0, 3.0],
        radius: 20.0,
    };
    scene.colliders = vec![
        Collider {
            plane: Some(plane),
            ..Collider::default()
        },
        Collider {
            ball: Some(ball),
            ..Collider::default()
        },
    ];
    scene.contact = Some(Contact {
        penalty: Some(Penalty {
            stiffness: 0.01,
            damping: 0.2,
        }),
        ..Contact::default()
    });
    scene
}

/// A scene that calls for every effect of the registry but that of contact, in moving air.
pub fn all_effects(model: DampingModel) -> Scene {
    let mut scene = driven(everything(model));
    scene.air = Some(Air {
        velocity: [0.6, -0.3, 0.2],
        density: 1.2,
    });
    scene.particles[1].quadratic_drag = 0.2;
    scene.particles[2].quadratic_drag = 0.4;
    for (corners, air_drag) in [([1, 2, 3], 1.0), ([0, 3, 1], 0.7)] {
        scene.triangles.push(Triangle { corners, air_drag });
    }
    scene
}

/// Random positions near the scene's and random velocities of order 1.
pub fn sample(scene: &Scene, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let start = ParticleSystem::initial_state(scene);
    let x = start.x.iter().map(|x| x + 0.2 * random.next()).collect();
    let v = start.x.iter().map(|_| random.next()).collect();
    (x, v)
}

/// An effect's force alone, and its powers.
pub fn force(effect: &dyn Effect, x: &[f64], v: &[f64]) -> (Vec<f64>, Power) {
    let mut f = vec![0.0; x.len()];
    let power = effect.add_force(0.0, x, v, &mut f);
    (f, power)
}
