//! From a group of particles and springs to modes, where its forces are linear all along.

use super::lengths::bounds;
use super::line::{Drift, Line};
use super::modes::Modes;
use super::part::{Axis, Part};
use super::problem::{Group, Link, Problem};
use super::sideways::Sideways;
use super::vector::norm;
use super::words;
use nalgebra::Vector3;

/// A length has to stay above this share of the scene's size.
const CLOSEST: f64 = 1e-9;

/// Rounding may push particles off their line by this share of the scene's size.
const ASIDE: f64 = 1e-9;

/// The group's motion, if it has a closed form.
pub(super) fn reduce(problem: &Problem, group: &Group) -> Option<Part> {
    if group.is_linear(problem.scene.damping_model) {
        in_space(problem, group)
    } else {
        on_line(problem, group)
    }
}

/// All three axes move alike and apart from each other.
fn in_space(problem: &Problem, group: &Group) -> Option<Part> {
    let modes = Modes::new(problem, group)?;
    let axes = [0, 1, 2].map(|c| {
        let direction = Vector3::ith(c, 1.0);
        let tension = |link: &Link| link.spring.stiffness * link.between[c];
        axis(problem, group, &modes, direction, tension)
    });
    let (method, reason) = words::in_space(problem, group, &modes);
    Some(Part {
        particles: group.free.clone(),
        modes,
        axes: axes.to_vec(),
        drift: Drift::default(),
        sideways: None,
        method,
        reason,
    })
}

/// One axis, along a line that may move sideways as a whole.
fn on_line(problem: &Problem, group: &Group) -> Option<Part> {
    let line = Line::of(problem, group)?;
    let modes = Modes::new(problem, group)?;
    // On which side of its first end a spring's second end lies; 0 where they coincide.
    let side = |link: &Link| link.between.dot(&line.direction);
    let bound = || group.links.iter().filter(|link| link.has_rest_length());
    if bound().any(|link| side(link) == 0.0) {
        return None;
    }
    let tension = |link: &Link| {
        let stretch = norm(link.between) - link.spring.rest_length;
        let sign = if side(link) < 0.0 { -1.0 } else { 1.0 };
        link.spring.stiffness * stretch * sign
    };
    let along = axis(problem, group, &modes, line.direction, tension);
    let mut part = Part {
        particles: group.free.clone(),
        modes,
        axes: vec![along],
        drift: line.drift,
        sideways: None,
        method: String::new(),
        reason: String::new(),
    };
    // Springs are linear only while their ends do not pass each other.
    let springs: Vec<_> = bound()
        .map(|link| {
            let [a, b] = link.ends;
            let along = if side(link) < 0.0 { [b, a] } else { [a, b] };
            (along, norm(link.between))
        })
        .collect();
    let closest = (CLOSEST * problem.size).max(4.0 * part.error_bar(problem.until, problem.size));
    let lengths = bounds(&part.modes, &part.axes[0], &springs, problem.until, closest)?;
    if !line.off.is_none() {
        let sideways = Sideways::new(problem, group, line.off, &lengths)?;
        let stays = sideways.bound(problem.until) <= ASIDE * problem.size;
        if !stays {
            return None;
        }
        part.sideways = Some(sideways);
    }
    let shortest = lengths.iter().map(|b| b.shortest).reduce(f64::min);
    (part.method, part.reason) = words::on_line(group, &part.modes, shortest);
    Some(part)
}

/// The modes' start along one axis. `tension` is the force on a spring's first end there, N.
fn axis(
    problem: &Problem,
    group: &Group,
    modes: &Modes,
    direction: Vector3<f64>,
    tension: impl Fn(&Link) -> f64,
) -> Axis {
    let velocity = |&i: &usize| problem.velocity(i).dot(&direction);
    let velocities: Vec<f64> = group.free.iter().map(velocity).collect();
    let weight = |&i: &usize| problem.scene.particles[i].mass * problem.constant(i).dot(&direction);
    let weights: Vec<f64> = group.free.iter().map(weight).collect();
    let mut pull = modes.of_forces(&weights);
    for link in &group.links {
        let force = tension(link);
        for (j, pull) in pull.iter_mut().enumerate() {
            // Both ends at once: on a mode that hardly stretches the spring they cancel here.
            *pull -= force * modes.stretch(j, link.ends);
        }
    }
    Axis {
        direction,
        velocity: modes.of_velocities(&velocities),
        pull,
    }
}
