//! A charge in a magnetic field: what every method makes of it, and Boris' own laws. Golden numbers: q/m B = 3 along z,
//! v0 = (1, 0, 0.2).

use crate::testkit::scenes::{empty, free, spring};
use crate::testkit::{Build, Random, advance, built, distance, method, own};
use nalgebra::{DMatrix, DVector};
use springcheck::integrators::{DampingTreatment, Method, Splitting, Stage, fixed};
use springcheck::physics::{Dampers, ForceKinds, ParticleSystem, Power, State, System};
use springcheck::scene::{Axis, DampingModel, Magnetic, Particle, Scene, Spring};

/// rad/s.
const W: f64 = 3.0;

/// The golden charge: mass and charge 1 C/kg beside each other do not hide behind 1.
fn charge() -> Scene {
    let particle = Particle {
        velocity: [1.0, 0.0, 0.2],
        charge: 0.5,
        ..free([0.0; 3], 0.25)
    };
    Scene {
        particles: vec![particle],
        magnetic: Some(Magnetic {
            field: [0.0, 0.0, 0.5 * W],
        }),
        ..empty()
    }
}

/// States after each of n steps, and before the first.
fn states(scene: &Scene, build: Build, h: f64, n: usize) -> Vec<State> {
    let (system, mut state) = built(scene);
    let mut integrator = build();
    let mut all = vec![state.clone()];
    for _ in 0..n {
        advance(integrator.as_mut(), &system, h, 1, &mut state);
        all.push(state.clone());
    }
    all
}

fn across(v: &[f64]) -> f64 {
    v[0].hypot(v[1])
}

/// v keeps its size: what 1,000 steps change it by.
fn speed_law(build: Build, h: f64) -> f64 {
    let all = states(&charge(), build, h, 1_000);
    let off = all.iter().map(|s| (across(&s.v) - 1.0).abs());
    off.fold(0.0, f64::max)
}

/// The methods that turn velocities and do nothing else to them, with their turns a step.
const TURN: [(&str, f64); 5] = [
    ("velocity_verlet", 2.0),
    ("position_verlet", 1.0),
    ("boris", 1.0),
    ("yoshida4", 3.0),
    ("pefrl", 4.0),
];

#[test]
fn speed_is_kept_to_rounding_by_what_turns() {
    for (id, turns) in TURN {
        for h in [0.01, 0.1, 2.5] {
            // The same turn is rounded alike every time: half a last bit of its sine, and one of its cosine, add up
            // over 1,000 steps. Measured half of it.
            let bound = 1_000.0 * turns * f64::EPSILON;
            let off = speed_law(&own(method(id)), h);
            assert!(off < bound, "{id} {h}: {off:e}");
        }
    }
    assert!(speed_law(&own(method("rk4")), 0.1) > 1e-6);
}

/// Boris' turn a step, and the radii of its whole and half steps.
fn boris_law(build: Build, h: f64) -> Result<(), String> {
    let n = 100;
    let all = states(&charge(), build, h, n);
    let turn = 2.0 * (0.5 * W * h).atan();
    // The circle's middle lies right of the first velocity.
    let middle = [0.0, -1.0 / W];
    let half = (1.0 + (0.5 * W * h).powi(2)).sqrt() / W;
    for (k, state) in all.iter().enumerate() {
        // Clockwise, seen from where the field points to. A walk of 100 steps' roundings: measured 1.5e-15.
        let (sin, cos) = (turn * k as f64).sin_cos();
        let (dx, dy) = (state.v[0] - cos, state.v[1] + sin);
        let radius = |x: f64, y: f64| (x - middle[0]).hypot(y - middle[1]);
        let whole = radius(state.x[0], state.x[1]) - 1.0 / W;
        let [x, y] = [0, 1].map(|c| state.x[c] + 0.5 * h * state.v[c]);
        let between = radius(x, y) - half;
        let off = dx.hypot(dy).max(whole.abs()).max(between.abs());
        if off > 1e-14 {
            return Err(format!("step {k}: off by {off:e}"));
        }
    }
    Ok(())
}

#[test]
fn boris_turns_by_its_angle_on_its_radii() {
    // The published frequencies and radii of h = 0.1 and 0.01.
    for (h, frequency, radius) in [
        (0.1, 2.977_798_952_189_945, 0.337_062_473_602_611_41),
        (0.01, 2.999_775_030_370_119_2, 0.333_370_831_224_195_6),
    ] {
        assert!((2.0 * (0.5 * W * h).atan() / h - frequency).abs() < 1e-15 * 4.0);
        let half = (1.0 + (0.5 * W * h).powi(2)).sqrt() / W;
        assert!((half - radius).abs() < 1e-16 * 2.0);
        // The midpoint rule is the same map where nothing else acts: Cayley's turn between two half drifts.
        for id in ["boris", "implicit_midpoint"] {
            boris_law(&own(method(id)), h).unwrap();
        }
        // The exact turn, and the other order of kick and drift, are other laws.
        for id in ["position_verlet", "velocity_verlet"] {
            assert!(boris_law(&own(method(id)), h).is_err(), "{id}");
        }
    }
}

/// The displacement a step in the frame of no turn: over steps that make whole turns, the drift alone.
fn drift_law(build: Build) -> f64 {
    let mut scene = charge();
    scene.particles[0].velocity = [0.0; 3];
    (scene.up, scene.solver.gravity) = (Axis::Y, -9.81);
    // 12 steps a turn of Boris.
    let h = 2.0 / W * (std::f64::consts::PI / 12.0).tan();
    let all = states(&scene, build, h, 36);
    let [end, time] = [all[36].x[0], 36.0 * h];
    // g x B / B²: towards -x.
    (end / time + 9.81 / W)
        .abs()
        .max((all[36].x[1] / time).abs())
}

#[test]
fn boris_drifts_across_crossed_fields_at_their_speed() {
    // Positions up to 6.4 m, 36 steps of a few roundings: measured 2e-15.
    let off = drift_law(&own(method("boris")));
    assert!(off < 1e-14, "{off:e}");
    // Not with the circle behind or ahead of the steps.
    assert!(drift_law(&own(method("position_verlet"))) > 1e-3);
    assert!(drift_law(&own(method("rk4"))) > 1e-3);
}

/// A row of masses of 0.5 to 1.5 with charges of both signs, in a slanted field; dampers on these links, and drag.
fn row(dampers: &[(usize, f64)], drag: f64, field: f64) -> Scene {
    let mut random = Random(5);
    let particles = (0..5)
        .map(|i| Particle {
            velocity: [random.next(), random.next(), random.next()],
            charge: 2.0 * random.next(),
            drag: if i == 2 { drag } else { 0.0 },
            fixed: i == 0,
            ..free(
                [i as f64, 0.2 * random.next(), 0.2 * random.next()],
                1.0 + 0.5 * random.next(),
            )
        })
        .map(|p| {
            if p.fixed {
                Particle {
                    velocity: [0.0; 3],
                    ..p
                }
            } else {
                p
            }
        });
    let mut springs: Vec<Spring> = (0..4).map(|i| spring([i, i + 1], 50.0, 1.0)).collect();
    for (at, damping) in dampers {
        springs[*at].damping = *damping;
    }
    let mut scene = Scene {
        particles: particles.collect(),
        springs,
        damping_model: DampingModel::Axial,
        magnetic: Some(Magnetic {
            field: [0.6, -0.3, 0.7].map(|b| field * b),
        }),
        ..empty()
    };
    scene.solver.gravity = -9.81;
    scene
}

/// Velocities after `h` at frozen positions: v' = a + G v as one matrix exponential, G by unit vectors.
fn flow(scene: &Scene, h: f64) -> Vec<f64> {
    let (system, start) = built(scene);
    let n = system.dim();
    let mut matrix = DMatrix::zeros(n + 1, n + 1);
    let mut image = vec![0.0; n];
    for column in 0..n {
        let mut unit = vec![0.0; n];
        unit[column] = 1.0;
        system.damping(0.0, &start.x, &unit, &mut image);
        for (row, value) in image.iter().enumerate() {
            matrix[(row, column)] = h * value;
        }
    }
    system.acceleration(0.0, &start.x, &vec![0.0; n], &mut image);
    for (row, value) in image.iter().enumerate() {
        matrix[(row, n)] = h * value;
    }
    let mut before = DVector::from_element(n + 1, 1.0);
    before.rows_mut(0, n).copy_from_slice(&start.v);
    let after = matrix.exp() * before;
    after.rows(0, n).iter().copied().collect()
}

/// One kick over h, and how far it is from the flow, relative to the largest velocity.
fn flow_law(scene: &Scene, h: f64, damping: DampingTreatment) -> f64 {
    const KICK: &[Stage] = &[Stage::Kick(1.0)];
    let (system, mut state) = built(scene);
    advance(
        &mut Splitting::new(KICK, damping),
        &system,
        h,
        1,
        &mut state,
    );
    let exact = flow(scene, h);
    distance(&exact, &state.v) / exact.iter().fold(1.0, |m: f64, v| m.max(v.abs()))
}

/// Weak, some turns a step, and with dampers that are stiff; and what the largest velocity may be off by.
const FIELDS: [(f64, f64, f64); 3] = [(0.1, 0.05, 4e-15), (40.0, 1.0, 2e-14), (40.0, 200.0, 6e-14)];

#[test]
fn kicks_are_the_exponential_of_a_field_and_dampers() {
    for (field, damper, tolerance) in FIELDS {
        // Together, by Krylov spaces, dampers that share particles among them.
        let scene = row(&[(0, damper), (1, damper), (3, damper)], damper, field);
        assert_eq!(built(&scene).0.dampers(), Dampers::Shared);
        let off = flow_law(&scene, 0.2, DampingTreatment::ExactFlow);
        assert!(off < tolerance, "{field} {damper}: {off:e}");
        assert!(flow_law(&scene, 0.2, DampingTreatment::Explicit) > 100.0 * tolerance);
        // One after the other, where each has its particles for itself: turns with the forces, exactly.
        let scene = row(&[], 0.0, field);
        assert_eq!(built(&scene).0.dampers(), Dampers::Apart);
        for treatment in [DampingTreatment::Sweeps, DampingTreatment::ExactFlow] {
            let off = flow_law(&scene, 0.2, treatment);
            assert!(off < tolerance, "{field} {treatment:?}: {off:e}");
        }
        assert!(flow_law(&scene, 0.2, DampingTreatment::Boris) > 100.0 * tolerance);
    }
}

/// A system that cannot be swept: dampers and field are known by products alone.
struct Whole(ParticleSystem);

impl System for Whole {
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(t, x, v, a)
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds()
    }
    fn damping(&self, t: f64, x: &[f64], w: &[f64], a: &mut [f64]) {
        self.0.damping(t, x, w, a);
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
}

/// Boris' kick is the midpoint rule at frozen positions: (1 - hG/2) v1 = (1 + hG/2) v0 + h a, where flows are apart and,
/// of systems that cannot be swept, always.
#[test]
fn boris_kicks_by_the_midpoint_rule() {
    const KICK: &[Stage] = &[Stage::Kick(1.0)];
    let law = |system: &dyn System, start: &State, damping| {
        let h = 0.1;
        let mut state = start.clone();
        let kick = &mut Splitting::new(KICK, damping);
        advance(kick, system, h, 1, &mut state);
        let pairs = start.v.iter().zip(&state.v);
        let mean: Vec<f64> = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
        let mut a = vec![0.0; start.v.len()];
        system.acceleration(0.0, &start.x, &mean, &mut a);
        let wanted: Vec<f64> = start.v.iter().zip(&a).map(|(v, a)| v + h * a).collect();
        distance(&wanted, &state.v)
    };
    let (boris, sweeps) = (DampingTreatment::Boris, DampingTreatment::Sweeps);
    for scene in [row(&[], 0.0, 8.0), row(&[(1, 3.0)], 0.0, 0.0)] {
        let (system, start) = built(&scene);
        assert_eq!(system.dampers(), Dampers::Apart);
        // A dozen roundings of velocities up to 6 m/s.
        assert!(law(&system, &start, boris) < 8e-15);
        assert!(law(&system, &start, sweeps) > 1e-3);
    }
    let together = row(&[(0, 3.0), (1, 3.0), (3, 3.0)], 2.0, 8.0);
    let (system, start) = built(&together);
    assert!(law(&system, &start, boris) > 1e-3);
    // The solution in a Krylov space, to its last bits.
    let whole = Whole(system);
    assert!(law(&whole, &start, boris) < 2e-14);
    assert!(law(&whole, &start, sweeps) > 1e-3);
}

/// The order with springs, gravity, dampers and a field, against RK4 at steps a sixteenth.
fn order(scene: &Scene, method: &Method) -> f64 {
    let end = |id: &Method, n: usize| {
        let (system, mut state) = built(scene);
        let mut integrator = id.build(&Default::default());
        advance(integrator.as_mut(), &system, END / n as f64, n, &mut state);
        state
    };
    let truth = end(crate::testkit::method("rk4"), 16 * FINE);
    let off = |n: usize| {
        let state = end(method, n);
        distance(&state.x, &truth.x).max(distance(&state.v, &truth.v))
    };
    (off(FINE / 2) / off(FINE)).log2()
}

/// s.
const END: f64 = 0.5;
const FINE: usize = 128;

#[test]
fn every_method_keeps_its_order_in_a_field() {
    for (name, scene) in [
        ("alone", row(&[], 0.0, 4.0)),
        (
            "with dampers",
            row(&[(0, 1.0), (1, 1.0), (3, 1.0)], 1.0, 4.0),
        ),
    ] {
        for method in fixed() {
            // The next order adds up to z = 0.2 of the error at these steps.
            let found = order(&scene, method);
            let stated = f64::from(method.order_damped);
            assert!(
                (found - stated).abs() < 0.25,
                "{name}, {}: {found}",
                method.id
            );
        }
    }
}

/// A step forward and one backward in the reversed field lead back: what is symmetric without a field is so with one.
#[test]
fn reversible_methods_are_so_with_the_field_turned_round() {
    let law = |build: Build| {
        let scene = row(&[], 0.0, 4.0);
        let mut turned = scene.clone();
        turned.magnetic = Some(Magnetic {
            field: scene.magnetic.as_ref().expect("a field").field.map(|b| -b),
        });
        let (system, start) = built(&scene);
        let mut state = start.clone();
        advance(build().as_mut(), &system, 0.02, 10, &mut state);
        state.v.iter_mut().for_each(|v| *v = -*v);
        let back = built(&turned).0;
        advance(build().as_mut(), &back, 0.02, 10, &mut state);
        distance(&start.x, &state.x)
    };
    for method in fixed().iter().filter(|method| method.reversible) {
        // Implicit steps are solved to 1e-12.
        let off = law(&own(method));
        assert!(off < 1e-11, "{}: {off:e}", method.id);
    }
    assert!(law(&own(method("symplectic_euler"))) > 1e-4);
}
