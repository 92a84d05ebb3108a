//! The same objects with more and more links.

use super::balance;
use crate::measure::rest::farthest;
use crate::physics::ParticleSystem;
use crate::report::names::sentence;
use crate::scene::Scene;
use crate::scene::object::Scaling;
use crate::verbs::rest::{Refined, Trend};
use crate::verbs::session::{Label, TimeEstimate};
use rayon::prelude::*;
use std::time::Duration;

/// Frequencies that are followed.
const FREQUENCIES: usize = 3;
/// Frequencies as near as this are one: directions in which a scene is the same.
const SAME: f64 = 1e-6;
/// Differences below this part of the quantity tell no order.
const TOLD: f64 = 1e-9;
/// Differences that fall more slowly tell no limit.
const LEAST: f64 = 0.5;
/// Orders as near as this are one.
const STEADY: f64 = 0.25;
/// A limit below this part of the last value is 0.
const NOTHING: f64 = 0.05;

/// How long each finer scene will take, from the time of the scene itself: its particles to the power 0.95 to 1.16 on nets
/// and cloths of up to 6,500, and more where it does not come to rest.
pub fn estimates(scene: &Scene, links: &[u64], once: Duration) -> Vec<TimeEstimate> {
    let directions = scene.bodies.iter().map(|body| body.shape.len());
    let directions = directions.max().unwrap_or(0) as i32;
    let each = links.iter().map(|links| TimeEstimate {
        label: Label {
            engine: format!("{links} links, with scaling and without"),
            timestep: 0.0,
            steps: 0,
            particles: 0,
        },
        seconds: 2.0 * once.as_secs_f64() * (*links as f64).powi(directions).powf(1.2),
    });
    each.collect()
}

/// The scene with each of these many links, with and without scaling. The particle that is `watched` stays the same.
pub fn refined(scene: &Scene, links: &[u64], watched: Option<usize>) -> Vec<Refined> {
    let scalings = [(Scaling::Continuum, "continuum"), (Scaling::None, "none")];
    let cases: Vec<_> = scalings
        .into_iter()
        .flat_map(|scaling| links.iter().map(move |links| (scaling, *links)))
        .collect();
    let one = |((scaling, word), links): &((Scaling, &str), u64)| {
        one(scene, *links, *scaling, word, watched)
    };
    cases.par_iter().map(one).collect()
}

fn one(scene: &Scene, links: u64, scaling: Scaling, word: &str, watched: Option<usize>) -> Refined {
    let mut refined = Refined {
        scaling: word.to_owned(),
        links,
        particles: 0,
        moved_m: None,
        omega_rad_s: Vec::new(),
        reason: None,
    };
    let finer = match scene.refined(links, scaling) {
        Ok(finer) => finer,
        Err(refusal) => {
            refined.reason = Some(refusal.to_string());
            return refined;
        }
    };
    refined.particles = finer.particles.len();
    match balance::find(&finer) {
        // Ids are those of this finer scene: names say more.
        Err(error) => refined.reason = Some(sentence(&error.to_string(), &finer.bodies)),
        Ok((rest, balance)) => {
            let id = watched.and_then(|id| scene.refined_id(&finer, id, links));
            let start = ParticleSystem::initial_state(&finer);
            refined.moved_m = id.map(|id| {
                let at = 3 * id..3 * id + 3;
                farthest(&start.x[at.clone()], &rest.x[at]).1
            });
            let omegas = balance.oscillations.iter().filter_map(|o| o.omega_rad_s);
            for omega in omegas.filter(|omega| *omega > 0.0) {
                let last = refined.omega_rad_s.last();
                if last.is_none_or(|last| omega > last * (1.0 + SAME)) {
                    refined.omega_rad_s.push(omega);
                }
            }
            refined.omega_rad_s.truncate(FREQUENCIES);
        }
    }
    refined
}

/// The trend of each quantity over rows of one scaling.
pub fn trends(refined: &[Refined]) -> Vec<Trend> {
    let groups = refined.chunk_by(|a, b| a.scaling == b.scaling);
    groups.flat_map(of_one_scaling).collect()
}

fn of_one_scaling(rows: &[Refined]) -> Vec<Trend> {
    let moved = (
        "moved_m".to_owned(),
        rows.iter().map(|row| row.moved_m).collect::<Vec<_>>(),
    );
    let most = rows
        .iter()
        .map(|row| row.omega_rad_s.len())
        .min()
        .unwrap_or(0);
    let omegas = (0..most).map(|at| {
        let values = rows.iter().map(|row| row.omega_rad_s.get(at).copied());
        (format!("omega_rad_s[{at}]"), values.collect())
    });
    let all = std::iter::once(moved).chain(omegas);
    let trend = |(quantity, values): (String, Vec<Option<f64>>)| {
        let (order, limit) = told(rows, &values).unzip();
        Trend {
            scaling: rows[0].scaling.clone(),
            quantity,
            order,
            limit: limit.flatten(),
        }
    };
    all.filter(|(_, values)| values.iter().any(Option::is_some))
        .map(trend)
        .collect()
}

/// The order of the three finest, and what they tend to (Richardson 1911), where the three before tell the same order:
/// quantities that change places give any order once.
fn told(rows: &[Refined], values: &[Option<f64>]) -> Option<(f64, Option<f64>)> {
    let order = order(rows, values)?;
    let [.., y, z] = values else { return None };
    let [.., b, c] = rows else { return None };
    let (z, second) = ((*z)?, (*z)? - (*y)?);
    let ratio = c.links as f64 / b.links as f64;
    let limit = z + second / (ratio.powf(order) - 1.0);
    // What falls by the same ratio for ever tends to 0.
    let limit = if limit.abs() < NOTHING * z.abs() {
        0.0
    } else {
        limit
    };
    let fewer = rows.len() - 1;
    let before = self::order(&rows[..fewer], &values[..fewer]);
    let steady = before.is_some_and(|before| (before - order).abs() < STEADY);
    let tends = steady && order > LEAST && limit.is_finite() && limit * z >= 0.0;
    Some((order, tends.then_some(limit)))
}

/// The order of the three last, which have to be apart by one ratio and go one way.
fn order(rows: &[Refined], values: &[Option<f64>]) -> Option<f64> {
    let [.., a, b, c] = rows else { return None };
    let [.., x, y, z] = values else { return None };
    let (x, y, z) = ((*x)?, (*y)?, (*z)?);
    let ratio = b.links as f64 / a.links as f64;
    let (first, second) = (y - x, z - y);
    let tells = ratio > 1.0
        && c.links as f64 / b.links as f64 == ratio
        && first.abs().min(second.abs()) > TOLD * z.abs()
        && first * second > 0.0;
    tells.then(|| (first / second).ln() / ratio.ln())
}
