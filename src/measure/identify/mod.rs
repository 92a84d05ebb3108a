//! Identity by one-step replay: which scheme a trajectory really follows.
//!
//! From each recorded row one step of every known scheme is taken and compared with the next row.
//! The difference is measured in units of what rounding of the data can explain, so no threshold
//! depends on the scene, and it works in chaos, where trajectories part but steps do not.
//!
//! Not to be confused with comparing trajectories: a replay never sees an accumulated error.

mod candidate;
mod contest;
mod decision;
mod defect;
mod fault;
mod judge;
mod mistakes;
mod replay;
mod result;
mod same;
mod stretch;
mod sweep;
mod transition;
mod velocity;

pub use candidate::{Candidate, Map, Replayer, Scheme};
pub use fault::{first_departure, first_fault, moved_anchor};
pub use mistakes::{MISTAKES, Mistake, Wrong, mistakes};
pub use replay::{BEYOND, Defect, FIT, Replay};
pub use result::{Fault, Identified, Quantity, Undecided};
pub use transition::Transition;

use crate::integrators::{Settings, fixed};
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::trajectory::Rows;
use contest::{Entry, Race};
use decision::Decision;
use same::Comparison;
use transition::Weighed;

/// Substeps that are tried.
const MOST_SUBSTEPS: u32 = 16;
/// Half of the transitions a race goes over; all count for those that may have won.
const HALF_SAMPLE: usize = 32;

/// The question: which scheme these rows follow.
pub struct Question<'a> {
    pub scene: &'a Scene,
    /// Built from `scene`.
    pub system: &'a ParticleSystem,
    pub rows: &'a Rows,
    /// Settings of implicit methods.
    pub settings: Settings,
    /// Most transitions to use, spread evenly; None for all. With a limit, large scenes are tried in
    /// fewer substeps, too.
    pub transitions: Option<usize>,
    /// What the trajectory is said to be, method and substeps: its name among equals.
    pub hint: Option<(&'static str, u32)>,
}

/// The scheme a trajectory follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Identity {
    /// Id of a method, or of a mistake.
    pub method: String,
    /// Steps it takes in a timestep.
    pub substeps: u32,
    /// Largest distance of a replayed row from the recorded one, in units of what rounding explains,
    /// over the transitions that follow it; where nothing fits, the median over all.
    pub defect: f64,
    /// The nearest candidate that can be told from it.
    pub runner_up: Option<RunnerUp>,
    /// Whether no other candidate explains the data, and either this one does to rounding, or it is
    /// a thousand times nearer than all others and off by less than a thousandth of what the steps
    /// move (as a solver is that stops early).
    pub decisive: bool,
    /// The candidates that cannot be told from it here, each method once with the fewest substeps:
    /// `heun`, `implicit_euler/4`.
    pub equivalent: Vec<String>,
    pub same: Sameness,
    /// What is wrong with the scheme, if it is a known mistake.
    pub mistake: Option<&'static str>,
    /// Transitions replayed.
    pub transitions: usize,
    /// How many of them follow the scheme.
    pub followed: usize,
    /// Steps taken to find out, substeps included.
    pub steps: u64,
}

/// The nearest scheme that it is not.
#[derive(Debug, Clone, PartialEq)]
pub struct RunnerUp {
    pub method: String,
    pub substeps: u32,
    /// As [`Identity::defect`], over the sample of transitions that told it apart.
    pub defect: f64,
}

/// How the winner is like its equivalents.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sameness {
    /// It has none.
    Alone,
    /// They are the same map where this trajectory goes; no data could tell.
    Mathematically,
    /// They differ, but less than the data is rounded.
    TooCoarse,
    /// Rounding explains none of them: the trajectory follows no known scheme, or a step of it is
    /// only nearly solved.
    NothingFits,
}

/// Names the scheme; None where there is nothing to replay: fewer than two rows, three without
/// velocities, rows of another scene, or rows more than 20,000 steps apart. Rows far apart in a large
/// scene are tried in fewer substeps.
pub fn identify(question: &Question) -> Option<Identity> {
    let Question {
        scene,
        system,
        rows,
        ..
    } = *question;
    let replay = Replay::new(scene, system, rows, question.settings)?;
    let used = transition::choose(rows, system, question.transitions);
    let sample = transition::sample(&used, HALF_SAMPLE);
    let probes = transition::probes(&sample);
    let all = bare(&used);
    let sample = bare(&sample);
    let candidates = candidates(scene, system);
    let brief = question.transitions.is_some();
    let first = probes.first()?;
    let candidates = contest::affordable(&replay, candidates, brief, question.hint, first);
    let race = contest::race(&replay, candidates, &probes, &sample, brief);
    let Race { entries, sample } = race;
    let place = |(id, substeps): (&str, u32)| {
        let named =
            |entry: &Entry| entry.candidate.id == id && entry.candidate.substeps == substeps;
        entries.iter().position(named)
    };
    let hint = question.hint.and_then(place);
    // Velocities found from positions are not what was computed with.
    let bits = rows.v.is_some();
    let ranking = judge::rank(&entries, hint, bits)?;
    // Over longer stretches of positions alone, the velocity to start from is too uncertain.
    let ranking = match bits {
        true => stretch::rank(&replay, &entries, ranking, hint),
        false => ranking,
    };
    let comparison = Comparison::new(scene, system, &replay, &sample);
    let decision = Decision {
        replay: &replay,
        comparison: &comparison,
        entries: &entries,
        all: &all,
        hint,
    };
    Some(decision.identity(&ranking))
}

fn bare(weighed: &[Weighed]) -> Vec<Transition> {
    weighed.iter().map(|w| w.transition).collect()
}

/// Every scheme that is known, in the order of preference among equals.
fn candidates(scene: &Scene, system: &ParticleSystem) -> Vec<Candidate> {
    let methods = fixed().iter().flat_map(|method| {
        let substeps = 1..=MOST_SUBSTEPS;
        substeps.map(|n| Candidate::method(system, method, n))
    });
    methods.chain(mistakes(scene, system)).collect()
}

impl Identity {
    /// The identity as reports write it; None if its defect is no number.
    pub fn report(&self) -> Option<Identified> {
        self.defect.is_finite().then(|| {
            let runner_up = self.runner_up.as_ref();
            Identified {
                method: self.method.clone(),
                substeps: self.substeps,
                defect: self.defect,
                runner_up: runner_up.map(RunnerUp::label),
                runner_up_defect: runner_up.map(|r| r.defect).filter(|d| d.is_finite()),
                decisive: self.decisive,
                equivalent: self.equivalent.clone(),
                undecided: match self.same {
                    _ if self.decisive => None,
                    Sameness::Mathematically => Some(Undecided::SameMap),
                    Sameness::Alone | Sameness::TooCoarse => Some(Undecided::DataTooCoarse),
                    Sameness::NothingFits => Some(Undecided::NothingFits),
                },
            }
        })
    }
}

impl RunnerUp {
    /// The method, and after a slash its substeps if there are several.
    pub fn label(&self) -> String {
        candidate::label(&self.method, self.substeps)
    }
}
