//! Identity by one-step replay: which scheme a trajectory really follows.
//!
//! From each recorded row one step of every known scheme is taken and compared with the next row.
//! The difference is measured in units of what rounding can explain, so no threshold
//! depends on the scene, and it works in chaos, where trajectories part but steps do not.
//!
//! A scheme is named where rounding explains every row. A trajectory that follows none is *near* one, or is
//! *explained* by what its forces deviate in, or is unexplained.
//!
//! Not to be confused with comparing trajectories: a replay never sees an accumulated error.

mod altered;
mod bounce;
mod candidate;
mod channels;
mod compose;
mod contact;
mod explain;
mod fault;
mod fit;
mod keeping;
mod mistakes;
mod near;
mod numbers;
mod race;
mod replay;
mod result;
mod rods;
mod same;
mod step;
mod transition;
mod treated;
mod velocity;
mod words;

pub use altered::{Around, OneStep};
pub use bounce::{
    Bounce, FRICTIONS, Friction, Lift, Own, PARTNERS, PLACES, Partner, RESTITUTIONS, Restitution,
    Row, Shares, Size, Touching, WAYS, Way, Wrong as WrongNumber, treatments,
};
pub use candidate::{Candidate, Factor, Forces, Replayer, ScaledAt, Scaling};
pub use compose::{composed, composed_schemes};

pub use explain::TRUTH;
pub use fault::{first_departure, first_fault, moved_anchor};
pub use keeping::{Kept, Moved};
pub use mistakes::{MISTAKES, Mistake, Wrong, mistakes};
pub use replay::{Defect, FIT, Replay, solve_effort};
pub use result::{Deviation, Explained, Fault, Identity, Quantity, Treated, Undecided};
pub use step::{Formula, Place, Step};
pub use transition::Transition;

use crate::integrators::Settings;
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::trajectory::{Precision, Rows};
use race::{Entry, Race, Ranking, defects_of_all, quantile};
use same::Comparison;
use transition::Weighed;

/// Substeps that are tried.
const MOST_SUBSTEPS: u32 = 16;
/// Half of the transitions a race goes over; all count for the winner.
const HALF_SAMPLE: usize = 32;

/// The question: which scheme these rows follow.
pub struct Question<'a> {
    pub scene: &'a Scene,
    /// Built from `scene`.
    pub system: &'a ParticleSystem,
    pub rows: &'a Rows,
    /// Settings of implicit methods.
    pub settings: Settings,
    /// Most transitions to use, spread evenly; None for all.
    pub transitions: Option<usize>,
    /// Most steps times particles to replay, a linear solve counting as many; candidates beyond it are
    /// left out, the more elaborate first.
    pub budget: u64,
    /// What the trajectory is said to be, method and substeps: its name among equals, and the only scheme
    /// that it may be near.
    pub hint: Option<(&'static str, u32)>,
}

/// What is known of a trajectory's scheme.
#[derive(Debug, Clone, Default)]
pub struct Found {
    /// The scheme it follows, or nearly follows.
    pub identity: Option<Identity>,
    /// What it deviates in where it follows none exactly, or follows a mistake.
    pub explained: Option<Explained>,
}

/// Finds the scheme. Nothing is found where there is nothing to replay: fewer than two rows, three without
/// velocities, rows of another scene, or rows more than 20,000 steps apart.
pub fn identify(question: &Question) -> Found {
    let Found {
        identity,
        explained,
    } = found(question).unwrap_or_default();
    let numbered = identity.filter(|identity| identity.defect.is_finite());
    let identity = numbered.map(|identity| Identity {
        decisive: identity.undecided.is_none(),
        ..identity
    });
    Found {
        identity,
        explained,
    }
}

fn found(question: &Question) -> Option<Found> {
    let Question {
        scene,
        system,
        rows,
        ..
    } = *question;
    let replay = Replay::new(scene, system, rows, question.settings)?;
    let apart = contact::apart(question);
    let used = &apart.away;
    let sample = transition::sample(used, HALF_SAMPLE);
    let probes = transition::probes(&sample);
    let (all, sample) = (bare(used), bare(&sample));
    probes.first()?;
    let mut race = Race {
        replay: &replay,
        probes: &probes,
        sample: &sample,
        budget: question.budget,
        entries: Vec::new(),
        left_out: Vec::new(),
    };
    let plain = |n: u32| Candidate::plain(system, n);
    race.enter(expected(question).into_iter().collect(), None);
    race.enter(plain(1).collect(), None);
    let together = |race: &Race| {
        let identity = contact::together(question, race, &apart)?;
        Some(Found {
            explained: contact::explained(&identity),
            identity: Some(identity),
        })
    };
    // In contact nearly throughout, friction is told from gravity by what treatments leave.
    if !race.decided()
        && let Some(found) = together(&race)
    {
        let treated = found.identity.as_ref().and_then(|one| one.contact.as_ref());
        let sooner = treated.and_then(|treated| explain::sooner(question, &race, &all, treated));
        return Some(sooner.unwrap_or(found));
    }
    // Digits that are few tell fewer schemes apart, and that is to be said.
    let coarse = rows.precision != Precision::Double;
    if coarse || !race.decided() {
        race.enter(
            rods::restabilised(scene, system, 1),
            Some("other stabilisations"),
        );
    }
    if coarse || !race.decided() {
        race.enter(
            (2..=MOST_SUBSTEPS).flat_map(plain).collect(),
            Some("substeps"),
        );
    }
    if !race.decided() {
        let finer = (2..=MOST_SUBSTEPS).flat_map(|n| rods::restabilised(scene, system, n));
        race.enter(finer.collect(), Some("other stabilisations in substeps"));
    }
    if !race.decided() {
        race.enter(composed(scene, system), Some("composed schemes"));
    }
    if !race.decided() {
        race.enter(mistakes(scene, system), Some("mistakes"));
    }
    if !race.decided() {
        let fitted = rods::fitted(scene, system, &replay, &sample, race.budget / 2);
        race.enter(fitted, Some("fitted constraints"));
    }
    let named =
        |entry: &Entry| question.hint == Some((&entry.candidate.id, entry.candidate.substeps));
    let first = race.entries.iter().position(named);
    if let Some(ranking) = race.ranking(first, rows.v.is_some())
        && let Some(identity) = decide(question, &race, &ranking, &all, &sample)
    {
        if race.exact(ranking.winner) && Some(ranking.winner) != first {
            return Some(explain::of_truth(&identity));
        }
        if identity.followed < identity.transitions
            && let Some(found) = together(&race)
        {
            return Some(found);
        }
        let identity = contact::told(question, &race, &apart, identity);
        let identity = compose::staggered(system, scene, rows, identity);
        let explained = explain::of_mistake(scene, &identity);
        return Some(Found {
            explained: explained.or_else(|| contact::explained(&identity)),
            identity: Some(identity),
        });
    }
    Some(explain::of_none(question, &race, &all))
}

/// The scheme that is expected.
fn expected(question: &Question) -> Option<Candidate> {
    let (id, substeps) = question.hint?;
    if let Some(method) = crate::integrators::find(id) {
        return Some(Candidate::method(question.system, method, substeps));
    }
    let mut composed = composed(question.scene, question.system).into_iter();
    composed.find(|c| c.id == id && c.substeps == substeps)
}

/// The identity over all transitions; None where the winner follows less than half of them.
fn decide(
    question: &Question,
    race: &Race,
    ranking: &Ranking,
    all: &[Transition],
    sample: &[Transition],
) -> Option<Identity> {
    let winner = &race.entries[ranking.winner];
    let defects = if winner.defects.len() == all.len() {
        // The sample was all of them.
        winner.defects.clone()
    } else {
        defects_of_all(race.replay, &winner.candidate, all)
    };
    let followed = defects.iter().filter(|d| d.fits()).count();
    let share = followed as f64 / defects.len().max(1) as f64;
    if share < 0.5 {
        return None;
    }
    let candidate = &winner.candidate;
    let meant = || crate::integrators::find(candidate.meant);
    if let Some(meant) = meant().filter(|_| candidate.mistake) {
        // Where the mistake makes no difference, it is none.
        let right = Candidate::method(question.system, meant, candidate.substeps);
        let defects = defects_of_all(race.replay, &right, all);
        let fit: Vec<Defect> = defects.iter().copied().filter(Defect::fits).collect();
        // A transition that says nothing does not say that it was made.
        let told = |defect: &Defect| defect.units.is_finite() && !defect.fits();
        if 2 * fit.len() >= defects.len() && !defects.iter().any(told) {
            return Some(Identity {
                defect: quantile(&fit, 1.0),
                undecided: Some(Undecided::DataTooCoarse),
                equivalent: vec![candidate.label()],
                transitions: all.len(),
                followed: fit.len(),
                left_out: race.left_out.clone(),
                ..Identity::of(&right)
            });
        }
    }
    let comparison = Comparison::new(question.scene, question.system, race.replay, sample);
    let equals = race.equals(ranking, all, &defects, &comparison);
    let runner_up = race.runner_up(ranking, &equals, share);
    let candidate = |i: usize| &race.entries[i].candidate;
    let undecided = match equals.iter().all(|(_, same)| *same) {
        _ if equals.is_empty() => None,
        true => Some(Undecided::SameMap),
        false => Some(Undecided::DataTooCoarse),
    };
    Some(Identity {
        defect: quantile(&defects, share),
        relative: median_relative(&defects),
        runner_up: runner_up.map(|(i, _)| candidate(i).label()),
        runner_up_defect: runner_up
            .map(|(_, defect)| defect)
            .filter(|d| d.is_finite()),
        equivalent: equals.iter().map(|(i, _)| candidate(*i).label()).collect(),
        undecided,
        transitions: all.len(),
        followed,
        left_out: race.left_out.clone(),
        ..Identity::of(&winner.candidate)
    })
}

/// None where that is no number.
fn median_relative(defects: &[Defect]) -> Option<f64> {
    median(defects.iter().map(|d| d.relative)).filter(|r| r.is_finite())
}

/// The upper median; None of nothing.
fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

fn bare(weighed: &[Weighed]) -> Vec<Transition> {
    weighed.iter().map(|w| w.transition).collect()
}

/// A method of the registry with contact treated so; None of another id.
pub fn treated_so(
    scene: &Scene,
    system: &ParticleSystem,
    method: &str,
    bounce: &Bounce,
) -> Option<Candidate> {
    let method = crate::integrators::find(method)?;
    Candidate::method(system, method, 1).bouncing(scene, system, bounce)
}

/// Every scheme that has a name here, the simplest first: methods whole and in substeps, composed schemes,
/// mistakes.
fn candidates(scene: &Scene, system: &ParticleSystem) -> impl Iterator<Item = Candidate> {
    let methods = (1..=MOST_SUBSTEPS).flat_map(|n| Candidate::plain(system, n));
    let others = (1..=MOST_SUBSTEPS).flat_map(|n| rods::restabilised(scene, system, n));
    let methods: Vec<Candidate> = methods.chain(others).collect();
    methods
        .into_iter()
        .chain(composed(scene, system))
        .chain(mistakes(scene, system))
}

impl Identity {
    /// The name alone.
    fn of(candidate: &Candidate) -> Self {
        Self {
            method: candidate.id.clone(),
            substeps: candidate.substeps,
            says: candidate.says.clone(),
            mistake: candidate.mistake,
            defect: f64::INFINITY,
            ..Self::default()
        }
    }
}
