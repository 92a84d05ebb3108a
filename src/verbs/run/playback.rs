//! What the page plays: the recorded motion of every engine and the truth, at a few instants on one clock.

use super::figures::{id, stroke};
use super::plan::Plan;
use super::record::Record;
use super::text::{engine, several_timesteps};
use super::truths::Truths;
use crate::report::page::playback::{
    Bodies, Grid, Motion, Obstacle, Pairs, Playback, Radius, Shape, Shown, Springs,
};
use crate::report::svg::{TRUTH_NAME, palette, range, tamed};
use crate::report::words::short;
use crate::scene::{Collider, Scene};
use crate::solvers::Status;
use crate::trajectory::Trajectory;
use crate::verbs::run::Outcome;
use crate::verbs::{Body, Report};

/// The frames of a small scene, at most.
const FRAMES: usize = 240;
/// The frames of a large one, at least.
const FEWEST: usize = 32;
/// Coordinates of all frames and engines together that ordinary pages have at most: about a byte each.
const ORDINARY: usize = 1_200_000;
/// The same of any page.
const MOST: usize = 5_000_000;
/// A scene's extent in units, for few coordinates and for many. Springs of a hundredth of it are then coloured by strain
/// to .2 and 1.2 %.
const FINE: f64 = 65_536.0;
const COARSE: f64 = 8_192.0;

/// What a page plays of a report, each engine in its look; None where nothing was kept.
pub fn shown(report: &Report) -> Option<Playback<Shown>> {
    let fault = match &report.body {
        Body::Compare { fault, .. } => fault.as_ref().map(|fault| fault.t_s),
        _ => None,
    };
    let playback = report.run_series().playback.as_deref()?;
    Some(playback.map(|motion| {
        let motion = motion.clone();
        let outcome = motion.outcome.and_then(|at| report.outcomes().get(at));
        let Some(outcome) = outcome else {
            return Shown {
                id: TRUTH_NAME.into(),
                name: TRUTH_NAME.into(),
                colour: palette::TRUTH.colour,
                dash: palette::TRUTH.dash,
                own: false,
                truth: true,
                diverged: None,
                fault: None,
                motion,
            };
        };
        let stroke = stroke(report, outcome);
        Shown {
            id: id(report, outcome),
            name: match several_timesteps(report) {
                true => format!("{}, h = {} s", engine(outcome), short(outcome.timestep)),
                false => engine(outcome),
            },
            colour: stroke.colour,
            dash: stroke.dash,
            own: report.header.is_own(&outcome.engine),
            truth: false,
            diverged: outcome.stopped_at_s,
            fault,
            motion,
        }
    }))
}

/// What the rows about each outcome begin with in tables, and its id.
pub fn rows(report: &Report) -> Vec<(Vec<String>, String)> {
    let several = several_timesteps(report);
    let row = |outcome: &Outcome| {
        let h = several.then(|| short(outcome.timestep));
        let begin = std::iter::once(engine(outcome)).chain(h).collect();
        (begin, id(report, outcome))
    };
    report.outcomes().iter().map(row).collect()
}

/// None where nothing was recorded, or too much.
pub fn playback(plan: &Plan, records: &[Record], truths: &Truths) -> Option<Playback> {
    let scene = plan.scene;
    let recorded = records.iter().enumerate();
    let mut recorded: Vec<(usize, &Trajectory)> = recorded
        .filter_map(|(at, record)| Some((at, record.trajectory.as_ref()?)))
        .filter(|(_, run)| !run.is_empty())
        .collect();
    let end = |run: &Trajectory| run.time(run.len() - 1);
    let by_end = |a: &Trajectory, b: &Trajectory| {
        let longer = end(a).total_cmp(&end(b));
        longer.then(a.len().cmp(&b.len()))
    };
    let (_, lead) = *recorded.iter().max_by(|(_, a), (_, b)| by_end(a, b))?;
    let known = truths.at(lead.rows().timestep);
    let frame = 3 * scene.particles.len();
    let most = (MOST / (FEWEST * frame.max(1))).max(1) - usize::from(known.is_some());
    let all = recorded.len();
    recorded.truncate(most);
    let engines = recorded.len() + usize::from(known.is_some());
    if engines == 0 || frame * FEWEST > MOST {
        return None;
    }
    let room = ORDINARY / (frame * engines);
    let instants = spaced(lead.len(), room.clamp(FEWEST, FRAMES));
    let t: Vec<f64> = instants.iter().map(|k| lead.time(*k)).collect();

    let mut motions: Vec<(Option<usize>, Vec<Vec<f64>>)> = Vec::new();
    for (outcome, run) in &recorded {
        let rows: Vec<(f64, &[f64])> = (0..run.len()).map(|k| (run.time(k), run.x(k))).collect();
        motions.push((Some(*outcome), at(&rows, &t)));
    }
    if let Some(known) = known {
        let time = |step: &u64| *step as f64 * lead.rows().timestep;
        let rows = known.steps.iter().enumerate();
        let rows: Vec<(f64, &[f64])> = rows
            .map(|(k, step)| (time(step), known.states.x(k)))
            .collect();
        motions.push((None, at(&rows, &t)));
    }
    let units = match t.len() * frame * engines {
        few if few <= ORDINARY / 4 => FINE,
        _ => COARSE,
    };
    let grid = grid(scene, records, &motions, units);
    let mut playback = Playback::new(
        bodies(scene),
        Springs::new(
            scene.springs.iter().map(|spring| spring.ends),
            &scene
                .springs
                .iter()
                .map(|s| s.rest_length)
                .collect::<Vec<_>>(),
        ),
        Pairs::new(scene.rods.iter().map(|rod| rod.ends)),
        t,
    );
    playback.engines = motions
        .iter()
        .map(|(outcome, frames)| Motion::new(*outcome, frames, grid))
        .collect();
    playback.obstacles = scene
        .colliders
        .iter()
        .filter_map(|collider| obstacle(collider, &playback.t))
        .collect();
    playback.left_out = all - recorded.len();
    Some(playback)
}

/// About so many of the places up to a length, both ends included.
fn spaced(length: usize, most: usize) -> Vec<usize> {
    let stride = (length - 1).div_ceil(most.max(2) - 1).max(1);
    let mut places: Vec<usize> = (0..length).step_by(stride).collect();
    if places.last() != Some(&(length - 1)) {
        places.push(length - 1);
    }
    places
}

/// Positions at these times, as far as the rows reach: straight from one row to the next.
fn at(rows: &[(f64, &[f64])], t: &[f64]) -> Vec<Vec<f64>> {
    let Some((end, _)) = rows.last() else {
        return Vec::new();
    };
    // Times of different steps that stand for one instant differ by rounding.
    let reached = t.iter().take_while(|t| **t <= end * (1.0 + 1e-12));
    let place = |t: &f64| {
        let next = rows
            .partition_point(|(time, _)| time < t)
            .min(rows.len() - 1);
        let [(from, a), (to, b)] = [rows[next.saturating_sub(1)], rows[next]];
        let part = if to > from {
            ((t - from) / (to - from)).min(1.0)
        } else {
            1.0
        };
        a.iter().zip(b).map(|(a, b)| a + part * (b - a)).collect()
    };
    reached.map(place).collect()
}

/// The grid of all motions: it divides the extent of those that are calm.
fn grid(
    scene: &Scene,
    records: &[Record],
    motions: &[(Option<usize>, Vec<Vec<f64>>)],
    units: f64,
) -> Grid {
    let starts = scene.starts();
    let spans = [0, 1, 2].map(|axis| {
        let start = range(starts.iter().map(|start| start[axis]));
        let of = |(outcome, frames): &(Option<usize>, Vec<Vec<f64>>)| {
            let wild = outcome.is_some_and(|at| records[at].status != Status::Completed);
            let all = frames.iter().flat_map(|x| x[axis..].iter().step_by(3));
            Some((wild, range(all.copied())?))
        };
        let spans = motions.iter().filter_map(of);
        tamed(spans.chain(start.map(|span| (false, span)))).unwrap_or_default()
    });
    let extent = spans.iter().map(|[lo, hi]| hi - lo).fold(0.0, f64::max);
    Grid {
        origin: spans.map(|[lo, _]| lo),
        unit: if extent > 0.0 {
            extent / units
        } else {
            1.0 / units
        },
    }
}

fn bodies(scene: &Scene) -> Bodies {
    let particles = scene.particles.iter().enumerate();
    // Where nothing collides a radius is none.
    let radius = |p: &crate::scene::Particle| if scene.collides() { p.radius } else { 0.0 };
    let radii: Vec<f64> = scene.particles.iter().map(radius).collect();
    let same = radii.windows(2).all(|pair| pair[0] == pair[1]);
    Bodies {
        count: scene.particles.len(),
        fixed: particles
            .filter(|(_, p)| p.fixed)
            .map(|(at, _)| at)
            .collect(),
        radius: match radii.first() {
            Some(one) if same => Radius::All(*one),
            _ => Radius::Each(radii),
        },
    }
}

fn obstacle(collider: &Collider, t: &[f64]) -> Option<Obstacle> {
    let shape = if let Some(plane) = &collider.plane {
        Shape::Plane {
            normal: plane.normal,
            offset: plane.offset,
        }
    } else if let Some(ball) = &collider.ball {
        Shape::Ball {
            center: ball.center,
            radius: ball.radius,
        }
    } else if let Some(block) = &collider.block {
        Shape::Box {
            center: block.center,
            half: block.half_extents,
            axes: crate::shape::Shape::sides(block.rotation),
        }
    } else if let Some(capsule) = &collider.capsule {
        Shape::Capsule {
            ends: [capsule.a, capsule.b],
            radius: capsule.radius,
        }
    } else {
        let mesh = collider.mesh.as_ref()?;
        Shape::Mesh {
            vertices: mesh.vertices.0.clone(),
            triangles: mesh.triangles.0.clone(),
        }
    };
    let moved = |motion: crate::scene::Drive| t.iter().map(|t| motion.at(*t)[0]).collect();
    Some(Obstacle {
        shape,
        path: collider.displacement().map(moved),
    })
}
