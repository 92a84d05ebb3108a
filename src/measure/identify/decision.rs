//! From a ranking over a sample to an identity over the whole trajectory.

use super::candidate::Candidate;
use super::contest::{BUDGET, Entry, defects_of_all, quantile};
use super::judge::{LEAD, Ranking, SMALL, untold};
use super::replay::{BEYOND, Defect, Replay};
use super::same::Comparison;
use super::transition::{Transition, spread};
use super::{Identity, RunnerUp, Sameness};

/// Those that fit the sample as well as the winner are compared with it over this many transitions,
/// fewer where they cost more.
const COMPARED: (usize, usize) = (64, 1024);

/// Everything that an identity is decided from.
pub(super) struct Decision<'a> {
    pub(super) replay: &'a Replay<'a>,
    pub(super) comparison: &'a Comparison<'a>,
    pub(super) entries: &'a [Entry],
    /// Every transition that counts.
    pub(super) all: &'a [Transition],
    pub(super) hint: Option<usize>,
}

/// A candidate that cannot be told from the winner.
struct Equal {
    entry: usize,
    /// Whether it is the same map where the trajectory goes.
    same: bool,
}

impl Decision<'_> {
    pub(super) fn identity(&self, ranking: &Ranking) -> Identity {
        let mut winner = ranking.winner;
        let mut defects = self.over_all(winner);
        let mut equals = self.equals(ranking, &defects);
        // The expected name is preferred if it is as good; so is a method to a mistake that makes no
        // difference here.
        let right = |i: usize| self.candidate(i).mistake.is_none();
        let better = |equal: &&mut Equal| {
            Some(equal.entry) == self.hint || (!right(winner) && equal.same && right(equal.entry))
        };
        if Some(winner) != self.hint
            && let Some(equal) = equals.iter_mut().find(better)
        {
            std::mem::swap(&mut equal.entry, &mut winner);
            defects = self.over_all(winner);
        }
        let followed = defects.iter().filter(|d| d.fits()).count();
        let share = followed as f64 / defects.len().max(1) as f64;
        let fits = ranking.fits && share >= 0.5;
        let share = share.max(0.5);
        let own = &self.entries[winner];
        let runner_up = self.runner_up(winner, &equals, share).map(|(i, defect)| {
            // The defect where it was told apart, if that was not in single transitions.
            (i, ranking.told(i).flatten().unwrap_or(defect))
        });
        let equivalent = self.labels(winner, &equals);
        let defect = quantile(&defects, share);
        let lead = runner_up.map_or(f64::INFINITY, |(_, defect)| defect);
        let told = if fits {
            lead >= BEYOND || runner_up.is_some_and(|(i, _)| ranking.told(i).is_some())
        } else {
            lead >= LEAD * defect && median_relative(&defects) <= SMALL
        };
        Identity {
            method: own.candidate.id.clone(),
            substeps: own.candidate.substeps,
            defect,
            runner_up: runner_up.map(|(i, defect)| RunnerUp {
                method: self.candidate(i).id.clone(),
                substeps: self.candidate(i).substeps,
                defect,
            }),
            decisive: told && equivalent.is_empty(),
            same: match (fits, equivalent.is_empty()) {
                (false, _) => Sameness::NothingFits,
                (true, true) => Sameness::Alone,
                (true, false) if equals.iter().all(|equal| equal.same) => Sameness::Mathematically,
                (true, false) => Sameness::TooCoarse,
            },
            equivalent,
            mistake: own.candidate.mistake,
            transitions: self.all.len(),
            followed,
            steps: self.replay.steps(),
        }
    }

    fn candidate(&self, i: usize) -> &Candidate {
        &self.entries[i].candidate
    }

    fn over_all(&self, i: usize) -> Vec<Defect> {
        let entry = &self.entries[i];
        if entry.defects.len() == self.all.len() {
            // The sample was all of them.
            return entry.defects.clone();
        }
        defects_of_all(self.replay, &entry.candidate, self.all)
    }

    /// The sample's equals that are the winner's equals throughout.
    fn equals(&self, ranking: &Ranking, defects: &[Defect]) -> Vec<Equal> {
        let winner = self.candidate(ranking.winner);
        let mut equals: Vec<Equal> = Vec::new();
        for &entry in &ranking.alike {
            let candidate = self.candidate(entry);
            // A method counts once, with the fewest substeps that do.
            let known = |equal: &Equal| self.candidate(equal.entry).id == candidate.id;
            if Some(entry) != self.hint && equals.iter().any(known) {
                continue;
            }
            let same = self.comparison.same(winner, candidate);
            let alike = || ranking.told(entry).is_none() && self.untold(entry, defects);
            if same || !ranking.fits || alike() {
                equals.push(Equal { entry, same });
            }
        }
        equals
    }

    /// Whether a candidate is nowhere clearly off where the winner, of these defects, fits: over as
    /// many of the transitions as there is time for.
    fn untold(&self, entry: usize, winner: &[Defect]) -> bool {
        let pairs: Vec<(Transition, Defect)> = self
            .all
            .iter()
            .copied()
            .zip(winner.iter().copied())
            .collect();
        let candidate = self.candidate(entry);
        let each = self
            .all
            .first()
            .map_or(1, |t| self.replay.effort(candidate, t));
        let affordable = usize::try_from(BUDGET / 10 / each.max(1)).unwrap_or(usize::MAX);
        let compared = affordable.clamp(COMPARED.0, COMPARED.1);
        let (at, winner): (Vec<_>, Vec<_>) = spread(&pairs, compared).into_iter().unzip();
        let other = defects_of_all(self.replay, candidate, &at);
        untold(&winner, &other)
    }

    /// The labels, each once, in order.
    fn labels(&self, winner: usize, equals: &[Equal]) -> Vec<String> {
        let own = self.candidate(winner);
        let same = equals.iter().filter(|equal| equal.same);
        let methods: Vec<&str> = same
            .map(|equal| self.candidate(equal.entry))
            .chain([own])
            .filter(|c| c.mistake.is_none())
            .map(|c| c.meant)
            .collect();
        // More substeps of the winner itself, and mistakes in a method that is here already, are news
        // only where they differ.
        let news = |equal: &&Equal| {
            let candidate = self.candidate(equal.entry);
            let idle = candidate.mistake.is_some() && methods.contains(&candidate.meant);
            !(equal.same && (idle || candidate.id == own.id))
        };
        let mut entries: Vec<usize> = equals.iter().filter(news).map(|e| e.entry).collect();
        entries.sort_unstable();
        entries.iter().map(|&i| self.candidate(i).label()).collect()
    }

    /// The nearest candidate by the sample that is not an equal.
    fn runner_up(&self, winner: usize, equals: &[Equal], share: f64) -> Option<(usize, f64)> {
        let names = |i: usize| {
            let own = i == winner || equals.iter().any(|equal| equal.entry == i);
            let collapsed = |equal: &Equal| self.candidate(equal.entry).id == self.candidate(i).id;
            own || equals.iter().any(collapsed)
        };
        (0..self.entries.len())
            .filter(|&i| !names(i))
            .map(|i| (i, self.entries[i].quantile(share)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn median_relative(defects: &[Defect]) -> f64 {
    let mut relative: Vec<f64> = defects.iter().map(|d| d.relative).collect();
    relative.sort_by(f64::total_cmp);
    relative
        .get(relative.len() / 2)
        .copied()
        .unwrap_or(f64::INFINITY)
}
