//! What gets a closed form, which, and why; and what gets none.

use super::families;
use super::{exact, form};
use crate::testkit::Random;
use crate::testkit::scenes::{empty, shipped};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{DampingModel, GravitationalPair, Scene};
use springcheck::truth::closed::find;

/// Shipped scenes and their forms.
const FORMS: &[(&str, Option<&str>)] = &[
    ("pa1/scene00.yml", Some("parabola")),
    ("pa1/scene01.yml", Some("oscillator in line, undamped")),
    ("pa1/scene02.yml", Some("oscillator in line, underdamped")),
    ("pa1/scene03.yml", None),
    ("pa1/scene04.yml", None),
    ("pa1/scene05.yml", None),
    ("pa1/scene06.yml", None),
    (
        "oscillator/oscillator.yml",
        Some("oscillator in line, undamped"),
    ),
    (
        "oscillator/damped_under.yml",
        Some("oscillator in line, underdamped"),
    ),
    (
        "oscillator/damped_critical.yml",
        Some("oscillator in line, critically damped"),
    ),
    (
        "oscillator/damped_over.yml",
        Some("oscillator in line, overdamped"),
    ),
    (
        "oscillator/circle.yml",
        Some("oscillator in space, undamped"),
    ),
];

#[test]
fn shipped_scenes() {
    for (file, method) in FORMS {
        let found = form(&shipped(file), 5.0);
        assert_eq!(
            found.as_ref().and_then(|f| f.method.as_deref()),
            *method,
            "{file}"
        );
    }
    let reason = form(&shipped("pa1/scene02.yml"), 5.0)
        .expect("a form")
        .reason;
    assert_eq!(
        reason,
        "one free particle on one spring, moving along it: the force is linear while the spring's \
         length stays above 1.0 m"
    );
}

/// What a family's form is called.
#[test]
fn families_by_name() {
    let mut random = Random(3);
    let random = &mut random;
    let cases: [(Scene, &str); 9] = [
        (families::fall(random, 0.0), "parabola"),
        (families::fall(random, 0.2), "fall with linear drag"),
        (families::charged(random, 3.0, 0.0), "helix"),
        (
            families::charged(random, 3.0, 0.2),
            "helix with linear drag",
        ),
        (
            families::chain(random, 4, 0.0),
            "eigendecomposition of 4 modes",
        ),
        (
            families::network(random, 5, 0.1, 0.0),
            "eigendecomposition of 5 modes",
        ),
        (families::two(random), "two bodies on one spring, undamped"),
        (
            families::together(random),
            "eigendecomposition of 3 modes and fall with linear drag and oscillator in space, undamped",
        ),
        (empty(), "rest"),
    ];
    for (scene, method) in cases {
        assert_eq!(
            form(&scene, 2.0).expect(method).method.as_deref(),
            Some(method)
        );
    }
}

/// Nothing that couples or bends the motion otherwise gets a form.
#[test]
fn none_where_forces_are_not_linear() {
    let mut random = Random(5);
    let random = &mut random;
    let hanging = families::hanging(random, 3.0, 0.1);
    assert!(form(&hanging, 5.0).is_some());
    let change = |change: fn(&mut Scene)| {
        let mut scene = hanging.clone();
        change(&mut scene);
        form(&scene, 5.0).is_some()
    };
    assert!(!change(|s| s.particles[1].position[0] = 1e-6), "aside");
    assert!(
        !change(|s| s.particles[1].velocity[1] = 1e-9),
        "moving aside"
    );
    assert!(
        !change(|s| s.particles[1].velocity[2] = 100.0),
        "passing the anchor"
    );
    assert!(
        !change(|s| s.particles[1].velocity[2] = -100.0),
        "passing it on the way back"
    );
    assert!(
        !change(|s| s.particles[1].position = [0.0, 0.0, 2.0]),
        "no direction"
    );
    assert!(
        !change(|s| s.gravitational.push(GravitationalPair {
            ends: [0, 1],
            g: 1e-9
        })),
        "attraction"
    );
    assert!(!change(|s| s.springs[0].cubic = 1e-9), "a cubic spring");
    // Where it can move nothing it changes nothing.
    let mut apart = hanging.clone();
    let mut between = apart.springs[0].clone();
    apart.particles.push(apart.particles[0].clone());
    apart.particles[2].position = [0.0, 0.0, 9.0];
    (between.ends, between.cubic) = ([0, 2], 1.0);
    apart.springs.push(between);
    assert!(
        form(&apart, 5.0).is_some(),
        "a cubic spring between fixed ends"
    );
    // The same effect in the system alone is enough.
    let mut attracted = hanging.clone();
    attracted.gravitational.push(GravitationalPair {
        ends: [0, 1],
        g: 1e-9,
    });
    assert!(find(&hanging, &ParticleSystem::new(&attracted), 5.0).is_none());
    for until in [f64::NAN, f64::INFINITY, -1.0] {
        assert!(form(&hanging, until).is_none());
    }

    // An axial damper turns with its spring, at any rest length.
    let mut axial = families::isotropic(random, 3.0, 0.1);
    axial.damping_model = DampingModel::Axial;
    assert!(form(&axial, 5.0).is_none());
    let mut line = axial.clone();
    line.solver.gravity = 0.0;
    line.particles[0].position = [0.0; 3];
    line.particles[1].position = [0.5, 0.0, 0.0];
    line.particles[1].velocity = [-4.0, 0.0, 0.0];
    assert!(form(&line, 5.0).is_some(), "but on a line it does not turn");

    // Masses damped alike by K or by M have modes, otherwise not.
    let mut network = families::network(random, 4, 0.05, 0.0);
    assert!(form(&network, 5.0).is_some());
    network.springs[1].damping *= 1.0 + 1e-9;
    assert!(form(&network, 5.0).is_none());
    let mut chain = families::chain(random, 4, 0.0);
    chain.particles[2].drag = 1e-6;
    assert!(form(&chain, 5.0).is_none());

    // Unlike masses are blown apart across their line by wind, and by unlike drag.
    let mut thrown = families::thrown(random, 1, 0.2);
    assert!(form(&thrown, 2.0).is_some());
    thrown.particles[1].drag *= 2.0;
    assert!(form(&thrown, 2.0).is_none());
    thrown = families::thrown(random, 1, 0.0);
    thrown.particles[1].mass *= 2.0;
    assert!(form(&thrown, 2.0).is_none());
}

/// One particle shot at its anchor comes 1 / w at v = 1: the form ends there, to a millionth.
#[test]
fn a_spring_reaches_its_anchor_at_v_over_w() {
    let (w, until) = (3.0, 5.0);
    let mut scene = families::hanging(&mut Random(2), w, 0.0);
    scene.solver.gravity = 0.0;
    let mut applies = |speed: f64| {
        scene.particles[1].velocity = [0.0, 0.0, speed];
        form(&scene, until).is_some()
    };
    assert!(applies(w * (1.0 - 1e-6)));
    assert!(!applies(w * (1.0 + 1e-6)));
    // Moving away first changes nothing, unless time is up before it is back.
    assert!(!applies(-w * (1.0 + 1e-6)));
    assert!(form(&scene, std::f64::consts::PI / w).is_some());
}

/// For chains shot at random the form applies just where no length comes to 0, sampled densely.
#[test]
fn chains_apply_while_no_ends_meet() {
    let mut random = Random(31);
    let (mut yes, mut no) = (0, 0);
    for case in 0..60 {
        let damping = [0.0, 0.01][case % 2];
        let mut scene = families::chain(&mut random, 2, damping);
        for i in [1, 2] {
            let speed = 25.0 * random.next();
            scene.particles[i].velocity = [speed, 2.0 * speed, 2.0 * speed];
        }
        let until = 3.0;
        let mut shortest = f64::INFINITY;
        let mut motion = exact::Motion::new(&scene);
        let flow = exact::flow(&scene, until / 600.0);
        for k in 0..=600 {
            if k > 0 {
                motion.advance(&flow);
            }
            let (x, _) = motion.states();
            for i in 0..3 {
                shortest = shortest.min(3.0 * (x[3 * i + 3] - x[3 * i]).0);
            }
        }
        // Between samples, 5 ms apart, a length may still lose l'' dt² / 8: 1e-2 at 3,000 m/s².
        if shortest.abs() > 1e-2 {
            assert_eq!(
                form(&scene, until).is_some(),
                shortest > 0.0,
                "{case}: {shortest}"
            );
            *(if shortest > 0.0 { &mut yes } else { &mut no }) += 1;
        }
    }
    assert!(yes > 10 && no > 10, "{yes} apply, {no} do not");
}
