//! Checks that involve several values of a scene, defaults that follow from other values, and the check of
//! a timestep against a duration.

use super::colliders;
use super::drive::motion;
use super::error::Refusal;
use super::expand;
use super::expect::engine;
use super::expectation::{Names, Scope};
use super::limits;
use super::model::{
    Constraints, Driven, NO_PARTICLES, Named, Particle, Scene, Spring, Stabilisation, Triangle,
    Written,
};
use super::object::{Body, called};
use super::place::Problem;
use super::read::Reading;
use super::rods;
use super::table::Value;
use super::values::Number;
use super::vectors::normalise;
use nalgebra::Vector3;
use std::fmt::Display;
use std::sync::Arc;

/// Checks that the duration holds at least one step, and no more than a run can take; both in seconds.
///
/// # Errors
/// A [`Refusal`] that says what was expected, also where a value is not finite or not positive.
pub fn check_times(timestep: f64, duration: f64) -> Result<(), Refusal> {
    for (what, seconds, limit) in [
        ("a timestep", timestep, limits::TIMESTEP),
        ("a duration", duration, limits::DURATION),
    ] {
        if !(limit.low..=limit.high).contains(&seconds) {
            let message = format!("expected {what} of positive seconds, found {seconds:?}");
            return Refusal::because(message, "");
        }
    }
    if timestep > duration {
        let message = format!("expected at most the duration ({duration:?} s), found {timestep:?}");
        let help = "the duration is 5 s unless `duration` says otherwise";
        return Refusal::because(message, help);
    }
    if duration / timestep > limits::STEPS {
        let most = limits::STEPS;
        let message = format!(
            "expected at most {most:e} steps in {duration:e} s, found {timestep:e} s a step"
        );
        return Refusal::because(message, "take larger steps or a shorter `duration`");
    }
    Ok(())
}

/// Completes the scene that was read. The first problem ends the check.
pub(super) fn scene(reading: Reading) -> Result<Scene, Problem> {
    let Reading {
        scene,
        names,
        no_id,
        named,
        problem,
    } = reading;
    if let Some(problem) = problem {
        return Err(problem);
    }
    externals(&scene, names)?;
    check_times(scene.solver.timestep, scene.duration)
        .map_err(|refusal| Problem::new("solver.timestep", refusal))?;
    if scene.objects.is_empty() {
        return expanded(scene, &named, no_id);
    }
    let written = Arc::new(Written {
        scene: scene.clone(),
        named,
    });
    let scene = expanded(scene, &written.named, no_id)?;
    Ok(Scene {
        written: Some(written),
        ..scene
    })
}

/// Expands the objects of a scene, finds the particles that are named, and checks what is there then.
pub(super) fn expanded(
    mut scene: Scene,
    named: &[Named],
    no_id: Option<(String, Number)>,
) -> Result<Scene, Problem> {
    let objects = expand::expand(&mut scene)?;
    for named in named {
        let found = scene.particle_named(&named.name);
        let id = found.map_err(|refusal| Problem::new(named.path(), refusal))?;
        (named.row.set)(&mut scene, named.at, named.component, Value::Id(id));
    }
    particles(&scene.particles)?;
    let count = scene.particles.len();
    for (at, motion) in scene.driven.iter().enumerate() {
        driven(at, motion, &scene)?;
    }
    let starts = scene.starts();
    if let Some((path, number)) = no_id {
        return Err(Problem::new(path, no_particle(number, count)));
    }
    for (at, spring) in scene.springs.iter_mut().enumerate() {
        ends(
            &spring.ends,
            &scene.bodies,
            count,
            &format_args!("springs[{at}]"),
        )?;
        if spring.rest_length.is_nan() {
            spring.rest_length = distance(&starts, spring.ends);
        }
    }
    for (at, rod) in scene.rods.iter_mut().enumerate() {
        let of = format!("rods[{at}]");
        ends(&rod.ends, &scene.bodies, count, &of)?;
        if rod.length.is_nan() {
            rod.length = distance(&starts, rod.ends);
        }
    }
    rods::check(&scene, &starts, &objects)?;
    idle(&scene)?;
    for (at, found) in scene.triangles.iter().enumerate() {
        ends(
            &found.corners,
            &scene.bodies,
            count,
            &format_args!("triangles[{at}]"),
        )?;
        triangle(at, found, &scene.bodies, &starts)?;
    }
    for (at, hinge) in scene.bending.iter().enumerate() {
        ends(
            &hinge.particles,
            &scene.bodies,
            count,
            &format_args!("bending[{at}]"),
        )?;
        links(at, hinge.particles, &scene.bodies, &starts)?;
    }
    for (at, pair) in scene.gravitational.iter().enumerate() {
        ends(
            &pair.ends,
            &scene.bodies,
            count,
            &format_args!("gravitational[{at}]"),
        )?;
        attraction(pair.ends, &scene.particles, &starts).map_err(|refusal| {
            Problem::new(format!("gravitational[{at}].particle_ids"), refusal)
        })?;
    }
    for particle in scene.particles.iter_mut().filter(|p| p.mass.is_nan()) {
        particle.mass = Particle::default().mass;
    }
    if let Some(plot) = &scene.plot {
        if plot.particle >= count {
            let refusal = no_particle(whole(plot.particle), count);
            return Err(Problem::new("plot.particle_id", refusal));
        }
        if let Some([low, high]) = plot.y_range
            && low >= high
        {
            let message = format!("expected [lower, upper], found [{low:?}, {high:?}]");
            let help = "the first number is the smaller one";
            return Problem::because("plot.y_range", message, help);
        }
    }
    if let Some(wind) = &mut scene.wind {
        normalise(&mut wind.direction, "wind.direction")?;
    }
    colliders::complete(&mut scene)?;
    colliders::check(&scene, &starts)?;
    Ok(scene)
}

/// Checks that rods and strain limits that are asked for have something to act on.
fn idle(scene: &Scene) -> Result<(), Problem> {
    if let Some(constraints) = &scene.constraints {
        if scene.rods.is_empty() {
            let message = "expected rods to keep, found none";
            let help = "`constraints` says how rods are kept: remove it, or add `rods`";
            return Problem::because("constraints", message, help);
        }
        let usual = Constraints::default().rate;
        if constraints.stabilisation != Stabilisation::Baumgarte && constraints.rate != usual {
            let message = "expected `stabilisation: baumgarte`, which alone has a rate";
            let help = "remove `rate`, or choose baumgarte";
            return Problem::because("constraints.rate", message, help);
        }
    }
    let free = |end: &usize| !scene.particles[*end].fixed;
    let limits = |spring: &Spring| spring.rest_length > 0.0 && spring.ends.iter().any(free);
    if scene.strain_limit.is_some() && !scene.springs.iter().any(limits) {
        let message = "expected a spring to limit, with a rest length and a free end, found none";
        let help = "remove `strain_limit`, or give a spring a `rest_length` above 0";
        return Problem::because("strain_limit", message, help);
    }
    Ok(())
}

/// Checks that programs have names of their own, and that every engine something is expected of exists.
fn externals(scene: &Scene, names: &Names) -> Result<(), Problem> {
    for (at, name) in scene.externals.iter().enumerate() {
        let taken = names.methods.iter().chain(&names.engines);
        let help = "choose another name";
        if taken.into_iter().any(|id| id.eq_ignore_ascii_case(name)) {
            let message = format!("an integrator or engine has the name `{name}`");
            return Problem::because(format!("externals[{at}]"), message, help);
        }
        if scene.externals[..at].contains(name) {
            let message = format!("`{name}` is listed twice");
            return Problem::because(format!("externals[{at}]"), message, "keep one of them");
        }
    }
    for expectation in &scene.expect {
        if let Scope::Engine(id) = &expectation.scope {
            engine(id, names, &scene.externals)
                .map_err(|refusal| Problem::of_key("expect", id, refusal))?;
        }
    }
    Ok(())
}

/// Checks that there is a particle, and one that can move.
fn particles(particles: &[Particle]) -> Result<(), Problem> {
    if particles.is_empty() {
        let message = "expected at least one particle, found none";
        return Problem::because("particles", message, NO_PARTICLES);
    }
    for (at, particle) in particles.iter().enumerate() {
        let velocity = particle.velocity;
        if particle.fixed && velocity != [0.0; 3] {
            let message = format!("expected no velocity on a fixed particle, found {velocity:?}");
            let help = "remove `vel`, or `fixed: true`";
            return Problem::because(format!("particles[{at}].vel"), message, help);
        }
        // A fixed particle needs a mass only if it attracts others.
        if !particle.fixed && particle.mass.is_nan() {
            let help = "a free particle needs its mass in kg";
            return Problem::because(format!("particles[{at}].mass"), "missing", help);
        }
    }
    if particles.iter().all(|p| p.fixed) {
        let message = "expected at least one free particle, found all of them fixed";
        let help = "nothing can move: remove `fixed: true` from one";
        return Problem::because("particles", message, help);
    }
    Ok(())
}

/// Checks that the ends, or corners, exist and differ.
fn ends(ends: &[usize], bodies: &[Body], count: usize, of: &impl Display) -> Result<(), Problem> {
    if let Some(index) = ends.iter().position(|&end| end >= count) {
        let refusal = no_particle(whole(ends[index]), count);
        return Err(Problem::new(format!("{of}.particle_ids[{index}]"), refusal));
    }
    let twice = |(at, end): (usize, &usize)| ends[..at].contains(end);
    if let Some((_, end)) = ends.iter().enumerate().find(|end| twice(*end)) {
        let many = if ends.len() == 2 { "two" } else { "three" };
        let end = called(bodies, *end);
        let message = format!("expected {many} different particles, found {end} twice");
        return Problem::because(format!("{of}.particle_ids"), message, "");
    }
    Ok(())
}

/// Checks that a motion is one, of a fixed particle that has no other.
fn driven(at: usize, driven: &Driven, scene: &Scene) -> Result<(), Problem> {
    let of = format!("driven[{at}]");
    let id = driven.particle;
    let because =
        |message: String, help: &str| Problem::because(format!("{of}.particle_id"), message, help);
    match scene.particles.get(id) {
        // An id that is no whole number has its own message.
        None if id == usize::MAX => return Ok(()),
        None => {
            let refusal = no_particle(whole(id), scene.particles.len());
            return Err(Problem::new(format!("{of}.particle_id"), refusal));
        }
        Some(particle) if !particle.fixed => {
            let id = called(&scene.bodies, id);
            let message = format!("expected a fixed particle, found that {id} is free");
            return because(message, "a motion decides where it is: add `fixed: true`");
        }
        Some(_) => {}
    }
    if scene.driven[..at].iter().any(|other| other.particle == id) {
        let message = format!("particle {} has two motions", called(&scene.bodies, id));
        return because(message, "keep one of them; a table can be any motion");
    }
    motion(&of, &driven.motion())
}

/// Checks that no two corners start in one place, nor all three on one line.
fn triangle(
    at: usize,
    triangle: &Triangle,
    bodies: &[Body],
    starts: &[[f64; 3]],
) -> Result<(), Problem> {
    let [a, b, c] = triangle.corners;
    for ends in [[a, b], [b, c], [a, c]] {
        if distance(starts, ends) == 0.0 {
            let [one, other] = ends.map(|id| called(bodies, id));
            let message =
                format!("expected three corners apart, found {one} and {other} in one place");
            let help = "a triangle needs an area";
            return Problem::because(format!("triangles[{at}].particle_ids"), message, help);
        }
    }
    let edges = [b, c].map(|end| Vector3::from(starts[end]) - Vector3::from(starts[a]));
    let [first, second] = edges.map(|edge| edge / edge.amax());
    // To the rounding of a product: what is exactly on a line in decimals is not in binary.
    if first.cross(&second).amax() <= 4.0 * f64::EPSILON {
        let message = "expected three corners apart, found them on one line";
        let help = "a triangle needs an area";
        return Problem::because(format!("triangles[{at}].particle_ids"), message, help);
    }
    Ok(())
}

/// Checks that both links of a hinge have a direction at the start.
fn links(
    at: usize,
    [a, b, c]: [usize; 3],
    bodies: &[Body],
    starts: &[[f64; 3]],
) -> Result<(), Problem> {
    for link in [[a, b], [b, c]] {
        if distance(starts, link) == 0.0 {
            let [one, other] = link.map(|id| called(bodies, id));
            let message =
                format!("expected neighbours apart, found {one} and {other} in one place");
            let help = "the angle at the middle particle needs two directions";
            return Problem::because(format!("bending[{at}].particle_ids"), message, help);
        }
    }
    Ok(())
}

fn no_particle(found: Number, count: usize) -> Refusal {
    let last = count.saturating_sub(1);
    let message = format!("expected a particle from 0 to {last}, found {found}");
    let help = match found {
        Number::Real(_) => "ids are whole numbers",
        Number::Whole(_) => "ids count from 0, in the order of `particles`",
    };
    Refusal::new(message, help)
}

/// The id as the number it was read from, an i64.
fn whole(id: usize) -> Number {
    Number::Whole(id as i64)
}

/// Checks that both particles state their mass and start at different places.
fn attraction(
    ends: [usize; 2],
    particles: &[Particle],
    starts: &[[f64; 3]],
) -> Result<(), Refusal> {
    if let Some(id) = ends.into_iter().find(|id| particles[*id].mass.is_nan()) {
        let message = format!("expected particles with a mass, found that {id} states none");
        return Refusal::because(message, "the attraction depends on it: add `mass`");
    }
    let apart = distance(starts, ends);
    if apart < limits::ATTRACTION_DISTANCE {
        let message =
            format!("expected two particles apart, found them {apart:?} m from each other");
        return Refusal::because(message, "the attraction is infinite at distance 0");
    }
    Ok(())
}

/// Initial distance of two particles, in metres.
fn distance(starts: &[[f64; 3]], [a, b]: [usize; 2]) -> f64 {
    let (a, b) = (starts[a], starts[b]);
    // hypot neither overflows nor loses tiny distances.
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}
