//! Checks of rods: each can be held, the scene starts on all of them, and none is held by others already.

use super::error::Refusal;
use super::model::Scene;
use super::object::called;
use super::place::Problem;
use crate::gram::{DEPENDENT, Gram, NoFactor};

/// How far a start may be off a rod: of its length, and of the speed of its faster end or of a length in the duration.
pub(super) const OFF: f64 = 1e-9;

/// Checks the rods of a scene whose particles start at `starts`; lengths are filled in. `objects` are those that made
/// rods: the first rod of each, and its path.
pub(super) fn check(
    scene: &Scene,
    starts: &[[f64; 3]],
    objects: &[(usize, String)],
) -> Result<(), Problem> {
    let path = |at: usize, key: &str| match objects.iter().rfind(|(first, _)| *first <= at) {
        Some((_, object)) => format!("{object}.structural"),
        None if key.is_empty() => format!("rods[{at}]"),
        None => format!("rods[{at}].{key}"),
    };
    if scene.rods.is_empty() {
        return Ok(());
    }
    let fixed = |id: usize| scene.particles[id].fixed;
    for (at, rod) in scene.rods.iter().enumerate() {
        if rod.ends.iter().all(|end| fixed(*end)) {
            let [one, other] = rod.ends.map(|id| called(&scene.bodies, id));
            let message = format!("expected a free end, found particles {one} and {other} fixed");
            let help = "what is fixed needs no rod: remove it, or free an end";
            return Problem::because(path(at, "particle_ids"), message, help);
        }
    }
    let x: Vec<f64> = starts.iter().flatten().copied().collect();
    let ends = scene.rods.iter().map(|rod| rod.ends).collect();
    let gram = Gram::new(ends, starts.len(), |id| !fixed(id));
    let mut found = gram.room();
    gram.look(&x, &mut found);
    let mut velocities: Vec<[f64; 3]> = scene.particles.iter().map(|p| p.velocity).collect();
    let speed = |v: &[f64; 3]| v[0].hypot(v[1]).hypot(v[2]);
    let mut speeds: Vec<f64> = velocities.iter().map(speed).collect();
    for drive in scene.drives() {
        velocities[drive.particle] = drive.at(0.0)[1];
        // It may start where it turns: what is 0 there has the rounding of its fastest.
        speeds[drive.particle] = drive.speed_bound(scene.duration);
    }
    for (at, rod) in scene.rods.iter().enumerate() {
        let [one, other] = rod.ends.map(|id| called(&scene.bodies, id));
        let (length, apart) = (rod.length, found.lengths[at]);
        if apart == 0.0 {
            let message = format!(
                "expected two particles apart, found particles {one} and {other} in one place"
            );
            let help = "a rod needs a direction";
            return Problem::because(path(at, "particle_ids"), message, help);
        }
        if (apart - length).abs() > OFF * length {
            let message = format!(
                "expected the distance at the start, {apart:?} m between {one} and {other}, found {length:?}"
            );
            let help = "a rod has its length from the start on, to 1e-9 of it: leave `length` out, or move a particle";
            return Problem::because(path(at, "length"), message, help);
        }
        let [a, b] = rod.ends.map(|end| velocities[end]);
        let along: f64 = (0..3)
            .map(|axis| found.directions[at][axis] * (b[axis] - a[axis]))
            .sum();
        let [a, b] = rod.ends.map(|end| speeds[end]);
        if along.abs() > OFF * a.max(b).max(length / scene.duration) {
            let message = format!(
                "expected no velocity along the rod, found that particles {one} and {other} {} each other at {:?} m/s",
                if along > 0.0 { "leave" } else { "approach" },
                along.abs()
            );
            let help = "give its ends the same velocity along it, to 1e-9 of the faster one or of a rod's length in the duration";
            return Problem::because(path(at, "particle_ids"), message, help);
        }
    }
    independent(scene, &gram, &x).map_err(|(at, message)| {
        let help = match objects.iter().any(|(first, _)| *first <= at) {
            true => SPRINGS,
            false => REMOVE,
        };
        Problem::new(path(at, ""), Refusal::new(message, help))
    })
}

const REMOVE: &str = "the tensions of such rods are not determined: remove one of them, make one a spring, or let them sag";
const SPRINGS: &str = "the tensions of such rods are not determined: give springs, as `structural: {stiffness: 1000}`, let it \
                       sag, or take a pin away";

/// Checks that no rod is held by the others. Masses have no part in that, so every free particle counts the same.
fn independent(scene: &Scene, gram: &Gram, x: &[f64]) -> Result<(), (usize, String)> {
    let weight = |id: usize| f64::from(!scene.particles[id].fixed);
    let mut found = gram.room();
    let Err(NoFactor::Dependent(rod)) = gram.factorise(x, weight, DEPENDENT, &mut found) else {
        return Ok(());
    };
    let together = gram.dependent(x, weight);
    if let [one, other] = together[..]
        && {
            let [mut a, mut b] = [one, other].map(|rod| scene.rods[rod].ends);
            a.sort_unstable();
            b.sort_unstable();
            a == b
        }
    {
        let [a, b] = scene.rods[other].ends.map(|id| called(&scene.bodies, id));
        let message = format!("particles {a} and {b} have two rods, rods[{one}] and rods[{other}]");
        return Err((other, message));
    }
    let among = if together.len() > 1 {
        format!(": rods {} hold each other", listed(&together))
    } else {
        String::new()
    };
    let message = format!(
        "expected a distance that the other rods leave open, found one that they fix already{among}"
    );
    Err((rod, message))
}

/// `0, 1, 2`, or `0, 1, 2, ... 18` where there are many.
fn listed(rods: &[usize]) -> String {
    let words: Vec<String> = rods.iter().map(usize::to_string).collect();
    match &words[..] {
        [first, second, third, .., last] if words.len() > 6 => {
            format!("{first}, {second}, {third}, ... {last}")
        }
        _ => words.join(", "),
    }
}
