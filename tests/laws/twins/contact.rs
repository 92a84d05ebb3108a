//! The proof of contact: passes on what is the same scene, fails on what is not.

use crate::testkit::scenes::shipped;
use springcheck::measure::twin::{prove, prove_pair};
use springcheck::measure::{Check, CheckStatus};
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::solvers::{Setting, find};
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

fn contact_proof(checks: Vec<Check>) -> Check {
    let mut own = checks
        .into_iter()
        .filter(|check| check.id == "twin-contact");
    own.next().expect("a proof of contact")
}

#[test]
fn the_proof_of_contact_decides_on_every_scene_of_contact() {
    for name in [
        "bouncing",
        "incline",
        "coulomb",
        "belt",
        "drag",
        "corner",
        "curtain",
        "off_a_ball",
    ] {
        let scene = shipped(&format!("contact/{name}.yml"));
        let proof = contact_proof(prove(&scene, scene.solver.timestep));
        // rapier has no quadratic drag.
        let right = if name == "drag" {
            CheckStatus::Skip
        } else {
            CheckStatus::Pass
        };
        assert_eq!(proof.status, right, "{name}: {}", proof.message);
    }
    assert!(
        prove(&shipped("pa1/scene01.yml"), 0.01)
            .iter()
            .all(|check| check.id != "twin-contact")
    );
}

#[test]
fn the_proof_of_contact_sees_another_obstacle() {
    let scene = shipped("contact/bouncing.yml");
    type Mutation = fn(&mut Scene);
    let mutants: [(&str, Mutation); 4] = [
        ("restitution", |s| s.colliders[0].restitution = 0.800_001),
        ("offset", |s| {
            if let Some(plane) = &mut s.colliders[0].plane {
                plane.offset = 1e-6;
            }
        }),
        ("radius", |s| s.particles[0].radius = 1e-6),
        ("none", |s| s.colliders.clear()),
    ];
    for (name, mutate) in mutants {
        let mut other = scene.clone();
        mutate(&mut other);
        let proof = contact_proof(prove_pair(&scene, &other, scene.solver.timestep));
        assert_eq!(proof.status, CheckStatus::Fail, "{name}: {proof:?}");
    }
}

/// What the row is not the law of, it refuses with its reason.
#[test]
fn the_rest_is_unsupported() {
    let row = find("rapier_contact").expect("a row");
    let why = |scene: &Scene| {
        let system = ParticleSystem::new(scene);
        let engine = row.engine(scene, &system, &Setting::step(0.01));
        engine.err().expect("unsupported").reason
    };
    let mut rough = shipped("contact/bouncing.yml");
    rough.colliders[0].static_friction = 1.0;
    assert!(why(&rough).contains("static friction"));
    assert!(why(&shipped("pa1/scene01.yml")).contains("no obstacles"));
    let mut rods = shipped("rods/unstabilised.yml");
    rods.colliders = shipped("contact/bouncing.yml").colliders;
    assert!(why(&rods).contains("rods"));
}

/// g/w² with w of 60 and 30 Hz, and µ/(1 + e); only what applies to a scene.
#[test]
fn a_report_says_where_rapiers_contact_differs() {
    let differs = |name: &str, mutate: fn(&mut Scene)| {
        let mut scene = shipped(&format!("contact/{name}.yml"));
        mutate(&mut scene);
        let solvers = [find("rk4"), find("rapier")].into_iter().flatten();
        let choice = Choice {
            solvers: solvers.collect(),
            prove: false,
            ..Choice::default_for(&scene)
        };
        let report = Plan::new(&scene, &choice)
            .execute(&Quiet)
            .expect("no files");
        let [ours, rapier] = [0, 1].map(|at| {
            let contact = report.outcomes()[at].contact.as_ref();
            contact.expect("contact").differs.clone()
        });
        assert!(ours.is_empty());
        rapier
    };
    let bouncing = differs("bouncing", |_| ());
    let [once, soft] = &bouncing[..] else {
        panic!("{bouncing:?}")
    };
    assert!(once.contains("e (1 + e)/2 V h = "), "{once}");
    assert!(
        soft.contains("60 Hz") && soft.contains(" 0.069 mm inside"),
        "{soft}"
    );
    let belt = differs("belt", |_| ());
    let [soft] = &belt[..] else {
        panic!("{belt:?}")
    };
    assert!(
        soft.contains("30 Hz") && soft.contains(" 0.276 mm inside"),
        "{soft}"
    );
    let rough = differs("bouncing", |scene| {
        scene.colliders[0].friction = 0.36;
        scene.colliders[0].static_friction = 0.36;
    });
    assert!(rough[1].contains("µ/(1 + e) = 0.2."), "{rough:?}");
}
