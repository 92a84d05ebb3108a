//! The race: few transitions for all candidates, all transitions for those that may still win.

use super::candidate::Candidate;
use super::replay::{Defect, FIT, Replay};
use super::sweep;
use super::transition::{Transition, spread};
use rayon::prelude::*;

/// A candidate this many times worse than the best drops out.
const OUT: f64 = 1e3;
/// A defect of this many last digits is no fault of the data: it is rounding, magnified by a stiff scene.
const SOUND: f64 = 100.0 * FIT;
/// Number of candidates that stay although they fit nowhere yet.
const RUNNERS_UP: usize = 3;
/// Transitions of the first round.
const FIRST: usize = 4;
/// The budget of the second round, in [`Replay::effort`]: well below a second.
pub(super) const BUDGET: u64 = 5_000_000;
/// Fewest transitions of the second round.
const FEWEST: usize = 8;

/// A candidate and its defects at the transitions of a sample.
#[derive(Clone)]
pub(super) struct Entry {
    pub(super) candidate: Candidate,
    pub(super) defects: Vec<Defect>,
}

impl Entry {
    pub(super) fn fits(&self) -> usize {
        self.defects.iter().filter(|d| d.fits()).count()
    }

    /// The defect that a fraction `kept` of the transitions does not exceed.
    pub(super) fn quantile(&self, kept: f64) -> f64 {
        quantile(&self.defects, kept)
    }
}

/// The value that a fraction `kept` of these does not exceed; infinite where there are none.
pub(super) fn quantile(defects: &[Defect], kept: f64) -> f64 {
    let mut units: Vec<f64> = defects.iter().map(|d| d.units).collect();
    units.sort_by(f64::total_cmp);
    let at = (units.len() as f64 * kept).ceil() as usize;
    units
        .get(at.saturating_sub(1))
        .copied()
        .unwrap_or(f64::INFINITY)
}

/// The budget of a look at one transition, in [`Replay::effort`]: some seconds at most.
const LOOK: u64 = 100_000_000;
/// The budget where only some transitions are to be used and an answer is wanted soon: a fraction
/// of a second.
const GLANCE: u64 = 2_000_000;

/// Newton iterations of a step, about, where an answer is wanted soon: four where the motion is calm, a
/// dozen on stiff cloth.
const ITERATIONS: u64 = 8;

/// The candidates that there is time for: in a large scene, or where rows lie far apart in it, only
/// those of few substeps, and the one that is expected.
pub(super) fn affordable(
    replay: &Replay,
    candidates: Vec<Candidate>,
    brief: bool,
    hint: Option<(&str, u32)>,
    at: &Transition,
) -> Vec<Candidate> {
    let effort = |most: u32| {
        let tried = candidates.iter().filter(|c| c.substeps <= most);
        tried
            .map(|c| {
                let times = if brief && c.iterates() { ITERATIONS } else { 1 };
                replay.effort(c, at).saturating_mul(times)
            })
            .fold(0, u64::saturating_add)
    };
    let enough = if brief { GLANCE } else { LOOK };
    let most = [16, 8, 4, 2]
        .into_iter()
        .find(|&most| effort(most) <= enough);
    let expected = |c: &Candidate| hint == Some((c.id.as_str(), c.substeps));
    let wanted = |c: &Candidate| c.substeps <= most.unwrap_or(1) || expected(c);
    candidates.into_iter().filter(wanted).collect()
}

/// The candidates still of interest after the probes and a few more transitions, with their defects
/// at all of the sample.
pub(super) fn race(
    replay: &Replay,
    candidates: Vec<Candidate>,
    probes: &[Transition],
    sample: &[Transition],
    brief: bool,
) -> Race {
    let near = nearest(replay, &candidates, probes, brief);
    let best = near.iter().copied().fold(f64::INFINITY, f64::min);
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|&a, &b| near[a].total_cmp(&near[b]));
    let bound = OUT * best.max(FIT);
    let within = near.iter().filter(|near| **near <= bound).count();
    let mut kept = vec![false; candidates.len()];
    for &i in order.iter().take(within + RUNNERS_UP) {
        kept[i] = near[i].is_finite();
    }
    let few = spread(sample, FIRST);
    let entries = candidates.into_iter().zip(kept);
    let entries: Vec<Candidate> = entries.filter(|(_, kept)| *kept).map(|(c, _)| c).collect();
    let entries = enter(replay, entries, &few);
    let entries = survivors(entries);
    let candidates = entries.into_iter().map(|entry| entry.candidate);
    let candidates: Vec<Candidate> = candidates.collect();
    let each: u64 = match sample.first() {
        Some(first) => candidates.iter().map(|c| replay.effort(c, first)).sum(),
        None => 0,
    };
    let affordable = usize::try_from(BUDGET / each.max(1)).unwrap_or(usize::MAX);
    let sample = spread(sample, affordable.max(FEWEST));
    let entries = enter(replay, candidates, &sample);
    Race { entries, sample }
}

/// The result of a race: the candidates that may have won, with their defects at a sample of the
/// transitions.
pub(super) struct Race {
    pub(super) entries: Vec<Entry>,
    pub(super) sample: Vec<Transition>,
}

/// The least distance of each candidate over the probes. Some probes may be faults, and a trajectory may
/// follow another scheme early on. `brief` ends with the first probe that some candidate nearly follows.
fn nearest(
    replay: &Replay,
    candidates: &[Candidate],
    probes: &[Transition],
    brief: bool,
) -> Vec<f64> {
    let mut near = vec![f64::INFINITY; candidates.len()];
    let mut open: Vec<usize> = (0..candidates.len()).collect();
    for probe in probes {
        let distances = sweep::distances(replay, candidates, &open, probe);
        for (near, distance) in near.iter_mut().zip(&distances) {
            *near = near.min(*distance);
        }
        if !brief {
            continue;
        }
        let best = distances.iter().copied().fold(f64::INFINITY, f64::min);
        if best <= SOUND {
            break;
        }
        // A fault makes all candidates alike; one that is far behind here need not be tried again.
        open.retain(|&i| distances[i] <= OUT * best);
    }
    near
}

pub(super) fn enter(replay: &Replay, candidates: Vec<Candidate>, at: &[Transition]) -> Vec<Entry> {
    let run = |candidate: Candidate| Entry {
        defects: defects(replay, &candidate, at),
        candidate,
    };
    candidates.into_par_iter().map(run).collect()
}

fn defects(replay: &Replay, candidate: &Candidate, at: &[Transition]) -> Vec<Defect> {
    let mut replayer = candidate.replayer(&replay.settings);
    at.iter().map(|t| replay.defect(&mut replayer, t)).collect()
}

/// Transitions one replayer takes: few enough that threads share the work, many enough that its
/// scratch memory pays.
const CHUNK: usize = 64;

/// The defects over many transitions, in parallel.
pub(super) fn defects_of_all(
    replay: &Replay,
    candidate: &Candidate,
    at: &[Transition],
) -> Vec<Defect> {
    at.par_chunks(CHUNK)
        .flat_map_iter(|chunk| defects(replay, candidate, chunk))
        .collect()
}

/// The candidates that fit about as often as the best, and the nearest of the rest.
fn survivors(entries: Vec<Entry>) -> Vec<Entry> {
    let most = entries.iter().map(Entry::fits).max().unwrap_or(0);
    let fits = |entry: &Entry| most > 0 && entry.fits() + 1 >= most.max(2);
    let mut rest: Vec<usize> = (0..entries.len()).filter(|&i| !fits(&entries[i])).collect();
    let median = |i: &usize| entries[*i].quantile(0.5);
    rest.sort_by(|a, b| median(a).total_cmp(&median(b)));
    rest.truncate(RUNNERS_UP);
    let kept: Vec<bool> = (0..entries.len())
        .map(|i| fits(&entries[i]) || rest.contains(&i))
        .collect();
    let entries = entries.into_iter().zip(kept);
    entries.filter(|(_, kept)| *kept).map(|(e, _)| e).collect()
}
