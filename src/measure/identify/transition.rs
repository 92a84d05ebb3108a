//! The pairs of rows that are replayed.

use crate::physics::constraints::contact::{Against, Obstacles};
use crate::physics::{ParticleSystem, System};
use crate::space::{minus, norm, three};
use crate::trajectory::Rows;

/// A replay from one row to a later one.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Transition {
    /// The row before `from`: without velocities the two of them tell it; with velocities it helps
    /// schemes that look back, where it lies exactly one step before.
    pub before: Option<usize>,
    pub from: usize,
    pub to: usize,
}

impl Transition {
    /// Steps from `from` to `to`.
    pub fn span(&self, rows: &Rows) -> u64 {
        rows.steps[self.to].saturating_sub(rows.steps[self.from])
    }

    /// The longest stretch a replay has to cover, steps.
    pub(super) fn reach(&self, rows: &Rows) -> u64 {
        let back = match (&rows.v, self.before) {
            (None, Some(before)) => rows.steps[self.from].saturating_sub(rows.steps[before]),
            _ => 0,
        };
        self.span(rows).max(back)
    }
}

/// Longer replays take too long, for several hundred candidates.
const LONGEST: u64 = 20_000;
/// Where data moves less than this many of its roundings, nothing can be told.
const STILL: f64 = 16.0;

/// A transition and how far it moves, in roundings of the data.
#[derive(Debug, Clone, Copy)]
pub(super) struct Weighed {
    pub(super) transition: Transition,
    pub(super) motion: f64,
}

/// The transitions to use, in order: between neighbouring rows, the shortest there are, without
/// those that are not finite and, if any move, those where nothing does. At most `limit` of them,
/// evenly spread.
pub(super) fn choose(rows: &Rows, system: &ParticleSystem, limit: Option<usize>) -> Vec<Weighed> {
    let all: Vec<Transition> = neighbours(rows).filter(|t| is_finite(rows, t.to)).collect();
    // Beside the short ones of a thinned record its long ones are no use; where all are about
    // alike, all are. A lone short one at the end of a file is no measure: hence the quartile.
    let mut spans: Vec<u64> = all.iter().map(|t| t.reach(rows)).collect();
    spans.sort_unstable();
    let Some(&short) = spans.get(spans.len() / 4) else {
        return Vec::new();
    };
    let short = all
        .into_iter()
        .filter(|t| t.reach(rows) <= LONGEST && 2 * t.reach(rows) <= short.saturating_mul(3))
        .map(|transition| Weighed {
            transition,
            motion: motion(rows, system, &transition),
        });
    let short: Vec<Weighed> = short.collect();
    let moving: Vec<Weighed> = short.iter().copied().filter(|w| w.motion > STILL).collect();
    let used = if moving.is_empty() { short } else { moving };
    spread(&used, limit.unwrap_or(usize::MAX))
}

/// Between neighbouring rows, wherever a replay can start.
pub(super) fn neighbours(rows: &Rows) -> impl Iterator<Item = Transition> {
    from_each(rows, 0..rows.len(), 1, 1)
}

/// From these rows to those `ahead`, with the rows `back`, wherever a replay can start.
fn from_each(
    rows: &Rows,
    starts: impl Iterator<Item = usize>,
    back: usize,
    ahead: usize,
) -> impl Iterator<Item = Transition> {
    let all = starts.map(move |from| Transition {
        before: from.checked_sub(back).filter(|&k| is_finite(rows, k)),
        from,
        to: from + ahead,
    });
    all.filter(move |t| t.to < rows.len() && is_finite(rows, t.from))
        .filter(move |t| rows.v.is_some() || t.before.is_some())
}

pub(super) fn is_finite(rows: &Rows, k: usize) -> bool {
    let v = rows.v(k).unwrap_or(&[]);
    rows.x(k).iter().chain(v).all(|c| c.is_finite())
}

/// Stretches of `apart` rows, one after the other, at most `limit` of them.
pub(super) fn stretches(rows: &Rows, apart: usize, limit: usize) -> Vec<Transition> {
    let back = if rows.v.is_some() { 0 } else { apart };
    let starts = (back..rows.len()).step_by((apart + back).max(1));
    let stretches: Vec<Transition> = from_each(rows, starts, back.max(1), apart)
        .filter(|t| t.reach(rows) <= LONGEST && is_finite(rows, t.to))
        .collect();
    spread(&stretches, limit)
}

/// How far the data moves here, or by its velocities and forces should, in roundings.
fn motion(rows: &Rows, system: &ParticleSystem, t: &Transition) -> f64 {
    let seconds = t.span(rows) as f64 * rows.timestep;
    let (x0, x1) = (rows.x(t.from), rows.x(t.to));
    let (v0, v1) = (rows.v(t.from), rows.v(t.to));
    let rest = vec![0.0; x0.len()];
    let mut a = vec![0.0; x0.len()];
    system.acceleration(0.0, x0, v0.unwrap_or(&rest), &mut a);
    let round = |value: f64| rows.precision.half_unit(value).max(f64::MIN_POSITIVE);
    let round_v = |value: f64| rows.precision_v.half_unit(value).max(f64::MIN_POSITIVE);
    let mut most = 0.0_f64;
    for i in 0..x0.len() {
        let unit = round(x0[i]) + round(x1[i]);
        let mut way = (x1[i] - x0[i]).abs().max((seconds * seconds * a[i]).abs());
        if let (Some(v0), Some(v1)) = (v0, v1) {
            way = way.max((seconds * v0[i]).abs());
            let gain = (v1[i] - v0[i]).abs().max((seconds * a[i]).abs());
            most = most.max(gain / (round_v(v0[i]) + round_v(v1[i])));
        }
        most = most.max(way / unit);
    }
    // A force that is not finite here is for the replay to find.
    if most.is_finite() { most } else { f64::MAX }
}

/// The depth of the deepest particle, m, where one is so near an obstacle, or another particle, that it may meet it within
/// these rows. Without velocities the rows before them count, too.
pub(super) fn beside(obstacles: &Obstacles, rows: &Rows, t: &Transition) -> Option<f64> {
    let before = t.before.filter(|_| rows.v.is_none());
    let earlier = before.and_then(|before| beside_two(obstacles, rows, [before, t.from]));
    let own = beside_two(obstacles, rows, [t.from, t.to]);
    match (earlier, own) {
        (Some(a), Some(b)) => Some(a.max(b)),
        (a, b) => a.or(b),
    }
}

fn beside_two(obstacles: &Obstacles, rows: &Rows, ends: [usize; 2]) -> Option<f64> {
    let times = ends.map(|k| rows.time(k));
    let seconds = times[1] - times[0];
    let at = |end: usize| move |particle: usize| three(rows.x(ends[end]), particle);
    // The way in between is no longer, unless forces are large.
    let way = |particle: usize| {
        let speeds = ends.map(|k| rows.v(k).map_or(0.0, |v| norm(three(v, particle))));
        let moved = norm(minus(at(1)(particle), at(0)(particle)));
        moved + seconds * (speeds[0] + speeds[1]) + obstacles.close(at(0)(particle))
    };
    let mut found: Option<f64> = None;
    let mut look = |(particle, against): (usize, Against), reach: f64| {
        let gaps = [0, 1].map(|end| obstacles.gap(particle, against, times[end], at(end)));
        if gaps[0] <= reach || gaps[1] <= reach {
            let depth = -gaps[0].min(gaps[1]);
            found = Some(found.unwrap_or(0.0).max(depth));
        }
    };
    for (particle, against) in obstacles.pairs() {
        let moved = obstacles.reach(against, times[0], times[1]);
        look((particle, against), way(particle) + moved);
    }
    if obstacles.among_particles() {
        let near = obstacles.near(times, |particle| (at(0)(particle), way(particle)));
        for pair in near.pairs() {
            if let Against::Particle(other) = pair.1 {
                look(pair, way(pair.0) + way(other));
            }
        }
    }
    found
}

/// At most `limit` of them, evenly spread, both ends included.
pub(super) fn spread<T: Copy>(all: &[T], limit: usize) -> Vec<T> {
    let n = all.len();
    match limit {
        0 => Vec::new(),
        _ if n <= limit => all.to_vec(),
        1 => all[n / 2..=n / 2].to_vec(),
        _ => (0..limit).map(|i| all[i * (n - 1) / (limit - 1)]).collect(),
    }
}

/// A sample of these, in order: `half` evenly spread, and as many of the livelier ones, since
/// schemes differ most where much moves.
pub(super) fn sample(all: &[Weighed], half: usize) -> Vec<Weighed> {
    if all.len() <= 2 * half {
        return all.to_vec();
    }
    let mut motions: Vec<f64> = all.iter().map(|w| w.motion).collect();
    motions.sort_by(f64::total_cmp);
    let lively = motions[motions.len() * 3 / 4];
    let lively: Vec<Weighed> = all.iter().copied().filter(|w| w.motion >= lively).collect();
    let mut picked = spread(all, half);
    picked.extend(spread(&lively, half));
    picked.sort_by_key(|w| w.transition.from);
    picked.dedup_by_key(|w| w.transition.from);
    picked
}

/// One transition from each third, livelier than three quarters of it: never the liveliest, which
/// in a faulty trajectory is the fault.
pub(super) fn probes(sample: &[Weighed]) -> Vec<Transition> {
    let third = sample.len().div_ceil(3).max(1);
    sample
        .chunks(third)
        .filter_map(|part| {
            let mut part = part.to_vec();
            part.sort_by(|a, b| a.motion.total_cmp(&b.motion));
            part.get((part.len() * 3 / 4).min(part.len() - 1)).copied()
        })
        .map(|w| w.transition)
        .collect()
}
