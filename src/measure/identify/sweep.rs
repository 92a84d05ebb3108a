//! How near every candidate comes at one transition, substeps and all, without taking all steps.

use super::candidate::Candidate;
use super::replay::Replay;
use super::transition::Transition;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Substeps that are always taken; those between are cheap, or found by interpolation.
const NODES: [u32; 5] = [1, 2, 4, 8, 16];
/// Of the substeps between the nodes, this many that look nearest are taken.
const NEAREST: usize = 2;

/// Distances of the candidates `open` at a transition, in units of the data's last digits alone;
/// infinite for a candidate that cannot take it, or is not near enough to be worth its solves.
pub(super) fn distances(
    replay: &Replay,
    candidates: &[Candidate],
    open: &[usize],
    transition: &Transition,
) -> Vec<f64> {
    let (nodes, between): (Vec<usize>, Vec<usize>) = open
        .iter()
        .partition(|&&i| NODES.contains(&candidates[i].substeps));
    let mut distances = vec![f64::INFINITY; candidates.len()];
    let mut curves: BTreeMap<&str, Curve> = BTreeMap::new();
    for (i, taken) in nodes
        .iter()
        .zip(take(replay, candidates, &nodes, transition))
    {
        let Some(taken) = taken else { continue };
        distances[*i] = largest(&taken);
        if candidates[*i].solves() {
            let curve = curves.entry(&candidates[*i].id).or_default();
            curve.push(candidates[*i].substeps, taken);
        }
    }
    // A step that solves a system costs as much as hundreds that do not.
    let worth: Vec<usize> = between
        .into_iter()
        .filter(|&i| {
            let candidate = &candidates[i];
            let curve = curves.get(candidate.id.as_str());
            let near = curve.is_some_and(|curve| curve.nearest().contains(&candidate.substeps));
            near || !candidate.solves()
        })
        .collect();
    for (i, taken) in worth
        .iter()
        .zip(take(replay, candidates, &worth, transition))
    {
        distances[*i] = taken.map_or(f64::INFINITY, |taken| largest(&taken));
    }
    distances
}

/// Predicted minus recorded for each number, in last digits.
fn take(
    replay: &Replay,
    candidates: &[Candidate],
    which: &[usize],
    transition: &Transition,
) -> Vec<Option<Vec<f64>>> {
    let one = |&i: &usize| {
        let mut replayer = candidates[i].replayer(&replay.settings);
        let predicted = replay.predict(&mut replayer, transition).ok()?;
        Some(replay.last_digits_off(transition, &predicted))
    };
    which.par_iter().map(one).collect()
}

/// Differences of one method as a function of s = 1 / substeps, smooth in it.
#[derive(Default)]
struct Curve {
    nodes: Vec<(f64, Vec<f64>)>,
}

impl Curve {
    fn push(&mut self, substeps: u32, off: Vec<f64>) {
        self.nodes.push((1.0 / f64::from(substeps), off));
    }

    /// The substeps between nodes that look nearest by Lagrange's interpolation, and their
    /// neighbours.
    fn nearest(&self) -> Vec<u32> {
        let mut ranked: Vec<(f64, u32)> = (1..=16)
            .map(|n| (largest(&self.at(1.0 / f64::from(n))), n))
            .collect();
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let best = ranked.iter().take(NEAREST);
        best.flat_map(|(_, n)| n.saturating_sub(1)..=n + 1)
            .collect()
    }

    fn at(&self, s: f64) -> Vec<f64> {
        let mut sum = Vec::new();
        for (i, (at, off)) in self.nodes.iter().enumerate() {
            let others = self.nodes.iter().enumerate().filter(|(j, _)| *j != i);
            let weight: f64 = others
                .map(|(_, (other, _))| (s - other) / (at - other))
                .product();
            sum.resize(off.len(), 0.0);
            for (sum, off) in sum.iter_mut().zip(off) {
                *sum += weight * off;
            }
        }
        sum
    }
}

fn largest(values: &[f64]) -> f64 {
    let most = values.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    if values.iter().all(|c| c.is_finite()) {
        most
    } else {
        f64::INFINITY
    }
}
