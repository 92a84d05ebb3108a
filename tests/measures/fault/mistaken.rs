//! Laws over the registry of mistakes, and over the methods that are none.

use super::record::{PRECISIONS, fault_of, question, rows, run, thinned};
use crate::testkit::scenes::parsed;
use crate::testkit::{distance, driven, everything, is_its_own, part, swinging_triangle};
use springcheck::integrators::{Settings, fixed};
use springcheck::measure::identify::{Candidate, MISTAKES, Wrong, first_fault, identify, mistakes};
use springcheck::physics::{ParticleSystem, State, System};
use springcheck::scene::{DampingModel, Scene, StrainLimit, Table};
use springcheck::trajectory::Precision;
use std::collections::BTreeMap;

/// A step long enough that schemes part, short enough that implicit ones solve.
fn scene(model: DampingModel) -> Scene {
    let mut scene = driven(everything(model));
    scene.solver.timestep = 0.01;
    // One spring pushes.
    scene.springs[0].rest_length *= 1.5;
    scene
}

/// Two rods of unequal masses, bent, with drag.
fn rods() -> Scene {
    parsed(
        "
solver: {type: rk4, timestep: 0.01}
duration: 1.0
particles:
  - {pos: [0, 0, 0], fixed: true}
  - {pos: [0.75, 0, -0.5], vel: [0, 0.7, 0], mass: 2.0, drag: 0.3}
  - {pos: [0.75, 0.5, 0.25], vel: [0.4, 0.7, 0], mass: 0.5, drag: 0.1}
rods:
  - {particle_ids: [0, 1]}
  - {particle_ids: [1, 2]}
",
    )
}

/// The same with a strain limit that acts at the start.
fn limited() -> Scene {
    Scene {
        strain_limit: Some(StrainLimit {
            ratio: 0.0,
            ..StrainLimit::default()
        }),
        ..scene(DampingModel::Axial)
    }
}

fn built(scene: &Scene) -> (ParticleSystem, Vec<Candidate>, Vec<Candidate>) {
    let system = ParticleSystem::new(scene);
    let methods = fixed().iter().filter(|method| is_its_own(scene, method));
    let methods = methods.map(|m| Candidate::method(&system, m, 1)).collect();
    let wrong = mistakes(scene, &system);
    (system, methods, wrong)
}

/// The first two states of an RK4 run.
fn begun(scene: &Scene) -> Vec<State> {
    let system = ParticleSystem::new(scene);
    let rk4 = Candidate::method(&system, crate::testkit::method("rk4"), 1);
    run(scene, 1, |_| &rk4, |_, _| {})
}

/// One step from the second of them, the first known.
fn second_step(scene: &Scene, candidate: &Candidate) -> State {
    let states = begun(scene);
    let mut state = states[1].clone();
    let mut replayer = candidate.replayer(&Settings::default());
    let h = scene.solver.timestep;
    replayer
        .advance(1, 1, h, Some(&states[0]), &mut state)
        .expect("a solvable step");
    state
}

/// All schemes of a scene and where they lead.
fn ends(scene: &Scene) -> Vec<(String, State)> {
    let (_, methods, wrong) = built(scene);
    let all = methods.iter().chain(&wrong);
    all.map(|c| (c.id.clone(), second_step(scene, c))).collect()
}

/// No two end within `bound` of each other.
fn all_differ(ends: &[(String, State)], bound: f64) -> Result<(), String> {
    for (k, (a, first)) in ends.iter().enumerate() {
        for (b, second) in &ends[k + 1..] {
            if [a, b].iter().all(|id| id.starts_with("springs_forgotten(")) {
                // Without springs the linearised methods are one.
                continue;
            }
            let off = distance(&first.x, &second.x).max(distance(&first.v, &second.v));
            if a == b || off < bound {
                return Err(format!("{a} and {b}: {off:e}"));
            }
        }
    }
    Ok(())
}

#[test]
fn every_mistake_is_a_map_of_its_own() {
    // The nearest are two methods of order 4 without springs, 1.2e-10 apart. Numbers of order 1 are
    // rounded in the sixteenth digit, a million times finer.
    let bound = 6e-11;
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = scene(model);
        let mut ends = ends(&scene);
        all_differ(&ends, bound).unwrap_or_else(|error| panic!("{error}"));
        // A second name for a scheme that is there already.
        let again = ends[0].1.clone();
        ends.push(("another_name".to_owned(), again));
        assert!(all_differ(&ends, bound).is_err());
    }
}

/// Every row of the registry is made in one scene or the other, and says what to change.
#[test]
fn every_mistake_can_be_made_and_speaks() {
    let ids = |model| {
        let (_, _, wrong) = built(&scene(model));
        wrong.into_iter().map(|c| c.id).collect::<Vec<_>>()
    };
    let mut table = scene(DampingModel::Axial);
    table.driven[0].sine = None;
    table.driven[0].table = Some(Table(vec![
        [0.0; 4],
        [1.0, 0.1, 0.0, 0.0],
        [2.0, 0.0, 0.0, 0.0],
    ]));
    let (_, _, tabled) = built(&table);
    let tabled = tabled.into_iter().map(|c| c.id).collect();
    let (_, _, limited) = built(&limited());
    let limited = limited.into_iter().map(|c| c.id).collect();
    let made = [
        limited,
        ids(DampingModel::Axial),
        ids(DampingModel::Isotropic),
        tabled,
        built(&rods()).2.into_iter().map(|c| c.id).collect(),
    ]
    .concat();
    for mistake in MISTAKES {
        let own = |id: &&String| id.split('(').next() == Some(mistake.id);
        let forms = made.iter().filter(own).count();
        let least = match mistake.wrong {
            Wrong::Step { meant, .. } => {
                assert!(springcheck::integrators::find(meant).is_some(), "{meant}");
                1
            }
            // Of methods that take forces at several times.
            Wrong::Applied(_) => 4,
            // Of those that take rods; the others take no other stabilisation.
            Wrong::Rods(_) => 9,
            _ if mistake.id.starts_with("rod") => 20,
            // Rows tell the stiffness.
            Wrong::SpringsForRods => 0,
            _ => fixed().len(),
        };
        assert!(forms >= least, "{}: {forms}", mistake.id);
        assert!(mistake.says.len() > 40, "{}", mistake.id);
    }
}

/// Without gravity, damping and mass there is nothing of them to get wrong.
#[test]
fn only_what_the_scene_calls_for_can_be_wrong() {
    let mut bare = swinging_triangle(0.0, DampingModel::Axial);
    bare.solver.gravity = 0.0;
    for particle in &mut bare.particles {
        particle.mass = 1.0;
    }
    let (_, _, wrong) = built(&bare);
    for candidate in &wrong {
        let id = candidate.id.as_str();
        let about = ["gravity", "damp", "mass", "acceleration"];
        assert!(!about.iter().any(|part| id.contains(part)), "{id}");
    }
    assert!(wrong.iter().any(|c| c.id == "springs_twice(rk4)"));
}

/// What replay says of a trajectory made by `made`: its id, and that the fault begins where it can
/// and gives the mistake's sentence.
fn names_itself(scene: &Scene, made: &Candidate, expected: &Candidate) -> Result<(), String> {
    let system = ParticleSystem::new(scene);
    // A program says where it has put what is driven.
    let place = |step: u64, state: &mut State| {
        let t = (step + 1) as f64 * scene.solver.timestep;
        system.place(t, &mut state.x, &mut state.v);
    };
    let states = run(scene, 12, |_| made, place);
    let rows = rows(scene, &states, Precision::Double);
    let question = question(scene, &system, &rows);
    let identity = identify(&question).identity.ok_or("nothing identified")?;
    // Without springs some methods are one.
    let same = |other: &String| other.split('(').next() == identity.method.split('(').next();
    let named = identity.method == expected.id || identity.equivalent.contains(&expected.id);
    if !named || !identity.equivalent.iter().all(same) {
        return Err(format!("{} taken for {identity:?}", expected.id));
    }
    let fault =
        first_fault(&question, &identity).ok_or_else(|| format!("{}: no fault", expected.id))?;
    // What adds up or comes late is right in the first step.
    let first = u64::from(expected.remembers());
    let says = expected.says.as_deref().ok_or("no mistake")?;
    if fault.step != first || !fault.explanation.starts_with(says) {
        return Err(format!("{}: {fault:?}", expected.id));
    }
    Ok(())
}

#[test]
fn every_mistake_is_named_and_explained() {
    // Each in every scene that it can be made in.
    let mut makes: BTreeMap<String, Vec<(Scene, Candidate)>> = BTreeMap::new();
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = scene(model);
        let (_, methods, mistaken) = built(&scene);
        for candidate in &mistaken {
            let made = makes.entry(candidate.id.clone()).or_default();
            made.push((scene.clone(), candidate.clone()));
        }
        // A method is none of its mistakes, nor one mistake another.
        assert!(names_itself(&scene, &methods[0], &mistaken[0]).is_err());
        assert!(names_itself(&scene, &mistaken[1], &mistaken[0]).is_err());
    }
    for (at, made) in makes.values().enumerate() {
        for (scene, candidate) in part(made, made.len(), at) {
            names_itself(scene, candidate, candidate).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

/// Those of rods are compared with methods that project, as the scene does.
#[test]
fn every_mistake_with_rods_is_named_and_explained() {
    let scene = rods();
    let (_, methods, mistaken) = built(&scene);
    let of_rods = |c: &&Candidate| {
        let row = MISTAKES
            .iter()
            .find(|m| Some(m.id) == c.id.split('(').next());
        // A kick at the end of a drift leaves no velocity along rods to take out.
        let last = "symplectic_euler_drift_first";
        let same = c.id == format!("velocities_projected({last})")
            || c.id.starts_with("velocities_projected_alone(")
                && [last, "explicit_euler"].contains(&c.meant);
        // A method that takes no rods is none to be held against.
        let held = is_its_own(&scene, crate::testkit::method(c.meant));
        row.is_some_and(|m| matches!(m.wrong, Wrong::Rods(_))) && held && !same
    };
    let mistaken: Vec<&Candidate> = mistaken.iter().filter(of_rods).collect();
    assert!(names_itself(&scene, &methods[0], mistaken[0]).is_err());
    for candidate in mistaken {
        names_itself(&scene, candidate, candidate).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn mistakes_of_a_strain_limit_are_named() {
    let scene = limited();
    let (_, _, mistaken) = built(&scene);
    for what in ["forgotten", "of_positions", "by_halves"] {
        for method in ["symplectic_euler", "rk4"] {
            let id = format!("strain_limit_{what}({method})");
            let made = mistaken.iter().find(|c| c.id == id).expect("a mistake");
            names_itself(&scene, made, made).unwrap_or_else(|error| panic!("{error}"));
        }
    }
}

/// A trajectory of the method itself has no fault, however it was written down.
fn is_clean(scene: &Scene, candidate: &Candidate, method: &str) -> Result<(), String> {
    let states = run(scene, 120, |_| candidate, |_, _| {});
    for precision in PRECISIONS {
        let all = rows(scene, &states, precision);
        let mut positions = all.clone();
        positions.v = None;
        let thin = [7, 60].map(|every| thinned(&all, every));
        for rows in [
            &all,
            &thin[0],
            &thin[1],
            &positions,
            &thinned(&positions, 7),
        ] {
            if let Some(fault) = fault_of(scene, rows, method) {
                return Err(format!("{method}, {precision:?}: {fault:?}"));
            }
        }
    }
    Ok(())
}

#[test]
fn what_follows_its_scheme_has_no_fault() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = scene(model);
        let (_, methods, _) = built(&scene);
        for method in &methods {
            is_clean(&scene, method, &method.id).unwrap_or_else(|error| panic!("{error}"));
        }
        // A twentieth of a percent of gravity, and it is not clean.
        let mut heavier = scene.clone();
        heavier.solver.gravity *= 1.0005;
        let heavier = methods[0].under(&ParticleSystem::new(&heavier));
        assert!(is_clean(&scene, &heavier, &methods[0].id).is_err());
    }
}
