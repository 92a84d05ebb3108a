//! The search for a treatment: what is right before what is wrong, few mistakes before more.

use super::super::bounce::{self, Bounce, Row, WAYS, Way};
use super::super::candidate::{Candidate, SOFT_SCHEMES};
use super::search::{Search, Told};
use super::{fitted, numbers};
use crate::integrators;
use crate::measure::identify::MOST_SUBSTEPS;
use crate::physics::constraints::contact::Obstacles;

/// Replays of a transition that a candidate takes, about: most are told in their first.
const REPLAYS: u64 = 6;
/// Schemes that treatments are looked for with; of those that a trajectory cannot tell apart elsewhere, the first.
const SCHEMES: usize = 5;
/// Steps that a treatment misses and are searched as well, and how often.
const MISSED: usize = 4;
const REFINED: usize = 3;
/// Steps of all substeps that soft steps are tried in, of both schemes.
const FINER: u64 = (MOST_SUBSTEPS * (MOST_SUBSTEPS + 1)) as u64;

/// The treatment with the fewest mistakes that explains all steps beside obstacles, and whether all were tried. What a sample
/// leaves out and the first finding misses is searched as well; what explains the sample alone is kept where nothing explains
/// that, too.
pub(super) fn found(
    search: &Search,
    all: &[Candidate],
    obstacles: &Obstacles,
    budget: u64,
) -> (Option<Told>, bool) {
    let (first, whole) = of_sample(search, all, obstacles, budget);
    let mut apart = search.apart.clone();
    let mut told = first.clone();
    for _ in 0..REFINED {
        let missed = told
            .as_ref()
            .map_or_else(Vec::new, |told| search.missed_by(told, MISSED));
        if missed.is_empty() {
            break;
        }
        apart.beside.splice(..0, missed);
        let wider = Search {
            apart: &apart,
            ..*search
        };
        told = of_sample(&wider, all, obstacles, budget).0;
        if told.is_none() {
            return (first, whole);
        }
    }
    (told, whole)
}

/// The treatment with the fewest mistakes, a simpler one first, and the schemes that explain the sampled steps with it; None
/// where none does. And whether all were tried.
fn of_sample(
    search: &Search,
    all: &[Candidate],
    obstacles: &Obstacles,
    budget: u64,
) -> (Option<Told>, bool) {
    let (explicit, implicit): (Vec<_>, Vec<_>) = all.iter().cloned().partition(|c| !c.solves());
    let few = explicit.into_iter().chain(implicit).take(SCHEMES);
    let few: Vec<Candidate> = few.collect();
    let first = search.apart.beside.first();
    let each = few
        .iter()
        .zip(first)
        .map(|(scheme, t)| search.replay.effort(scheme, t));
    let each = each.fold(0, u64::saturating_add).saturating_mul(REPLAYS);
    let affordable = (budget / each.max(1)) as usize;
    let mut bounces = match obstacles.penalty() {
        Some(force) => pressing(force),
        None => bounce::all(obstacles, search.question.rows.timestep),
    };
    // What soft steps keep is found from all rows.
    let finest = few.iter().map(|scheme| scheme.substeps.max(1)).max();
    let soft = search.pass().saturating_mul(u64::from(finest.unwrap_or(1))) <= budget;
    bounces.retain(|bounce| soft || !matches!(bounce.way.does, Way::Soft));
    let mistakes = |most: usize| bounces.partition_point(|b| b.mistakes().count() < most);
    let (right, one, two) = (
        &bounces[..mistakes(1)],
        &bounces[mistakes(1)..mistakes(2)],
        &bounces[mistakes(2)..],
    );
    let whole = affordable >= bounces.len() + fitted::REPLAYS + numbers::REPLAYS;
    let mut told = search.told(&few, &right[..right.len().min(affordable)]);
    let finer = search.pass().saturating_mul(FINER) <= budget;
    if finer && search.apart.mixed && obstacles.penalty().is_none() {
        let soft = right
            .iter()
            .filter(|bounce| matches!(bounce.way.does, Way::Soft));
        let soft: Vec<Bounce> = soft.copied().collect();
        told = told.or_else(|| search.told(&softened(search), &soft));
    }
    if whole {
        told = told
            .or_else(|| fitted::found(search, all))
            .or_else(|| search.told(&few, one))
            .or_else(|| numbers::found(search, &few, obstacles, 1))
            .or_else(|| search.told(&few, two))
            .or_else(|| numbers::found(search, &few, obstacles, 2));
    }
    let told = told.map(|told| {
        let others = search.fitting(all, &told.bounce);
        let own = told.schemes.iter();
        let new = own.filter(|own| others.iter().all(|other| other.label() != own.label()));
        let schemes = others.iter().chain(new).cloned().collect();
        Told { schemes, ..told }
    });
    (told, whole && soft)
}

/// The schemes that have a soft step, in substeps.
fn softened(search: &Search) -> Vec<Candidate> {
    let methods = || SOFT_SCHEMES.iter().filter_map(|id| integrators::find(id));
    let system = search.question.system;
    let all = (2..=MOST_SUBSTEPS)
        .flat_map(|n| methods().map(move |method| Candidate::method(system, method, n)));
    all.collect()
}

/// The treatments of a scene with a penalty.
fn pressing(force: [f64; 2]) -> Vec<Bounce> {
    let is = |row: &&Row<Way>| {
        matches!(
            row.does,
            Way::Event | Way::Never | Way::Force { whole: true, .. }
        )
    };
    let all = WAYS.iter().filter(is).map(|way| match way.does {
        Way::Force { .. } => Bounce {
            force,
            ..Bounce::new(way)
        },
        _ => Bounce::new(way),
    });
    all.collect()
}
