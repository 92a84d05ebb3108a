//! What a trajectory's program does at contact: of the steps beside obstacles, which treatment explains all to rounding.

mod fitted;

use super::Question;
use super::bounce::{self, Bounce, PLACES, Row, WAYS, Way, pressed};
use super::candidate::Candidate;
use super::race::{Race, defects_of_all, quantile};
use super::replay::{Defect, Replay};
use super::result::{Deviation, Explained, Identity, Treated, Undecided};
use super::transition::{Transition, Weighed, beside, choose, spread};
use super::treated::treated;
use crate::integrators;
use crate::physics::System;
use crate::physics::constraints::contact::Obstacles;
use crate::trajectory::Rows;
use rayon::prelude::*;

/// Steps beside obstacles that are replayed, at most.
const SAMPLE: usize = 64;
/// With fewer steps away from obstacles than these, all name the scheme.
const FEWEST: usize = 8;
/// Replays of a transition that a candidate takes, about: most are told in their first.
const REPLAYS: u64 = 6;
/// Where nearly all steps are beside obstacles, the scheme is looked for among these.
const USUAL: [&str; 4] = [
    "symplectic_euler",
    "velocity_verlet",
    "rk4",
    "explicit_euler",
];
/// Schemes that treatments are looked for with; of those that a trajectory cannot tell apart elsewhere, the first.
const SCHEMES: usize = 4;

/// The steps away from obstacles, or all where these are few, and those beside some.
pub(super) struct Apart {
    pub(super) away: Vec<Weighed>,
    /// Whether those are all.
    mixed: bool,
    /// The liveliest first.
    pub(super) beside: Vec<Transition>,
    /// How deep a particle is inside, m.
    deepest: f64,
}

/// Parts the steps of a trajectory. Where nothing stands in the way, of an engine whose contact is known, and without
/// velocities, which positions do not tell across an impact, all are away.
pub(super) fn apart(question: &Question) -> Apart {
    let Question {
        rows,
        system,
        transitions,
        ..
    } = *question;
    let told = question.hint.is_none() && rows.v.is_some();
    // A penalty is a force as any other.
    let impulses = |all: &&Obstacles| told && all.penalty().is_none();
    let Some(obstacles) = system.obstacles().filter(impulses) else {
        return Apart {
            away: choose(rows, system, transitions),
            mixed: false,
            beside: Vec::new(),
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

/// What is replayed to find a treatment.
struct Search<'a> {
    question: &'a Question<'a>,
    replay: &'a Replay<'a>,
    apart: &'a Apart,
}

/// The schemes, of those that are no others away from obstacles, that a treatment explains all steps beside them with.
struct Told {
    bounce: Bounce,
    schemes: Vec<Candidate>,
}

impl Search<'_> {
    fn fits(&self, candidate: &Candidate) -> bool {
        let mut replayer = candidate.replayer(&self.replay.settings);
        let mut all = self.apart.beside.iter();
        all.all(|t| self.replay.defect(&mut replayer, t).fits())
    }

    /// The schemes that fit with this treatment.
    fn fitting(&self, schemes: &[Candidate], bounce: &Bounce) -> Vec<Candidate> {
        let Question { scene, system, .. } = self.question;
        let with = |scheme: &&Candidate| {
            let candidate = scheme.bouncing(scene, system, bounce);
            candidate.is_some_and(|candidate| self.fits(&candidate))
        };
        schemes.iter().filter(with).cloned().collect()
    }

    fn told(&self, schemes: &[Candidate], bounces: &[Bounce]) -> Option<Told> {
        bounces.par_iter().find_map_first(|bounce| {
            let schemes = self.fitting(schemes, bounce);
            (!schemes.is_empty()).then_some(Told {
                bounce: *bounce,
                schemes,
            })
        })
    }

    /// The treatment with the fewest mistakes, a simpler one first, and the schemes that explain all steps with it; None
    /// where none does. And whether all were tried.
    fn search(
        &self,
        all: &[Candidate],
        obstacles: &Obstacles,
        budget: u64,
    ) -> (Option<Told>, bool) {
        let (explicit, implicit): (Vec<_>, Vec<_>) = all.iter().cloned().partition(|c| !c.solves());
        let few = explicit.into_iter().chain(implicit).take(SCHEMES);
        let few: Vec<Candidate> = few.collect();
        let first = self.apart.beside.first();
        let each = few
            .iter()
            .zip(first)
            .map(|(scheme, t)| self.replay.effort(scheme, t));
        let each = each.fold(0, u64::saturating_add).saturating_mul(REPLAYS);
        let affordable = (budget / each.max(1)) as usize;
        let bounces = bounce::all(obstacles, self.question.rows.timestep);
        let (right, wrong) =
            bounces.split_at(bounces.partition_point(|b| b.mistakes().next().is_none()));
        let whole = affordable >= bounces.len() + fitted::REPLAYS;
        let mut told = self.told(&few, &right[..right.len().min(affordable)]);
        if whole {
            told = told
                .or_else(|| fitted::found(self, all))
                .or_else(|| self.told(&few, wrong));
        }
        let told = told.map(|told| {
            let others = self.fitting(all, &told.bounce);
            let own = told.schemes.iter();
            let new = own.filter(|own| others.iter().all(|other| other.label() != own.label()));
            let schemes = others.iter().chain(new).cloned().collect();
            Told { schemes, ..told }
        });
        (told, whole)
    }

    /// What is said of contact.
    fn treated(&self, told: Option<&Told>) -> Treated {
        let force = told.map(|told| told.bounce.force);
        let force = force.filter(|[stiffness, _]| *stiffness != 0.0);
        let says = "no known treatment explains";
        Treated {
            treatment: told.map(|told| told.bounce.label()),
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

    /// The other ways and places that explain all steps too.
    fn equivalent(&self, told: &Told) -> Vec<String> {
        let alike = |way: &&Row<Way>| match told.bounce.way.does {
            Way::Force { .. } => matches!(way.does, Way::Force { .. }),
            Way::Event | Way::Once(_) => matches!(way.does, Way::Event | Way::Once(_)),
            Way::Never => false,
        };
        let others = WAYS.iter().filter(alike).flat_map(|way| {
            let places = PLACES.iter().map(|place| Bounce {
                way,
                place,
                ..told.bounce
            });
            places.filter(Bounce::is_sensible)
        });
        let others = others.filter(|other| *other != told.bounce);
        let fitting = others.filter(|other| !self.fitting(&told.schemes, other).is_empty());
        fitting.map(|other| other.label()).collect()
    }
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
    let search = Search {
        question,
        replay: race.replay,
        apart,
    };
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
    let right = Bounce::new(&WAYS[0]);
    let free = Bounce::new(&WAYS[WAYS.len() - 1]);
    if !search.fitting(&schemes, &right).is_empty() && !search.fitting(&schemes, &free).is_empty() {
        // Nothing was touched.
        return identity;
    }
    let budget = race.budget.max(question.budget / 4);
    let (found, whole) = search.search(&schemes, obstacles, budget);
    if found.is_none() && !whole {
        let own = identity.left_out.iter().cloned();
        return Identity {
            left_out: own.chain(["treatments of contact".to_owned()]).collect(),
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

/// The identity of rows beside obstacles nearly throughout, which name a scheme and a treatment together.
pub(super) fn together(question: &Question, race: &Race, apart: &Apart) -> Option<Identity> {
    let obstacles = question.system.obstacles().filter(|_| apart.mixed)?;
    let search = Search {
        question,
        replay: race.replay,
        apart,
    };
    let usual = USUAL.iter().filter_map(|id| integrators::find(id));
    let usual = usual.filter(|method| method.is_its_own(question.system.kinds()));
    let usual = usual.map(|method| Candidate::method(question.system, method, 1));
    let schemes: Vec<Candidate> = usual.chain(treated(question.system)).collect();
    let budget = race.budget.max(question.budget / 4);
    let found = search.search(&schemes, obstacles, budget).0?;
    let Question { scene, system, .. } = question;
    let all: Vec<Transition> = apart.away.iter().map(|w| w.transition).collect();
    let defects = |scheme: &Candidate| {
        let candidate = scheme.bouncing(scene, system, &found.bounce)?;
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
