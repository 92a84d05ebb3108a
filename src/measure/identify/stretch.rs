//! Telling schemes apart over longer stretches, where single transitions are too coarse.
//!
//! Differences between schemes add up from step to step. The rounding of the data enters once,
//! however long the stretch, and its growth along the motion is part of the unit.

use super::contest::{Entry, enter};
use super::judge::{self, Ranking, Told};
use super::replay::Replay;
use super::transition::{Transition, spread, stretches};

/// Rows from the start to the end of a stretch, in turn.
const APART: [usize; 5] = [4, 16, 64, 256, 1024];
/// Stretches of each length, while that is affordable: a fault lies in one of them.
const STRETCHES: usize = 6;
/// Fewest stretches of each length.
const FEWEST: usize = 2;
/// The budget of the stretches of one length, in [`Replay::effort`]: a second or so. It has to buy
/// five stretches of 16 rows, four particles, all methods and all substeps.
const BUDGET: u64 = 30_000_000;

/// Ranks the winner and those alike anew, over longer and longer stretches, as long as there are
/// several and the effort is bearable.
pub(super) fn rank(
    replay: &Replay,
    entries: &[Entry],
    ranking: Ranking,
    hint: Option<usize>,
) -> Ranking {
    let mut best = ranking;
    for apart in APART {
        let alike = best.alike.iter().filter(|&&i| best.told(i).is_none());
        let class: Vec<usize> = std::iter::once(best.winner).chain(alike.copied()).collect();
        if !best.fits || class.len() < 2 {
            break;
        }
        let stretches = affordable(replay, entries, &class, apart);
        if stretches.len() < FEWEST {
            break;
        }
        let candidates = class.iter().map(|&i| entries[i].candidate.clone());
        let long = enter(replay, candidates.collect(), &stretches);
        let here = hint.and_then(|hint| class.iter().position(|&i| i == hint));
        let Some(ranked) = judge::rank(&long, here, false).filter(|ranked| ranked.fits) else {
            break;
        };
        best = narrowed(best, &class, &long, &ranked);
    }
    best
}

/// As many stretches as the class can be replayed over.
fn affordable(
    replay: &Replay,
    entries: &[Entry],
    class: &[usize],
    apart: usize,
) -> Vec<Transition> {
    let stretches = stretches(replay.rows, apart, STRETCHES);
    let each = match stretches.first() {
        Some(first) => {
            let efforts = class
                .iter()
                .map(|&i| replay.effort(&entries[i].candidate, first));
            efforts.fold(0, u64::saturating_add)
        }
        None => 0,
    };
    spread(
        &stretches,
        usize::try_from(BUDGET / each.max(1)).unwrap_or(usize::MAX),
    )
}

/// The ranking after its class was ranked over stretches.
fn narrowed(before: Ranking, class: &[usize], long: &[Entry], ranked: &Ranking) -> Ranking {
    let mut told = before.told;
    let mut alike: Vec<usize> = ranked.alike.iter().map(|&place| class[place]).collect();
    for (place, &entry) in class.iter().enumerate() {
        if place != ranked.winner && !alike.contains(&entry) {
            let defect = Some(long[place].quantile(1.0)).filter(|defect| defect.is_finite());
            told.push(Told { entry, defect });
        }
    }
    // By bits it is still told from those that fit.
    let by_bits = before.alike.iter().filter(|i| !class.contains(i));
    alike.extend(by_bits);
    alike.sort_unstable();
    Ranking {
        winner: class[ranked.winner],
        fits: true,
        alike,
        told,
    }
}
