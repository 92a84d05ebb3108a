//! The systems integrators are tested on: one coordinate in closed form (the constant force has three),
//! and small networks without symmetries that could hide an error, as scenes built in code.

use crate::physics::{ForceKinds, Jacobian, Linearization, ParticleSystem, Power, State, System};
use crate::scene::{DampingModel, Particle, Scene, Solver, Spring};

/// x'' = -w² x - 2 ζ w x', one coordinate, mass 1.
#[derive(Debug, Clone, Copy)]
pub struct Oscillator {
    /// rad/s.
    pub w: f64,
    /// Damping ratio.
    pub zeta: f64,
}

impl Oscillator {
    /// Its energy, J.
    pub fn energy(&self, state: &State) -> f64 {
        self.kinetic(&state.v) + self.potential(state.t, &state.x)
    }
}

impl System for Oscillator {
    fn inverse_mass(&self) -> &[f64] {
        &[1.0]
    }
    fn acceleration(&self, _t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        for ((a, x), v) in a.iter_mut().zip(x).zip(v) {
            *a = -self.w * self.w * x - 2.0 * self.zeta * self.w * v;
        }
        Power::default()
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::of_damper(self.zeta * self.w)
    }
    fn damping(&self, _t: f64, _x: &[f64], w: &[f64], a: &mut [f64]) {
        for (a, w) in a.iter_mut().zip(w) {
            *a = -2.0 * self.zeta * self.w * w;
        }
    }
    fn potential(&self, _t: f64, x: &[f64]) -> f64 {
        x.iter().map(|x| 0.5 * self.w * self.w * x * x).sum()
    }
    fn jacobian(&self, _: f64, _: &[f64], _: &[f64], _: Linearization, out: &mut Jacobian) {
        out.position.push((0, 0, -self.w * self.w));
        out.velocity.push((0, 0, -2.0 * self.zeta * self.w));
    }
}

/// x'' = -w² x of a spring turning: a stiffness that is no part of k n nᵀ, and that a method which
/// keeps only that part does not know of.
#[derive(Debug, Clone, Copy)]
pub struct Across {
    /// rad/s.
    pub w: f64,
}

impl Across {
    fn along(&self) -> Oscillator {
        Oscillator {
            w: self.w,
            zeta: 0.0,
        }
    }
}

impl System for Across {
    fn inverse_mass(&self) -> &[f64] {
        &[1.0]
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.along().acceleration(t, x, v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.along().potential(t, x)
    }
    fn jacobian(&self, t: f64, x: &[f64], v: &[f64], kept: Linearization, out: &mut Jacobian) {
        if kept == Linearization::Exact {
            self.along().jacobian(t, x, v, kept, out);
        }
    }
}

/// x'' = -w² x + cos(u t), mass 1, from x = 0.5, v = 0.3: a force that depends on time.
#[derive(Debug, Clone, Copy, Default)]
pub struct Driven;

impl Driven {
    /// w, rad/s.
    pub const W: f64 = 3.0;
    /// u, rad/s.
    pub const DRIVE: f64 = 5.0;

    pub fn start() -> State {
        State::new(vec![0.5], vec![0.3])
    }

    /// The state at time t, in closed form.
    pub fn exact(t: f64) -> State {
        let (w, u) = (Self::W, Self::DRIVE);
        let amplitude = 1.0 / (w * w - u * u);
        let (a, b) = (0.5 - amplitude, 0.3 / w);
        let ((sin, cos), (drive_sin, drive_cos)) = ((w * t).sin_cos(), (u * t).sin_cos());
        let x = a * cos + b * sin + amplitude * drive_cos;
        let v = w * (b * cos - a * sin) - u * amplitude * drive_sin;
        let mut state = State::new(vec![x], vec![v]);
        state.t = t;
        state
    }
}

impl System for Driven {
    fn inverse_mass(&self) -> &[f64] {
        &[1.0]
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }
    fn acceleration(&self, t: f64, x: &[f64], _: &[f64], a: &mut [f64]) -> Power {
        for (a, x) in a.iter_mut().zip(x) {
            *a = -Self::W * Self::W * x + (Self::DRIVE * t).cos();
        }
        Power::default()
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        let of = |x: &f64| 0.5 * Self::W * Self::W * x * x - x * (Self::DRIVE * t).cos();
        x.iter().map(of).sum()
    }
    fn jacobian(&self, _: f64, _: &[f64], _: &[f64], _: Linearization, out: &mut Jacobian) {
        out.position.push((0, 0, -Self::W * Self::W));
    }
}

/// Three coordinates of different masses, each under a force of its own that never changes.
#[derive(Debug, Clone, Copy, Default)]
pub struct ConstantForce;

impl ConstantForce {
    /// m/s².
    const A: [f64; 3] = [-9.81, 2.3, 0.7];

    pub fn start() -> State {
        State::new(vec![1.0, -0.4, 0.2], vec![0.3, 1.7, -0.9])
    }

    /// The state at time t, in closed form.
    pub fn exact(t: f64) -> State {
        let mut state = Self::start();
        for ((x, v), a) in state.x.iter_mut().zip(&mut state.v).zip(Self::A) {
            *x += *v * t + 0.5 * a * t * t;
            *v += a * t;
        }
        state.t = t;
        state
    }
}

impl System for ConstantForce {
    fn inverse_mass(&self) -> &[f64] {
        &[1.0, 2.0, 0.4]
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }
    fn acceleration(&self, _: f64, _: &[f64], _: &[f64], a: &mut [f64]) -> Power {
        for (a, constant) in a.iter_mut().zip(Self::A) {
            *a = constant;
        }
        Power::default()
    }
    fn potential(&self, _: f64, x: &[f64]) -> f64 {
        let force = Self::A.iter().zip(self.inverse_mass()).map(|(a, w)| a / w);
        -x.iter().zip(force).map(|(x, f)| x * f).sum::<f64>()
    }
    fn jacobian(&self, _: f64, _: &[f64], _: &[f64], _: Linearization, _: &mut Jacobian) {}
}

/// Three masses on a triangle of springs, hung from a fixed fourth, turning and swinging in
/// 3D: non-linear, smooth, far from collisions, of unequal masses. `damping` goes on every spring,
/// N s/m.
pub fn swinging_triangle(damping: f64, model: DampingModel) -> Scene {
    let particle = |position: [f64; 3], velocity: [f64; 3], mass: f64, fixed: bool| Particle {
        position,
        velocity,
        fixed,
        mass,
        ..Particle::default()
    };
    let spring = |a: usize, b: usize, stiffness: f64, rest_length: f64| Spring {
        ends: [a, b],
        stiffness,
        damping,
        rest_length,
        ..Spring::default()
    };
    Scene {
        name: "swinging triangle".into(),
        solver: Solver {
            method: "rk4".into(),
            timestep: 0.01,
            ..Solver::default()
        },
        duration: 1.0,
        damping_model: model,
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
        ..Scene::default()
    }
}

/// The same with drag on one particle.
pub(super) fn dragged_triangle(damping: f64) -> Scene {
    let mut scene = swinging_triangle(damping, DampingModel::Axial);
    for particle in scene.particles.iter_mut().skip(2).take(1) {
        particle.drag = 0.5;
    }
    scene
}

/// The swinging triangle without gravity and with nothing fixed: momentum and angular momentum are kept.
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

/// A scene's system and the state it starts from.
pub(super) fn built(scene: &Scene) -> (ParticleSystem, State) {
    (
        ParticleSystem::new(scene),
        ParticleSystem::initial_state(scene),
    )
}
