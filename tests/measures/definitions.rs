//! What the report's numbers mean: each definition against a case worked out by hand.

use crate::testkit::scenes::{self, parsed};
use crate::testkit::{free_triangle, swinging_triangle};
use springcheck::integrators;
use springcheck::measure::EnergyClass;
use springcheck::measure::{self, deviation};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{DampingModel, Scene, Wind};
use springcheck::solvers::Status;
use springcheck::solvers::{Limits, Setting, Solver};
use springcheck::trajectory::{Recorder, Trajectory};
use springcheck::truth::Demand;
use springcheck::verbs::Report;
use springcheck::verbs::run::Outcome;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

/// The oscillator k = 50, m = 1, A = 0.5 at rest length 0, without gravity.
fn oscillator(timestep: f64, damping: f64) -> Scene {
    let mut scene = scenes::oscillator(50.0, 0.5);
    (scene.solver.timestep, scene.duration) = (timestep, 10.0);
    scene.springs[0].damping = damping;
    scene
}

fn report(scene: &Scene, methods: &[&str]) -> Report {
    let mut choice = Choice::default_for(scene);
    let solver = |id: &&str| Solver::method(crate::testkit::method(id));
    choice.solvers = methods.iter().map(solver).collect();
    Plan::new(scene, &choice)
        .execute(&Quiet)
        .expect("nothing is saved")
}

fn outcome(scene: &Scene, method: &str) -> Outcome {
    report(scene, &[method]).outcomes()[0].clone()
}

fn class(outcome: &Outcome) -> Option<EnergyClass> {
    outcome.energy.as_ref().and_then(|energy| energy.class)
}

fn recorded(scene: &Scene, method: &str, steps: u64, h: f64) -> Trajectory {
    let system = ParticleSystem::new(scene);
    let limits = Limits::new(system.clone(), None);
    let method = crate::testkit::method(method);
    let setting = Setting::Steps { timestep: h, steps };
    let run = Solver::method(method).start(scene, &system, &setting);
    let mut recorder = Recorder::new(steps, 3 * scene.particles.len(), h);
    run.expect("a run").finish(&limits, &mut recorder, &|_| {});
    recorder.finish()
}

#[test]
fn the_energy_scale_is_kinetic_plus_elastic_else_weight_times_size_else_none() {
    let scale = |scene: &Scene| measure::energy_scale(scene, &ParticleSystem::new(scene), None);
    // k A² / 2 = 6.25 J, plus m v² / 2.
    let mut scene = oscillator(0.01, 0.0);
    assert_eq!(scale(&scene), Some(6.25));
    scene.particles[1].velocity = [0.0, 2.0, 0.0];
    assert_eq!(scale(&scene), Some(8.25));
    // At rest and unstretched: m |g| (distance 3 + rest length 3), whatever the height.
    let hanging = "solver: {type: rk4, timestep: 0.01}\n\
                   particles: [{pos: [1, 2, 105], fixed: true}, {pos: [3, 3, 107], mass: 2}]\n\
                   springs: [{particle_ids: [0, 1], stiffness: 50}]\n";
    let weight = scale(&parsed(hanging)).expect("a scale");
    assert!(
        (weight - 2.0 * 9.81 * 6.0).abs() < 1e-13 * weight,
        "{weight}"
    );
    // Rest lengths two last bits off the distance leave k d² / 2 of rounding, not energy; a part in
    // 1e9 is stretch.
    let mut rounded = parsed(hanging);
    let length = rounded.springs[0].rest_length;
    rounded.springs[0].rest_length = length.next_up().next_up();
    let found = scale(&rounded).expect("a scale");
    assert!((found / weight - 1.0).abs() < 1e-14, "{found}");
    rounded.springs[0].rest_length = length * (1.0 + 1e-9);
    let found = scale(&rounded).expect("a scale");
    // k (l d)² / 2 with a difference known to eps / 1e-9 = 2.2e-7: measured 1.7e-7.
    assert!(
        (found / (25.0 * (3e-9_f64).powi(2)) - 1.0).abs() < 5e-7,
        "{found}"
    );
    // A lone particle at rest has neither energy nor size.
    let lone = "solver: {type: rk4, timestep: 0.01}\nparticles: [{pos: [0, 0, 3], mass: 2}]\n";
    assert_eq!(scale(&parsed(lone)), None);
}

#[test]
fn a_run_stops_in_the_step_its_energy_passes_a_billion_scales_squared() {
    // E_n = E_0 (1 + z²)^n on this scene, and S = E_0.
    for h in [0.15_f64, 0.3, 1.0] {
        let scene = oscillator(h, 0.0);
        let growth = (1.0 + 50.0 * h * h).ln();
        let step = (1e12_f64.ln() / growth).floor() + 1.0;
        let found = outcome(&scene, "explicit_euler");
        if step > 10.0 / h {
            assert_eq!(found.status, Status::Completed);
            continue;
        }
        assert_eq!(found.status, Status::Diverged, "h = {h}");
        assert_eq!(found.work.steps as f64, step, "h = {h}");
        assert_eq!(found.stopped_at_s, Some(step * h));
        assert_eq!(class(&found), Some(EnergyClass::Growing));
        let energy = found
            .energy
            .expect("recorded")
            .relative_error_max
            .expect("a scale");
        // The last state is recorded: beyond 1e12 and within one step's growth of it.
        assert!(energy > 0.9e12 && energy < 1e12 * growth.exp(), "{energy}");
        assert!(found.reason.is_some_and(|why| why.contains("particle 1")));
    }
}

#[test]
fn a_long_fall_is_no_divergence_however_small_the_scale() {
    // S = m v² / 2 = 1e-12 J, 1e12 times of which is 1 J; the fall gains 2.4e3 J.
    let falling = parsed(
        "solver: {type: rk4, timestep: 0.01}\n\
         particles: [{pos: [0, 0, 3], mass: 2, vel: [1.0e-6, 0, 0]}]\n",
    );
    // The wind's 20 N do as much without gravity: (20 N * 5 s)² / 2 m = 2.5e3 J.
    let mut blown = falling.clone();
    blown.solver.gravity = 0.0;
    blown.wind = Some(Wind {
        direction: [1.0, 0.0, 0.0],
        strength: 20.0,
    });
    for scene in [&falling, &blown] {
        for id in integrators::ids(integrators::fixed()) {
            let found = outcome(scene, id);
            assert_eq!(found.status, Status::Completed, "{id}");
            let energy = found.energy.expect("recorded").kinetic_final_j.expect("J");
            assert!(energy > 1e3, "{id}: {energy} J would not have been enough");
        }
    }
}

#[test]
fn a_scene_without_a_scale_says_why() {
    let lone = "solver: {type: rk4, timestep: 0.01}\nparticles: [{pos: [0, 0, 3], mass: 2}]\n";
    let scene = parsed(lone);
    let with = |truth| {
        let choice = Choice {
            truth,
            ..Choice::default_for(&scene)
        };
        Plan::new(&scene, &choice).execute(&Quiet).expect("it runs")
    };
    let check = |report: &Report| {
        let found = report
            .header
            .checks
            .iter()
            .find(|check| check.id == "energy-scale");
        found.map(|check| check.message.clone())
    };
    let unknown = with(Demand::None);
    assert_eq!(unknown.header.scene.energy_scale_j, None);
    assert!(check(&unknown).is_some_and(|message| message.contains("at rest")));
    // Of the truth the fall is known: m (g t)² / 2, with t = 5 s.
    let known = with(Demand::Auto);
    let fall = 0.5 * 2.0 * (9.81 * 5.0_f64).powi(2);
    let scale = known.header.scene.energy_scale_j.expect("a scale");
    assert!((scale / fall - 1.0).abs() < 4.0 * f64::EPSILON, "{scale}");
    assert_eq!(check(&known), None);
}

#[test]
fn explicit_euler_multiplies_the_energy_and_the_report_says_so() {
    let found = outcome(&oscillator(0.01, 0.0), "explicit_euler");
    let energy = found.energy.expect("recorded");
    // 1,000 steps of 1 + z² = 1.005: 1,000 eps of rounding are 2.2e-13, measured 1.1e-13.
    let wanted = 1.005_f64.powi(1000) - 1.0;
    let measured = energy.relative_error_max.expect("a scale");
    assert!(
        (measured / wanted - 1.0).abs() < 3e-13,
        "{measured} {wanted}"
    );
    assert_eq!(energy.class, Some(EnergyClass::Growing));
    assert!(energy.drift_per_s.is_some_and(|drift| drift > 0.0));
    let [lo, hi] = energy.drift_per_s_ci.expect("an interval");
    assert!(
        lo > 0.0
            && energy
                .drift_per_s
                .is_some_and(|drift| lo <= drift && drift <= hi)
    );
}

/// The bare energy is gone, and the balance is kept to `off` of it.
fn damped_law(id: &str, off: f64) -> Result<(), String> {
    // A tenth of critical: the bare energy falls to e^-14 of itself.
    let found = outcome(&oscillator(0.001, std::f64::consts::SQRT_2), id);
    let energy = found.energy.as_ref().expect("recorded");
    let (start, end) = (energy.initial_j.expect("J"), energy.final_j.expect("J"));
    let balance = (energy.dissipated_j.expect("J") + end - start).abs() / start;
    let worst = energy.relative_error_max.expect("a scale");
    // e^-14.1 = 7.2e-7 and the phase: measured 7.8e-7.
    if end < 2e-6 * start && balance <= worst && worst < off {
        Ok(())
    } else {
        Err(format!("{id}: {end} J, balance {balance:e}, {worst:e}"))
    }
}

#[test]
fn damping_is_judged_by_the_balance_not_by_the_bare_energy() {
    // What the stages' powers miss of the work: z = 0.007 to the method's order, times small constants;
    // nothing for implicit midpoint, whose balance is exact on linear forces. Measured 5.3e-11, 1.1e-5,
    // 5.5e-12 and 3.6e-15.
    for (id, off) in [
        ("rk4", 1.5e-10),
        ("velocity_verlet", 3e-5),
        ("pefrl", 1.5e-11),
        ("implicit_midpoint", 1e-14),
    ] {
        damped_law(id, off).unwrap();
    }
    // A method of first order loses what it does not account for.
    assert!(damped_law("symplectic_euler", 3e-5).is_err());
}

#[test]
fn classes_of_the_undamped_oscillator() {
    let scene = oscillator(0.02, 0.0);
    for (id, wanted) in [
        ("explicit_euler", EnergyClass::Growing),
        ("midpoint", EnergyClass::Growing),
        ("symplectic_euler", EnergyClass::Bounded),
        ("velocity_verlet", EnergyClass::Bounded),
        ("yoshida4", EnergyClass::Bounded),
        ("pefrl", EnergyClass::Bounded),
        ("implicit_midpoint", EnergyClass::Bounded),
        ("trapezoidal", EnergyClass::Bounded),
        ("rk4", EnergyClass::Dissipating),
        ("implicit_euler", EnergyClass::Dissipating),
        ("linearized_implicit_predicted", EnergyClass::Dissipating),
        ("linearized_implicit_at_start", EnergyClass::Dissipating),
    ] {
        assert_eq!(class(&outcome(&scene, id)), Some(wanted), "{id}");
    }
}

#[test]
fn deviation_is_the_largest_distance_of_a_particle_over_common_instants() {
    let scene = oscillator(0.01, 0.0);
    let run = recorded(&scene, "velocity_verlet", 1000, 0.01);
    let same = deviation(&run, &run, 0.0).expect("common instants");
    assert_eq!(
        (same.last, same.max, same.first_exceeds_s),
        (0.0, 0.0, None)
    );

    // Explicit Euler against Verlet: worked out from the same states.
    let other = recorded(&scene, "explicit_euler", 1000, 0.01);
    let distance = |k: usize| (other.x(k)[3] - run.x(k)[3]).abs();
    let found = deviation(&other, &run, 0.05).expect("common instants");
    let all: Vec<f64> = (0..run.len()).map(distance).collect();
    assert_eq!(found.max, all.iter().copied().fold(0.0, f64::max));
    assert_eq!(found.last, all[1000]);
    let first = all.iter().position(|d| *d > 0.05).map(|k| run.time(k));
    assert_eq!(found.first_exceeds_s, first);
    assert!(first.is_some());

    // A run that stopped early is compared as far as it went.
    let short = recorded(&scene, "explicit_euler", 100, 0.01);
    assert_eq!(
        deviation(&short, &run, 0.05).expect("common").last,
        all[100]
    );
}

#[test]
fn momentum_is_reported_where_the_scene_conserves_it() {
    let momentum = |scene: &Scene| outcome(scene, "velocity_verlet").momentum;
    assert!(momentum(&swinging_triangle(0.0, DampingModel::Axial)).is_none());
    let axial = momentum(&free_triangle(0.5, DampingModel::Axial)).expect("kept");
    // 100 steps of half a last bit on sums of order 1, as a random walk: 1.1e-15, measured 6.2e-16.
    assert!(axial.linear_error_max.is_some_and(|e| e < 2e-15));
    assert!(axial.angular_error_max.is_some_and(|e| e < 2e-15));
    let isotropic = momentum(&free_triangle(0.5, DampingModel::Isotropic)).expect("kept");
    assert!(isotropic.linear_error_max.is_some() && isotropic.angular_error_max.is_none());
    // Explicit Euler breaks angular momentum by 1.33e-2, and the report shows it.
    let euler = outcome(&free_triangle(0.5, DampingModel::Axial), "explicit_euler");
    let broken = euler.momentum.expect("kept by the scene").angular_error_max;
    assert!(broken.is_some_and(|e| e > 5e-3), "{broken:?}");
}

#[test]
fn an_implicit_step_that_cannot_be_solved_is_a_typed_failure_with_its_step() {
    // Half compressed, a spring's stiffness across is -k, and h² k = m: nothing holds the particle
    // sideways in the linearised step, to the last bit.
    let scene = parsed(
        "solver: {type: linearized_implicit_at_start, timestep: 0.125, gravity: 0}\n\
         particles:\n\
         - {pos: [0, 0, 0], fixed: true}\n\
         - {pos: [0.5, 0, 0], mass: 1}\n\
         springs: [{particle_ids: [0, 1], stiffness: 64, rest_length: 1}]\n",
    );
    let found = outcome(&scene, "linearized_implicit_at_start");
    assert_eq!(found.status, Status::Failed, "{:?}", found.reason);
    let reason = found.reason.expect("a reason");
    assert!(
        reason.contains("in step 0") && reason.contains("particle 1"),
        "{reason}"
    );
    assert_eq!(found.stopped_at_s, Some(0.0));
    // The others went on.
    let all = report(&scene, &["linearized_implicit_at_start", "implicit_euler"]);
    assert_eq!(all.outcomes()[1].status, Status::Completed);
}

#[test]
fn the_kept_settings_reach_the_solver() {
    let mut scene = swinging_triangle(0.2, DampingModel::Axial);
    let solves = |scene: &Scene| outcome(scene, "implicit_midpoint").work.linear_solves;
    let tight = solves(&scene).expect("counted");
    scene.solver.tolerance = Some(1e-3);
    let loose = solves(&scene).expect("counted");
    assert!(loose < tight, "{loose} {tight}");
}
