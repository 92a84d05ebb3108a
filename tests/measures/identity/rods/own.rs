//! Own methods: each is named by its id at the scene's stabilisation, and by what it is at another.

use super::*;
use crate::testkit::is_its_own;
use springcheck::integrators::fixed;
use springcheck::physics::System;

/// A chain of ten rods with drag, zigzag at the start.
fn chain() -> String {
    let mut body = "solver: {type: rk4, timestep: 0.004}\nparticles:\n".to_owned();
    for k in 0..=10 {
        let (x, z) = (0.15 * f64::from(k), 0.05 * f64::from(k % 2));
        let rest = match k {
            0 => "fixed: true".to_owned(),
            _ => format!("drag: 0.05, mass: {}", 0.1 + 0.05 * f64::from(k % 3)),
        };
        body += &format!("  - {{pos: [{x:?}, 0, {z:?}], {rest}}}\n");
    }
    body += "rods:\n";
    for k in 0..10 {
        body += &format!("  - {{particle_ids: [{k}, {}]}}\n", k + 1);
    }
    body
}

/// A rod whose end is driven by a sine.
const DRIVEN: &str = "
solver: {type: rk4, timestep: 0.01}
particles:
  - {pos: [0, 0, 0], fixed: true}
  - {pos: [0.6, 0, -0.8], mass: 1.5}
rods:
  - {particle_ids: [0, 1]}
driven:
  - {particle_id: 0, sine: {amplitude: [0.08, 0.05, 0.06], omega: 4.0}}
";

/// A rod beside springs with dampers.
const BESIDE: &str = "
solver: {type: rk4, timestep: 0.005}
particles:
  - {pos: [0, 0, 0], fixed: true}
  - {pos: [1, 0, 0.25], mass: 1.0}
  - {pos: [1.5, 0.5, 0], mass: 0.5}
rods:
  - {particle_ids: [1, 2]}
springs:
  - {particle_ids: [0, 1], stiffness: 40, damping: 0.5, rest_length: 0.9}
  - {particle_ids: [0, 2], stiffness: 30, damping: 0.2, rest_length: 1.4}
";

fn bodies() -> [(&'static str, String); 6] {
    [
        ("pendulum", PENDULUM.to_owned()),
        ("double", DOUBLE.to_owned()),
        ("dumbbell", DUMBBELL.to_owned()),
        ("chain", chain()),
        ("driven", DRIVEN.to_owned()),
        ("beside", BESIDE.to_owned()),
    ]
}

/// Followed throughout under this name, alone or among equals; no mistake.
fn is_named(scene: &Scene, rows: &Rows, id: &str) -> Result<(), String> {
    let identity = name_of(scene, rows, Some(16)).ok_or("no scheme")?;
    let all = identity.followed == identity.transitions && !identity.mistake;
    if identity.is(id) && all && identity.defect <= 3.0 {
        Ok(())
    } else {
        Err(format!("{id} is taken for {identity:?}"))
    }
}

/// Whether rods do under a method, so that it matters what is done about it: a free dumbbell keeps its length under some.
fn drifts(body: &str, method: &str) -> bool {
    let scene = with(body, Stabilisation::None);
    let rows = run(&scene, method, 1, 60);
    let system = ParticleSystem::new(&scene);
    let rods = system.rods().expect("rods");
    (0..rows.len()).any(|k| {
        let off = rods.residual(rows.x(k), rows.v(k).expect("velocities"));
        off.position.max(off.velocity) > 1e-13
    })
}

#[test]
fn every_method_is_named_at_every_stabilisation() {
    for (name, body) in bodies() {
        for (own, _, prefix) in STABILISATIONS {
            let scene = with(&body, own);
            let methods = fixed().iter().filter(|method| is_its_own(&scene, method));
            for (at, method) in methods.enumerate() {
                let rows = run(&scene, method.id, 1, 60);
                is_named(&scene, &rows, method.id)
                    .unwrap_or_else(|error| panic!("{name}, {own:?}: {error}"));
                // In a scene that states another.
                let (other, ..) = STABILISATIONS[at % 3];
                let keeps = matches!(method.id, "rattle" | "shake");
                if other != own && !keeps && drifts(&body, method.id) {
                    let id = format!("{prefix}({})", method.id);
                    is_named(&with(&body, other), &rows, &id)
                        .unwrap_or_else(|error| panic!("{name}, {own:?} in {other:?}: {error}"));
                }
            }
        }
    }
}

/// A tenth of gravity more is none of them, nor is a rod a little longer.
#[test]
fn what_is_only_like_a_method_is_not_named() {
    let scene = with(DOUBLE, Stabilisation::Project);
    for id in ["symplectic_euler", "rk4", "rattle", "shake"] {
        let mut heavier = scene.clone();
        heavier.solver.gravity *= 1.1;
        let rows = run(&heavier, id, 1, 60);
        let found = found(&scene, &rows, Some(16));
        assert!(found.identity.is_none(), "{id}: {:?}", found.identity);
        let mut longer = scene.clone();
        longer.rods[1].length *= 1.0 + 1e-9;
        longer.particles[2].position[2] += 1e-9;
        let rows = run(&longer, id, 1, 60);
        assert!(is_named(&scene, &rows, id).is_err(), "{id}");
    }
}
