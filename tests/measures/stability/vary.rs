//! What a map varies.

use crate::testkit::scenes::shipped;
use springcheck::scene::Scene;
use springcheck::verbs::stability::{Range, Vary};

fn circle() -> Scene {
    shipped("oscillator/circle.yml")
}

#[test]
fn every_key_sets_its_field_and_nothing_else() {
    type Get = fn(&mut Scene) -> &mut f64;
    let keys: [(&str, Get); 7] = [
        ("springs.stiffness", |s| &mut s.springs[0].stiffness),
        ("springs.damping", |s| &mut s.springs[0].damping),
        ("springs.rest_length", |s| &mut s.springs[0].rest_length),
        ("particles.mass", |s| &mut s.particles[1].mass),
        ("particles.drag", |s| &mut s.particles[1].drag),
        ("springs[0].stiffness", |s| &mut s.springs[0].stiffness),
        ("particles[1].mass", |s| &mut s.particles[1].mass),
    ];
    let scene = circle();
    for (key, get) in keys {
        let vary = Vary::parse(&format!("{key}=3..7:2"), &scene).expect(key);
        assert_eq!(vary.id(), key);
        let mut varied = vary.apply(&scene, 7.0);
        assert_eq!(*get(&mut varied), 7.0, "{key}");
        let mut original = scene.clone();
        *get(&mut varied) = *get(&mut original);
        // The anchor does not move: its mass and drag stay.
        assert_eq!(varied, scene, "{key}");
    }
}

#[test]
fn values_are_evenly_spaced_in_their_logarithm_or_else_evenly() {
    let values = |text: &str| text.parse::<Range>().expect(text).values();
    let logarithmic = values("1e2..1e8:4");
    // Ends exactly, the rest to the rounding of exp(ln): a few eps times the logarithm.
    for (value, wanted) in logarithmic.iter().zip([1e2, 1e4, 1e6, 1e8]) {
        assert!((value / wanted - 1.0).abs() < 1e-14, "{value}");
    }
    assert_eq!((logarithmic[0], logarithmic[3]), (1e2, 1e8));
    assert_eq!(values("0..2:5"), [0.0, 0.5, 1.0, 1.5, 2.0]);
    assert_eq!(values("0.1..10").len(), 24);
}

#[test]
fn what_varies_nothing_is_refused_with_what_would() {
    let scene = circle();
    for (text, says) in [
        ("springs.stifness=1..2", "did you mean `springs.stiffness`?"),
        ("mass=1..2", "known: springs.stiffness"),
        ("springs.stiffness", "KEY=A..B"),
        ("springs.stiffness=5", "A..B"),
        ("springs.stiffness=2..1", "rises"),
        ("springs.stiffness=1..1", "rises"),
        ("springs.stiffness=1..x", "`x`"),
        ("springs.stiffness=1..inf", "finite"),
        ("springs.stiffness=1..nan", "finite"),
        ("springs.stiffness=1..2:1", "2 to 200"),
        ("springs.stiffness=1..2:999", "2 to 200"),
        ("springs.stiffness=-1..2", "0e0 to 1e18"),
        ("particles.mass=0..2", "1e-40 to 1e30"),
        ("springs[1].stiffness=1..2", "has 1 of these"),
        ("springs[x].stiffness=1..2", "unknown key"),
        ("particles[0].mass=1..2", "is fixed"),
    ] {
        let error = Vary::parse(text, &scene).expect_err(text).to_string();
        assert!(error.contains(says), "{text}: {error}");
    }
    let mut tilted = scene.clone();
    tilted.solver.gravities.0.push([0.0, 1.0, -9.81]);
    let error = Vary::parse("solver.gravity=1..2", &tilted).expect_err("vectors");
    assert!(error.to_string().contains("gives vectors"), "{error}");
    let mut none = scene;
    none.springs.clear();
    let error = Vary::parse("springs.damping=1..2", &none).expect_err("no spring");
    assert!(error.to_string().contains("has none"), "{error}");
}
