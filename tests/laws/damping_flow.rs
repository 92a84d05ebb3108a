//! The exact flow of the damping, against an eigendecomposition of the dense damping matrix in the
//! metric of the masses; and how its passes are counted.

use crate::testkit::scenes::{free, spring};
use crate::testkit::{Build, Random, advance, built, method, own, swinging_triangle};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use springcheck::integrators::{DampingTreatment, Integrator, Splitting, Stage};
use springcheck::physics::{Counting, Dampers, State, System};
use springcheck::scene::{DampingModel, Particle, Scene, Spring};
use springcheck::solvers::Solver;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

/// The kick alone: positions stay where they are.
const KICK: &[Stage] = &[Stage::Kick(1.0)];
const H: f64 = 0.01;

/// A crooked chain of 30 links between masses of 0.5 to 1.5, hung at one end.
fn chain(damping: f64, model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(0.0, model);
    let mut random = Random(9);
    scene.particles = (0..31)
        .map(|i| {
            let position = [
                0.1 * i as f64,
                0.05 * random.next(),
                0.05 * random.next() - 0.1,
            ];
            Particle {
                velocity: [random.next(), random.next(), random.next()],
                fixed: i == 0,
                ..free(position, 1.0 + 0.5 * random.next())
            }
        })
        .collect();
    scene.springs = (0..30)
        .map(|i| Spring {
            damping,
            ..spring([i, i + 1], 100.0, 0.1)
        })
        .collect();
    scene
}

/// (e^z - 1) / z.
fn phi1(z: f64) -> f64 {
    if z == 0.0 { 1.0 } else { z.exp_m1() / z }
}

/// (e^z - 1 - z) / z², by its series where that cancels.
fn phi2(z: f64) -> f64 {
    if z.abs() > 1.0 {
        return (z.exp_m1() - z) / (z * z);
    }
    let (mut sum, mut term) = (0.0, 0.5);
    for k in 3..30 {
        sum += term;
        term *= z / f64::from(k);
    }
    sum
}

/// Velocity and dissipated work after H, and the largest h |G|.
fn exact(scene: &Scene) -> (Vec<f64>, f64, f64) {
    let (system, start) = built(scene);
    let n = system.dim();
    let free: Vec<usize> = (0..n).filter(|&i| system.inverse_mass()[i] > 0.0).collect();
    let root = |i: usize| system.inverse_mass()[free[i]].sqrt().recip();
    // M^(1/2) G M^(-1/2), symmetric.
    let mut matrix = DMatrix::zeros(free.len(), free.len());
    for column in 0..free.len() {
        let (mut unit, mut image) = (vec![0.0; n], vec![0.0; n]);
        unit[free[column]] = 1.0;
        system.damping(0.0, &start.x, &unit, &mut image);
        for row in 0..free.len() {
            matrix[(row, column)] = root(row) * image[free[row]] / root(column);
        }
    }
    let mut at_rest = vec![0.0; n];
    system.acceleration(0.0, &start.x, &vec![0.0; n], &mut at_rest);
    let scaled = |u: &[f64]| DVector::from_fn(free.len(), |i, _| root(i) * u[free[i]]);
    let eigen = SymmetricEigen::new((&matrix + matrix.transpose()) * 0.5);
    let into = eigen.eigenvectors.transpose();
    let (velocity, push) = (&into * scaled(&start.v), &into * scaled(&at_rest));
    // In each eigendirection v' = λ v + a.
    let (mut end, mut dissipated, mut stiffest) = (velocity.clone(), 0.0, 0.0_f64);
    for (i, &rate) in eigen.eigenvalues.iter().enumerate() {
        let z = H * rate;
        let slope = push[i] + rate * velocity[i];
        end[i] = velocity[i] + H * phi1(z) * slope;
        let displacement = H * velocity[i] + H * H * phi2(z) * slope;
        // What the push did and the motion did not gain.
        dissipated += push[i] * displacement - 0.5 * (end[i] * end[i] - velocity[i] * velocity[i]);
        stiffest = stiffest.max(-z);
    }
    let end = &eigen.eigenvectors * end;
    let mut v = start.v.clone();
    for (i, &at) in free.iter().enumerate() {
        v[at] = end[i] / root(i);
    }
    (v, dissipated, stiffest)
}

/// The coefficient, the h |G| it makes, and what velocity and work may be off by.
///
/// Weak damping goes by Taylor and stiff by Lanczos. Both sides round sums over 90 directions, some ten
/// last bits: measured 2.8e-15 and 3.8e-15. Where h |G| is 200 the slope is as many times the velocity
/// that comes of it, and so is its rounding: measured 8.2e-14 and 1.1e-14.
const CASES: [(f64, [f64; 2], [f64; 2]); 3] = [
    (0.5, [0.01, 0.1], [8e-15, 1e-14]),
    (50.0, [1.0, 10.0], [8e-15, 1e-14]),
    (5e3, [100.0, 1e3], [2.4e-13, 3e-14]),
];

/// The kick is the flow: velocity and work, relative to the largest velocity and to the work.
fn flow_law(scene: &Scene, tolerance: [f64; 2], build: Build) -> Result<(), String> {
    let (system, start) = built(scene);
    let (v, dissipated, _) = exact(scene);
    let mut state = start.clone();
    advance(build().as_mut(), &system, H, 1, &mut state);
    let largest = v.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
    let off = crate::testkit::distance(&v, &state.v) / largest;
    let work = (state.work.dissipated / dissipated - 1.0).abs();
    if state.x != start.x {
        return Err("positions moved".into());
    }
    if off.is_nan() || off > tolerance[0] || work.is_nan() || work > tolerance[1] {
        return Err(format!("velocity off by {off:.1e}, work by {work:.1e}"));
    }
    Ok(())
}

fn kick(damping: DampingTreatment) -> impl Fn() -> Box<dyn Integrator> {
    move || Box::new(Splitting::new(KICK, damping))
}

const MODELS: [DampingModel; 2] = [DampingModel::Axial, DampingModel::Isotropic];

#[test]
fn kicks_follow_the_damping_exactly_however_stiff() {
    for (damping, [least, most], tolerance) in CASES {
        for model in MODELS {
            let scene = chain(damping, model);
            let (_, _, stiffest) = exact(&scene);
            assert!(least < stiffest && stiffest < most, "h |G| = {stiffest}");
            flow_law(&scene, tolerance, &kick(DampingTreatment::ExactFlow)).unwrap();
            // The textbook kick is not it.
            let explicit = kick(DampingTreatment::Explicit);
            assert!(flow_law(&scene, tolerance, &explicit).is_err());
        }
    }
}

/// Verlet's kicks are two halves of it: the composition with a drift in between, work included.
fn half_kicks_law(scene: &Scene, build: Build) -> Result<(), String> {
    let (system, start) = built(scene);
    let mut by_parts = start.clone();
    for stages in [
        &[Stage::Kick(0.5)],
        &[Stage::Drift(1.0)],
        &[Stage::Kick(0.5)],
    ] as [&[Stage]; 3]
    {
        let mut part = Splitting::new(stages, DampingTreatment::ExactFlow);
        advance(&mut part, &system, H, 1, &mut by_parts);
    }
    let mut state = start;
    advance(build().as_mut(), &system, H, 1, &mut state);
    let same = state.x == by_parts.x && state.v == by_parts.v && state.work == by_parts.work;
    same.then_some(())
        .ok_or_else(|| format!("{:?} instead of {:?}", state.work, by_parts.work))
}

#[test]
fn verlet_is_made_of_these_kicks() {
    for model in MODELS {
        let scene = chain(50.0, model);
        let flows = || Box::new(Splitting::new(Stage::VERLET, DampingTreatment::ExactFlow)) as _;
        half_kicks_law(&scene, &flows).unwrap();
        assert!(half_kicks_law(&scene, &own(method("symplectic_euler"))).is_err());
    }
}

/// The exact flow of each damper alone over h, in this order, written out.
fn sweep(scene: &Scene, order: &mut dyn Iterator<Item = usize>, h: f64, state: &mut State) {
    for s in order {
        let Spring { ends, damping, .. } = scene.springs[s];
        let w = ends.map(|end| 1.0 / scene.particles[end].mass);
        let w = [0, 1].map(|k| {
            if scene.particles[ends[k]].fixed {
                0.0
            } else {
                w[k]
            }
        });
        let kept = (-damping * (w[0] + w[1]) * h).exp();
        let between = |of: &[f64]| [0, 1, 2].map(|k| of[3 * ends[1] + k] - of[3 * ends[0] + k]);
        let (d, u) = (between(&state.x), between(&state.v));
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        for axis in 0..3 {
            let part = match scene.damping_model {
                DampingModel::Axial => dot(u, d) / dot(d, d) * d[axis],
                DampingModel::Isotropic => u[axis],
            };
            let lost = (1.0 - kept) * part / (w[0] + w[1]);
            state.v[3 * ends[0] + axis] += w[0] * lost;
            state.v[3 * ends[1] + axis] -= w[1] * lost;
        }
    }
}

/// Velocity Verlet on a network: sweep and push, drift, push and sweep back, each written out.
fn swept_law(scene: &Scene, build: Build) -> Result<(), String> {
    let (system, start) = built(scene);
    let mut by_hand = start.clone();
    let push = |state: &mut State| {
        let (rest, mut a) = (vec![0.0; system.dim()], vec![0.0; system.dim()]);
        system.acceleration(0.0, &state.x, &rest, &mut a);
        for (v, a) in state.v.iter_mut().zip(a) {
            *v += 0.5 * H * a;
        }
    };
    let springs = scene.springs.len();
    sweep(scene, &mut (0..springs), 0.5 * H, &mut by_hand);
    push(&mut by_hand);
    for (x, v) in by_hand.x.iter_mut().zip(&by_hand.v) {
        *x += H * v;
    }
    push(&mut by_hand);
    sweep(scene, &mut (0..springs).rev(), 0.5 * H, &mut by_hand);
    let mut state = start;
    advance(build().as_mut(), &system, H, 1, &mut state);
    let off = crate::testkit::distance(&by_hand.v, &state.v);
    // Each particle's velocity, at most 3 m/s, is changed some ten times by 60 dampers: half a last bit each.
    if off < 1e-14 {
        Ok(())
    } else {
        Err(format!("off by {off:.1e}"))
    }
}

#[test]
fn verlet_sweeps_there_and_back() {
    for model in MODELS {
        let scene = chain(5.0, model);
        swept_law(&scene, &own(method("velocity_verlet"))).unwrap();
        // Not all dampers together, nor the other order of pushes and drifts.
        let flows = || Box::new(Splitting::new(Stage::VERLET, DampingTreatment::ExactFlow)) as _;
        assert!(swept_law(&scene, &flows).is_err());
        assert!(swept_law(&scene, &own(method("position_verlet"))).is_err());
    }
}

/// A symmetric step: -h takes back what h did, dampers and all.
fn symmetry_law(scene: &Scene, build: Build) -> Result<(), String> {
    let (system, start) = built(scene);
    let mut state = start.clone();
    advance(build().as_mut(), &system, H, 1, &mut state);
    advance(build().as_mut(), &system, -H, 1, &mut state);
    let off = crate::testkit::distance(&start.v, &state.v)
        .max(crate::testkit::distance(&start.x, &state.x));
    // Going back multiplies roundings by e^(h |G|), at most e^1.7 a kick.
    if off < 1e-13 {
        Ok(())
    } else {
        Err(format!("off by {off:.1e}"))
    }
}

#[test]
fn swept_steps_are_symmetric() {
    for model in MODELS {
        let scene = chain(5.0, model);
        for id in ["velocity_verlet", "position_verlet", "yoshida4"] {
            symmetry_law(&scene, &own(method(id))).unwrap();
        }
        let textbook = || Box::new(Splitting::new(Stage::VERLET, DampingTreatment::Explicit)) as _;
        assert!(symmetry_law(&scene, &textbook).is_err());
        assert!(symmetry_law(&scene, &own(method("symplectic_euler"))).is_err());
    }
}

/// Every other link with a damper, and drag on none of their ends: no particle has two dampers, and the sweep with
/// the forces is the exact flow, its work included.
#[test]
fn dampers_that_share_no_particle_are_swept_exactly() {
    for (damping, _, tolerance) in CASES {
        for model in MODELS {
            let mut scene = chain(damping, model);
            for (at, spring) in scene.springs.iter_mut().enumerate() {
                if at % 3 != 0 {
                    spring.damping = 0.0;
                }
            }
            scene.particles[2].drag = damping;
            let system = built(&scene).0;
            assert_eq!(system.dampers(), Dampers::Apart);
            flow_law(&scene, tolerance, &kick(DampingTreatment::Sweeps)).unwrap();
            scene.springs[1].damping = damping;
            assert_eq!(built(&scene).0.dampers(), Dampers::Shared);
            assert!(flow_law(&scene, tolerance, &kick(DampingTreatment::Sweeps)).is_err());
        }
    }
}

/// One pass over the forces and two over the dampers a Verlet step, three times that for Yoshida's three.
#[test]
fn a_verlet_step_takes_three_passes() {
    let steps = 10;
    for model in MODELS {
        for (id, forces) in [
            ("velocity_verlet", 1),
            ("position_verlet", 1),
            ("yoshida4", 3),
        ] {
            let (inner, mut state) = built(&chain(50.0, model));
            let system = Counting::new(inner);
            let mut integrator = method(id).build(&Default::default());
            advance(integrator.as_mut(), &system, H, 1, &mut state);
            let first = system.evaluations();
            advance(integrator.as_mut(), &system, H, steps, &mut state);
            let all = system.evaluations();
            assert_eq!(all.forces - first.forces, forces * steps as u64, "{id}");
            assert_eq!(
                all.damping - first.damping,
                2 * forces * steps as u64,
                "{id}"
            );
        }
    }
}

/// What the counter says of `asked` damping passes through it.
fn counting_law(system: &dyn System, read: &dyn Fn() -> u64, state: &State) -> Result<(), String> {
    let mut a = vec![0.0; system.dim()];
    for asked in 1..=3 {
        system.damping(0.0, &state.x, &state.v, &mut a);
        if read() != asked {
            return Err(format!("{} of {asked}", read()));
        }
    }
    Ok(())
}

#[test]
fn damping_passes_are_counted_apart_from_forces() {
    let (inner, state) = built(&chain(0.5, DampingModel::Axial));
    let system = Counting::new(inner);
    counting_law(&system, &|| system.evaluations().damping, &state).unwrap();
    assert_eq!(system.evaluations().forces, 0);
    // A counter of something else does not pass.
    assert!(counting_law(&system, &|| system.evaluations().forces, &state).is_err());
}

/// In the ledger of a run, passes over the dampers alone are no evaluations of gravity.
fn ledger_law(scene: &Scene) -> Result<(), String> {
    let verlet = method("velocity_verlet");
    let mut choice = Choice::default_for(scene);
    choice.solvers = vec![Solver::method(verlet)];
    let report = Plan::new(scene, &choice).execute(&Quiet).expect("no files");
    let of = |id: &str| {
        let effect = report.header.scene.effects.iter().find(|e| e.id == id);
        effect.expect("in the ledger").evaluations
    };
    // One force a step and the first; dampers are asked more often.
    let forces = report.outcomes()[0].work.steps + 1;
    if of("gravity") == forces && of("springs") > forces {
        Ok(())
    } else {
        Err(format!(
            "{} and {} of {forces}",
            of("gravity"),
            of("springs")
        ))
    }
}

#[test]
fn the_ledger_counts_damping_passes_for_what_damps_only() {
    ledger_law(&swinging_triangle(0.7, DampingModel::Axial)).unwrap();
    // Without dampers the springs are asked as often as gravity.
    assert!(ledger_law(&swinging_triangle(0.0, DampingModel::Axial)).is_err());
}
