//! Fixed particles that move, and driven ones that move otherwise: no scheme does that.

use crate::measure::identify::{Fault, Quantity};
use crate::scene::{Drive, Scene};
use crate::trajectory::{Precision, Rows};

/// A fixed particle may be this many of its roundings away from where the scene has it: its own, and
/// that of the file's number for it.
const ROUNDINGS: f64 = 4.0;

/// The first row in which a fixed or driven particle is not where the scene has it; None if there is none.
pub fn moved_anchor(scene: &Scene, rows: &Rows) -> Option<Fault> {
    let drives = scene.drives();
    let fixed: Vec<(usize, Option<&Drive>)> = (0..scene.particles.len())
        .filter(|&i| scene.particles[i].fixed && 3 * i + 3 <= rows.dim)
        .map(|i| (i, drives.iter().find(|drive| drive.particle == i)))
        .collect();
    let first = |k| {
        fixed
            .iter()
            .find_map(|&(i, by)| moved(scene, rows, k, i, by))
    };
    (0..rows.len()).find_map(first)
}

fn moved(
    scene: &Scene,
    rows: &Rows,
    k: usize,
    particle: usize,
    by: Option<&Drive>,
) -> Option<Fault> {
    let t = rows.time(k);
    let expected = match by {
        Some(drive) => drive.at(t)[0],
        None => scene.particles[particle].position,
    };
    let at = &rows.x(k)[3 * particle..3 * particle + 3];
    let found = [at[0], at[1], at[2]];
    is_away(rows, k, by, found, expected).then(|| Fault {
        step: rows.steps[k].saturating_sub(1),
        t_s: rows.steps[k].saturating_sub(1) as f64 * rows.timestep,
        particle,
        quantity: Quantity::Position,
        expected,
        found: found.map(|c| Some(c).filter(|c| c.is_finite())),
        explanation: match by {
            Some(drive) => {
                let otherwise = otherwise(drive, rows, k);
                format!("particle {particle} is driven, but {otherwise}")
            }
            None => format!(
                "particle {particle} is fixed in the scene, but moves: leave fixed particles out of \
                 every update"
            ),
        },
    })
}

/// Whether a fixed or driven particle in row `k` is farther from a place than rounding explains.
fn is_away(rows: &Rows, k: usize, by: Option<&Drive>, found: [f64; 3], expected: [f64; 3]) -> bool {
    let computed = by.map_or([0.0; 3], |drive| {
        // A program in single precision computes the motion so, whatever it prints.
        let eps = match rows.precision {
            Precision::Single | Precision::SingleDecimals(_) => f64::from(f32::EPSILON),
            _ => f64::EPSILON,
        };
        drive.rounding(rows.time(k), rows.steps[k], eps)
    });
    (0..3).any(|axis| {
        let (place, x) = (&expected[axis], &found[axis]);
        let rounding = rows.precision.half_unit(*place).max(f64::MIN_POSITIVE) + computed[axis];
        // A program in single precision puts it at the nearest single, whatever it prints.
        let near = |place: f64| (x - place).abs() <= ROUNDINGS * rounding;
        !near(*place) && !near(f64::from(*place as f32))
    })
}

/// A position, m, at a time, s.
type Way<'a> = &'a dyn Fn(f64) -> [f64; 3];

/// How a driven particle moves that in row `first` is not where the scene says.
fn otherwise(drive: &Drive, rows: &Rows, first: usize) -> String {
    let h = rows.timestep;
    let [start, pos] = [drive.at(0.0)[0], drive.times(0.0).at(0.0)[0]];
    let less = |t: f64, from: [f64; 3]| {
        let position = drive.at(t)[0];
        [0, 1, 2].map(|axis| position[axis] - from[axis])
    };
    let from_pos = |t: f64| {
        let moved = less(t, start);
        [0, 1, 2].map(|axis| pos[axis] + moved[axis])
    };
    let ways: [(&str, Way); 8] = [
        (
            "stays at its `pos`: its displacement at time t is missing",
            &|_| pos,
        ),
        (
            "moves the other way: its displacement has the wrong sign",
            &|t| drive.times(-1.0).at(t)[0],
        ),
        ("moves twice as far as its motion says", &|t| {
            drive.times(2.0).at(t)[0]
        }),
        ("is one step late", &|t| drive.at(t - h)[0]),
        ("is one step ahead", &|t| drive.at(t + h)[0]),
        (
            "starts at its `pos`: it starts at `pos` plus its displacement at t = 0",
            &from_pos,
        ),
        (
            "is where its displacement alone has it: that is added to `pos`",
            &|t| less(t, pos),
        ),
        (
            "goes straight from row to row of its table, which it passes on a spline",
            &|t| drive.unbent().at(t)[0],
        ),
    ];
    let follows = |way: Way| {
        (1..rows.len()).all(|k| {
            let at = &rows.x(k)[3 * drive.particle..3 * drive.particle + 3];
            let wanted = way(rows.time(k));
            at.iter().zip(wanted).all(|(x, wanted)| {
                let size = wanted.abs().max(start[0].hypot(start[1]).hypot(start[2]));
                (x - wanted).abs() <= 1e-9 * size + rows.precision.half_unit(wanted)
            })
        })
    };
    // What the motion itself does is no other way.
    let differs = |way: Way| {
        let t = rows.time(first);
        is_away(rows, first, Some(drive), way(t), drive.at(t)[0])
    };
    let way = ways.iter().find(|(_, way)| differs(way) && follows(way));
    let says = way.map_or("is not where its motion has it", |(says, _)| says);
    format!("{says}; at n h it is at `pos` plus its displacement at that time")
}
