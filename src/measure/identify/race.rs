//! The race: which candidates' steps rounding explains, the simplest candidates first.

use super::candidate::Candidate;
use super::replay::{Defect, FIT, Replay};
use super::same::Comparison;
use super::transition::{Transition, spread, stretches};
use crate::trajectory::Precision;
use rayon::prelude::*;

/// Transitions one replayer takes: few enough that threads share the work, many enough that its
/// scratch memory pays.
const CHUNK: usize = 64;
/// Replays of a transition that a defect takes, about: the step itself, and a few more with every number off by its
/// rounding.
const REPLAYS: u64 = 4;
/// The fraction of transitions whose defects show how large a candidate's are.
const TYPICAL: f64 = 0.9;
/// A candidate whose typical defect is beyond this, and so many times that of another, fits by its tolerance alone.
const LIKELY: f64 = 4.0;
/// Those that fit the sample as the winner does are compared with it over this many transitions.
const COMPARED: usize = 256;
/// Rows from the start to the end of a stretch, in turn.
///
/// Differences between schemes add up from step to step. The rounding of the data enters once, however long
/// the stretch, and its growth along the motion is part of the unit. So longer stretches tell apart what
/// single transitions do not.
const APART: [usize; 5] = [4, 16, 64, 256, 1024];
/// Stretches of each length.
const STRETCHES: usize = 6;
/// Motions from which two candidates are said to be the same, and steps of each.
const MOTIONS: u64 = 40;

/// A candidate and its defects, over the probes alone if it fits none of them, else over the sample.
pub(super) struct Entry {
    pub(super) candidate: Candidate,
    pub(super) defects: Vec<Defect>,
    /// Whether the defects are those of the sample.
    pub(super) sampled: bool,
}

impl Entry {
    fn fits(&self, k: usize) -> bool {
        self.sampled && self.defects[k].fits()
    }

    fn follows(&self) -> bool {
        self.sampled && self.defects.iter().all(Defect::fits)
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
    let value = units.get(at.saturating_sub(1)).copied();
    value.unwrap_or(f64::INFINITY)
}

/// The candidates so far, and what is left to spend on more.
pub(super) struct Race<'a> {
    pub(super) replay: &'a Replay<'a>,
    /// A few transitions that all candidates are tried on.
    pub(super) probes: &'a [Transition],
    /// Those that all are tried on that may win.
    pub(super) sample: &'a [Transition],
    /// In [`Replay::effort`].
    pub(super) budget: u64,
    pub(super) entries: Vec<Entry>,
    /// What was not tried for want of it.
    pub(super) left_out: Vec<String>,
}

/// The winner, and those that the data cannot tell from it.
pub(super) struct Ranking {
    pub(super) winner: usize,
    pub(super) equals: Vec<usize>,
    /// Those that fit single transitions too, but not longer stretches, with their defects there.
    pub(super) told: Vec<(usize, f64)>,
}

impl Race<'_> {
    /// Tries these, a group as many as half of what is left holds: the rest is for telling apart those that fit.
    /// What it does not hold is left out under the group's name, or each under its own.
    pub(super) fn enter(&mut self, candidates: Vec<Candidate>, group: Option<&str>) {
        let known = |candidate: &Candidate| {
            self.entries.iter().any(|entry| {
                entry.candidate.id == candidate.id
                    && entry.candidate.substeps == candidate.substeps
                    && entry.candidate.says == candidate.says
                    && candidate.says.is_none()
            })
        };
        let new: Vec<Candidate> = candidates.into_iter().filter(|c| !known(c)).collect();
        let (replay, probes, sample) = (self.replay, self.probes, self.sample);
        let kept = group.map_or(0, |_| self.budget / 2);
        // No single one may take what many could.
        let most = group.map_or(self.budget, |_| self.budget / 8);
        let tried = self.afforded(new, group, probes, most, kept);
        let near: Vec<Vec<Defect>> = tried
            .par_iter()
            .map(|candidate| defects(replay, candidate, probes))
            .collect();
        let mut fitting = Vec::new();
        let mut others = Vec::new();
        for (candidate, defects) in tried.into_iter().zip(near) {
            if defects.iter().any(Defect::fits) {
                fitting.push(candidate);
            } else {
                others.push(Entry {
                    candidate,
                    defects,
                    sampled: false,
                });
            }
        }
        let fitting = self.afforded(fitting, group, sample, self.budget, kept);
        let sampled = fitting.into_par_iter().map(|candidate| Entry {
            defects: defects_of_all(replay, &candidate, sample),
            candidate,
            sampled: true,
        });
        let sampled: Vec<Entry> = sampled.collect();
        self.entries.extend(sampled);
        self.entries.extend(others);
    }

    /// Those that can be replayed `at` these places with `kept` left of the budget, each for at most `most`; the
    /// others are left out. What is expected comes first, and is tried whatever it costs.
    fn afforded(
        &mut self,
        candidates: Vec<Candidate>,
        group: Option<&str>,
        at: &[Transition],
        most: u64,
        kept: u64,
    ) -> Vec<Candidate> {
        let mut tried = Vec::new();
        let mut left_out: Vec<String> = Vec::new();
        for candidate in candidates {
            let effort = self.effort(&candidate, at);
            let expected = self.entries.is_empty() && tried.is_empty();
            if !expected && (effort > most || effort.saturating_add(kept) > self.budget) {
                left_out.push(group.map_or_else(|| candidate.label(), str::to_owned));
                continue;
            }
            self.budget = self.budget.saturating_sub(effort);
            tried.push(candidate);
        }
        self.left_out.extend(left_out);
        self.left_out.dedup();
        tried
    }

    fn effort(&self, candidate: &Candidate, at: &[Transition]) -> u64 {
        let efforts = at.iter().map(|t| self.replay.effort(candidate, t));
        REPLAYS.saturating_mul(efforts.fold(0, u64::saturating_add))
    }

    /// Whether a candidate of this id was tried.
    pub(super) fn tried(&self, id: &str) -> bool {
        self.entries.iter().any(|entry| entry.candidate.id == id)
    }

    /// Whether some candidate follows the whole sample.
    pub(super) fn decided(&self) -> bool {
        self.entries.iter().any(Entry::follows)
    }

    /// The ranking; None where no candidate follows at least half of the transitions that tell anything. `first` is
    /// preferred among equals, then the order of entry.
    pub(super) fn ranking(&self, first: Option<usize>, whole_states: bool) -> Option<Ranking> {
        let telling: Vec<usize> = (0..self.sample.len())
            .filter(|&k| self.entries.iter().any(|entry| !entry.fits(k)))
            .collect();
        let follows = |i: &usize| {
            let fits = |k: &&usize| self.entries[*i].fits(**k);
            telling.iter().filter(fits).count()
        };
        let sampled = (0..self.entries.len()).filter(|&i| self.entries[i].sampled);
        let sampled: Vec<usize> = sampled.collect();
        let most = sampled.iter().map(follows).max()?;
        if 2 * most < telling.len() || (most == 0 && !telling.is_empty()) {
            return None;
        }
        let leads = |i: &usize| follows(i) == most;
        let mut class: Vec<usize> = sampled.iter().copied().filter(leads).collect();
        let typical = |i: usize| self.entries[i].quantile(TYPICAL);
        let least = class
            .iter()
            .map(|&i| typical(i))
            .fold(f64::INFINITY, f64::min);
        // Rounding allows all of them; those with small defects come first.
        let unlikely = |i: usize| typical(i) > f64::max(LIKELY, LIKELY * least);
        class.sort_by_key(|&i| (Some(i) != first, unlikely(i), i));
        let mut told = Vec::new();
        if whole_states {
            // Over longer stretches of positions alone, the velocity to start from is too uncertain.
            class = self.narrowed(class, &mut told);
        }
        let winner = *class.first()?;
        let untold = |i: &usize| {
            *i != winner && {
                let pairs = self.entries[winner].defects.iter();
                let mut pairs = pairs.zip(&self.entries[*i].defects);
                pairs.all(|(own, other)| !own.fits() || other.fits())
            }
        };
        Some(Ranking {
            winner,
            equals: class.into_iter().filter(untold).collect(),
            told,
        })
    }

    /// Whether a winner in substeps is no more than exact: in twice as many it fits as well.
    pub(super) fn exact(&self, winner: usize) -> bool {
        let candidate = &self.entries[winner].candidate;
        let finer = || candidate.clone().in_substeps(2 * candidate.substeps);
        candidate.substeps > 1
            && candidate.says.is_none()
            && defects_of_all(self.replay, &finer(), self.sample)
                .iter()
                .all(Defect::fits)
    }

    /// Those of a class that follow longer and longer stretches.
    fn narrowed(&self, mut class: Vec<usize>, told: &mut Vec<(usize, f64)>) -> Vec<usize> {
        let mut budget = self.budget / 2;
        for apart in APART {
            let stretches = stretches(self.replay.rows, apart, STRETCHES);
            let effort = class
                .iter()
                .map(|&i| self.effort(&self.entries[i].candidate, &stretches));
            let effort = effort.fold(0, u64::saturating_add);
            if class.len() < 2 || stretches.len() < 2 || effort > budget {
                break;
            }
            budget -= effort;
            let run = |&i: &usize| defects(self.replay, &self.entries[i].candidate, &stretches);
            let defects: Vec<Vec<Defect>> = class.par_iter().map(run).collect();
            // The unit follows rounding that goes either way from step to step. Where a motion repeats itself it may
            // always push the same way, and add up by so much more. The digits of coarser data enter once.
            let doubles = self.replay.rows.precision == Precision::Double;
            let explained = FIT * if doubles { (apart as f64).sqrt() } else { 1.0 };
            let fits = |defects: &Vec<Defect>| {
                let explained = defects.iter().filter(|d| d.units <= explained);
                explained.count()
            };
            let most = defects.iter().map(fits).max().unwrap_or(0);
            if most == 0 {
                break;
            }
            let ranked: Vec<(usize, Vec<Defect>)> = class.into_iter().zip(defects).collect();
            class = Vec::new();
            for (i, defects) in ranked {
                if fits(&defects) == most {
                    class.push(i);
                } else {
                    told.push((i, quantile(&defects, 1.0)));
                }
            }
        }
        class
    }

    /// Of these equals of the winner, those that are its equals throughout, a method once with the fewest
    /// substeps, each with whether it is the same map where the trajectory goes.
    pub(super) fn equals(
        &self,
        ranking: &Ranking,
        all: &[Transition],
        defects: &[Defect],
        comparison: &Comparison,
    ) -> Vec<(usize, bool)> {
        let own = &self.entries[ranking.winner].candidate;
        let pairs: Vec<(Transition, Defect)> =
            all.iter().copied().zip(defects.iter().copied()).collect();
        let (at, own_defects): (Vec<Transition>, Vec<Defect>) =
            spread(&pairs, COMPARED).into_iter().unzip();
        let mut equals: Vec<(usize, bool)> = Vec::new();
        for &i in &ranking.equals {
            let candidate = &self.entries[i].candidate;
            let again = |(j, _): &(usize, bool)| self.entries[*j].candidate.id == candidate.id;
            if candidate.id == own.id || equals.iter().any(again) {
                continue;
            }
            let once = self.effort(candidate, &at[..1.min(at.len())]);
            let affordable = |times: u64| once.saturating_mul(times) <= self.budget;
            let same = affordable(MOTIONS) && comparison.same(own, candidate);
            let told = || {
                let others = defects_of_all(self.replay, candidate, &at);
                let mut pairs = own_defects.iter().zip(others);
                pairs.any(|(own, other)| own.fits() && !other.fits())
            };
            // What is not compared is not told apart.
            if same || !affordable(at.len() as u64) || !told() {
                equals.push((i, same));
            }
        }
        equals
    }

    /// The nearest candidate that is told from the winner, by the defect that this share of the transitions
    /// does not exceed.
    pub(super) fn runner_up(
        &self,
        ranking: &Ranking,
        equals: &[(usize, bool)],
        share: f64,
    ) -> Option<(usize, f64)> {
        let id = |i: usize| self.entries[i].candidate.id.as_str();
        let own = |i: usize| {
            i == ranking.winner
                || ranking.equals.contains(&i)
                || equals.iter().any(|(j, _)| id(*j) == id(i))
        };
        let defect = |i: usize| {
            let told = ranking.told.iter().find(|(j, _)| *j == i);
            told.map_or_else(|| self.entries[i].quantile(share), |(_, defect)| *defect)
        };
        let others = (0..self.entries.len()).filter(|&i| !own(i));
        others
            .map(|i| (i, defect(i)))
            .filter(|(_, defect)| *defect > FIT)
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }
}

fn defects(replay: &Replay, candidate: &Candidate, at: &[Transition]) -> Vec<Defect> {
    let mut replayer = candidate.replayer(&replay.settings);
    at.iter().map(|t| replay.defect(&mut replayer, t)).collect()
}

/// The defects over many transitions, in parallel.
pub(super) fn defects_of_all(
    replay: &Replay,
    candidate: &Candidate,
    at: &[Transition],
) -> Vec<Defect> {
    let chunks = at.par_chunks(CHUNK);
    chunks
        .flat_map_iter(|chunk| defects(replay, candidate, chunk))
        .collect()
}
