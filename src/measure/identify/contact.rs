//! What a trajectory's program does at contact: of the steps beside obstacles, which treatment explains all to rounding.

mod fitted;
mod numbers;
mod order;
mod search;

use super::Question;
use super::bounce::{Bounce, WAYS, pressed};
use super::candidate::Candidate;
use super::race::{Race, defects_of_all, quantile};
use super::replay::Defect;
use super::result::{Deviation, Explained, Identity, Treated, Undecided};
use super::transition::{Transition, Weighed, beside, choose, spread};
use super::treated::treated;
use crate::integrators;
use crate::physics::System;
use crate::trajectory::Rows;
use search::{Search, Told};

/// Steps beside obstacles that are replayed, at most.
const SAMPLE: usize = 64;
/// Steps away from obstacles that are looked at besides.
const LEFT: usize = 8;
/// With fewer steps away from obstacles than these, all name the scheme.
const FEWEST: usize = 8;
/// Where nearly all steps are beside obstacles, the scheme is looked for among these.
const USUAL: [&str; 5] = [
    "symplectic_euler",
    "velocity_verlet",
    "rk4",
    "explicit_euler",
    "midpoint",
];

/// The steps away from obstacles, or all where these are few, and those beside some.
#[derive(Clone)]
pub(super) struct Apart {
    pub(super) away: Vec<Weighed>,
    /// Whether those are all.
    mixed: bool,
    /// Some of those beside obstacles, the liveliest first.
    pub(super) beside: Vec<Transition>,
    /// All of them.
    met: Vec<Transition>,
    /// How deep a particle is inside, m.
    deepest: f64,
}

/// Parts the steps of a trajectory. Where nothing stands in the way, and of an engine whose contact is known, all are away.
pub(super) fn apart(question: &Question) -> Apart {
    let Question {
        rows,
        system,
        transitions,
        ..
    } = *question;
    let Some(obstacles) = system.obstacles().filter(|_| question.hint.is_none()) else {
        return Apart {
            away: choose(rows, system, transitions),
            mixed: false,
            beside: Vec::new(),
            met: Vec::new(),
            deepest: 0.0,
        };
    };
    let looked_at = question.budget / (8 * obstacles.pairs().count().max(1) as u64);
    let all = choose(rows, system, Some(looked_at as usize));
    let (mut away, mut met, mut deepest) = (Vec::new(), Vec::new(), 0.0_f64);
    for weighed in &all {
        match beside(obstacles, rows, &weighed.transition) {
            Some(depth) => {
                deepest = deepest.max(depth);
                met.push(weighed.transition);
            }
            None => away.push(*weighed),
        }
    }
    let mixed = away.len() < FEWEST;
    if mixed {
        away = all;
    }
    let most = transitions.unwrap_or(usize::MAX);
    Apart {
        away: spread(&away, most),
        mixed,
        beside: liveliest(rows, &met, most.min(SAMPLE)),
        met,
        deepest,
    }
}

/// Of these, half those whose velocities change most, and half evenly spread.
fn liveliest(rows: &Rows, all: &[Transition], most: usize) -> Vec<Transition> {
    let change = |t: &Transition| {
        let [Some(from), Some(to)] = [t.from, t.to].map(|k| rows.v(k)) else {
            return 0.0;
        };
        let changes = from.iter().zip(to).map(|(a, b)| (b - a).abs());
        changes.fold(0.0, f64::max)
    };
    let mut lively = all.to_vec();
    lively.sort_by(|a, b| change(b).total_cmp(&change(a)));
    lively.truncate(most.div_ceil(2));
    let even = spread(all, most / 2);
    let even: Vec<Transition> = even.into_iter().filter(|t| !lively.contains(t)).collect();
    lively.into_iter().chain(even).collect()
}

/// Adds what is known of contact to an identity that was found away from obstacles, and narrows its equals.
pub(super) fn told(
    question: &Question,
    race: &Race,
    apart: &Apart,
    identity: Identity,
) -> Identity {
    let (Some(obstacles), false) = (question.system.obstacles(), apart.beside.is_empty()) else {
        return identity;
    };
    let unjudged = |says: &str| {
        Some(Treated {
            unjudged: true,
            says: says.to_owned(),
            deepest_m: apart.deepest,
            steps: apart.beside.len(),
            ..Treated::default()
        })
    };
    if question.rows.v.is_none() {
        // Across an impact positions do not tell a velocity.
        let contact = unjudged("positions alone do not tell what it does at contact");
        return Identity {
            contact,
            ..identity
        };
    }
    let named = |candidate: &Candidate| {
        let own = (&candidate.id, candidate.substeps) == (&identity.method, identity.substeps);
        match own {
            true => candidate.says == identity.says,
            false => identity.equivalent.contains(&candidate.label()) && !candidate.mistake,
        }
    };
    let all = race.entries.iter().map(|entry| &entry.candidate);
    let mut schemes: Vec<Candidate> = all.filter(|c| named(c)).cloned().collect();
    schemes.sort_by_key(|scheme| scheme.id != identity.method);
    schemes.dedup_by_key(|scheme| scheme.label());
    // Steps away from obstacles that leave the scheme may be beside those of the program.
    let leaves = identity.followed < identity.transitions && !apart.mixed;
    let more = match schemes.first().filter(|_| leaves) {
        Some(scheme) => left(race, scheme, &apart.away),
        None => Vec::new(),
    };
    let apart = Apart {
        met: apart.met.iter().chain(&more).copied().collect(),
        ..apart.clone()
    };
    let search = Search {
        question,
        replay: race.replay,
        apart: &apart,
    };
    let fits = |way| !search.fitting(&schemes, &Bounce::new(way)).is_empty();
    // Nothing was touched where contact makes no difference.
    let touched = !fits(&WAYS[0]) || !WAYS.last().is_none_or(fits);
    if !touched && more.is_empty() {
        return identity;
    }
    let budget = race.budget.max(question.budget / 4);
    let (found, whole) = order::found(&search, &schemes, obstacles, budget);
    let right = |told: &Told| told.bounce.mistakes().next().is_none();
    if !touched && found.as_ref().is_none_or(right) {
        return identity;
    }
    if found.is_none() && !whole {
        let own = identity.left_out.iter().cloned();
        return Identity {
            left_out: own.chain(["treatments of contact".to_owned()]).collect(),
            contact: unjudged("what it does at contact would take too long to find"),
            ..identity
        };
    }
    let contact = Some(search.treated(found.as_ref()));
    let Some(found) = found else {
        return Identity {
            contact,
            ..identity
        };
    };
    let labels: Vec<String> = found.schemes.iter().map(Candidate::label).collect();
    let own = labels.contains(&identity.label());
    let first = found.schemes.first().filter(|_| !own);
    let renamed = first.map_or_else(
        || identity.clone(),
        |first| Identity {
            method: first.id.clone(),
            substeps: first.substeps,
            says: first.says.clone(),
            ..identity.clone()
        },
    );
    let equivalent = identity.equivalent.iter();
    let equivalent = equivalent.filter(|id| labels.contains(id) && **id != renamed.label());
    let equivalent: Vec<String> = equivalent.cloned().collect();
    Identity {
        mistake: identity.mistake || found.bounce.mistakes().next().is_some(),
        undecided: identity.undecided.filter(|_| !equivalent.is_empty()),
        equivalent,
        contact,
        ..renamed
    }
}

/// A few of these steps that a scheme does not explain.
fn left(race: &Race, scheme: &Candidate, away: &[Weighed]) -> Vec<Transition> {
    let all: Vec<Transition> = away.iter().map(|w| w.transition).collect();
    let defects = defects_of_all(race.replay, scheme, &all);
    let left = all.iter().zip(defects).filter(|(_, defect)| !defect.fits());
    left.map(|(t, _)| *t).take(LEFT).collect()
}

/// The identity of rows beside obstacles nearly throughout, which name a scheme and a treatment together.
pub(super) fn together(question: &Question, race: &Race, apart: &Apart) -> Option<Identity> {
    let told = apart.mixed && question.rows.v.is_some();
    let obstacles = question.system.obstacles().filter(|_| told)?;
    let search = Search {
        question,
        replay: race.replay,
        apart,
    };
    let schemes: Vec<Candidate> = usual(question).chain(treated(question.system)).collect();
    let budget = race.budget.max(question.budget / 4);
    let found = order::found(&search, &schemes, obstacles, budget).0?;
    let all: Vec<Transition> = apart.away.iter().map(|w| w.transition).collect();
    let defects = |scheme: &Candidate| {
        let candidate = search.bouncing(scheme, &found.bounce)?;
        let all = search.known(&candidate, &all);
        let defects = defects_of_all(race.replay, &candidate, &all);
        defects.iter().all(Defect::fits).then_some(defects)
    };
    let follow: Vec<(&Candidate, Vec<Defect>)> = (found.schemes.iter())
        .filter_map(|scheme| Some((scheme, defects(scheme)?)))
        .collect();
    let (first, defects) = follow.first()?;
    Some(Identity {
        defect: quantile(defects, 1.0),
        equivalent: follow.iter().skip(1).map(|(c, _)| c.label()).collect(),
        undecided: (follow.len() > 1).then_some(Undecided::DataTooCoarse),
        transitions: all.len(),
        followed: all.len(),
        mistake: found.bounce.mistakes().next().is_some(),
        contact: Some(search.treated(Some(&found))),
        ..Identity::of(first)
    })
}

fn usual(question: &Question) -> impl Iterator<Item = Candidate> {
    let system = question.system;
    let usual = USUAL.iter().filter_map(|id| integrators::find(id));
    let usual = usual.filter(|method| method.is_its_own(system.kinds()));
    usual.map(|method| Candidate::method(system, method, 1))
}

/// Schemes that differ in their treatment of dampers where these are those of a penalty.
pub(super) fn damped(question: &Question, bounce: &Bounce) -> Vec<Candidate> {
    let pressed = pressed(question.scene, question.system, bounce);
    pressed.map_or_else(Vec::new, |pressed| treated(&pressed))
}

/// The mistakes of a treatment, as what the trajectory deviates in.
pub(super) fn explained(identity: &Identity) -> Option<Explained> {
    let contact = identity.contact.as_ref()?;
    (!contact.mistakes.is_empty()).then(|| Explained {
        scheme: Some(identity.label()),
        residual: identity.defect,
        largest_at: None,
        deviations: vec![Deviation {
            what: "contact".to_owned(),
            factor: 1.0,
            place: None,
            sentence: format!("at contact it {}", contact.says),
        }],
        equivalent: identity.equivalent.clone(),
    })
}
