//! From a group of particles and springs to modes, where its forces are linear all along.

use super::lengths::{Bounds, bounds};
use super::line::{Drift, Line};
use super::modes::{Link, Modes};
use super::part::{Axis, Part};
use super::problem::{Group, Problem};
use super::sideways::Sideways;
use super::vector::{dot, norm, sub};
use super::words;
use crate::scene::{DampingModel, Spring};

/// A length has to stay above this share of the scene's size.
const CLOSEST: f64 = 1e-9;

/// Rounding may push particles off their line by this share of the scene's size.
const ASIDE: f64 = 1e-9;

/// The group's motion, if it has a closed form.
pub(super) fn reduce(problem: &Problem, group: &Group) -> Option<Part> {
    if is_linear_in_space(problem, group) {
        in_space(problem, group)
    } else {
        on_line(problem, group)
    }
}

/// Whether every force is linear wherever the particles are: no spring has a rest length, and no
/// damper a direction.
fn is_linear_in_space(problem: &Problem, group: &Group) -> bool {
    let isotropic = problem.scene.damping_model == DampingModel::Isotropic;
    (isotropic || !group.is_damped()) && group.springs.iter().all(|s| !has_rest_length(s))
}

/// Whether the spring pulls towards a length other than 0.
fn has_rest_length(spring: &Spring) -> bool {
    spring.stiffness > 0.0 && spring.rest_length > 0.0
}

/// All three axes move alike and apart from each other.
fn in_space(problem: &Problem, group: &Group) -> Option<Part> {
    let modes = modes(problem, group)?;
    let axes = [0, 1, 2].map(|c| {
        let mut direction = [0.0; 3];
        direction[c] = 1.0;
        let tension = |s: &Spring| s.stiffness * between(problem, s)[c];
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
    let modes = modes(problem, group)?;
    // On which side of its first end a spring's second end lies; 0 where they coincide.
    let side = |s: &Spring| dot(between(problem, s), line.direction);
    if group
        .springs
        .iter()
        .any(|s| has_rest_length(s) && side(s) == 0.0)
    {
        return None;
    }
    let length = |s: &Spring| norm(between(problem, s));
    let tension = |s: &Spring| {
        let stretch = length(s) - s.rest_length;
        s.stiffness * stretch * sign(side(s))
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
    let bound: Vec<&Spring> = group
        .springs
        .iter()
        .copied()
        .filter(|s| has_rest_length(s))
        .collect();
    let links: Vec<_> = bound
        .iter()
        .map(|s| (signed(link(group, s), side(s)), length(s)))
        .collect();
    let closest = (CLOSEST * problem.size).max(4.0 * part.error_bar(problem.until, problem.size));
    let lengths = bounds(&part.modes, &part.axes[0], &links, problem.until, closest)?;
    if !line.off.is_none() {
        let (low, high) = across(problem, group, &bound, &lengths)?;
        let sideways = Sideways::new(line.off, part.modes.masses(), low, high);
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

/// Bounds on the stiffness across the line over the mass, by Gershgorin's rows. None where a damper
/// without a shortest length makes it unbounded.
fn across(
    problem: &Problem,
    group: &Group,
    bound: &[&Spring],
    lengths: &[Bounds],
) -> Option<(f64, f64)> {
    let (mut low, mut high) = (vec![0.0; group.free.len()], vec![0.0; group.free.len()]);
    let isotropic = problem.scene.damping_model == DampingModel::Isotropic;
    for spring in &group.springs {
        let own = bound.iter().position(|s| std::ptr::eq(*s, *spring));
        let damping = if isotropic { 0.0 } else { spring.damping };
        let (least, most) = match own.and_then(|i| lengths.get(i)) {
            Some(b) => {
                let pull = |l: f64| spring.stiffness * (1.0 - spring.rest_length / l);
                let damper = damping * b.fastest / b.shortest;
                (pull(b.shortest) - damper, pull(b.longest) + damper)
            }
            None if damping > 0.0 => return None,
            None => (spring.stiffness, spring.stiffness),
        };
        for end in spring.ends {
            if let Some(i) = group.place(end) {
                // A row's diagonal, and as much beside it where the other end moves too.
                let free = spring.ends.iter().all(|e| group.place(*e).is_some());
                let entries = if free { 2.0 } else { 1.0 };
                let mass = problem.scene.particles[end].mass;
                low[i] += entries * least.min(0.0) / mass;
                high[i] += entries * most.max(0.0) / mass;
            }
        }
    }
    let least = low.into_iter().fold(0.0, f64::min);
    Some((least, high.into_iter().fold(0.0, f64::max)))
}

fn modes(problem: &Problem, group: &Group) -> Option<Modes> {
    let of = |value: fn(&crate::scene::Particle) -> f64| {
        let particles = group.free.iter().map(|&i| &problem.scene.particles[i]);
        particles.map(value).collect::<Vec<f64>>()
    };
    let links: Vec<Link> = group.springs.iter().map(|s| link(group, s)).collect();
    Modes::new(&of(|p| p.mass), &links, &of(|p| p.drag))
}

/// The modes' start along one axis. `tension` is the force on a spring's first end there, N.
fn axis(
    problem: &Problem,
    group: &Group,
    modes: &Modes,
    direction: [f64; 3],
    tension: impl Fn(&Spring) -> f64,
) -> Axis {
    let velocity = |&i: &usize| dot(problem.velocity(i), direction);
    let velocities: Vec<f64> = group.free.iter().map(velocity).collect();
    let weight = |&i: &usize| problem.scene.particles[i].mass * dot(problem.constant(i), direction);
    let weights: Vec<f64> = group.free.iter().map(weight).collect();
    let mut pull = modes.of_forces(&weights);
    for spring in &group.springs {
        let (force, link) = (tension(spring), link(group, spring));
        for (j, pull) in pull.iter_mut().enumerate() {
            // Both ends at once: on a mode that hardly stretches the spring they cancel here.
            *pull -= force * modes.stretch(j, &link);
        }
    }
    Axis {
        direction,
        velocity: modes.of_velocities(&velocities),
        pull,
    }
}

fn link(group: &Group, spring: &Spring) -> Link {
    Link {
        ends: spring.ends.map(|end| group.place(end)),
        stiffness: spring.stiffness,
        damping: spring.damping,
    }
}

/// With its ends in the order they have along the line.
fn signed(mut link: Link, side: f64) -> Link {
    if side < 0.0 {
        link.ends.reverse();
    }
    link
}

fn sign(side: f64) -> f64 {
    if side < 0.0 { -1.0 } else { 1.0 }
}

/// From a spring's first end to its second.
fn between(problem: &Problem, spring: &Spring) -> [f64; 3] {
    let [a, b] = spring.ends;
    sub(problem.position(b), problem.position(a))
}
