//! The picture of a stiff spring, against what a step from rest does by hand.

use crate::testkit::scenes::shipped;
use springcheck::scene::Scene;
use springcheck::verbs::session::Quiet;
use springcheck::verbs::stability::Admissible;
use springcheck::verbs::stability::StabilityPlan;

fn pair() -> Scene {
    shipped("hard/stiff_pair.yml")
}

fn picture(scene: &Scene, stiffnesses: &[f64]) -> Admissible {
    let plan = StabilityPlan {
        scene,
        solvers: Vec::new(),
        timestep: scene.solver.timestep,
        map: None,
        largest: None,
        admissible: stiffnesses.to_vec(),
    };
    let report = plan.execute(&Quiet).expect("two free particles");
    report
        .stability()
        .and_then(|limits| limits.admissible.clone())
        .expect("a picture")
}

/// At distance l = L + e, with s = h² k (1/m1 + 1/m2), the step takes e to e (1 - s) unless the ends
/// pass through each other. So for s <= 2 it never grows. Beyond, it grows for every e < 0; a stretched
/// spring turns over, to the length s e - l, which is off by s e - l - L: no more than e exactly from
/// e = 2L/s to 2L/(s - 2).
fn by_hand(s: f64, e: f64, rest: f64) -> bool {
    s <= 2.0 || (2.0 * rest / s..=2.0 * rest / (s - 2.0)).contains(&e)
}

/// Places where the picture and a formula differ.
fn differing(picture: &Admissible, formula: impl Fn(f64, f64) -> bool) -> usize {
    let mut count = 0;
    for panel in &picture.panels {
        for (line, x2) in panel.admitted.iter().zip(&picture.x2_m) {
            for (cell, x1) in line.chars().zip(&picture.x1_m) {
                let e = (x2 - x1).abs() - picture.rest_length_m;
                count += usize::from((cell == '1') != formula(panel.stiffness_n_m, e));
            }
        }
    }
    count
}

#[test]
fn the_region_is_what_a_step_by_hand_admits() {
    for masses in [[1.0, 1.0], [0.5, 4.0]] {
        let mut scene = pair();
        for (particle, mass) in scene.particles.iter_mut().zip(masses) {
            particle.mass = mass;
        }
        let h = scene.solver.timestep;
        let picture = picture(&scene, &[1.0, 5.0, 11.0]);
        let inverse: f64 = masses.iter().map(|m| 1.0 / m).sum();
        let s = |k: f64| h * h * k * inverse;
        // No place of the picture lies within rounding of an edge: all of them must agree.
        assert_eq!(differing(&picture, |k, e| by_hand(s(k), e, 1.0)), 0);
        // A step that moves one end only, half a step, and one that forgets the ends' passing.
        assert!(differing(&picture, |k, e| by_hand(h * h * k / masses[0], e, 1.0)) > 100);
        assert!(differing(&picture, |k, e| by_hand(s(k) / 4.0, e, 1.0)) > 100);
        assert!(differing(&picture, |k, _| s(k) <= 2.0) > 100);
    }
}

#[test]
fn the_region_shrinks_with_stiffness() {
    let picture = picture(&pair(), &[1.0, 5.0, 11.0, 1e4]);
    let shares: Vec<f64> = picture.panels.iter().map(|panel| panel.share).collect();
    assert_eq!(shares[0], 1.0);
    assert!(
        shares.windows(2).all(|pair| pair[1] < pair[0]),
        "{shares:?}"
    );
    // K = 11: s = 5.5, e from 2/5.5 to 2/3.5, of the square's 6 by 6: two strips of width w along
    // |x2 - x1| = l cover ((6 - l_low)² - (6 - l_high)²) / 36 of it.
    let strips = ((5.0_f64 - 2.0 / 5.5).powi(2) - (5.0_f64 - 2.0 / 3.5).powi(2)) / 36.0;
    // Edges are known to half a cell of 6/192 at either side of strips 0.208 wide, 15 % if all were off
    // the same way; cells drift past an edge along the strip and average to 1.6 %.
    assert!(
        (shares[2] / strips - 1.0).abs() < 0.05,
        "{} {strips}",
        shares[2]
    );
    assert!(shares[3] < 1e-3);
}

#[test]
fn other_scenes_are_refused() {
    let refused = |change: fn(&mut Scene)| {
        let mut scene = pair();
        change(&mut scene);
        let plan = StabilityPlan {
            scene: &scene,
            solvers: Vec::new(),
            timestep: 0.5,
            map: None,
            largest: None,
            admissible: vec![1.0],
        };
        plan.execute(&Quiet).expect_err("no picture").to_string()
    };
    assert!(refused(|scene| scene.particles[0].fixed = true).contains("particle 0 is fixed"));
    assert!(refused(|scene| scene.solver.gravity = -9.81).contains("gravity"));
    assert!(refused(|scene| scene.springs[0].rest_length = 0.0).contains("rest length is 0"));
    assert!(refused(|scene| scene.springs.clear()).contains("springs: 0"));
}
