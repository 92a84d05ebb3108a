//! The ranking of a race: the winner, the candidates that cannot be told from it, and the next.

use super::contest::Entry;
use super::replay::{BEYOND, Defect};

/// This many transitions that one candidate meets to the last bit and another does not tell them apart,
/// even where both fit: each time the other's rounding gives these bits with a chance of at most a half.
const BITS: usize = 8;
/// The fraction of transitions whose defects show how large a candidate's are.
const TYPICAL: f64 = 0.9;
/// Where nothing fits, candidates within this factor are alike.
const ALIKE: f64 = 2.0;

/// The ranking, with candidates as their indices in the race.
pub(super) struct Ranking {
    /// The nearest; of several that are equally near, the preferred.
    pub(super) winner: usize,
    /// Whether rounding explains the winner's defects on at least half of the transitions that tell
    /// anything.
    pub(super) fits: bool,
    /// Those not told from the winner, in order.
    pub(super) alike: Vec<usize>,
    /// Those that something else than single transitions tells from it, unless they are the same
    /// mathematically.
    pub(super) told: Vec<Told>,
}

/// A candidate that the winner is told from by its bits, or over longer stretches.
pub(super) struct Told {
    pub(super) entry: usize,
    /// Its largest defect over those stretches; None by bits.
    pub(super) defect: Option<f64>,
}

impl Ranking {
    /// Whether this one is told from the winner otherwise, and by which defect.
    pub(super) fn told(&self, entry: usize) -> Option<Option<f64>> {
        let told = self.told.iter().find(|told| told.entry == entry);
        told.map(|told| told.defect)
    }
}

/// Ranks by the defects over the sample; `hint` is preferred among equals, then the order of the
/// entries. None without entries. `bits`: whether the data holds whole states to the last bit.
pub(super) fn rank(entries: &[Entry], hint: Option<usize>, bits: bool) -> Option<Ranking> {
    let transitions = entries.first()?.defects.len();
    // Where all fit, nothing is told.
    let telling: Vec<usize> = (0..transitions)
        .filter(|&k| entries.iter().any(|entry| !entry.defects[k].fits()))
        .collect();
    let follows = |entry: &Entry| telling.iter().filter(|&&k| entry.defects[k].fits()).count();
    let most = entries.iter().map(follows).max()?;
    let fits = 2 * most >= telling.len() && entries.iter().any(|entry| entry.fits() > 0);
    Some(if fits {
        among_fitting(entries, hint, bits, |entry| follows(entry) == most)
    } else {
        by_median(entries, hint)
    })
}

fn among_fitting(
    entries: &[Entry],
    hint: Option<usize>,
    bits: bool,
    leads: impl Fn(&Entry) -> bool,
) -> Ranking {
    // Nine exact ones in ten mean a scheme written the same way, whatever happened in between.
    // Fewer are chance.
    let exact = |i: usize| {
        let defects = &entries[i].defects;
        let fits = defects.iter().filter(|d| d.fits()).count();
        let exact = defects.iter().filter(|d| d.exact).count();
        if bits && 10 * exact >= 9 * fits {
            exact
        } else {
            0
        }
    };
    let leaders: Vec<usize> = (0..entries.len()).filter(|&i| leads(&entries[i])).collect();
    let typical = |i: usize| entries[i].quantile(TYPICAL);
    let least = leaders
        .iter()
        .map(|&i| typical(i))
        .fold(f64::INFINITY, f64::min);
    // Of those that rounding allows, the likely ones come first.
    let unlikely = |i: usize| typical(i) > f64::max(1.0, 2.0 * least);
    let order = |&i: &usize| (std::cmp::Reverse(exact(i)), Some(i) != hint, unlikely(i), i);
    let winner = leaders.into_iter().min_by_key(order).unwrap_or(0);
    let of_winner = &entries[winner].defects;
    let alike = |&i: &usize| i != winner && untold(of_winner, &entries[i].defects);
    let alike: Vec<usize> = (0..entries.len()).filter(alike).collect();
    let by_bits = exact(winner) > 0;
    let told = |i: &usize| {
        let pairs = of_winner.iter().zip(&entries[*i].defects);
        by_bits
            && pairs
                .filter(|(own, other)| own.exact && !other.exact)
                .count()
                >= BITS
    };
    let told = (0..entries.len()).filter(told);
    let told = told
        .map(|entry| Told {
            entry,
            defect: None,
        })
        .collect();
    Ranking {
        winner,
        fits: true,
        alike,
        told,
    }
}

/// Whether the other candidate is nowhere clearly off where the winner fits.
pub(super) fn untold(winner: &[Defect], other: &[Defect]) -> bool {
    let mut pairs = winner.iter().zip(other);
    pairs.all(|(own, other)| !own.fits() || other.units <= BEYOND)
}

fn by_median(entries: &[Entry], hint: Option<usize>) -> Ranking {
    let medians: Vec<f64> = entries.iter().map(|entry| entry.quantile(0.5)).collect();
    let best = medians.iter().copied().fold(f64::INFINITY, f64::min);
    let near = |factor: f64| {
        let medians = &medians;
        (0..medians.len()).filter(move |&i| medians[i] <= factor * best)
    };
    // Candidates that are the same differ by rounding alone.
    let first = near(1.0 + 1e-3).next().unwrap_or(0);
    let winner = hint
        .filter(|&hint| near(ALIKE).any(|i| i == hint))
        .unwrap_or(first);
    Ranking {
        winner,
        fits: false,
        alike: near(ALIKE).filter(|&i| i != winner).collect(),
        told: Vec::new(),
    }
}

/// Where nothing fits, the winner has to be this many times better than all others.
pub(super) const LEAD: f64 = 1e3;
/// Its defect has to be this small a part of what the steps move.
pub(super) const SMALL: f64 = 1e-3;
