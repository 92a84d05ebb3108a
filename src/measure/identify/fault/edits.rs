//! Numbers that were overwritten: what a row shows without any step that explains it.

use super::super::replay::FIT;
use super::spot::{Spot, vector};
use super::words::short;
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
    let i = spot.worst;
    let has = |of: usize, from: usize| {
        (0..3).all(|axis| {
            near(
                spot,
                Quantity::Position,
                3 * of + axis,
                spot.predicted.x[3 * from + axis],
            ) && near(
                spot,
                Quantity::Velocity,
                3 * of + axis,
                spot.predicted.v[3 * from + axis],
            )
        })
    };
    let [a, b] = spot.off[..] else { return None };
    let other = if a == i { b } else { a };
    (has(i, other) && has(other, i)).then(|| format!("particles {a} and {b} are exchanged"))
}

/// Whether the number found is this value, to rounding.
fn near(spot: &Spot, quantity: Quantity, at: usize, value: f64) -> bool {
    if quantity == Quantity::Velocity && spot.replay.rows.v.is_none() {
        return true;
    }
    let off = (spot.found(quantity, at) - value).abs();
    off <= FIT * spot.unit(quantity, at)
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
    let is_off = |quantity| (0..3).any(|axis| spot.is_off(quantity, 3 * i + axis));
    let both = is_off(Quantity::Position) && is_off(Quantity::Velocity);
    overwritten(spot, spot.quantity).filter(|_| !both)
}

/// Velocities overwritten or kicked, positions moved: what one particle shows.
pub(super) fn of_step(spot: &Spot) -> Option<String> {
    let [i] = spot.off[..] else { return None };
    let is_off = |quantity| (0..3).any(|axis| spot.is_off(quantity, 3 * i + axis));
    if !is_off(Quantity::Velocity) {
        let moved = overwritten(spot, Quantity::Position);
        let by = || {
            format!(
                "particle {i} is moved by {} m",
                vector(spot, Quantity::Position, 1.0)
            )
        };
        return Some(moved.unwrap_or_else(by));
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
    let i = spot.worst;
    let wrong: Vec<usize> = (0..3)
        .filter(|a| spot.is_off(quantity, 3 * i + a))
        .collect();
    let (predicted, row, name) = match quantity {
        Quantity::Position => (
            &spot.predicted.x,
            Some(spot.replay.rows.x(spot.at.from)),
            "position",
        ),
        Quantity::Velocity => (
            &spot.predicted.v,
            spot.replay.rows.v(spot.at.from),
            "velocity",
        ),
    };
    let start = row?;
    let all = |test: &dyn Fn(usize, f64) -> bool| {
        wrong
            .iter()
            .all(|a| test(3 * i + a, spot.found(quantity, 3 * i + a)))
    };
    let what = if all(&|_, found| found == 0.0) {
        "is set to 0"
    } else if all(&|at, found| found == start[at]) {
        "keeps its value from the row before"
    } else if all(&|at, _| near(spot, quantity, at, -predicted[at])) {
        "has the wrong sign"
    } else {
        return None;
    };
    let axes: Vec<&str> = wrong.iter().map(|&a| AXES[a]).collect();
    let axes = if axes.len() == 3 {
        String::new()
    } else {
        format!("{} component of the ", axes.join(" and "))
    };
    Some(format!("the {axes}{name} of particle {i} {what}"))
}

/// The speed is cut to the largest any row has, its direction kept.
fn capped(spot: &Spot) -> Option<String> {
    let rows = spot.replay.rows;
    let speed = |v: &[f64]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let i = 3 * spot.worst;
    let predicted = spot.predicted.v.get(i..i + 3)?;
    let cap = speed(rows.v(spot.at.to)?.get(i..i + 3)?);
    let share = cap / speed(predicted);
    let along = (0..3).all(|a| near(spot, Quantity::Velocity, i + a, share * predicted[a]));
    let directions = (0..3)
        .filter(|a| spot.is_off(Quantity::Velocity, i + a))
        .count();
    let slack = (0..3)
        .map(|a| FIT * spot.unit(Quantity::Velocity, i + a))
        .sum::<f64>();
    let highest = rows.v.as_ref()?.chunks_exact(3).all(|v| {
        let speed = speed(v);
        speed.is_nan() || speed <= cap + slack
    });
    (directions > 1 && along && highest && share < 1.0).then(|| {
        format!(
            "the speed of particle {} is capped at {} m/s",
            spot.worst,
            short(cap)
        )
    })
}
