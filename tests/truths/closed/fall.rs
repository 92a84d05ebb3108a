//! Quadratic drag on a line, against published numbers, against the converged reference, and in moving air.

use super::form;
use crate::testkit::Random;
use crate::testkit::scenes::{empty, free, shipped};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{Air, Scene, Triangle};
use springcheck::truth::{Motion, NoStore, States, converged};

const EPS: f64 = f64::EPSILON;

/// A particle of 1 kg with c = 0.05 N s²/m² under standard gravity, thrown along z.
fn thrown(velocity: f64) -> Scene {
    let mut scene = empty();
    scene.solver.gravity = -9.81;
    let mut particle = free([0.0; 3], 1.0);
    particle.velocity[2] = velocity;
    particle.quadratic_drag = 0.05;
    scene.particles.push(particle);
    scene
}

fn states(scene: &Scene, times: &[f64]) -> States {
    let found = form(scene, 10.0).expect("a form");
    assert_eq!(found.method.as_deref(), Some("fall with quadratic drag"));
    found.motion().expect("a motion").states(times)
}

/// Speed and way after so many seconds, and the terminal speed: computed elsewhere at 36 digits.
const FALL: [(f64, f64, f64); 3] = [
    (1.0, 8.4686385137803239, 4.5497212082596806),
    (2.0, 12.403406112028349, 15.330358672185977),
    (5.0, 13.981709474047688, 56.190925954858809),
];

/// How far a fall is off, in roundings of the numbers published.
fn off(of: impl Fn(&[f64]) -> States) -> f64 {
    let found = of(&FALL.map(|(t, ..)| t));
    let each = FALL.iter().enumerate().map(|(k, (_, speed, way))| {
        let velocity = (found.v(k)[2] + speed).abs() / speed;
        velocity.max((found.x(k)[2] + way).abs() / way) / EPS
    });
    each.fold(0.0, f64::max)
}

#[test]
fn a_fall_has_the_published_speeds() {
    // A dozen operations, half a rounding each: measured 2.1.
    assert!(off(|times| states(&thrown(0.0), times)) < 6.0);
    let mut wrong = thrown(0.0);
    wrong.particles[0].quadratic_drag *= 1.0 + 1e-14;
    assert!(off(|times| states(&wrong, times)) > 6.0);
}

/// Thrown up at 20 m/s: the top, and the speed with which it comes back.
#[test]
fn a_throw_turns_and_returns_as_published() {
    let scene = thrown(20.0);
    let (apex, height, back) = (1.3704877648641028, 11.114416341127084, 11.473172184411919);
    let top = states(&scene, &[apex]);
    // The velocity there is a difference: roundings of g t, 13 m/s.
    assert!(top.v(0)[2].abs() < 4.0 * EPS * 13.4, "{}", top.v(0)[2]);
    assert!((top.x(0)[2] / height - 1.0).abs() < 4.0 * EPS);
    let (mut low, mut high) = (apex, 5.0);
    while high - low > 2.0 * EPS * high {
        let middle = 0.5 * (low + high);
        if states(&scene, &[middle]).x(0)[2] > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    // The time of return is known to a few roundings of heights over the speed, and g times that is the speed's.
    let speed = -states(&scene, &[high]).v(0)[2];
    assert!((speed / back - 1.0).abs() < 16.0 * EPS, "{speed}");
}

/// Every case of the closed form against a reference that shares nothing with it but the scene.
#[test]
fn the_converged_reference_agrees() {
    let mut random = Random(9);
    for (velocity, gravity) in [(0.0, -9.81), (20.0, -9.81), (-40.0, -9.81), (7.0, 0.0)] {
        for air in [[0.0; 3], [3.0, 0.0, 0.0], [0.0, 0.0, -5.0]] {
            let mut scene = thrown(velocity);
            scene.solver.gravity = gravity;
            scene.particles[0].mass = 1.0 + 0.5 * random.next();
            // Along x the particle moves with the air.
            scene.particles[0].velocity[0] = air[0];
            scene.air = Some(Air {
                velocity: air,
                ..Air::default()
            });
            let times = [0.5, 1.7, 3.0];
            let system = ParticleSystem::new(&scene);
            let found = form(&scene, 3.0).expect("a form");
            let other = converged::find(&scene, &system, 3.0, &NoStore).expect("a reference");
            let (ours, theirs) = (states(&scene, &times), other.motion.states(&times));
            let far = apart(&ours, &theirs);
            let bar = found.error_bound + other.motion.error_bar(3.0);
            assert!(
                far <= bar,
                "{velocity}, {gravity}, {air:?}: {far:e} > {bar:e}"
            );
            // Twice the drag is far beyond it.
            scene.particles[0].quadratic_drag *= 1.0 + 1e-6;
            let wrong = apart(&states(&scene, &times), &theirs);
            let still = velocity == 0.0 && gravity == 0.0;
            assert!(still || wrong > 10.0 * bar, "{wrong:e} {bar:e}");
        }
    }
}

fn apart(a: &States, b: &States) -> f64 {
    crate::testkit::distance(&a.x, &b.x)
}

/// Off the line, beside linear drag or on a spring there is none.
#[test]
fn other_scenes_have_none() {
    let none: [fn(&mut Scene); 3] = [
        |s| s.particles[0].velocity[0] = 1.0,
        |s| s.particles[0].drag = 0.1,
        |s| {
            s.particles.push(free([0.0, 0.0, 1.0], 1.0));
            s.springs
                .push(crate::testkit::scenes::spring([0, 1], 10.0, 1.0));
        },
    ];
    for change in none {
        let mut scene = thrown(1.0);
        change(&mut scene);
        assert!(form(&scene, 3.0).is_none());
    }
}

/// A flat sheet of two triangles has the area, and so the drag, of the ball above per mass.
#[test]
fn a_falling_sheet_has_the_published_speeds() {
    let reference = |scene: &Scene| {
        let system = ParticleSystem::new(scene);
        converged::find(scene, &system, 5.0, &NoStore).expect("a reference")
    };
    let scene = shipped("effects/falling_sheet.yml");
    let found = reference(&scene);
    // Its bar is some 1e-10 m over 56 m.
    let allowed = found.motion.error_bar(5.0) / 4.0 / EPS;
    assert!(allowed < 1e-9 / EPS, "{allowed:e}");
    let off_by = off(|times| found.motion.states(times));
    assert!(off_by <= allowed, "{off_by:e} > {allowed:e}");
    // The other mistakes of a factor: one corner's third, the area doubled.
    for factor in [1.0 / 3.0, 2.0] {
        let mut wrong = scene.clone();
        let change = |t: &mut Triangle| t.air_drag *= factor;
        wrong.triangles.iter_mut().for_each(change);
        assert!(off(|times| reference(&wrong).motion.states(times)) > 1e12);
    }
}
