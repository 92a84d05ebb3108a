//! The strain limit: lengths it holds, what it keeps and what it books, and where it cannot be met.

use crate::testkit::scenes::{empty, fixed, free, shipped, spring};
use crate::testkit::{Random, method};
use springcheck::integrators::{Settings, StepError, find, fixed as methods};
use springcheck::measure::CheckStatus;
use springcheck::physics::constraints::{Corrections, StrainLimiter};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{Rod, Scene, StrainLimit};
use springcheck::solvers::{Setting, Solver, Status, advance};
use springcheck::truth::{self, Demand, NoStore, TruthKind};
use springcheck::verbs::Report;
use springcheck::verbs::run::{Choice, Plan};

fn limited(ratio: f64, iterations: usize) -> Option<StrainLimit> {
    Some(StrainLimit {
        ratio,
        iterations,
        also_compression: false,
    })
}

/// A mass of 1 kg on a spring of 1 m and so many N/m, at a height.
fn hung(stiffness: f64, z: f64) -> Scene {
    let mut scene = Scene {
        particles: vec![fixed([0.0; 3]), free([0.0, 0.0, z], 1.0)],
        springs: vec![spring([0, 1], stiffness, 1.0)],
        strain_limit: limited(0.1, 10),
        ..empty()
    };
    scene.solver.gravity = -9.81;
    scene
}

/// Steps a scene, and hands every state over with what was corrected in it.
fn stepped(
    id: &str,
    scene: &Scene,
    h: f64,
    steps: u32,
    mut see: impl FnMut(&State, Corrections),
) -> Result<State, StepError> {
    let system = ParticleSystem::new(scene);
    let mut state = ParticleSystem::initial_state(scene);
    let mut integrator = method(id).build(&Settings::default());
    for n in 1..=steps {
        let end = f64::from(n) * h;
        let done = advance(integrator.as_mut(), &system, h, end, &mut state)?;
        see(&state, done);
    }
    Ok(state)
}

fn corrections(id: &str, scene: &Scene, h: f64, steps: u32) -> (State, u64) {
    let mut all = 0;
    let end = stepped(id, scene, h, steps, |_, done| all += done.springs);
    (end.expect("it can be stepped"), all)
}

fn length(state: &State, [a, b]: [usize; 2]) -> f64 {
    let d = [0, 1, 2].map(|axis| state.x[3 * b + axis] - state.x[3 * a + axis]);
    d[0].hypot(d[1]).hypot(d[2])
}

/// m g/k = 0.1962 L at 50 N/m, and 0.1 L at 98.1 N/m (golden 29).
#[test]
fn a_spring_that_would_be_longer_hangs_at_its_limit_under_every_method() {
    for row in methods() {
        let mut scene = hung(50.0, -1.0);
        scene.springs[0].damping = 3.0;
        if ParticleSystem::new(&scene)
            .admits(row.id, row.takes())
            .is_err()
        {
            continue;
        }
        let mut longest: f64 = 0.0;
        let end = stepped(row.id, &scene, 1e-3, 4000, |state, _| {
            longest = longest.max(length(state, [0, 1]));
        });
        let end = end.expect("it can be stepped");
        // Corrections begin a billionth beyond the limit, and end on it to two roundings.
        assert!(longest <= 1.1 * (1.0 + 1e-9), "{}: {longest}", row.id);
        let off = (length(&end, [0, 1]) - 1.1).abs();
        assert!(off <= 4.5e-16, "{}: {off:e}", row.id);
        // No fall goes on from step to step.
        assert!(end.v[5].abs() <= 1e-15, "{}: {:e}", row.id, end.v[5]);
    }
}

#[test]
fn a_limit_is_idle_from_the_stiffness_on_that_holds_the_mass_below_it() {
    for (stiffness, idle) in [(98.1 * 1.001, true), (98.1 * 0.999, false)] {
        // Where it hangs without a limit.
        let scene = hung(stiffness, -1.0 - 9.81 / stiffness);
        let (_, corrected) = corrections("velocity_verlet", &scene, 1e-3, 500);
        assert_eq!(corrected == 0, idle, "{stiffness}: {corrected}");
    }
}

/// At its limit the spring holds 5 N of 9.81 N, and the limit the rest.
#[test]
fn what_the_limit_holds_is_the_impulse_on_the_fixed_end() {
    let mut impulse = 0.0;
    let end = stepped("symplectic_euler", &hung(50.0, -1.1), 1e-3, 2000, |_, p| {
        impulse += p.impulse[2];
    });
    end.expect("it can be stepped");
    // 2000 sums of rounded numbers: 4e-13 measured.
    let off = impulse + 2.0 * (9.81 - 5.0);
    assert!(off.abs() <= 1e-12, "{off:e}");
}

/// Springs hang from the first to the last, and spring j from below carries j masses.
#[test]
fn a_string_is_limited_where_it_carries_more_than_a_tenth_of_its_stiffness() {
    let mut scene = shipped("strain/string_in_part.yml");
    scene.strain_limit = limited(0.1, 200);
    let (end, _) = corrections("symplectic_euler", &scene, 1e-3, 10_000);
    let (stiffness, weight) = (122.625 * 0.2, 0.1 * 9.81);
    for (at, spring) in scene.springs.iter().enumerate() {
        let strain = (5 - at) as f64 * weight / stiffness;
        let wanted = 0.2 * (1.0 + strain.min(0.1));
        let off = (length(&end, spring.ends) - wanted).abs();
        // A sweep leaves a billionth of a length, 2e-10 m, which goes on at 2e-10 m / h, and by that the damper holds
        // the spring below it longer: 1e-7 m/s times 1 N s/m over 123 N/m. Measured: 3e-9 m.
        assert!(off <= 6e-9, "spring {at}: {off:e}");
    }
}

/// Sweeps in the order of the scene halve what two springs in a row are too long by.
#[test]
fn sweeps_go_through_springs_in_their_order() {
    for sweeps in 1..6 {
        let at = |x: f64| [x, 0.0, 0.0];
        let scene = Scene {
            particles: vec![fixed(at(0.0)), free(at(1.4), 2.0), free(at(2.4), 2.0)],
            springs: vec![spring([0, 1], 0.0, 1.0), spring([1, 2], 0.0, 1.0)],
            strain_limit: limited(0.0, sweeps),
            ..empty()
        };
        let mut state = ParticleSystem::initial_state(&scene);
        let limiter = StrainLimiter::new(&scene).expect("a limiter");
        let done = limiter
            .correct(None, &mut state.x, &mut state.v)
            .expect("no rods");
        assert_eq!(done.sweeps, sweeps as u64);
        let left = 0.4 * 0.5_f64.powi(sweeps as i32);
        let found = [state.x[3] - 1.0, state.x[6] - 2.0];
        // Roundings of lengths of 2 m.
        assert!((found[0] - left).abs() <= 1e-15, "{sweeps}: {found:?}");
        assert!((found[1] - left).abs() <= 1e-15, "{sweeps}: {found:?}");
    }
}

struct Totals {
    centre: [f64; 3],
    momentum: [f64; 3],
    angular: [f64; 3],
    kinetic: f64,
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn totals(scene: &Scene, state: &State) -> Totals {
    let mut all = Totals {
        centre: [0.0; 3],
        momentum: [0.0; 3],
        angular: [0.0; 3],
        kinetic: 0.0,
    };
    for (id, particle) in scene.particles.iter().enumerate() {
        let of = |y: &[f64]| [y[3 * id], y[3 * id + 1], y[3 * id + 2]];
        let (x, v, m) = (of(&state.x), of(&state.v), particle.mass);
        let turning = cross(x, v);
        for axis in 0..3 {
            all.centre[axis] += m * x[axis];
            all.momentum[axis] += m * v[axis];
            all.angular[axis] += m * turning[axis];
            all.kinetic += 0.5 * m * v[axis] * v[axis];
        }
    }
    all
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max)
}

#[test]
fn between_free_ends_the_centre_and_momentum_stay_and_only_stretching_goes() {
    let mut random = Random(7);
    for case in 0..200 {
        let mut three = || [random.next(), random.next(), random.next()];
        let (place, way, u, w) = (three(), three(), three(), three());
        let mut scene = Scene {
            particles: vec![
                free(place, 0.3),
                free([0, 1, 2].map(|c| place[c] + way[c]), 2.0),
            ],
            ..empty()
        };
        (scene.particles[0].velocity, scene.particles[1].velocity) = (u, w);
        let before = ParticleSystem::initial_state(&scene);
        let l = length(&before, [0, 1]);
        // A limit of 10 %, that the spring is beyond by 5 % of its rest length.
        scene.springs = vec![spring([0, 1], 1.0, l / 1.15)];
        scene.strain_limit = limited(0.1, 10);
        let mut state = before.clone();
        let limiter = StrainLimiter::new(&scene).expect("a limiter");
        let done = limiter
            .correct(None, &mut state.x, &mut state.v)
            .expect("no rods");
        assert_eq!((done.springs, done.impulse), (1, [0.0; 3]));
        let [start, end] = [&before, &state].map(|state| totals(&scene, state));
        // Two roundings of sums of numbers up to 4.
        let rounding = 4e-15;
        assert!(apart(start.centre, end.centre) <= rounding, "{case}");
        assert!(apart(start.momentum, end.momentum) <= rounding, "{case}");
        assert!(end.kinetic <= start.kinetic + rounding, "{case}");
        assert!((length(&state, [0, 1]) - l * 1.1 / 1.15).abs() <= rounding);
        // The ends came nearer by s along n while they turn: s n × (velocity of the second past the first) less.
        let n = way.map(|d| d / l);
        let along = (0..3).map(|c| n[c] * (w[c] - u[c])).sum::<f64>();
        let (reduced, s) = (0.3 * 2.0 / 2.3, l - l * 1.1 / 1.15);
        let past = [0, 1, 2].map(|c| w[c] - u[c]);
        let turned = cross(n, past).map(|c| -reduced * s * c);
        let changed = [0, 1, 2].map(|c| end.angular[c] - start.angular[c]);
        assert!(
            apart(turned, changed) <= rounding,
            "{case}: {turned:?} {changed:?}"
        );
        // The part along the line is gone if it stretched, else it stays; the part across it always stays.
        let now = [0, 1, 2].map(|c| state.v[3 + c] - state.v[c]);
        let kept = if along > 0.0 { along } else { 0.0 };
        let wanted = [0, 1, 2].map(|c| past[c] - kept * n[c]);
        assert!(apart(now, wanted) <= rounding, "{case}");
    }
}

/// Threads without stiffness: between corrections masses fly freely, which rk4 has right to rounding.
fn thread() -> Scene {
    let at = |id: usize| [0.2 * id as f64, 0.0, 0.0];
    let masses = (1..6).map(|id| free(at(id), 0.1 * id as f64));
    let mut scene = Scene {
        particles: std::iter::once(fixed(at(0))).chain(masses).collect(),
        springs: (0..5).map(|id| spring([id, id + 1], 0.0, 0.2)).collect(),
        strain_limit: limited(0.1, 10),
        ..empty()
    };
    scene.solver.gravity = -9.81;
    scene
}

#[test]
fn what_the_limit_takes_closes_the_balance() {
    let scene = thread();
    let system = ParticleSystem::new(&scene);
    let energy = |state: &State| system.kinetic(&state.v) + system.potential(state.t, &state.x);
    let start = energy(&ParticleSystem::initial_state(&scene));
    let (end, corrected) = corrections("rk4", &scene, 1e-3, 2000);
    assert!(corrected > 1000);
    let (lost, booked) = (start - energy(&end), end.work.limited);
    // 2000 steps of rounding in sums of some joules; the energy itself changes by much.
    assert!(lost.abs() > 0.1, "{lost}");
    assert!((lost - booked).abs() <= 3e-13, "{lost} {booked}");
}

#[test]
fn a_limit_beyond_every_strain_changes_no_bit_and_one_that_acts_does() {
    let with = |limit: Option<StrainLimit>| {
        let mut scene = thread();
        scene.springs.iter_mut().for_each(|s| s.stiffness = 50.0);
        scene.strain_limit = limit;
        corrections("velocity_verlet", &scene, 1e-3, 1000)
    };
    let (free, none) = with(None);
    let (idle, corrected) = with(limited(1e3, 10));
    assert_eq!((none, corrected), (0, 0));
    assert_eq!(free, idle);
    assert_ne!(free.x, with(limited(0.1, 10)).0.x);
}

#[test]
fn springs_without_a_length_or_a_free_end_have_no_limit() {
    let mut scene = hung(50.0, -2.0);
    scene.springs[0].rest_length = 0.0;
    assert_eq!(StrainLimiter::new(&scene), None);
    let mut scene = hung(50.0, -2.0);
    scene.particles[1].fixed = true;
    assert_eq!(StrainLimiter::new(&scene), None);
    scene = hung(50.0, -2.0);
    scene.strain_limit = None;
    assert_eq!(StrainLimiter::new(&scene), None);
}

#[test]
fn compression_is_limited_where_that_is_asked_for() {
    for (also_compression, wanted) in [(false, 0.5), (true, 0.9)] {
        let mut scene = hung(0.0, -0.5);
        scene.strain_limit = Some(StrainLimit {
            also_compression,
            ..StrainLimit::default()
        });
        let mut state = ParticleSystem::initial_state(&scene);
        state.v[5] = 3.0;
        let limiter = StrainLimiter::new(&scene).expect("a limiter");
        limiter
            .correct(None, &mut state.x, &mut state.v)
            .expect("no rods");
        assert!((length(&state, [0, 1]) - wanted).abs() <= 1.2e-16);
        // Shortening ends as well.
        assert_eq!(state.v[5], if also_compression { 0.0 } else { 3.0 });
    }
    // Ends in one place have no direction: nothing is moved, and nothing is NaN.
    let mut scene = hung(0.0, 0.0);
    scene.strain_limit = Some(StrainLimit {
        also_compression: true,
        ..StrainLimit::default()
    });
    let mut state = ParticleSystem::initial_state(&scene);
    let limiter = StrainLimiter::new(&scene).expect("a limiter");
    assert_eq!(
        limiter
            .correct(None, &mut state.x, &mut state.v)
            .expect("no rods"),
        Corrections::default()
    );
    assert!(state.is_finite());
}

#[test]
fn pairs_keep_the_limit_at_every_step() {
    let scene = Scene {
        duration: 2.0,
        ..hung(50.0, -1.0)
    };
    let system = ParticleSystem::new(&scene);
    let pair = Solver::method(find("dormand_prince54").expect("a pair"));
    let setting = Setting::Tolerance {
        tolerance: 1e-8,
        duration: 2.0,
        steps: 1000,
        max_steps: 1_000_000,
    };
    let mut run = pair.start(&scene, &system, &setting).expect("a run");
    while run.state().t < 2.0 {
        run.advance(1).expect("a step");
        let state = run.state();
        assert!(length(state, [0, 1]) <= 1.1 * (1.0 + 1e-9), "{}", state.t);
    }
    assert!(run.counts().corrections.expect("a limit").springs > 0);
}

/// A rod of 1 m, and a spring below it that would be longer.
#[test]
fn rods_hold_beside_a_limit() {
    for id in ["rattle", "rk4", "symplectic_euler"] {
        let mut scene = hung(50.0, -1.0);
        scene.particles.push(free([0.3, 0.0, -1.9], 2.0));
        scene.springs = vec![spring([1, 2], 50.0, 0.9)];
        scene.rods = vec![Rod {
            ends: [0, 1],
            length: 1.0,
        }];
        scene.strain_limit = limited(0.1, 100);
        let (mut rod, mut strain) = (0.0_f64, 0.0_f64);
        let end = stepped(id, &scene, 1e-3, 3000, |state, _| {
            rod = rod.max((length(state, [0, 1]) - 1.0).abs());
            strain = strain.max(length(state, [1, 2]) / 0.9 - 1.0);
        });
        end.expect("it can be stepped");
        assert!(rod <= 4.5e-16, "{id}: {rod:e}");
        // Corrections begin a billionth of the length beyond the limit.
        assert!(strain <= 0.1 + 1.2e-9, "{id}: {strain}");
    }
}

fn ran(scene: &Scene, solvers: Vec<Solver>) -> Report {
    let choice = Choice {
        solvers,
        prove: false,
        ..Choice::default_for(scene)
    };
    let plan = Plan::new(scene, &choice);
    plan.execute(&springcheck::verbs::session::Quiet)
        .expect("no files")
}

#[test]
fn a_limit_that_pins_prevent_is_said_and_engines_without_one_say_so() {
    let scene = shipped("strain/pinned_triangle.yml");
    let rapier = springcheck::solvers::rapier::IDS.map(springcheck::solvers::find);
    let ours = Solver::method(method("symplectic_euler"));
    let solvers = std::iter::once(ours).chain(rapier.into_iter().flatten());
    let report = ran(&scene, solvers.collect());
    assert_eq!(report.header.truth.kind, TruthKind::None);
    let [first, rapier @ ..] = report.outcomes() else {
        panic!("no outcomes")
    };
    let strain = first.strain.as_ref().expect("a strain");
    // 3 m less the 1.1 m of the spring that is corrected last; alternating projections meet the line between the pins
    // (Cheney, Goldstein 1959), and are off it by less than 1e-5 m after the first step: the square of that.
    assert!((strain.largest.expect("a number") - 0.9).abs() <= 1e-9);
    assert_eq!((strain.spring, strain.met), (0, false));
    let said = first.remarks.join(" ");
    assert!(
        said.contains("strain limit of 10 % is not met: spring 0 is at 90 %"),
        "{said}"
    );
    for outcome in rapier {
        assert_eq!(outcome.status, Status::Unsupported, "{}", outcome.engine);
        let reason = outcome.reason.as_deref().unwrap_or_default();
        assert!(reason.contains("no strain limit"), "{reason}");
    }
    let failed = |status| status == CheckStatus::Fail;
    assert!(!report.header.checks.iter().any(|c| failed(c.status)));
}

#[test]
fn there_is_no_truth_with_a_limit_that_can_act() {
    let mut scene = hung(50.0, -1.0);
    let kind = |scene: &Scene| {
        let system = ParticleSystem::new(scene);
        let found = truth::find(scene, &system, Demand::Auto, 1.0, &NoStore);
        (found.kind, found.reason)
    };
    let (none, reason) = kind(&scene);
    assert_eq!(none, TruthKind::None);
    assert!(
        reason.contains("timestep") && reason.contains("sweeps"),
        "{reason}"
    );
    scene.strain_limit = None;
    assert_ne!(kind(&scene).0, TruthKind::None);
}

/// Every method that steps such a scene is known by its own name.
#[test]
fn methods_are_identified_where_a_limit_acts() {
    let scene = Scene {
        duration: 0.3,
        ..shipped("strain/string_in_part.yml")
    };
    let system = ParticleSystem::new(&scene);
    let own = methods().iter().filter(|m| m.is_its_own(system.kinds()));
    let report = ran(&scene, own.map(Solver::method).collect());
    for outcome in report.outcomes() {
        let strain = outcome.strain.as_ref().expect("a strain");
        assert!(strain.corrections > Some(0), "{}", outcome.engine);
        let identity = outcome.identified.as_ref().expect("an identity");
        assert_eq!(identity.method, outcome.engine);
        assert_eq!(
            identity.followed, identity.transitions,
            "{}",
            outcome.engine
        );
    }
}
