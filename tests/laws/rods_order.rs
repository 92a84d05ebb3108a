//! Orders and evaluations of every method on rods are its facts, and methods that refuse rods say so by name.

use crate::testkit::scenes::parsed;
use springcheck::integrators::{Method, PerStep, Settings, fixed};
use springcheck::measure::order::{Study, Verdict};
use springcheck::physics::{Counting, ForceKinds, ParticleSystem, State, System};
use springcheck::scene::Scene;
use springcheck::solvers::{Setting, Solver, advance};
use springcheck::truth::{self, Demand, NoStore};

const STABILISATIONS: [&str; 3] = ["project", "baumgarte", "none"];
/// Seconds of every run.
const TIME: f64 = 0.5;

/// A scene, and the state at the end where another source knows it: positions and velocities of free particles.
struct Case {
    name: &'static str,
    text: &'static str,
    truth: Option<fn() -> [Vec<f64>; 2]>,
}

const CASES: [Case; 4] = [
    Case {
        name: "a free dumbbell tumbles",
        text: "solver: {type: rattle, timestep: 0.01, gravity: 0}\nparticles:\n\
               - {pos: [0, 0, 0], vel: [0.3, -1.8, -0.1], mass: 1}\n\
               - {pos: [1, 0, 0], vel: [0.3, 0.6, -0.1], mass: 2}\n\
               rods: [{particle_ids: [0, 1]}]\n",
        truth: Some(dumbbell),
    },
    Case {
        name: "a double pendulum",
        text: "solver: {type: rattle, timestep: 0.01}\nparticles:\n\
               - {pos: [0, 0, 0], fixed: true}\n\
               - {pos: [0.6, 0, -0.8], mass: 1}\n\
               - {pos: [1.4, 0.6, -0.8], vel: [0.3, -0.4, 0], mass: 0.5}\n\
               rods: [{particle_ids: [0, 1]}, {particle_ids: [1, 2]}]\n",
        truth: None,
    },
    Case {
        name: "a chain of six in air",
        text: "solver: {type: rattle, timestep: 0.01}\nparticles:\n\
               - {pos: [0, 0, 0], fixed: true}\n\
               - {pos: [0.3, 0, 0.4], mass: 1, drag: 2}\n\
               - {pos: [0.6, 0, 0], mass: 0.5, drag: 0.4}\n\
               - {pos: [0.9, 0.4, 0], mass: 1, drag: 2}\n\
               - {pos: [1.2, 0, 0], mass: 0.5, drag: 0.4}\n\
               - {pos: [1.5, 0, 0.4], mass: 1, drag: 2}\n\
               - {pos: [1.8, 0, 0], mass: 0.5, drag: 0.4}\n\
               rods: [{particle_ids: [0, 1]}, {particle_ids: [1, 2]}, {particle_ids: [2, 3]}, \
               {particle_ids: [3, 4]}, {particle_ids: [4, 5]}, {particle_ids: [5, 6]}]\n",
        truth: None,
    },
    Case {
        name: "a driven end",
        text: "solver: {type: rattle, timestep: 0.01}\nparticles:\n\
               - {pos: [0, 0, 0], fixed: true}\n\
               - {pos: [0, 0, -1], mass: 1}\n\
               - {pos: [0.6, 0, -1.8], mass: 0.5}\n\
               rods: [{particle_ids: [0, 1]}, {particle_ids: [1, 2]}]\n\
               driven: [{particle_id: 0, sine: {amplitude: [0.1, 0, 0], omega: 5, phase: 0}}]\n",
        truth: None,
    },
];

/// The centre of mass at (2/3, 0, 0) moves straight on, and the rod turns at 2.4 rad/s about z.
fn dumbbell() -> [Vec<f64>; 2] {
    let (sin, cos) = f64::sin_cos(2.4 * TIME);
    let centre = [2.0 / 3.0 + 0.3 * TIME, -0.2 * TIME, -0.1 * TIME];
    let mut at = [Vec::new(), Vec::new()];
    for arm in [-2.0 / 3.0, 1.0 / 3.0] {
        at[0].extend([centre[0] + arm * cos, centre[1] + arm * sin, centre[2]]);
        at[1].extend([0.3 - 2.4 * arm * sin, -0.2 + 2.4 * arm * cos, -0.1]);
    }
    at
}

fn scene(case: &Case, stabilisation: &str) -> Scene {
    let constraints = format!("constraints: {{stabilisation: {stabilisation}}}\n");
    parsed(&(case.text.to_owned() + &constraints))
}

/// Positions and velocities after so many steps.
fn end(method: &Method, scene: &Scene, steps: u32) -> [Vec<f64>; 2] {
    let system = ParticleSystem::new(scene);
    let mut integrator = method.build(&Settings::default());
    let State { mut t, x, v, .. } = ParticleSystem::initial_state(scene);
    let mut state = State::new(x, v);
    let h = TIME / f64::from(steps);
    for n in 1..=steps {
        state.t = t;
        t = f64::from(n) * h;
        advance(integrator.as_mut(), &system, h, t, &mut state).expect("a step");
    }
    [state.x, state.v]
}

/// Steps of the coarsest run, by order: errors of the next power of h are below 0.1 of a slope there, and those of
/// the finest run far above rounding.
fn coarsest(order: u32) -> u32 {
    [1024, 1024, 256, 96, 48][order as usize]
}

/// The slopes of errors in position and velocity over halved steps: against the truth, or against each other.
fn slopes(case: &Case, method: &Method, scene: &Scene, order: u32) -> [f64; 2] {
    let first = coarsest(order);
    let ends = [1, 2, 4].map(|part| end(method, scene, part * first));
    let truth = case.truth.map(|truth| truth());
    [0, 1].map(|of| {
        let apart = |at: usize| {
            let other = truth.as_ref().unwrap_or(&ends[at + 1]);
            let each = ends[at][of].iter().zip(&other[of]);
            each.map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
        };
        (apart(0) / apart(1)).log2()
    })
}

fn taking() -> impl Iterator<Item = &'static Method> {
    let takes = |m: &&Method| m.takes().has(ForceKinds::CONSTRAINED);
    fixed().iter().filter(takes)
}

#[test]
fn the_order_on_rods_is_the_fact() {
    let mut seen = 0;
    for stabilisation in STABILISATIONS {
        for method in taking() {
            let mut closest = [[f64::INFINITY; 2]; 2];
            for case in &CASES {
                let scene = scene(case, stabilisation);
                let system = ParticleSystem::new(&scene);
                let stated = method.order_on(&system);
                let found = slopes(case, method, &scene, stated);
                let damped = usize::from(system.kinds().depends_on_velocity());
                // Half a kick short of the impulse at the end, a velocity of SHAKE's is off by h T/2m. Among dampers
                // that half kick has the forces of rods.
                let short = method.id == "shake" && damped == 0;
                let wanted = [stated, if short { 1 } else { stated }];
                for of in 0..2 {
                    let beyond = found[of] - f64::from(wanted[of]);
                    closest[damped][of] = closest[damped][of].min(beyond);
                    let what = ["positions", "velocities"][of];
                    assert!(
                        beyond > -0.1,
                        "{}, {stabilisation}, {}: {what} of order {:.3}, {} stated",
                        method.id,
                        case.name,
                        found[of],
                        wanted[of]
                    );
                    seen += 1;
                }
            }
            // A symmetry may give a scene more; over all scenes the fact is sharp.
            for (damped, closest) in closest.iter().enumerate() {
                for beyond in closest {
                    assert!(
                        beyond.abs() < 0.1,
                        "{}, {stabilisation}, damped {damped}: {beyond:.3} beyond what is stated",
                        method.id
                    );
                }
            }
        }
    }
    assert!(seen >= 3 * 4 * 2 * 13);
}

#[test]
fn evaluations_on_rods_are_the_fact() {
    for method in taking() {
        // The fact is of scenes without dampers.
        for case in CASES.iter().filter(|case| !case.text.contains("drag")) {
            let scene = scene(case, "project");
            let system = Counting::new(ParticleSystem::new(&scene));
            let mut integrator = method.build(&Settings::default());
            let mut state = ParticleSystem::initial_state(&scene);
            let mut count = || {
                let before = system.evaluations().forces;
                let end = state.t + 0.01;
                advance(integrator.as_mut(), &system, 0.01, end, &mut state).expect("a step");
                system.evaluations().forces - before
            };
            count();
            let stated = method.under(system.kinds()).evaluations;
            let found = PerStep::Exactly(count() as u32);
            assert_eq!(found, stated, "{}, {}", method.id, case.name);
        }
    }
}

#[test]
fn refusals_name_rods_and_point_to_rattle() {
    let scene = scene(&CASES[1], "project");
    let system = ParticleSystem::new(&scene);
    let refusing: Vec<&Method> = fixed()
        .iter()
        .filter(|m| !m.takes().has(ForceKinds::CONSTRAINED))
        .collect();
    let ids: Vec<&str> = refusing.iter().map(|m| m.id).collect();
    assert_eq!(
        ids,
        [
            "boris",
            "yoshida4",
            "pefrl",
            "implicit_euler",
            "linearized_implicit_predicted",
            "linearized_implicit_at_start",
            "linearized_implicit_material",
            "implicit_midpoint",
            "trapezoidal",
            "tr_bdf2"
        ]
    );
    for method in refusing {
        let refused = system.admits(method.id, method.takes()).unwrap_err();
        let text = refused.to_string();
        assert!(text.starts_with(&format!("{}: rods", method.id)), "{text}");
        assert!(text.contains("rattle"), "{text}");
        // A run is refused before its first step, and a bare step leaves the state as it was.
        let run = Solver::method(method).start(&scene, &system, &Setting::step(0.01));
        let reason = run.err().expect("refused").reason;
        assert!(
            reason.contains("rods") && reason.contains("rattle"),
            "{reason}"
        );
        let mut state = ParticleSystem::initial_state(&scene);
        let before = state.clone();
        let mut integrator = method.build(&Settings::default());
        assert!(integrator.step(&system, 0.01, &mut state).is_err());
        assert_eq!(state.x, before.x, "{}", method.id);
        assert_eq!(state.v, before.v, "{}", method.id);
    }
}

/// Three particles fall together: beside the fall there is no motion but rounding, and none of it is a divergence.
/// x = -g n (n + 1) h²/2 under symplectic Euler, off by g t h/2: of order 1.
#[test]
fn a_body_that_only_falls_shows_the_order() {
    let particles = "solver: {type: symplectic_euler, timestep: 0.002}\nduration: 1\nparticles:\n\
                     - {pos: [0, 0, 0], mass: 1}\n- {pos: [1, 0, 0], mass: 1}\n- {pos: [0, 1, 0], mass: 1}\n";
    for bonds in [
        "rods: [{particle_ids: [0, 1]}, {particle_ids: [1, 2]}]",
        "springs: [{particle_ids: [0, 1], stiffness: 100}, {particle_ids: [1, 2], stiffness: 100}]",
    ] {
        let scene = parsed(&format!("{particles}{bonds}\n"));
        let system = ParticleSystem::new(&scene);
        let truth = truth::find(&scene, &system, Demand::Auto, 1.0, &NoStore);
        let motion = truth.motion().expect("a truth");
        let study = Study::of_scene(&scene, &system, motion, 1.0);
        let measured = study.method(crate::testkit::method("symplectic_euler"));
        assert_eq!(
            measured.observed.verdict,
            Verdict::Meets,
            "{bonds}: {measured:?}"
        );
        assert!(measured.left_out.is_empty(), "{:?}", measured.left_out);
    }
}

/// A method that takes neither rods nor quadratic drag names both, and who takes both does.
#[test]
fn a_refusal_of_rods_and_drag_names_both() {
    let scene = parsed(
        "solver: {type: rattle, timestep: 0.01}\nparticles:\n- {pos: [0, 0, 0], fixed: true}\n\
         - {pos: [1, 0, 0], mass: 1, quadratic_drag: 0.1}\nrods: [{particle_ids: [0, 1]}]\n",
    );
    let system = ParticleSystem::new(&scene);
    let admits = |id: &str| system.admits(id, crate::testkit::method(id).takes());
    let reason = admits("implicit_euler").expect_err("a refusal").reason();
    let both =
        "neither rods nor a force that is non-linear in the velocity (quadratic_drag) is taken: ";
    assert!(reason.starts_with(both), "{reason}");
    assert!(reason.contains("symplectic_euler take both"), "{reason}");
    for id in ["rk4", "dopri5", "symplectic_euler"] {
        if let Some(method) = springcheck::integrators::find(id) {
            assert_eq!(system.admits(id, method.takes()), Ok(()));
        }
    }
}
