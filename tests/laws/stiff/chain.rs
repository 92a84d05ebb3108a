//! The quartic chain in steps of 5 and 10 radians of its stiff springs.

use super::hard;
use crate::testkit::{advance, built, method, own};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{Scene, steps};

/// Of the stiff springs, rad/s; and how long each spring is at rest, m.
const W: f64 = 50.0;
const LENGTH: f64 = 20.0;

/// Energy, J, of the stiff springs and of what moves them; and of all the rest.
fn energies(system: &ParticleSystem, state: &State) -> (f64, f64) {
    let pair = |first: usize| {
        let [low, high] = [first, first + 1].map(|i| (state.x[3 * i], state.v[3 * i]));
        let (stretch, rate) = (high.0 - low.0 - LENGTH, high.1 - low.1);
        // In coordinates (x2 - x1)/√2.
        0.25 * (rate * rate + W * W * stretch * stretch)
    };
    let fast: f64 = [1, 3, 5].map(pair).iter().sum();
    let all = system.kinetic(&state.v) + system.potential(state.t, &state.x);
    (fast, all - fast)
}

/// Fast and slow energy at t = 200, and the largest fast one from t = 100 on.
fn at_the_end(id: &str, h: f64) -> (f64, f64, f64) {
    let (system, mut state) = built(&hard("fput.yml"));
    let mut integrator = own(method(id))();
    let n = steps(200.0, h);
    let mut most = 0.0_f64;
    for step in 1..=n {
        advance(integrator.as_mut(), &system, h, 1, &mut state);
        if step > n / 2 {
            most = most.max(energies(&system, &state).0);
        }
    }
    let (fast, slow) = energies(&system, &state);
    (fast, slow, most)
}

/// What slow motion leaves in a stiff spring: it is stretched by F / w², F being the difference of the
/// quartic springs' pulls 4 s³ at its ends over √2. With the sum of all s⁴ at most 1 J, that of s⁶ is,
/// too; each pull is at two springs, so the sum of all F² is at most 2 · 2 · 16/2 = 32 N², and the energy
/// 32 / (2 w²).
const FORCED: f64 = 32.0 / (2.0 * W * W);

/// Of an energy of 1 J fast and 1 J slow.
#[test]
fn a_coarse_step_keeps_the_slow_half_of_the_energy() {
    let mut lost = Vec::new();
    for h in [0.2, 0.1] {
        let (_, slow, most) = at_the_end("tr_bdf2", h);
        // Measured 2.5e-3.
        assert!(most < FORCED, "h = {h}: {most:e}");
        lost.push(1.0 - slow);
        // Neither of the others: all is lost, or the fast half is still there.
        let (_, slow, _) = at_the_end("implicit_euler", h);
        assert!(slow < 0.005, "{slow}");
        for id in ["implicit_midpoint", "trapezoidal"] {
            let (fast, slow, most) = at_the_end(id, h);
            assert!(most > 100.0 * FORCED, "{id}");
            // To 1/w, as the chain itself exchanges it.
            assert!(
                (fast - 1.0).abs() < 1.0 / W && (slow - 1.0).abs() < 1.1 / W,
                "{id} {fast} {slow}"
            );
        }
    }
    // z⁴ a step is of third order over a given time.
    let ratio = lost[0] / lost[1];
    assert!((7.0..10.0).contains(&ratio), "{lost:?}");
    assert!(lost[1] < 0.02, "{lost:?}");
}

/// The start without fast motion: both masses of the first pair at 1/√2, with speed 1/√2.
fn slow_start() -> Scene {
    let mut scene = hard("fput.yml");
    let share = 0.5_f64.sqrt();
    for i in [1, 2] {
        scene.particles[i].position[0] = LENGTH * i as f64 + share;
        scene.particles[i].velocity[0] = share;
    }
    scene
}

/// The pairs' middles at t = 10.
fn middles(id: &str, h: f64) -> Vec<f64> {
    let (system, mut state) = built(&slow_start());
    let n = (10.0 / h).round() as usize;
    advance(own(method(id))().as_mut(), &system, h, n, &mut state);
    let middle = |first: usize| 0.5 * (state.x[3 * first] + state.x[3 * first + 3]);
    [1, 3, 5].map(middle).to_vec()
}

/// Stiff springs take nothing from the order of the slow motion, far from resolving them: halving
/// the step from 10 rad of them to 2.5 divides its error by four each time.
#[test]
fn slow_motion_keeps_its_order() {
    let truth = middles("pefrl", 5e-4);
    let orders = |id: &str| {
        let error = |h: f64| crate::testkit::distance(&middles(id, h), &truth);
        let errors = [0.2, 0.1, 0.05].map(error);
        (
            [errors[0] / errors[1], errors[1] / errors[2]].map(f64::log2),
            errors[2],
        )
    };
    let (found, _) = orders("tr_bdf2");
    // Measured 2.23 and 2.13.
    assert!(found.iter().all(|p| (1.95..2.3).contains(p)), "{found:?}");
    let (found, error) = orders("implicit_euler");
    assert!(found.iter().all(|p| *p < 0.5) && error > 0.5, "{found:?}");
}
