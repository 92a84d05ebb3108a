//! Implicit methods on forces linear in position and velocity: steps of any length are those of the textbook, and cost
//! one linear solve a stage.

use crate::testkit::scenes::{empty, fixed, free, spring};
use crate::testkit::{Build, advance, built, own};
use nalgebra::Complex;
use springcheck::integrators::{self, Coefficients, ImplicitScheme, Integrator, Method};
use springcheck::physics::{Jacobian, Linearization, Power, State, System};
use springcheck::scene::{Air, DampingModel, Magnetic, Particle, Scene};
use std::f64::consts::{PI, SQRT_2};

/// h times the rate of the fastest motion.
const STEPS: [f64; 6] = [0.06, 0.1, 1.0, 10.0, 1e3, 1e5];

/// R(z).
type Factor = fn(Complex<f64>) -> Complex<f64>;

/// Implicit methods with their R(z) and the equations they solve a step. Hairer, Wanner, Solving ODEs II, IV.3; Hosea,
/// Shampine 1996 for TR-BDF2.
fn methods() -> Vec<(&'static Method, Factor, u64)> {
    let of = |method: &'static Method| {
        let Coefficients::Implicit(scheme) = method.coefficients else {
            return None;
        };
        let (r, stages): (Factor, u64) = match scheme {
            ImplicitScheme::Midpoint | ImplicitScheme::Trapezoidal => {
                (|z| (z / 2.0 + 1.0) / (-z / 2.0 + 1.0), 1)
            }
            ImplicitScheme::TrBdf2 => (
                |z| {
                    let d = -z * (1.0 - SQRT_2 / 2.0) + 1.0;
                    (z * (SQRT_2 - 1.0) + 1.0) / (d * d)
                },
                2,
            ),
            _ => (|z| (-z + 1.0).inv(), 1),
        };
        Some((method, r, stages))
    };
    integrators::fixed().iter().filter_map(of).collect()
}

/// What two steps lead to, and what they should; both in units of the largest speed.
struct Found {
    off: f64,
    solves: u64,
}

/// A charge in a field along z.
fn charge() -> Scene {
    let particle = Particle {
        velocity: [0.6, -0.8, 0.0],
        charge: 0.5,
        ..free([0.3, 0.1, -0.2], 0.25)
    };
    Scene {
        particles: vec![particle],
        magnetic: Some(Magnetic {
            field: [0.0, 0.0, 1.5],
        }),
        ..empty()
    }
}

/// A grain with b/m = 3 that air takes along.
fn dragged(air: [f64; 3]) -> Scene {
    let particle = Particle {
        velocity: [0.6, -0.8, 0.0],
        drag: 0.6,
        ..free([0.3, 0.1, -0.2], 0.2)
    };
    Scene {
        particles: vec![particle],
        air: Some(Air {
            velocity: air,
            ..Air::default()
        }),
        ..empty()
    }
}

const LINKS: usize = 5;
/// The rate of the fastest mode of [`dampers`], 1/s.
const FASTEST: f64 = 3.0;

/// Rate of the k-th mode of a row between walls, 4 c/m sin²(k π / 2 (n + 1)).
fn rate(k: usize) -> f64 {
    let sine = |k: usize| (k as f64 * PI / (2 * LINKS) as f64).sin().powi(2);
    FASTEST * sine(k) / sine(LINKS - 1)
}

/// Particles on dampers alone, in a row between two fixed ones; each has the velocity 0.6 along x and -0.8 along y.
fn dampers() -> Scene {
    let ends = |i: usize| i == 0 || i == LINKS;
    let particles = (0..=LINKS).map(|i| {
        let at = [i as f64, 0.1, -0.2];
        if ends(i) {
            return fixed(at);
        }
        Particle {
            velocity: [0.6, -0.8, 0.0],
            ..free(at, 0.7)
        }
    });
    let mut springs: Vec<_> = (0..LINKS).map(|i| spring([i, i + 1], 0.0, 1.0)).collect();
    for spring in &mut springs {
        let fastest = (((LINKS - 1) as f64) * PI / (2 * LINKS) as f64)
            .sin()
            .powi(2);
        spring.damping = 0.7 * FASTEST / (4.0 * fastest);
    }
    Scene {
        damping_model: DampingModel::Isotropic,
        particles: particles.collect(),
        springs,
        ..empty()
    }
}

/// Velocities along x and y, as complex numbers, and positions less those at the start, of each free particle: after two
/// steps of h by a method of this R.
type Exact = fn(h: f64, r: Factor) -> Vec<[Complex<f64>; 2]>;

const V: Complex<f64> = Complex::new(0.6, -0.8);

/// v' = λ v: v0 R², and x1 = x0 + (v1 - v0)/λ, since a Runge-Kutta method keeps λ x - v.
fn one(rate: Complex<f64>, h: f64, r: Factor) -> [Complex<f64>; 2] {
    let v = V * r(rate * h).powi(2);
    [v, (v - V) / rate]
}

/// The scenes, with the rate of their fastest motion, 1/s, and what steps should lead to.
fn cases() -> [(&'static str, Scene, Exact); 3] {
    [
        ("charge", charge(), |h, r| {
            // Clockwise, seen from where the field points to.
            vec![one(Complex::new(0.0, -3.0), h, r)]
        }),
        ("drag", dragged([0.0; 3]), |h, r| {
            vec![one(Complex::new(-3.0, 0.0), h, r)]
        }),
        ("dampers", dampers(), |h, r| {
            let of = |i: usize| {
                let modes = (1..LINKS).map(|k| {
                    let shape = |i: usize| ((i * k) as f64 * PI / LINKS as f64).sin();
                    let share: f64 = (1..LINKS).map(shape).sum::<f64>() * 2.0 / LINKS as f64;
                    one(Complex::new(-rate(k), 0.0), h, r).map(|part| part * share * shape(i))
                });
                modes.fold([Complex::new(0.0, 0.0); 2], |sum, mode| {
                    [sum[0] + mode[0], sum[1] + mode[1]]
                })
            };
            (1..LINKS).map(of).collect()
        }),
    ]
}

fn law(
    scene: &Scene,
    exact: Exact,
    build: Build,
    r: Factor,
    z: f64,
    wrap: impl Fn(&dyn System, &mut dyn Integrator, f64, &mut State),
) -> Found {
    let h = z / 3.0;
    let (system, start) = built(scene);
    let (mut integrator, mut state) = (build(), start.clone());
    wrap(&system, integrator.as_mut(), h, &mut state);
    let free = (0..scene.particles.len()).filter(|&i| !scene.particles[i].fixed);
    let mut off = 0.0_f64;
    for (i, [v, moved]) in free.zip(exact(h, r)) {
        let of = |all: &[f64], from: &[f64]| {
            Complex::new(all[3 * i] - from[3 * i], all[3 * i + 1] - from[3 * i + 1])
        };
        let rest = vec![0.0; start.x.len()];
        off = off.max((of(&state.v, &rest) - v).norm());
        off = off.max((of(&state.x, &start.x) - moved).norm() / h.max(1.0));
    }
    Found {
        off,
        solves: integrator.linear_solves(),
    }
}

fn two_steps(system: &dyn System, integrator: &mut dyn Integrator, h: f64, state: &mut State) {
    advance(integrator, system, h, 2, state);
}

/// The solves two steps may take. Velocities of 1 m/s are known to eps, so what is left of the first solve is z eps
/// of the forces: from z = 1e-12 / eps on, a second one may be needed to meet the tolerance of 1e-12.
fn solves(stages: u64, z: f64) -> u64 {
    2 * stages * if z < 1e-12 / f64::EPSILON { 1 } else { 2 }
}

#[test]
fn any_step_of_a_linear_system_is_one_solve_and_the_textbooks() {
    for (name, scene, exact) in cases() {
        for (method, r, stages) in methods() {
            for z in STEPS {
                let found = law(&scene, exact, &own(method), r, z, two_steps);
                let id = method.id;
                // Two steps of a few operations, with 2 u - v and TR-BDF2's differences in them: measured 2.3e-15.
                assert!(found.off < 7e-15, "{name} {id} {z}: {:e}", found.off);
                assert!(
                    found.solves <= solves(stages, z),
                    "{name} {id} {z}: {} solves",
                    found.solves
                );
            }
        }
    }
}

/// Leaves the turning out of the matrix: what is off the diagonal in the velocity's derivative.
struct Blind<'a>(&'a dyn System);

impl System for Blind<'_> {
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(t, x, v, a)
    }
    fn kinds(&self) -> springcheck::physics::ForceKinds {
        self.0.kinds()
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
    fn jacobian(&self, t: f64, x: &[f64], v: &[f64], of: Linearization, out: &mut Jacobian) {
        self.0.jacobian(t, x, v, of, out);
        out.velocity.retain(|(row, column, _)| row == column);
    }
}

#[test]
fn a_matrix_without_the_field_takes_more_solves() {
    let [(_, scene, exact), ..] = cases();
    for (method, r, stages) in methods() {
        let z = 0.1;
        let found = law(
            &scene,
            exact,
            &own(method),
            r,
            z,
            |system, own, h, state| {
                advance(own, &Blind(system), h, 2, state);
            },
        );
        assert!(
            found.off > 1e-14 || found.solves > solves(stages, z),
            "{}",
            method.id
        );
    }
}

/// Steps of up to 1e5 b/m, where the grain has come to the velocity of the air and the forces that are left are
/// roundings: no step fails, and the grain stays with the air.
#[test]
fn a_grain_that_moves_with_the_air_is_at_rest_in_it() {
    // With gravity the drag holds what falls: the forces cancel, and are no smaller for that.
    for (air, gravity) in [
        ([3.0, 0.0, 0.0], 0.0),
        ([3e3, -2.0, 1.0], 0.0),
        ([0.0, 0.0, 10.0], -30.0),
    ] {
        let mut scene = dragged(air);
        scene.solver.gravity = gravity;
        // w + m g/b.
        let last = [air[0], air[1], air[2] + gravity / 3.0];
        for (method, ..) in methods() {
            for z in [0.5, 10.0, 75.0, 1e3, 1e5] {
                let (system, mut state) = built(&scene);
                let mut integrator = own(method)();
                for _ in 0..400 {
                    let stepped = integrator.step(&system, z / 3.0, &mut state);
                    stepped.unwrap_or_else(|e| panic!("{} {z} {air:?}: {e}", method.id));
                }
                // |R| of the A-stable ones is nearly 1 at large z.
                let r = (1.0 - z / 2.0) / (1.0 + z / 2.0);
                let slow = 2.0 * r.abs().powi(400);
                let size = air.iter().fold(1.0, |m: f64, a| m.max(a.abs()));
                for axis in 0..3 {
                    let off = (state.v[axis] - last[axis]).abs() / size;
                    // 400 roundings of the velocity.
                    assert!(off < slow + 1e-13, "{} {z} {air:?}: {off:e}", method.id);
                }
            }
        }
    }
}
