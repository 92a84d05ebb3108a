//! Distances from a reference engine: of what has no size, and at which timestep.

use crate::testkit::scenes::parsed;
use springcheck::measure::Deviation;
use springcheck::physics::effects;
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{DampingModel, Scene};
use springcheck::verbs::Report;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

/// Explicit Euler and rapier, whose four iterations a step are four steps of symplectic Euler.
fn report(scene: &Scene, timesteps: &[f64]) -> Report {
    let mut choice = Choice::default_for(scene);
    choice
        .solvers
        .retain(|solver| solver.id == "explicit_euler" || solver.id == "rapier");
    choice.timesteps = timesteps.to_vec();
    let plan = Plan::new(scene, &choice);
    plan.execute(&Quiet).expect("nothing is saved")
}

fn deviations(report: &Report) -> Vec<(f64, Vec<&Deviation>)> {
    let ours = report.outcomes().iter().filter(|o| o.engine != "rapier");
    ours.map(|o| (o.timestep, o.deviation_m.values().collect()))
        .collect()
}

#[test]
fn a_lone_particle_is_measured_by_the_way_the_reference_goes() {
    let lone = parsed(
        "solver: {type: rk4, timestep: 0.01}\nduration: 1\n\
         particles: [{pos: [0, 0, 3], mass: 2}]\n",
    );
    let report = report(&lone, &[0.01]);
    let found = deviations(&report)[0].1[0];
    // In units of g h²: explicit Euler falls n (n - 1) / 2, rapier n (n + 1/4) / 2, so they are 5/8 n
    // apart, and 1 % of rapier's way in 100 steps, 50.125, is passed at n = 81. (Of our own way,
    // 49.5, it would be at 80.)
    assert_eq!(found.first_exceeds_s, Some(0.81));
    let unit = 9.81 * 1e-4;
    // 400 substeps of half a last bit at heights of 3 m, as a random walk: 20 * 2.2e-16 of 0.061 m,
    // 7e-14; measured 1.3e-13.
    assert!(
        (found.max / (62.5 * unit) - 1.0).abs() < 4e-13,
        "{}",
        found.max
    );
    assert_eq!(found.last, found.max);
}

#[test]
fn distances_are_taken_at_the_same_timestep_only() {
    let scene = crate::testkit::swinging_triangle(0.0, DampingModel::Axial);
    let both = report(&scene, &[0.01, 0.005]);
    let together = deviations(&both);
    assert_eq!(together.len(), 2);
    for (timestep, found) in together {
        let alone = report(&scene, &[timestep]);
        let alone = deviations(&alone);
        assert_eq!((found.len(), alone[0].1.len()), (1, 1));
        let numbers = |d: &Deviation| (d.last, d.max, d.first_exceeds_s);
        assert_eq!(numbers(found[0]), numbers(alone[0].1[0]));
    }
    // An engine with a timestep of its own is nobody's reference at another.
    let mut choice = Choice::default_for(&scene);
    choice.solvers.retain(|solver| solver.id != "rapier-forces");
    let rapier = choice.solvers.last_mut().expect("rapier");
    rapier.timestep = Some(0.005);
    let apart = Plan::new(&scene, &choice)
        .execute(&Quiet)
        .expect("no files");
    assert!(deviations(&apart).iter().all(|(_, found)| found.is_empty()));
}

/// What acts between fixed particles only is no member, and has neither energy nor loss.
#[test]
fn what_is_fixed_at_both_ends_is_no_member() {
    let mut scene = crate::testkit::swinging_triangle(0.7, DampingModel::Axial);
    scene.solver.gravity = 0.0;
    let count = |scene: &Scene, id: &str| {
        let row = effects::REGISTRY.iter().find(|row| row.id == id);
        (row.expect("a row").build)(scene).map(|effect| effect.members())
    };
    scene.particles[2].drag = 0.5;
    scene.springs[0].cubic = 8.0;
    scene.springs[1].cubic = 8.0;
    assert_eq!(
        (count(&scene, "springs"), count(&scene, "drag")),
        (Some(4), Some(1))
    );
    assert_eq!(count(&scene, "cubic_springs"), Some(2));
    // Particle 0 is fixed already; with 1 the first spring is, and its stretch counts no more.
    let energy = |scene: &Scene| {
        let start = ParticleSystem::initial_state(scene);
        ParticleSystem::new(scene).potential(0.0, &start.x)
    };
    let before = energy(&scene);
    scene.particles[0].drag = 0.5;
    scene.particles[1].fixed = true;
    assert_eq!(
        (count(&scene, "springs"), count(&scene, "drag")),
        (Some(3), Some(1))
    );
    assert_eq!(count(&scene, "cubic_springs"), Some(1));
    let stretch = (0.01_f64 + 1.0).sqrt() - 0.9;
    let gone = before - energy(&scene);
    // A difference of energies of order 1: measured 2.8e-17.
    assert!(
        (gone - 20.0 * stretch * stretch - 2.0 * stretch.powi(4)).abs() < 1e-16,
        "{gone}"
    );
    // With everything fixed nothing acts at all, however it is stretched and blown along.
    for particle in &mut scene.particles {
        particle.fixed = true;
        particle.drag = 0.5;
    }
    assert_eq!(
        (count(&scene, "springs"), count(&scene, "drag")),
        (None, None)
    );
    assert_eq!(count(&scene, "cubic_springs"), None);
    assert_eq!(energy(&scene), 0.0);
    let system = ParticleSystem::new(&scene);
    let State { x, .. } = ParticleSystem::initial_state(&scene);
    let power = system.acceleration(0.0, &x, &vec![1.0; x.len()], &mut vec![0.0; x.len()]);
    assert_eq!(power.dissipated, 0.0);
}
