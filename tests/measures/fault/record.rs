//! Trajectories step by step, with whatever went wrong, and written down with so many digits.

use springcheck::integrators::Settings;
use springcheck::measure::identify::Fault;
use springcheck::measure::identify::{Candidate, Question, first_departure};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::Scene;
use springcheck::trajectory::{Precision, Rows};

/// The precisions data comes in.
pub const PRECISIONS: [Precision; 3] = [Precision::Double, Precision::Single, Precision::Digits(6)];

/// `steps` steps from the scene's start, each by the candidate `by` names; `after` may change a
/// state before the next step is taken from it.
pub fn run<'a>(
    scene: &Scene,
    steps: u64,
    by: impl Fn(u64) -> &'a Candidate,
    after: impl Fn(u64, &mut State),
) -> Vec<State> {
    let mut state = ParticleSystem::initial_state(scene);
    let mut states: Vec<State> = vec![state.clone()];
    for step in 0..steps {
        let before = states.len().checked_sub(2).map(|k| states[k].clone());
        let candidate = by(step);
        let mut replayer = candidate.replayer(&Settings::default());
        replayer
            .advance(step, 1, scene.solver.timestep, before.as_ref(), &mut state)
            .unwrap_or_else(|error| panic!("{}, step {step}: {error}", candidate.id));
        after(step, &mut state);
        states.push(state.clone());
    }
    states
}

/// States as a file has them, one step apart.
pub fn rows(scene: &Scene, states: &[State], precision: Precision) -> Rows {
    let write = |value: &f64| match precision {
        Precision::Double => *value,
        Precision::Single => f64::from(*value as f32),
        Precision::Digits(n) => format!("{value:.*e}", n as usize - 1)
            .parse()
            .expect("a number"),
        Precision::SingleDecimals(n) => format!("{:.*}", n as usize, *value as f32)
            .parse()
            .expect("a number"),
        Precision::Decimals(n) => format!("{value:.*}", n as usize).parse().expect("a number"),
    };
    Rows {
        timestep: scene.solver.timestep,
        dim: 3 * scene.particles.len(),
        steps: (0..states.len() as u64).collect(),
        x: states.iter().flat_map(|s| s.x.iter().map(write)).collect(),
        v: Some(states.iter().flat_map(|s| s.v.iter().map(write)).collect()),
        precision,
        precision_v: precision,
        cut: false,
    }
}

/// Every `every`-th of these rows.
pub fn thinned(rows: &Rows, every: usize) -> Rows {
    let kept = |all: &[f64]| {
        let rows = all.chunks_exact(rows.dim).step_by(every);
        rows.flatten().copied().collect::<Vec<f64>>()
    };
    Rows {
        steps: rows.steps.iter().copied().step_by(every).collect(),
        x: kept(&rows.x),
        v: rows.v.as_deref().map(kept),
        ..rows.clone()
    }
}

/// The question about rows.
pub fn question<'a>(scene: &'a Scene, system: &'a ParticleSystem, rows: &'a Rows) -> Question<'a> {
    Question {
        scene,
        system,
        rows,
        settings: Settings::default(),
        transitions: None,
        budget: u64::MAX,
        hint: None,
    }
}

/// The first fault of rows that should follow this method.
pub fn fault_of(scene: &Scene, rows: &Rows, method: &str) -> Option<Fault> {
    let system = ParticleSystem::new(scene);
    let candidate = Candidate::method(&system, crate::testkit::method(method), 1);
    first_departure(&question(scene, &system, rows), &candidate)
}
