//! Systems and probes the law tests share.
#![allow(dead_code)] // each test binary uses its own part

pub mod mutants;

use springcheck::effects::Effect;
use springcheck::integrators::{Integrator, Method, REGISTRY, Settings};
use springcheck::scene::{
    Axis, DampingModel, GravitationalPair, Particle, Scene, Solver, Spring, Wind,
};
use springcheck::system::{Jacobian, Linearization, ParticleSystem, Power, State, System};

/// x'' = -w² x - 2 ζ w x', one coordinate, mass 1.
pub struct Oscillator {
    pub w: f64,
    pub zeta: f64,
}

impl System for Oscillator {
    fn dim(&self) -> usize {
        1
    }
    fn inverse_mass(&self) -> &[f64] {
        &[1.0]
    }
    fn acceleration(&self, _t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        a[0] = -self.w * self.w * x[0] - 2.0 * self.zeta * self.w * v[0];
        Power::default()
    }
    fn is_damped(&self) -> bool {
        self.zeta != 0.0
    }
    fn damping(&self, _t: f64, _x: &[f64], w: &[f64], a: &mut [f64]) {
        a[0] = -2.0 * self.zeta * self.w * w[0];
    }
    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        0.5 * self.w * self.w * x[0] * x[0]
    }
    fn jacobian(&self, _: f64, _: &[f64], _: &[f64], _: Linearization, out: &mut Jacobian) {
        out.position.push((0, 0, -self.w * self.w));
        out.velocity.push((0, 0, -2.0 * self.zeta * self.w));
    }
}

/// Energy of an oscillator state.
pub fn energy(system: &Oscillator, state: &State) -> f64 {
    system.kinetic(&state.v) + system.potential(0.0, &state.x)
}

/// How to make an integrator; a row's own, or a mutant's.
pub type Build<'a> = &'a dyn Fn() -> Box<dyn Integrator>;

/// The row's own integrator.
pub fn own(method: &'static Method) -> impl Fn() -> Box<dyn Integrator> {
    move || (method.build)(&Settings::default())
}

pub fn method(id: &str) -> &'static Method {
    REGISTRY
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

/// The one-step map of a linear one-coordinate system as a 2 x 2 matrix over (x, v/w), row-major.
pub fn one_step_matrix(build: Build, w: f64, zeta: f64, z: f64) -> [f64; 4] {
    one_step_matrix_of(build, &Oscillator { w, zeta }, w, z)
}

/// The same of any linear system of one coordinate.
pub fn one_step_matrix_of(build: Build, system: &dyn System, w: f64, z: f64) -> [f64; 4] {
    let mut matrix = [0.0; 4];
    for column in 0..2 {
        let mut state = State::new(
            vec![if column == 0 { 1.0 } else { 0.0 }],
            vec![if column == 1 { w } else { 0.0 }],
        );
        advance(build().as_mut(), system, z / w, 1, &mut state);
        matrix[column] = state.x[0];
        matrix[2 + column] = state.v[0] / w;
    }
    matrix
}

/// Largest modulus of the eigenvalues of a 2 x 2 matrix.
pub fn spectral_radius([a, b, c, d]: [f64; 4]) -> f64 {
    let (half, det) = ((a + d) / 2.0, a * d - b * c);
    let disc = half * half - det;
    if disc < 0.0 {
        det.sqrt()
    } else {
        half.abs() + disc.sqrt()
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

/// Three masses on a triangle of springs, hung from a fixed fourth, turning and swinging in
/// 3D: non-linear, smooth, far from collisions. `damping` goes on every spring.
pub fn swinging_triangle(damping: f64, model: DampingModel) -> Scene {
    let particle = |position: [f64; 3], velocity: [f64; 3], mass: f64, fixed: bool| Particle {
        position,
        velocity,
        fixed,
        mass,
        radius: 0.1,
        drag: 0.0,
    };
    let spring = |a: usize, b: usize, stiffness: f64, rest_length: f64| Spring {
        ends: [a, b],
        stiffness,
        damping,
        rest_length,
    };
    Scene {
        name: "swinging triangle".into(),
        description: None,
        file: String::new(),
        solver: Solver {
            method: "rk4".into(),
            timestep: 0.01,
            gravity: -9.81,
            tolerance: None,
        },
        duration: 1.0,
        up: Axis::Z,
        damping_model: model,
        plot: None,
        particles: vec![
            particle([0.0, 0.0, 2.0], [0.0; 3], 1.0, true),
            particle([0.1, 0.0, 1.0], [0.3, 0.5, 0.0], 1.0, false),
            particle([0.9, 0.2, 0.4], [0.0, -0.6, 0.4], 0.5, false),
            particle([-0.3, 0.8, 0.3], [-0.4, 0.0, 0.2], 0.8, false),
        ],
        springs: vec![
            spring(0, 1, 40.0, 0.9),
            spring(1, 2, 25.0, 0.8),
            spring(2, 3, 30.0, 1.1),
            spring(3, 1, 20.0, 1.0),
        ],
        gravitational: Vec::new(),
        wind: None,
    }
}

/// The same without gravity and with nothing fixed: momentum and angular momentum are kept.
pub fn free_triangle(damping: f64, model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(damping, model);
    scene.particles.remove(0);
    scene.springs.remove(0);
    for spring in &mut scene.springs {
        spring.ends = spring.ends.map(|end| end - 1);
    }
    scene.solver.gravity = 0.0;
    scene
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

/// A scene that calls for every effect of the registry.
pub fn everything(model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(0.7, model);
    scene.particles[1].drag = 0.3;
    scene.particles[3].drag = 0.1;
    scene.wind = Some(Wind {
        direction: [0.6, 0.0, 0.8],
        strength: 1.5,
    });
    for ends in [[1, 2], [2, 3], [0, 3]] {
        scene.gravitational.push(GravitationalPair { ends, g: 2.0 });
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
