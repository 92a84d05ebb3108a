//! Where the horizon ends, how neighbours part, and what does not converge at all.

use super::honesty::times;
use super::problems::{self, Rough, bodies, closure, shot};
use crate::testkit::scenes::{parsed, shipped, spring};
use crate::testkit::swinging_triangle;
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{DampingModel, Scene};
use springcheck::truth::converged::{
    BUDGET, Converged, HORIZON, NotConverged, SharedSystem, converge, find,
};
use springcheck::truth::{Motion, NoStore};
use std::sync::Arc;

fn of(scene: &Scene, until: f64) -> Result<Converged, NotConverged> {
    find(scene, &ParticleSystem::new(scene), until, &NoStore)
}

#[test]
fn the_growth_of_an_unstable_equilibrium_is_its_rate() {
    // x'' = w² x: all neighbours part as exp(w t). From rest at 0 nothing else moves.
    let w = 1.5;
    let system = closure(1, move |x, a| a[0] = w * w * x[0]);
    let start = State::new(vec![0.0], vec![0.0]);
    let converged = converge(&system, &start, 12.0, 1.0, BUDGET).expect("it converges");
    let growth = converged.facts.growth.expect("neighbours part");
    // The cosh's flat start, an eighth of which is left out, takes some away: measured 1.492.
    assert!((growth - w).abs() < 0.02, "measured {growth}");
}

#[test]
fn neighbours_of_regular_motion_have_no_growth_rate() {
    for known in [
        problems::chain(),
        problems::damped(),
        problems::kepler(),
        problems::thrown(),
    ] {
        let converged = converge(&known.system, &known.start, known.until, known.size, BUDGET);
        let converged = converged.expect(known.name);
        assert_eq!(converged.facts.growth, None, "{}", known.name);
    }
}

#[test]
fn chaos_ends_the_horizon_and_its_rate_says_when() {
    // A double pendulum on stiff springs that goes over the top.
    let mut scene = bodies(&[
        (1.0, [0.0, 0.0, 0.0], [0.0; 3]),
        (1.0, [1.0, 0.0, 0.2], [0.0; 3]),
        (1.0, [2.0, 0.0, 0.5], [0.0; 3]),
    ]);
    scene.gravitational.clear();
    scene.particles[0].fixed = true;
    scene.solver.gravity = -9.81;
    for ends in [[0, 1], [1, 2]] {
        scene.springs.push(spring(ends, 500.0, 1.02));
    }
    let until = 40.0;
    let converged = of(&scene, until).expect("it converges for a while");
    let limit = HORIZON * scene.size();
    let growth = converged.facts.growth.expect("chaotic");
    println!("{} {growth}", converged.facts.reason);
    assert!(converged.facts.horizon > 5.0 && converged.facts.horizon < until);
    assert!(converged.facts.error_bound <= limit);
    assert_eq!(
        converged.facts.error_bound,
        converged.motion.error_bar(converged.facts.horizon)
    );
    assert!(converged.motion.error_bar(converged.facts.horizon + 0.2) > limit);
    // From rounding to the limit there are ln(1e-6 / 1e-16) = 23 e-foldings.
    let foldings = growth * converged.facts.horizon;
    assert!((10.0..46.0).contains(&foldings), "{foldings} e-foldings");
    // Beyond, states are still numbers.
    let states = converged.motion.states(&[until]);
    assert!(states.x.iter().chain(&states.v).all(|c| c.is_finite()));
}

#[test]
fn the_shipped_scenes_lie_within_their_horizons() {
    for name in ["00", "01", "02", "03", "04", "05", "06"] {
        let scene = shipped(&format!("pa1/scene{name}.yml"));
        let until = scene.steps(scene.solver.timestep) as f64 * scene.solver.timestep;
        let converged = of(&scene, until).expect("it converges");
        println!(
            "{name}: {}; bound {:.1e}, growth {:?}, spent {}",
            converged.facts.reason,
            converged.facts.error_bound,
            converged.facts.growth,
            converged.facts.spent
        );
        assert_eq!(converged.facts.horizon, until, "{name}");
        // Rounding of coordinates of up to 120 m, amplified; measured 5.5e-13 and below.
        assert!(converged.facts.error_bound < 1e-12, "{name}");
    }
}

#[test]
fn a_spring_is_followed_through_its_own_end() {
    // Past it at a distance and head on, where the force jumps.
    // Measured bounds 5.3e-13 and 2.6e-12 m, energies off by 1.3e-15 and 5.8e-13.
    for (miss, bound, off) in [(1e-3, 1.6e-12, 4e-15), (0.0, 8e-12, 1.7e-12)] {
        let scene = shot(miss);
        let converged = of(&scene, 5.0).expect("it converges");
        println!(
            "{miss}: {} {:.1e}",
            converged.facts.reason, converged.facts.error_bound
        );
        assert_eq!(converged.facts.horizon, 5.0, "{miss}");
        assert!(converged.facts.error_bound < bound, "{miss}");
        // Whichever way it went, its energy is still there.
        let system = ParticleSystem::new(&scene);
        let energy = |x: &[f64], v: &[f64]| system.kinetic(v) + system.potential(0.0, x);
        let start = ParticleSystem::initial_state(&scene);
        let start = energy(&start.x, &start.v);
        let times = times(5.0);
        let states = converged.motion.states(&times);
        let lost = (0..times.len()).map(|k| (energy(states.x(k), states.v(k)) - start).abs());
        let lost = lost.fold(0.0, f64::max) / start;
        println!("{miss}: energy off by {lost:.1e}");
        assert!(lost < off, "{miss}: {lost:.1e}");
    }
}

#[test]
fn what_no_method_can_follow_has_no_reference_or_a_short_one() {
    let system: SharedSystem = Arc::new(Rough);
    let start = State::new(vec![1.0], vec![0.0]);
    match converge(&system, &start, 20.0, 1.0, BUDGET / 16) {
        Err(none) => println!("{none}"),
        Ok(short) => assert!(short.facts.horizon < 2.0, "{}", short.facts.reason),
    }
}

#[test]
fn too_fast_a_motion_says_what_it_would_take() {
    let mut scene = shot(0.0);
    scene.springs[0].stiffness = 1e14;
    let refused = of(&scene, 5.0).err().expect("beyond the budget");
    // w = 1e7 /s for 5 s: 5e7 radians of at most one a step.
    assert!(refused.reason.contains("67,108,864 steps"), "{refused}");
    // And so does a damper.
    scene.springs[0].stiffness = 1.0;
    scene.springs[0].damping = 1e9;
    assert!(of(&scene, 5.0).is_err());
    // A budget decides by counting.
    let known = problems::chain();
    let within = |budget| converge(&known.system, &known.start, known.until, known.size, budget);
    assert!(within(10).is_err());
    assert!(within(BUDGET).is_ok_and(|c| c.facts.spent <= BUDGET));
}

#[test]
fn forces_that_are_no_numbers_have_no_reference() {
    let start = State::new(vec![1.0], vec![0.0]);
    let nan = closure(1, |_, a| a[0] = f64::NAN);
    assert!(converge(&nan, &start, 1.0, 1.0, BUDGET).is_err());
    // A motion that blows up at t = 1 has one until shortly before: x = 1 / (1 - t)² solves
    // x'' = 6 x² for x(0) = 1, x'(0) = 2.
    let blows_up = closure(1, |x, a| a[0] = 6.0 * x[0] * x[0]);
    let start = State::new(vec![1.0], vec![2.0]);
    let converged = converge(&blows_up, &start, 2.0, 1.0, BUDGET / 64).expect("up to then");
    assert!(
        (0.5..1.0).contains(&converged.facts.horizon),
        "{}",
        converged.facts.reason
    );
    let states = converged.motion.states(&times(2.0));
    assert!(states.x.iter().chain(&states.v).all(|c| c.is_finite()));
    for t in [0.0, 0.25, 0.5] {
        let x = converged.motion.states(&[t]).x[0];
        assert!((x - (1.0 - t).powi(-2)).abs() <= converged.motion.error_bar(t));
    }
    for until in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(converge(&blows_up, &start, until, 1.0, BUDGET).is_err());
    }
    // Nor has a state of another system, or of none.
    let two = State::new(vec![0.0; 2], vec![0.0; 2]);
    assert!(converge(&blows_up, &two, 1.0, 1.0, BUDGET).is_err());
    let none = State::new(Vec::new(), Vec::new());
    assert!(converge(&closure(0, |_, _| ()), &none, 1.0, 1.0, BUDGET).is_err());
}

#[test]
fn nothing_moves_where_all_is_fixed() {
    let mut scene = shot(0.5);
    for particle in &mut scene.particles {
        particle.fixed = true;
        particle.velocity = [0.0; 3];
    }
    let converged = of(&scene, 5.0).expect("it stands still");
    let start = ParticleSystem::initial_state(&scene);
    let states = converged.motion.states(&times(5.0));
    for k in 0..times(5.0).len() {
        assert_eq!((states.x(k), states.v(k)), (&start.x[..], &start.v[..]));
    }
    assert_eq!(
        (converged.facts.horizon, converged.facts.growth),
        (5.0, None)
    );
}

#[test]
fn any_times_give_the_same_bits_and_any_number_of_threads() {
    let scene = swinging_triangle(0.2, DampingModel::Isotropic);
    let all = times(4.0);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("threads").install(|| {
            let converged = of(&scene, 4.0).expect("it converges");
            let facts = (
                converged.facts.horizon,
                converged.facts.error_bound,
                converged.facts.method,
            );
            (facts, converged.motion.states(&all))
        })
    };
    let (facts, states) = run(1);
    assert_eq!(run(4), (facts, states.clone()));

    let motion = of(&scene, 4.0).expect("it converges").motion;
    let start = ParticleSystem::initial_state(&scene);
    assert_eq!((states.x(0), states.v(0)), (&start.x[..], &start.v[..]));
    for k in (0..all.len()).step_by(37) {
        let alone = motion.states(&all[k..=k]);
        assert_eq!(
            (&alone.x[..], &alone.v[..]),
            (states.x(k), states.v(k)),
            "{k}"
        );
    }
}

#[test]
fn a_penalty_that_is_met_on_the_way_does_not_end_the_horizon() {
    // In after .05 s at 1 m/s, inside for π/(w sqrt(1 - ζ²)) with w = 100/s, ζ = .1, and out at exp(-π ζ/sqrt(1 - ζ²)) of it.
    let scene = parsed(
        "solver: {type: rk4, timestep: 0.001, gravity: 0}\nduration: 1\n\
         particles: [{pos: [0, 0, 0.05], vel: [0, 0, -1], radius: 0, mass: 1}]\n\
         contact: {penalty: {stiffness: 10000, damping: 20}}\n\
         colliders: [{plane: {normal: [0, 0, 1]}}]\n",
    );
    let found = of(&scene, 1.0).expect("it converges");
    assert_eq!(found.facts.horizon, 1.0, "{}", found.facts.reason);
    let across = 0.99_f64.sqrt();
    let inside = std::f64::consts::PI / (100.0 * across);
    let right = (-0.1 * std::f64::consts::PI / across).exp() * (1.0 - 0.05 - inside);
    let off = (found.motion.states(&[1.0]).x(0)[2] - right).abs();
    assert!(off <= found.facts.error_bound && off < 1e-11, "{off:e}");
}
