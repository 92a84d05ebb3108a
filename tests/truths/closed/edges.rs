//! Where rounding decides: offsets from a line, modes that share a frequency, numbers at the limits.

use super::families::{self, empty, fixed, free, spring};
use super::{exact, form, gauss};
use crate::testkit::{Random, distance};
use springcheck::physics::{ParticleSystem, State};
use springcheck::scene::{DampingModel, Scene};

/// A mass an ulp beside the line of two compressed springs buckles; `far` puts the line where that
/// ulp is large. The distance of its anchors is 2, `rest` the rest length of each spring.
fn beside(far: f64, offset: f64, rest: f64, speed: f64) -> Scene {
    let mut scene = empty();
    scene.particles = vec![
        fixed([far, 0.0, 0.0]),
        fixed([far, 0.0, 2.0]),
        free([far + offset, 0.0, 1.0], [0.0, 0.0, speed], 1.0),
    ];
    scene.springs = vec![spring(0, 2, 4.5, 0.0, rest), spring(1, 2, 4.5, 0.0, rest)];
    scene
}

#[test]
fn rounding_across_the_line_is_in_the_bar() {
    // Compressed: buckles at σ = 3/s at most. Stretched and swinging: pumped, but hardly.
    for (rest, speed, until) in [(1.5, 0.0, 0.8), (1.5, 0.3, 0.7), (0.6, 0.4, 1.5)] {
        let ulp = 1e6 * f64::EPSILON / 2.0;
        let offset = (1e6 + ulp) - 1e6;
        let scene = beside(1e6, offset, rest, speed);
        let aside = form(&scene, until)
            .expect("a form")
            .motion()
            .expect("a motion")
            .error_bar(until);
        let straight = form(&beside(1e6, 0.0, rest, speed), until).expect("a form");
        let bar = aside - straight.motion().expect("a motion").error_bar(until);
        // The same about the origin, where doubles resolve it.
        let near = beside(0.0, offset, rest, speed);
        let mut state: State = ParticleSystem::initial_state(&near);
        gauss::advance(&ParticleSystem::new(&near), &mut state, until, 2000);
        let found = state.x[6].abs();
        // Measured 3.9 to 6.3: twice for the second order, and growth at the fastest rate throughout.
        assert!(found < bar && bar < 12.0 * found, "{found:e}, bar {bar:e}");
        // Later it is too much.
        assert!(form(&scene, 10.0).is_none());
        assert!(form(&beside(1e6, 0.0, rest, speed), 10.0).is_some());
        // And an offset beyond rounding is none at all.
        assert!(form(&beside(1e6, 16.0 * offset, rest, speed), 1e-3).is_none());
    }
}

/// Damping that is no multiple of stiffness or mass, but has its modes: rings of equal masses, where
/// pairs of modes share a frequency and only damping tells them apart, or nothing does.
#[test]
fn rings_have_modes() {
    let ring = |damping: [f64; 2], n: usize| {
        let mut scene = empty();
        scene.damping_model = DampingModel::Isotropic;
        let mut random = Random(8);
        for _ in 0..n {
            let (x, v) = (
                families::vector(&mut random, 1.0),
                families::vector(&mut random, 1.0),
            );
            scene.particles.push(free(x, v, 0.7));
        }
        for i in 0..n {
            scene
                .springs
                .push(spring(i, (i + 1) % n, 50.0, damping[0], 0.0));
            scene
                .springs
                .push(spring(i, (i + 2) % n, 7.0, damping[1], 0.0));
        }
        scene
    };
    for n in [5, 6, 9] {
        let scene = ring([0.3, 1.1], n);
        let truth = form(&scene, 3.0).expect("modes");
        let motion = truth.motion().expect("a motion");
        for t in [0.1, 1.0, 3.0] {
            let exact: Vec<f64> = exact::states(&scene, t).0.iter().map(|x| x.0).collect();
            let off = distance(&exact, motion.states(&[t]).x(0)) / motion.error_bar(t);
            assert!(off < 1.0, "{n}, {t}: {off}");
            let other = form(&ring([0.3, 1.1 + 1e-6], n), 3.0);
            let truth = other.expect("modes");
            let other = truth.motion().expect("a motion");
            assert!(distance(&exact, other.states(&[t]).x(0)) > motion.error_bar(t));
        }
    }
    // One damper elsewhere breaks it.
    let mut scene = ring([0.3, 1.1], 6);
    scene.springs[0].damping = 0.31;
    assert!(form(&scene, 3.0).is_none());
}

/// The largest and smallest numbers a scene may hold give numbers, or no form; never NaN.
#[test]
fn extremes_stay_numbers() {
    let mut random = Random(12);
    let mut forms = 0;
    for case in 0..400 {
        let mut scene = match case % 5 {
            0 => families::fall(&mut random, 1.0),
            1 => families::hanging(&mut random, 2.0, 1.0),
            2 => families::isotropic(&mut random, 2.0, 1.0),
            3 => families::chain(&mut random, 3, 0.1),
            _ => families::network(&mut random, 3, 0.1, 0.1),
        };
        let mut extreme =
            |low: f64, high: f64| 10f64.powf(families::between(&mut random, low, high));
        let (mass, stiffness) = (extreme(-30.0, 30.0), extreme(-18.0, 18.0));
        scene.particles.iter_mut().for_each(|p| {
            p.mass *= mass;
            p.drag *= stiffness;
        });
        scene.springs.iter_mut().for_each(|s| {
            s.stiffness *= stiffness;
            s.damping *= stiffness;
        });
        scene.solver.gravity *= extreme(-30.0, 11.0);
        let until = extreme(-30.0, 12.0);
        let Some(found) = form(&scene, until) else {
            continue;
        };
        forms += 1;
        let states =
            found
                .motion()
                .expect("a motion")
                .states(&[0.0, 1e-9 * until, 0.3 * until, until]);
        let finite = states.x.iter().chain(&states.v).all(|c| c.is_finite());
        let bar = found.motion().expect("a motion").error_bar(until);
        assert!(finite && bar.is_finite() && bar >= 0.0, "{case}: {scene:?}");
    }
    assert!(forms > 200, "{forms}");
}
