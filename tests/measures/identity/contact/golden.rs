//! SimBenchmark's bouncing balls under ODE's law.

use super::programs::{Ball, Forces, METHODS, Rule, bounce, rows};
use super::{contact, found, scene};
use springcheck::measure::identify::{Bounce, WAYS, treated_so};
use springcheck::physics::{ParticleSystem, State};

const H: f64 = 5.0;
const G: f64 = 9.81;
/// Balls, and the mass of each, kg.
const BALLS: f64 = 49.0;
const MASS: f64 = 10.0;
const T: f64 = 20.0;

/// The balls are alike, and do not meet.
fn ball() -> Ball {
    Ball {
        x: [0.0, 0.0, H],
        v: [0.0; 3],
        e: 1.0,
        mu: 0.0,
    }
}

/// The mean of (E - 49 m g H)², J², with the energy before each step.
fn mean_square(h: f64) -> f64 {
    let ball = ball();
    let scene = scene(&Forces::default(), &ball, h);
    let system = ParticleSystem::new(&scene);
    let way = WAYS.iter().find(|way| way.id == "flip_before_kick");
    let bounce = Bounce::new(way.expect("a row"));
    let mut state: State = ParticleSystem::initial_state(&scene);
    let candidate = treated_so(&scene, &system, "symplectic_euler", &bounce).expect("a method");
    let mut replayer = candidate.replayer(&Default::default());
    let steps = (T / h).round() as u64;
    let mut sum = 0.0;
    for step in 0..steps {
        let energy = BALLS * MASS * (0.5 * state.v[2] * state.v[2] + G * (state.x[2] - H));
        sum += energy * energy;
        replayer
            .advance(step, 1, h, None, &mut state)
            .expect("a step");
    }
    sum / steps as f64
}

#[test]
fn the_law_of_simbenchmarks_ode_gives_its_published_numbers() {
    for (h, published) in [(1e-4, 1.85055), (1e-3, 185.027), (1e-2, 18_808.3)] {
        let found = mean_square(h);
        // Six digits are published: half of the last is at most 5e-6 of the first.
        assert!((found / published - 1.0).abs() < 3e-6, "{h}: {found}");
    }
}

#[test]
fn its_rows_are_named() {
    let ball = ball();
    let forces = Forces::default();
    for h in [1e-3, 1e-2] {
        let scene = scene(&forces, &ball, h);
        let rows = rows(
            &scene,
            &ball,
            &forces,
            METHODS[0].1,
            (Rule::BeforeKick, bounce),
            2500,
        );
        let found = found(&scene, &rows, None);
        let treated = contact(&found).unwrap_or_else(|| panic!("no contact: {found:#?}"));
        assert_eq!(
            treated.treatment.as_deref(),
            Some("flip_before_kick"),
            "{found:#?}"
        );
        assert!(treated.mistakes.is_empty() && treated.deepest_m > 0.0);
    }
}
