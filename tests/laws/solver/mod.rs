//! What the implicit methods solve: their stage equations, with dense and with sparse matrices, worked
//! out here from accelerations alone; and the Jacobians they solve them with.

mod hard;
use crate::testkit::mutants::{self, mutant};
use crate::testkit::scenes::{free, spring};
use crate::testkit::{Build, Random, built, method, own, swinging_triangle};
use springcheck::integrators::{Integrator, Settings, StepError};
use springcheck::physics::{
    ForceKinds, Jacobian, Linearization, ParticleSystem, Power, State, System,
};
use springcheck::scene::{DampingModel, Particle, Scene, Spring};

/// A strip of `rows` times two particles, crossed by springs with dampers, hung by its corners and
/// shaken: as non-linear as a cloth is.
fn strip(rows: usize) -> Scene {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    let mut random = Random(5);
    let particle = |i: usize, random: &mut Random| {
        let position = [
            0.5 * (i / 2) as f64 + 0.05 * random.next(),
            0.5 * (i % 2) as f64 + 0.05 * random.next(),
            0.05 * random.next(),
        ];
        Particle {
            velocity: [random.next(), random.next(), random.next()],
            fixed: i < 2,
            ..free(position, 1.0 + 0.5 * random.next())
        }
    };
    scene.particles = (0..2 * rows).map(|i| particle(i, &mut random)).collect();
    let spring = |ends| Spring {
        damping: 0.7,
        ..spring(ends, 200.0, 0.5)
    };
    scene.springs = (0..2 * rows - 2)
        .flat_map(|i| [Some([i, i + 2]), (i % 2 == 0).then_some([i, i + 3])])
        .flatten()
        .map(spring)
        .collect();
    scene
}

/// Dense below 60 unknowns, sparse above: 12 and 114.
fn networks() -> [Scene; 2] {
    [strip(3), strip(20)]
}

const H: f64 = 0.02;

/// |M (u - b) - γ f(t + τ, y + γ u, u)| as the step leaves it, and the size of the two parts.
fn stage(id: &str, system: &dyn System, start: &State, end: &State, h: f64) -> (f64, f64) {
    let n = system.dim();
    let acceleration = |t: f64, x: &[f64], v: &[f64]| {
        let mut a = vec![0.0; n];
        system.acceleration(t, x, v, &mut a);
        a
    };
    let combined = |a: &[f64], factor: f64, b: &[f64]| -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a + factor * b).collect()
    };
    let (gamma, u, b, y) = match id {
        "implicit_euler" => (h, end.v.clone(), start.v.clone(), start.x.clone()),
        "implicit_midpoint" => {
            let middle = combined(&start.v, 1.0, &end.v);
            let middle = middle.iter().map(|v| 0.5 * v).collect();
            (0.5 * h, middle, start.v.clone(), start.x.clone())
        }
        "trapezoidal" => {
            let a = acceleration(0.0, &start.x, &start.v);
            let b = combined(&start.v, 0.5 * h, &a);
            let y = combined(&start.x, 0.5 * h, &start.v);
            (0.5 * h, end.v.clone(), b, y)
        }
        _ => unreachable!("{id}"),
    };
    let x = combined(&y, gamma, &u);
    let a = acceleration(0.0, &x, &u);
    let (mut off, mut left, mut right) = (0.0, 0.0, 0.0);
    for (i, w) in system.inverse_mass().iter().enumerate() {
        if *w > 0.0 {
            let (inertia, impulse) = ((u[i] - b[i]) / w, gamma * a[i] / w);
            off += (inertia - impulse).powi(2);
            left += inertia * inertia;
            right += impulse * impulse;
        }
    }
    (f64::sqrt(off), f64::sqrt(left) + f64::sqrt(right))
}

/// After a step the stage equation holds, and the position has moved with the stage's velocity.
fn stage_law(id: &str, scene: &Scene, build: Build) -> Result<(), String> {
    let (system, start) = built(scene);
    let mut end = start.clone();
    build()
        .step(&system, H, &mut end)
        .map_err(|e| e.to_string())?;
    let (off, size) = stage(id, &system, &start, &end, H);
    let found = off / size;
    // What Newton's iteration promises by default; measured up to 3.8e-13.
    if found.is_nan() || found > 1e-12 {
        return Err(format!("{id}: residual {found:.1e}"));
    }
    let factors = match id {
        "implicit_euler" => [0.0, H],
        _ => [0.5 * H, 0.5 * H],
    };
    for i in 0..start.x.len() {
        let moved = factors[0] * start.v[i] + factors[1] * end.v[i];
        // Coordinates up to 10, half a last bit of which is 8.9e-16: measured 9.4e-16.
        if (end.x[i] - start.x[i] - moved).abs() > 2.5e-15 {
            return Err(format!("{id}: moved {} of {moved}", end.x[i] - start.x[i]));
        }
    }
    Ok(())
}

const SOLVED: [&str; 3] = ["implicit_euler", "implicit_midpoint", "trapezoidal"];

#[test]
fn implicit_steps_solve_their_stage_equation() {
    for scene in networks() {
        for id in SOLVED {
            stage_law(id, &scene, &own(method(id))).unwrap();
        }
    }
}

/// A step of linearly implicit Euler at the predicted positions as a dense NumPy program computes it, from the 40th
/// state of a swinging triangle with dampers along its springs.
#[test]
fn a_predicted_step_is_that_of_another_program() {
    let scene = crate::testkit::scenes::parsed(
        "solver: {type: linearized_implicit, timestep: 0.004, gravity: -9.81}\n\
         particles:\n\
         - {pos: [0, 0, 1], fixed: true}\n\
         - {pos: [0.55, 0.1, 0.3], mass: 0.35}\n\
         - {pos: [-0.45, 0, 0.2], mass: 0.25}\n\
         springs:\n\
         - {particle_ids: [0, 1], stiffness: 75.0, rest_length: 0.85, damping: 0.4}\n\
         - {particle_ids: [1, 2], stiffness: 75.0, rest_length: 0.9, damping: 0.4}\n\
         - {particle_ids: [2, 0], stiffness: 75.0, rest_length: 0.8, damping: 0.4}\n",
    );
    let before = [
        0.4846737627417811,
        0.08920795927478824,
        0.23852924716984475,
        -0.3295368438386212,
        0.0003998105948133686,
        0.2799615395647491,
        0.4809103976835656,
        0.0011177283841082982,
        -0.6666699835354291,
        -0.877706563473451,
        -0.1811870691219665,
        -0.09496397603634751,
    ];
    let after = [
        0.4867029591964858,
        0.08921516711496147,
        0.23588004818181513,
        -0.33336818143707775,
        -0.00035923660016789333,
        0.27942720880322064,
        0.5072991136761787,
        0.0018019600433071426,
        -0.6622997470074024,
        -0.9578343996141376,
        -0.18976179874531549,
        -0.13358269038212262,
    ];
    let system = ParticleSystem::new(&scene);
    let off = |id: &str| {
        let mut state = ParticleSystem::initial_state(&scene);
        state.x[3..].copy_from_slice(&before[..6]);
        state.v[3..].copy_from_slice(&before[6..]);
        let mut integrator = method(id).build(&Settings::default());
        integrator
            .step(&system, 0.004, &mut state)
            .expect("solvable");
        let found = state.x[3..].iter().chain(&state.v[3..]);
        let distances = found
            .zip(after)
            .map(|(found, wanted)| (found - wanted).abs());
        distances.fold(0.0, f64::max)
    };
    // h/m of forces of 30 N, summed from parts that are rounded a few times, 0.004/0.25 · 30 · 3 eps = 3e-16: velocities
    // near 1 round as much again. Measured 2.2e-16.
    assert!(off("linearized_implicit_predicted") < 7e-16);
    // Force and Jacobians at the start, and the iteration carried on.
    for id in ["linearized_implicit_at_start", "implicit_euler"] {
        assert!(off(id) > 1e-7, "{id}: {}", off(id));
    }
    // What a scene calls by the short name.
    assert_eq!(scene.solver.method, "linearized_implicit_predicted");
}

#[test]
fn the_stage_law_kills_mutants() {
    for scene in networks() {
        for id in SOLVED {
            let loose = || method(id).build(&Settings::stated(Some(1e-3)));
            assert!(stage_law(id, &scene, &loose).is_err(), "{id}");
            // Another method solves another equation.
            for other in SOLVED.into_iter().chain(["linearized_implicit_at_start"]) {
                let law = stage_law(id, &scene, &own(method(other)));
                assert_eq!(law.is_ok(), other == id, "{id}: {other}");
            }
            let verlet = mutant(mutants::verlet_with_explicit_damping);
            assert!(stage_law(id, &scene, &verlet).is_err(), "{id}");
        }
    }
}

/// A system that leaves its Jacobian to the default's differences, spoiled by a factor.
struct Differenced<S>(S, f64);

impl<S: System> System for Differenced<S> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let power = self.0.acceleration(t, x, v, a);
        a.iter_mut().for_each(|a| *a *= self.1);
        power
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
}

/// Both blocks between free coordinates, dense: of the position, then of the velocity.
fn blocks(system: &dyn System, state: &State) -> [Vec<f64>; 2] {
    let n = system.dim();
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &state.x, &state.v, Linearization::Exact, &mut jacobian);
    [&jacobian.position, &jacobian.velocity].map(|triplets| {
        let mut dense = vec![0.0; n * n];
        for &(row, column, value) in triplets {
            if system.inverse_mass()[row] > 0.0 && system.inverse_mass()[column] > 0.0 {
                dense[row * n + column] += value;
            }
        }
        dense
    })
}

/// The default Jacobian is the exact one, to differences with steps of 6e-6.
fn default_jacobian_law(spoiled: f64) -> Result<(), String> {
    let (system, state) = built(&strip(3));
    let exact = blocks(&system, &state);
    let found = blocks(&Differenced(system, spoiled), &state);
    // Truncation of 6e-6 squared, 4e-11 of the stiffness of 200, and rounding eps / 6e-6 = 4e-11 of the
    // forces, of order 10 and so worth more beside the damping of 0.7: measured 6.0e-11 and 4.4e-10.
    let tolerance = [2e-10, 1.3e-9];
    for ((exact, found), tolerance) in exact.iter().zip(&found).zip(tolerance) {
        let largest = exact.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
        let off = crate::testkit::distance(exact, found) / largest;
        if off.is_nan() || off > tolerance {
            return Err(format!("off by {off:.1e}"));
        }
    }
    Ok(())
}

#[test]
fn the_default_jacobian_is_the_exact_one() {
    default_jacobian_law(1.0).unwrap();
    assert!(default_jacobian_law(1.0 + 1e-8).is_err());
}

/// Steps one system, then another of as many coordinates whose matrix has other places.
fn other_pattern_law(build: Build) -> Result<(), String> {
    let scene = strip(20);
    let mut other = scene.clone();
    other.springs.remove(7);
    other.springs.remove(30);
    let mut used = build();
    let (system, mut state) = built(&scene);
    used.step(&system, H, &mut state)
        .map_err(|e| e.to_string())?;
    let (system, start) = built(&other);
    let (mut by_used, mut by_fresh) = (start.clone(), start);
    used.step(&system, H, &mut by_used)
        .map_err(|e| e.to_string())?;
    build()
        .step(&system, H, &mut by_fresh)
        .map_err(|e| e.to_string())?;
    if by_used == by_fresh {
        Ok(())
    } else {
        Err(format!(
            "off by {:e}",
            crate::testkit::distance(&by_used.x, &by_fresh.x)
        ))
    }
}

/// After its first step, takes any system for the whole strip.
struct Loyal(bool, Box<dyn Integrator>);

impl Integrator for Loyal {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        if std::mem::replace(&mut self.0, true) {
            self.1.step(&ParticleSystem::new(&strip(20)), h, state)
        } else {
            self.1.step(system, h, state)
        }
    }
}

#[test]
fn a_kept_pattern_is_dropped_with_its_system() {
    for id in SOLVED {
        other_pattern_law(&own(method(id))).unwrap_or_else(|error| panic!("{id}: {error}"));
        let loyal = || -> Box<dyn Integrator> { Box::new(Loyal(false, own(method(id))())) };
        assert!(other_pattern_law(&loyal).is_err());
    }
}
