//! Numbers that were overwritten: what a row shows without any step that explains it.

use super::super::replay::FIT;
use super::super::words::digits;
use super::spot::{Spot, vector};
use crate::measure::identify::Quantity;

const AXES: [&str; 3] = ["x", "y", "z"];

/// A fault that no step can make: numbers that are not finite, or a fixed particle that moves.
pub(super) fn impossible(spot: &Spot) -> Option<String> {
    let i = spot.worst;
    let is_none = |quantity| (0..3).any(|a| !spot.found(quantity, 3 * i + a).is_finite());
    let recorded = spot.replay.rows.v.is_some();
    if is_none(Quantity::Position) || (recorded && is_none(Quantity::Velocity)) {
        return Some(format!("particle {i} is not finite"));
    }
    let fixed = spot.question.scene.particles.get(i)?.fixed;
    fixed.then(|| format!("particle {i} is fixed in the scene, but moves here"))
}

/// Particles exchanged or left as they were, in positions and velocities alike.
pub(super) fn of_row(spot: &Spot) -> Option<String> {
    swapped(spot).or_else(|| left_behind(spot))
}

/// Two particles have each other's numbers.
fn swapped(spot: &Spot) -> Option<String> {
    let [a, b] = spot.off[..] else { return None };
    let has = |of: usize, from: usize| {
        [Quantity::Position, Quantity::Velocity]
            .into_iter()
            .all(|quantity| {
                let there = &spot.predicted(quantity)[3 * from..3 * from + 3];
                (0..3).all(|axis| near(spot, quantity, 3 * of + axis, there[axis]))
            })
    };
    (has(a, b) && has(b, a)).then(|| format!("particles {a} and {b} are exchanged"))
}

/// Whether the number found is this value, to rounding.
fn near(spot: &Spot, quantity: Quantity, at: usize, value: f64) -> bool {
    let unknown = quantity == Quantity::Velocity && spot.replay.rows.v.is_none();
    unknown || (spot.found(quantity, at) - value).abs() <= FIT * spot.unit(quantity, at)
}

/// Every particle that is off has the numbers of the row before, to the last digit.
fn left_behind(spot: &Spot) -> Option<String> {
    let rows = spot.replay.rows;
    let stays = |i: usize| {
        let at = 3 * i..3 * i + 3;
        let v = |k| rows.v(k).map(|v| &v[at.clone()]);
        rows.x(spot.at.from)[at.clone()] == rows.x(spot.at.to)[at.clone()]
            && v(spot.at.from) == v(spot.at.to)
    };
    let all = spot.off.iter().all(|&i| stays(i));
    all.then(|| match spot.off.len() {
        1 => format!("particle {} is left as it was", spot.worst),
        n => format!("{n} particles are left as they were"),
    })
}

/// One particle's position or velocity overwritten, the other untouched.
pub(super) fn rewritten(spot: &Spot) -> Option<String> {
    let [i] = spot.off[..] else { return None };
    let both = spot.has_off(Quantity::Position, i) && spot.has_off(Quantity::Velocity, i);
    overwritten(spot, spot.quantity).filter(|_| !both)
}

/// Velocities overwritten or kicked, positions moved: what one particle shows.
pub(super) fn of_step(spot: &Spot) -> Option<String> {
    let [i] = spot.off[..] else { return None };
    if !spot.has_off(Quantity::Velocity, i) {
        let by = vector(spot, Quantity::Position, 1.0);
        let moved = || format!("particle {i} is moved by {by} m");
        return Some(overwritten(spot, Quantity::Position).unwrap_or_else(moved));
    }
    if !drifts_along(spot) {
        return None;
    }
    let kicked = || {
        let mass = spot.question.scene.particles[i].mass;
        let impulse = vector(spot, Quantity::Velocity, mass);
        format!("an impulse of {impulse} N s on particle {i}")
    };
    let overwritten = overwritten(spot, Quantity::Velocity);
    Some(overwritten.or_else(|| capped(spot)).unwrap_or_else(kicked))
}

/// Whether the position is off by no more than the change of velocity carries it: not at all, half
/// a step or a whole one.
fn drifts_along(spot: &Spot) -> bool {
    let h = spot.replay.rows.timestep;
    [0.0, 0.5, 1.0].into_iter().any(|share| {
        (0..3).all(|axis| {
            let at = 3 * spot.worst + axis;
            let carried = share * h * spot.difference(Quantity::Velocity, at);
            let left = spot.difference(Quantity::Position, at) - carried;
            let unit =
                spot.unit(Quantity::Position, at) + share * h * spot.unit(Quantity::Velocity, at);
            left.abs() <= FIT * unit
        })
    })
}

/// Components that are 0, kept, or turned round where they should not be.
fn overwritten(spot: &Spot, quantity: Quantity) -> Option<String> {
    let (i, rows, from) = (spot.worst, spot.replay.rows, spot.at.from);
    let (start, name) = match quantity {
        Quantity::Position => (rows.x(from), "position"),
        Quantity::Velocity => (rows.v(from)?, "velocity"),
    };
    let wrong = (0..3).filter(|axis| spot.is_off(quantity, 3 * i + axis));
    let wrong: Vec<usize> = wrong.collect();
    let all = |is: &dyn Fn(usize) -> bool| wrong.iter().all(|axis| is(3 * i + axis));
    let found = |at| spot.found(quantity, at);
    let what = if all(&|at| found(at) == 0.0) {
        "is set to 0"
    } else if all(&|at| found(at) == start[at]) {
        "keeps its value from the row before"
    } else if all(&|at| near(spot, quantity, at, -spot.predicted(quantity)[at])) {
        "has the wrong sign"
    } else {
        return None;
    };
    let axes: Vec<&str> = wrong.iter().map(|&axis| AXES[axis]).collect();
    let axes = match axes.len() {
        3 => String::new(),
        _ => format!("{} component of the ", axes.join(" and ")),
    };
    Some(format!("the {axes}{name} of particle {i} {what}"))
}

/// The speed is cut to the largest any row has, its direction kept.
fn capped(spot: &Spot) -> Option<String> {
    let rows = spot.replay.rows;
    let speed = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let at = 3 * spot.worst..3 * spot.worst + 3;
    let predicted = spot.predicted.v.get(at.clone())?;
    let cap = speed(rows.v(spot.at.to)?.get(at.clone())?);
    let share = cap / speed(predicted);
    let numbers = || at.clone().zip(predicted);
    let along = numbers().all(|(at, v)| near(spot, Quantity::Velocity, at, share * v));
    let off = numbers().filter(|(at, _)| spot.is_off(Quantity::Velocity, *at));
    let slack: f64 = at
        .clone()
        .map(|at| FIT * spot.unit(Quantity::Velocity, at))
        .sum();
    let highest = rows.v.as_ref()?.chunks_exact(3).all(|v| {
        let speed = speed(v);
        speed.is_nan() || speed <= cap + slack
    });
    let is = off.count() > 1 && along && highest && share < 1.0;
    let (i, cap) = (spot.worst, digits(cap, 4));
    is.then(|| format!("the speed of particle {i} is capped at {cap} m/s"))
}
