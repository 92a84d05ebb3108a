//! The admissible region of a stiff spring: the starts from which one step does not enlarge its force.
//!
//! Two free particles on a line, at rest, x1 and x2 apart by l, on a spring of rest length L. Explicit
//! Euler's first step moves nothing; after its second the particles have moved by h² f/m. Where
//! h² k (1/m1 + 1/m2) is at most 2 the force |k (l - L)| is nowhere larger than it was; beyond, it is
//! larger almost everywhere, and the region shrinks to the line l = L and to places from where the
//! ends pass through each other and happen to land well.

use crate::integrators::{self, Integrator, Settings};
use crate::physics::{ParticleSystem, State};
use crate::scene::Scene;
use crate::scene::object::called;
use crate::solvers::advance;
use crate::verbs::stability::{Admissible, AdmissiblePanel, StabilityError};
use rayon::prelude::*;

/// The method that takes the steps.
const METHOD: &str = "explicit_euler";
/// Cells along x1 and along x2. One number is even and the other odd, so no middle along x1 equals one
/// along x2: no place has l = 0, where the spring has no direction.
const GRID: [usize; 2] = [192, 193];
/// Rest lengths from the middle of the picture to either side.
const HALF_WIDTH: f64 = 3.0;
/// Rounding may add this much to a force that stays equal, relative to the spring's force at l = 0.
const ROUNDING: f64 = 1e-12;

/// One panel for each stiffness, N/m, at a timestep in seconds.
pub fn draw(
    scene: &Scene,
    timestep: f64,
    stiffnesses: &[f64],
) -> Result<Admissible, StabilityError> {
    check(scene).map_err(StabilityError::NotAdmissible)?;
    let refuse = |found: &str| StabilityError::NotAdmissible(found.to_owned());
    let ([first, second], [spring]) = (scene.particles.as_slice(), scene.springs.as_slice()) else {
        return Err(refuse("other particles"));
    };
    let method = integrators::find(METHOD).ok_or_else(|| refuse("no such method"))?;
    let rest = spring.rest_length;
    let [x1, x2] = GRID.map(|cells| axis(cells, rest));
    let panel = |&stiffness: &f64| {
        let mut scene = scene.clone();
        for spring in &mut scene.springs {
            spring.stiffness = stiffness;
        }
        let system = ParticleSystem::new(&scene);
        let settings = Settings::stated(scene.solver.tolerance);
        let line = |x2: &f64| {
            let mut integrator = method.build(&settings);
            let mut admits = |x1: &f64| {
                let admitted = admits(&system, integrator.as_mut(), timestep, [*x1, *x2], rest);
                if admitted { '1' } else { '0' }
            };
            x1.iter().map(&mut admits).collect::<String>()
        };
        let admitted: Vec<String> = x2.par_iter().map(line).collect();
        let ones = admitted.iter().flat_map(|line| line.bytes());
        let count = ones.filter(|byte| *byte == b'1').count();
        AdmissiblePanel {
            stiffness_n_m: stiffness,
            share: count as f64 / (x1.len() * x2.len()) as f64,
            admitted,
        }
    };
    let panels = stiffnesses.iter().map(panel).collect();
    Ok(Admissible {
        engine: method.id.to_owned(),
        timestep_s: timestep,
        masses_kg: [first.mass, second.mass],
        rest_length_m: rest,
        x1_m: x1,
        x2_m: x2,
        panels,
    })
}

/// Refuses a scene with anything but two free particles on one spring, and says what it has.
fn check(scene: &Scene) -> Result<(), String> {
    let (particles, springs) = (scene.particles.len(), scene.springs.len());
    if particles != 2 || springs != 1 {
        return Err(format!("particles: {particles}, springs: {springs}"));
    }
    if let Some(fixed) = scene.particles.iter().position(|p| p.fixed) {
        let fixed = called(&scene.bodies, fixed);
        return Err(format!("particle {fixed} is fixed"));
    }
    if scene.springs.iter().any(|spring| spring.rest_length == 0.0) {
        return Err("its rest length is 0".to_owned());
    }
    let system = ParticleSystem::new(scene);
    let other = system.effects().iter().find(|(row, _)| !row.elastic);
    other.map_or(Ok(()), |(row, _)| Err(format!("{} acts too", row.id)))
}

/// The middles of these cells over the width of the picture.
fn axis(cells: usize, rest: f64) -> Vec<f64> {
    let middle = |i: usize| (2.0 * (i as f64 + 0.5) / cells as f64 - 1.0) * HALF_WIDTH * rest;
    (0..cells).map(middle).collect()
}

/// Whether two steps from rest leave the spring's force no larger than it was.
fn admits(
    system: &ParticleSystem,
    integrator: &mut dyn Integrator,
    timestep: f64,
    [x1, x2]: [f64; 2],
    rest: f64,
) -> bool {
    let mut state = State::new(vec![x1, 0.0, 0.0, x2, 0.0, 0.0], vec![0.0; 6]);
    // The stiffness is on both sides and cancels.
    let strain = |state: &State| {
        let apart = |axis: usize| state.x[3 + axis] - state.x[axis];
        let length = (0..3).map(|axis| apart(axis).powi(2)).sum::<f64>().sqrt();
        (length - rest).abs()
    };
    let before = strain(&state);
    for _ in 0..2 {
        let end = state.t + timestep;
        if advance(integrator, system, timestep, end, &mut state).is_err() {
            return false;
        }
    }
    strain(&state) <= before + ROUNDING * (before + rest)
}
