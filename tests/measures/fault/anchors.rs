//! Driven particles that are not where their motion has them: the first row, and how they move instead.

use super::record::{PRECISIONS, rows, run};
use crate::testkit::{driven, everything};
use springcheck::measure::identify::{Candidate, moved_anchor};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{DampingModel, Scene};
use springcheck::trajectory::Precision;

type Way = (&'static str, fn(&Scene, f64) -> [f64; 3]);

/// Where a program may put what is driven, and what is said of it.
const WAYS: [Way; 7] = [
    ("stays at its `pos`", |scene, _| pos(scene)),
    ("moves the other way", |scene, t| moved(scene, t, -1.0)),
    ("moves twice as far", |scene, t| moved(scene, t, 2.0)),
    ("is one step late", |scene, t| {
        moved(scene, t - scene.solver.timestep, 1.0)
    }),
    ("is one step ahead", |scene, t| {
        moved(scene, t + scene.solver.timestep, 1.0)
    }),
    ("starts at its `pos`", |scene, t| {
        let (now, start, pos) = (moved(scene, t, 1.0), moved(scene, 0.0, 1.0), pos(scene));
        [0, 1, 2].map(|axis| pos[axis] + now[axis] - start[axis])
    }),
    ("is where its displacement alone has it", |scene, t| {
        let (now, pos) = (moved(scene, t, 1.0), pos(scene));
        [0, 1, 2].map(|axis| now[axis] - pos[axis])
    }),
];

fn pos(scene: &Scene) -> [f64; 3] {
    scene.particles[scene.driven[0].particle].position
}

/// `pos` and so many times the sine, by its formula.
fn moved(scene: &Scene, t: f64, times: f64) -> [f64; 3] {
    let sine = scene.driven[0].sine.as_ref().expect("a sine");
    let (pos, phase) = (pos(scene), (sine.omega * t + sine.phase).sin());
    [0, 1, 2].map(|axis| pos[axis] + times * sine.amplitude[axis] * phase)
}

#[test]
fn what_is_driven_otherwise_is_said() {
    let mut scene = driven(everything(DampingModel::Axial));
    scene.solver.timestep = 0.01;
    let particle = scene.driven[0].particle;
    let system = ParticleSystem::new(&scene);
    let rk4 = Candidate::method(&system, crate::testkit::method("rk4"), 1);
    let states = run(&scene, 20, |_| &rk4, |_, _| {});
    for precision in PRECISIONS {
        let right = moved_anchor(&scene, &rows(&scene, &states, precision));
        assert!(right.is_none(), "{precision:?}: {right:?}");
        for (says, way) in WAYS {
            let put = |(k, state): (usize, &State)| {
                let mut state = state.clone();
                let at = way(&scene, k as f64 * scene.solver.timestep);
                state.x[3 * particle..3 * particle + 3].copy_from_slice(&at);
                state
            };
            let wrong: Vec<State> = states.iter().enumerate().map(put).collect();
            let fault = moved_anchor(&scene, &rows(&scene, &wrong, precision)).expect(says);
            assert_eq!(fault.particle, particle);
            assert!(fault.explanation.contains(says), "{precision:?}: {fault:?}");
        }
    }
}

/// Right motions with the rounding of other programs: the time as a running sum, a sine as the cosine of a phase less
/// π/2, and a place that is a running sum itself. One that is off by a millionth of its amplitude is none.
#[test]
fn what_is_driven_may_be_rounded_otherwise() {
    let mut scene = driven(everything(DampingModel::Axial));
    scene.solver.timestep = 0.01;
    let particle = scene.driven[0].particle;
    let system = ParticleSystem::new(&scene);
    let rk4 = Candidate::method(&system, crate::testkit::method("rk4"), 1);
    let states = run(&scene, 1000, |_| &rk4, |_, _| {});
    let sine = scene.driven[0].sine.clone().expect("a sine");
    let fault = |scene: &Scene, way: &mut dyn FnMut(usize) -> [f64; 3]| {
        let mut states = states.clone();
        for (k, state) in states.iter_mut().enumerate() {
            state.x[3 * particle..3 * particle + 3].copy_from_slice(&way(k));
        }
        moved_anchor(scene, &rows(scene, &states, Precision::Double))
    };
    let h = scene.solver.timestep;
    let swings = |times: f64, sin: f64| {
        [0, 1, 2].map(|at| pos(&scene)[at] + times * sine.amplitude[at] * sin)
    };
    let mut t = -h;
    let summed = fault(&scene, &mut |_| {
        t += h;
        swings(1.0, (sine.omega * t + sine.phase).sin())
    });
    assert!(summed.is_none(), "{summed:?}");
    let quarter = std::f64::consts::FRAC_PI_2;
    let phase = |k: usize| sine.omega * (k as f64 * h) + sine.phase;
    let cosine = fault(&scene, &mut |k| swings(1.0, (phase(k) - quarter).cos()));
    assert!(cosine.is_none(), "{cosine:?}");
    assert!(fault(&scene, &mut |k| swings(1.0 + 1e-6, phase(k).sin())).is_some());

    let mut steady = scene.clone();
    let velocity = [0.8, -0.2, 0.1];
    (steady.driven[0].sine, steady.driven[0].velocity) = (None, Some(velocity));
    let mut place = [0, 1, 2].map(|at| pos(&scene)[at] - velocity[at] * h);
    let mut summed = |times: f64| {
        fault(&steady, &mut |_| {
            place = [0, 1, 2].map(|at| place[at] + times * velocity[at] * h);
            place
        })
    };
    assert!(summed(1.0).is_none());
    // It is wrong from the start, which is not where it would be without its displacement.
    let wrong = summed(1.0 + 1e-6).expect("another motion");
    assert!(
        !wrong.explanation.contains("starts at its `pos`"),
        "{wrong:?}"
    );
}
