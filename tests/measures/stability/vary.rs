//! What a map varies.

use crate::testkit::scenes::{parsed, shipped};
use springcheck::integrators;
use springcheck::measure::stability::{Effort, Limit, Linearised};
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::solvers;
use springcheck::verbs::session::Quiet;
use springcheck::verbs::stability::{Range, StabilityPlan, VariedKey, Vary};
use std::collections::BTreeSet;

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
        let mut varied = vary.apply(&scene, 7.0).expect(key);
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

fn objects(list: &str) -> Scene {
    parsed(&format!(
        "solver: {{type: symplectic_euler, timestep: 0.01, gravity: 0}}\nobjects:\n{list}"
    ))
}

/// N = 10 free masses of 0.1 kg between two walls.
fn rope() -> Scene {
    objects(
        "- string: {name: rope, from: [0, 0, 0], to: [1.1, 0, 0], particles: 12, particle_mass: 0.1, stiffness: 50,
    damping: 0.1, pins: [start, end]}",
    )
}

/// sin(N pi / (2 (N + 1))): over the highest of its 10 modes.
fn highest() -> f64 {
    (10.0 * std::f64::consts::PI / 22.0).sin()
}

fn at(key: &str, value: f64, scene: &Scene) -> Scene {
    let vary = Vary::parse(&format!("{key}={}..{value}:2", value / 2.0), scene).expect(key);
    assert_eq!(vary.id(), key);
    vary.apply(scene, value).expect(key)
}

/// The predicted limit of symplectic Euler, s.
fn limit(scene: &Scene) -> f64 {
    let (system, start) = (
        ParticleSystem::new(scene),
        ParticleSystem::initial_state(scene),
    );
    let about = Linearised::new(&system, &start, Effort::FULL);
    let method = integrators::find("symplectic_euler").expect("a method");
    match about.predict(method, 0.01).limit {
        Limit::At(limit) => limit,
        other => panic!("{other:?}"),
    }
}

/// The free particles' masses and drags and all springs are those of the plain key, so that limits are to the bit.
#[test]
fn names_and_an_objects_numbers_mean_its_members() {
    let scene = rope();
    for (key, plain) in [
        ("rope.stiffness", "springs.stiffness"),
        ("rope.damping", "springs.damping"),
        ("rope.particle_mass", "particles.mass"),
        ("rope.drag", "particles.drag"),
        ("rope[3].mass", "particles[3].mass"),
        ("rope[3].drag", "particles[3].drag"),
    ] {
        let [named, plain] = [key, plain].map(|key| at(key, 0.25, &scene));
        let of_free = |scene: &Scene| -> Vec<[f64; 2]> {
            let free = scene.particles.iter().filter(|p| !p.fixed);
            free.map(|p| [p.mass, p.drag]).collect()
        };
        assert_eq!(of_free(&named), of_free(&plain), "{key}");
        assert_eq!(named.springs, plain.springs, "{key}");
        assert_eq!(limit(&named), limit(&plain), "{key}");
        assert_ne!(limit(&named), limit(&scene), "{key}");
    }
}

/// Symplectic Euler takes steps up to 2/w, w = 2 sqrt(k/m) sin(N pi / (2 (N + 1))).
#[test]
fn a_strings_limit_is_its_closed_form_at_every_value() {
    let mut scene = objects(
        "- string: {name: rope, from: [0, 0, 0], to: [1.1, 0, 0], particles: 12, particle_mass: 0.1, stiffness: 50,
    pins: [start, end]}",
    );
    for stiffness in [0.5, 80.0, 1e6] {
        let found = limit(&at("rope.stiffness", stiffness, &scene));
        let wanted = 1.0 / ((stiffness / 0.1).sqrt() * highest());
        // Eigenvalues to some roundings of the largest: measured two, 4.4e-16.
        assert!(
            (found / wanted - 1.0).abs() < 6.0 * f64::EPSILON,
            "{found} {wanted}"
        );
    }
    // The other way: k = m / (h sin)², where the search ends within a millionth; measured 2.6e-7, bound
    // by the width itself.
    scene.duration = 0.1;
    let h = 0.02;
    let plan = StabilityPlan {
        scene: &scene,
        solvers: vec![solvers::find("symplectic_euler").expect("a solver").clone()],
        timestep: h,
        map: None,
        largest: Some(VariedKey::parse("rope.stiffness", &scene).expect("a key")),
        admissible: Vec::new(),
    };
    let report = plan.execute(&Quiet).expect("a report");
    let found = report
        .stability()
        .and_then(|s| s.largest.clone())
        .expect("a table");
    assert_eq!((&*found.vary, &*found.unit), ("rope.stiffness", "N/m"));
    let found = found.rows[0].value.expect("a value");
    let wanted = 0.1 / (h * highest()).powi(2);
    assert!((found / wanted - 1.0).abs() < 1e-6, "{found} {wanted}");
}

/// What docs/objects.md says each number makes.
#[test]
fn each_number_of_an_object_makes_what_its_page_says() {
    let scene = objects(
        "- hair: {from: [0, 0, 0], to: [4, 0, 0], particles: 5, mass: 2, structural: {stiffness: 9},
    bending: {stiffness: 1}, clamp: [1, 0, 0]}
- cloth: {name: sheet, origin: [0, 5, 0], plane: xy, size: [2, 2], particles: [3, 3], mass: 4,
    structural: {stiffness: 3}, shear: {stiffness: 3}, flexion: {stiffness: 3}, drag: 1}",
    );
    let hinges =
        |scene: &Scene| -> Vec<f64> { scene.bending.iter().map(|b| b.stiffness).collect() };
    // The root of a clamped hair has twice the stiffness.
    assert_eq!(
        hinges(&at("hair.bending.stiffness", 7.0, &scene)),
        [7.0, 7.0, 7.0, 14.0]
    );
    let angled = at("hair.bending.rest_angle", 0.5, &scene);
    let angles: Vec<f64> = angled.bending.iter().map(|b| b.rest_angle).collect();
    assert_eq!(angles, [0.5, 0.5, 0.5, 0.0]);
    // Springs by their lengths: 1 along threads, sqrt 2 across, 2 to the second.
    for (key, length) in [
        ("sheet.structural.stiffness", 1.0),
        ("sheet.shear.stiffness", 2.0_f64.sqrt()),
        ("sheet.flexion.stiffness", 2.0),
    ] {
        for spring in at(key, 8.0, &scene).springs {
            let wanted = match spring.stiffness {
                // The hair's.
                9.0 => continue,
                _ if (spring.rest_length - length).abs() < 1e-12 => 8.0,
                _ => 3.0,
            };
            assert_eq!(spring.stiffness, wanted, "{key}: {spring:?}");
        }
    }
    let weighed = at("sheet.mass", 6.0, &scene);
    let weight = |scene: &Scene, of: usize| -> f64 {
        let body = &scene.bodies[of];
        let count: usize = body.shape.iter().product();
        let own = &scene.particles[body.first..body.first + count];
        own.iter().map(|p| p.mass).sum()
    };
    // Masses are halves and quarters of 6/4 and 2/4: exact.
    assert_eq!([0, 1].map(|of| weight(&weighed, of)), [2.0, 6.0]);
    for spring in at("sheet.rest_ratio", 0.5, &scene).springs.iter().skip(4) {
        assert!(
            [0.5, 0.5 * 2.0_f64.sqrt(), 1.0]
                .iter()
                .any(|l| (l - spring.rest_length).abs() < 1e-12)
        );
    }
    let dragged = at("sheet.air_drag", 0.5, &scene);
    assert_eq!((scene.triangles.len(), dragged.triangles.len()), (0, 8));
    assert!(dragged.triangles.iter().all(|t| t.air_drag == 0.5));
}

#[test]
fn every_number_of_an_object_that_moves_something_is_a_key() {
    let scene = shipped("cloth/curtain.yml");
    let mut keys = BTreeSet::new();
    for number in scene.object_numbers() {
        let (_, key) = number.id.split_once('.').expect("an object and a key");
        keys.insert(key.to_owned());
        let vary = Vary::parse(&format!("{}=0.25..0.5:2", number.id), &scene);
        // Of the two masses one is given, and an object cannot have both.
        if ["mass", "particle_mass"].contains(&key) && number.given.is_none() {
            assert!(vary.is_err(), "{}", number.id);
            continue;
        }
        let varied = vary
            .expect(&number.id)
            .apply(&scene, 0.5)
            .expect(&number.id);
        assert!(
            varied != scene || number.given == Some(0.5),
            "{}",
            number.id
        );
        assert_eq!(varied.springs.len(), scene.springs.len());
    }
    for key in [
        "structural.stiffness",
        "structural.damping",
        "rest_ratio",
        "mass",
        "drag",
        "air_drag",
    ] {
        assert!(keys.contains(key), "{key} in {keys:?}");
    }
    for key in ["radius", "refine", "particles", "name", "vel"] {
        assert!(!keys.contains(key), "{key}");
    }
}

#[test]
fn what_objects_do_not_have_is_refused_with_what_they_have() {
    let scene = objects(
        "- string: {name: rope, from: [0, 0, 0], to: [1, 0, 0], particles: 5, mass: 1, stiffness: 50, refine: 4,
    pins: [start]}
- hair: {from: [0, 1, 0], to: [1, 1, 0], particles: 2, mass: 1, structural: {stiffness: 50}, bending: {stiffness: 1}}",
    );
    for (text, says) in [
        ("rop.stiffness=1..2", "did you mean `rope.stiffness`?"),
        ("rope.stifness=1..2", "did you mean `rope.stiffness`?"),
        ("rope.radius=1..2", "known of it: rope."),
        ("rope.from=1..2", "unknown key"),
        ("rope.particles=1..2", "unknown key"),
        ("rope.refine=1..2", "unknown key"),
        ("rope=1..2", "unknown key"),
        (
            "rope[3].stiffness=1..2",
            "known of it: rope[3].mass, rope[3].drag",
        ),
        ("rope[3].mas=1..2", "did you mean `rope[3].mass`?"),
        ("rope[3]=1..2", "unknown key"),
        ("rope[17].mass=1..2", "expected one of rope[0..16]"),
        ("rop[3].mass=1..2", "did you mean `rope`?"),
        ("rope[0].mass=1..2", "particle rope[0] is fixed"),
        ("rope.mass=0..1", "1e-40 to 1e30 (kg)"),
        ("rope.particle_mass=1..2", "found both"),
        // The file may have it, but not the four links that each link becomes.
        (
            "rope.stiffness=1..1e18",
            "rope.stiffness: expected at most 1e18",
        ),
        // A hair of two particles has no place for a hinge.
        ("hair.bending.stiffness=1..2", "changes nothing"),
    ] {
        let error = Vary::parse(text, &scene).expect_err(text).to_string();
        assert!(error.contains(says), "{text}: {error}");
    }
}
