//! What tells whether a treatment explains the steps beside obstacles, and what is said of it.

use super::super::Question;
use super::super::bounce::{Bounce, Row, WAYS, Way, relevant, same_here};
use super::super::candidate::Candidate;
use super::super::race::defects_of_all;
use super::super::replay::{Replay, solve_effort};
use super::super::result::Treated;
use super::super::transition::Transition;
use super::{Apart, usual};
use crate::physics::System;
use rayon::prelude::*;

/// What is replayed to find a treatment.
pub(super) struct Search<'a> {
    pub(super) question: &'a Question<'a>,
    pub(super) replay: &'a Replay<'a>,
    pub(super) apart: &'a Apart,
}

/// The schemes, of those that are no others away from obstacles, that a treatment explains all steps beside them with.
#[derive(Clone)]
pub(super) struct Told {
    pub(super) bounce: Bounce,
    pub(super) schemes: Vec<Candidate>,
    /// Others with as few mistakes that explain all as well.
    pub(super) others: Vec<Bounce>,
}

impl Told {
    pub(super) fn new(bounce: Bounce, schemes: Vec<Candidate>) -> Self {
        Self {
            bounce,
            schemes,
            others: Vec::new(),
        }
    }
}

impl Search<'_> {
    pub(super) fn bouncing(&self, scheme: &Candidate, bounce: &Bounce) -> Option<Candidate> {
        let candidate = scheme.bouncing(self.question.scene, self.question.system, bounce)?;
        Some(self.replay.remembering(candidate))
    }

    /// The effort of one pass of soft steps over all rows.
    pub(super) fn pass(&self) -> u64 {
        let rows = self.replay.rows;
        let particles = self.question.scene.particles.len() as u64;
        let steps = rows.steps.last().zip(rows.steps.first());
        let steps = steps.map_or(0, |(last, first)| last - first);
        (particles * solve_effort(particles)).saturating_mul(steps)
    }

    fn fits(&self, candidate: &Candidate) -> bool {
        let mut replayer = candidate.replayer(&self.replay.settings);
        let beside = self.known(candidate, &self.apart.beside);
        let mut all = beside.iter();
        !beside.is_empty() && all.all(|t| self.replay.defect(&mut replayer, t).fits())
    }

    /// Those of these steps that begin with all that a candidate's step depends on.
    pub(super) fn known(&self, candidate: &Candidate, at: &[Transition]) -> Vec<Transition> {
        let known = |t: &&Transition| self.replay.knows(candidate, t.from);
        at.iter().filter(known).copied().collect()
    }

    /// The schemes that fit with this treatment.
    pub(super) fn fitting(&self, schemes: &[Candidate], bounce: &Bounce) -> Vec<Candidate> {
        let with = |scheme: &&Candidate| {
            let candidate = self.bouncing(scheme, bounce);
            candidate.is_some_and(|candidate| self.fits(&candidate))
        };
        schemes.iter().filter(with).cloned().collect()
    }

    /// How far a scheme is off with a treatment, as velocities, m/s.
    pub(super) fn off(
        &self,
        scheme: &Candidate,
        bounce: &Bounce,
        at: &[Transition],
    ) -> Option<Vec<f64>> {
        let (replay, rows) = (self.replay, self.replay.rows);
        let candidate = self.bouncing(scheme, bounce)?;
        let mut replayer = candidate.replayer(&replay.settings);
        let mut all = Vec::new();
        for t in at {
            let state = replay.predict(&mut replayer, t).ok()?;
            let seconds = t.span(rows) as f64 * rows.timestep;
            let mut units = vec![seconds; rows.dim];
            units.resize(2 * rows.dim, 1.0);
            all.extend(replay.off(t, &state, &units));
        }
        all.iter().all(|off| off.is_finite()).then_some(all)
    }

    /// Of these steps beside obstacles, those that a treatment does not explain: a few, the liveliest first.
    pub(super) fn missed(
        &self,
        scheme: &Candidate,
        bounce: &Bounce,
        most: usize,
    ) -> Vec<Transition> {
        let Some(candidate) = self.bouncing(scheme, bounce) else {
            return Vec::new();
        };
        let mut replayer = candidate.replayer(&self.replay.settings);
        let missed = |t: &&Transition| !self.replay.defect(&mut replayer, t).fits();
        self.apart
            .beside
            .iter()
            .filter(missed)
            .take(most)
            .copied()
            .collect()
    }

    /// Of all steps beside obstacles, a few that a treatment does not explain.
    pub(super) fn missed_by(&self, told: &Told, most: usize) -> Vec<Transition> {
        let scheme = told.schemes.first();
        let candidate = scheme.and_then(|scheme| self.bouncing(scheme, &told.bounce));
        candidate.map_or_else(Vec::new, |candidate| {
            let all = self.known(&candidate, &self.apart.met);
            let defects = defects_of_all(self.replay, &candidate, &all);
            let missed = all.iter().zip(defects).filter(|(_, defect)| !defect.fits());
            missed.map(|(t, _)| *t).take(most).collect()
        })
    }

    /// The first treatment that fits, and all others that do.
    pub(super) fn told(&self, schemes: &[Candidate], bounces: &[Bounce]) -> Option<Told> {
        let fitting = bounces.par_iter().filter_map(|bounce| {
            let schemes = self.fitting(schemes, bounce);
            (!schemes.is_empty()).then_some((*bounce, schemes))
        });
        let mut fitting = fitting.collect::<Vec<_>>().into_iter();
        let (bounce, schemes) = fitting.next()?;
        Some(Told {
            others: fitting.map(|(bounce, _)| bounce).collect(),
            ..Told::new(bounce, schemes)
        })
    }

    /// What is said of contact.
    pub(super) fn treated(&self, told: Option<&Told>) -> Treated {
        let force = told.map(|told| told.bounce.force);
        let force = force.filter(|[stiffness, _]| *stiffness != 0.0);
        let says = "no known treatment explains what it does at contact";
        Treated {
            treatment: told.map(|told| told.bounce.label()),
            unjudged: false,
            says: told.map_or_else(|| says.to_owned(), |told| told.bounce.says()),
            mistakes: told.map_or_else(Vec::new, |told| {
                told.bounce.mistakes().map(str::to_owned).collect()
            }),
            deepest_m: self.apart.deepest,
            stiffness_n_m: force.map(|force| force[0]),
            damping_n_s_m: force.map(|force| force[1]),
            steps: self.apart.beside.len(),
            equivalent: told.map_or_else(Vec::new, |told| self.equivalent(told)),
            bounce: told.map(|told| told.bounce),
        }
    }

    /// The other ways and places that explain all steps too, other mistakes in the same way and place, and right treatments
    /// beside other schemes where no step away from contact tells these apart.
    fn equivalent(&self, told: &Told) -> Vec<String> {
        let own = &told.bounce;
        let beside = |way: &Way| !matches!(way, Way::Force { .. } | Way::Soft | Way::Never);
        let alike = |way: &&Row<Way>| match (own.way.does, way.does) {
            (Way::Force { whole: a, .. }, Way::Force { whole: b, .. }) => a == b,
            (a, b) => beside(&a) && beside(&b),
        };
        let obstacles = self.question.system.obstacles();
        let places = obstacles.map_or_else(Vec::new, |all| relevant(all).0);
        let ways = WAYS.iter().filter(alike).flat_map(|way| {
            let places = places.iter().map(|place| Bounce { way, place, ..*own });
            places.filter(Bounce::is_sensible).collect::<Vec<_>>()
        });
        let ways: Vec<Bounce> = ways.filter(|other| other != own).collect();
        let fits = |other: &&Bounce| !self.fitting(&told.schemes, other).is_empty();
        let mut labels: Vec<String> = ways.iter().filter(fits).map(Bounce::label).collect();
        let same = |other: &&Bounce| (other.way.id, other.place.id) == (own.way.id, own.place.id);
        let wrong = own.mistakes().next().is_some();
        let others = told.others.iter().filter(|other| wrong && same(other));
        labels.extend(others.map(Bounce::label));
        if let Some(obstacles) = obstacles.filter(|_| wrong) {
            let others = same_here(obstacles, self.question.rows.timestep, own);
            labels.extend(others.iter().map(Bounce::label));
        }
        if self.apart.mixed && !wrong {
            let new = usual(self.question)
                .filter(|other| told.schemes.iter().all(|scheme| scheme.id != other.id));
            let new: Vec<Candidate> = new.collect();
            for other in ways
                .iter()
                .chain(&told.others)
                .filter(|other| other.mistakes().next().is_none())
            {
                let with = self.fitting(&new, other).into_iter();
                labels.extend(
                    with.map(|scheme| format!("{} with {}", scheme.label(), other.label())),
                );
            }
        }
        let mut seen = std::collections::BTreeSet::new();
        labels.retain(|label| seen.insert(label.clone()));
        labels
    }
}
