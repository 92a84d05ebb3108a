//! Trajectories that follow no known scheme: near one, or explained by the fewest numbers that a program
//! has wrong.

use super::candidate::Candidate;
use super::channels::{self, Channel};
use super::compose::composed;
use super::fit::{Base, Fit, Model, Slope};
use super::mistakes::{self, MISTAKES, Mistake, Wrong};
use super::near;
use super::race::{Race, defects_of_all};
use super::replay::FIT;
use super::result::{Deviation, Explained, Treated};
use super::rods::restabilised;
use super::transition::{Transition, spread};
use super::treated::treated;
use super::{Found, Identity, Question};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Transitions that factors are fitted to.
const FITTED: usize = 8;
/// Directions in which their units are measured.
const NUDGES: u64 = 4;
/// Most numbers that are wrong at once.
const MOST: usize = 3;
/// Of the sets of several channels, so many are fitted that the linear model finds best.
const TRIED: usize = 4;
/// Fits that are kept while they grow.
const GROWN: usize = 2;
/// Methods under whose forces a mistake and a wrong number are looked for together.
const USUAL: [&str; 6] = [
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "velocity_verlet",
    "velocity_verlet_predicted_velocity",
    "rk4",
];
/// Substeps that are looked in.
const FINER: u32 = 5;
/// Particles that are suspected where one is wrong, or one spring.
const SUSPECTS: usize = 2;
/// Of the difference, a factor has to explain more than is left here by the linear model.
const PROMISING: f64 = 0.9;
/// Deviations that do not reach rounding have to leave at most this part.
const LEFT: f64 = 0.05;

/// Why a trajectory follows none of the candidates of a race: what it deviates in, or what it is near.
pub(super) fn of_none(question: &Question, race: &Race, all: &[Transition]) -> Found {
    if question.hint.is_some() {
        // An engine whose scheme is known is held to that alone.
        let own: Vec<Candidate> = super::expected(question).into_iter().collect();
        return near::nearest(question, race, all, &own).unwrap_or_else(|| unexplained(race, all));
    }
    let fitted = fitted(question, race);
    let plain = Candidate::plain(question.system, 1)
        .chain(restabilised(question.scene, question.system, 1))
        .filter(|c| race.tried(&c.id));
    let near = || near::nearest(question, race, all, &plain.collect::<Vec<_>>());
    match fitted {
        Some(exact) if exact.is_exact() => exact.found(race, all),
        rough => near()
            .or_else(|| rough.map(|fit| fit.found(race, all).unnamed()))
            .unwrap_or_else(|| unexplained(race, all)),
    }
}

/// Numbers that a person would write and that explain all, where a treatment of contact does so with a number that nobody
/// would: along a surface the data cannot tell one from the other.
pub(super) fn sooner(
    question: &Question,
    race: &Race,
    all: &[Transition],
    treated: &Treated,
) -> Option<Found> {
    let odd = treated.bounce.is_some_and(|bounce| !bounce.own.is_plain());
    let fitted = odd.then(|| fitted(question, race)).flatten();
    let exact = fitted.filter(|fit| fit.is_exact() && fit.plain)?;
    let other = format!("a program that at contact {}", treated.says);
    Some(exact.or(&[other]).found(race, all))
}

impl Found {
    /// What lowers the difference most, where rounding does not explain what is left: it explains nothing.
    fn unnamed(mut self) -> Self {
        if let Some(explained) = &mut self.explained
            && let Some(scheme) = explained.scheme.take()
            && let Some(first) = explained.deviations.first_mut()
        {
            first.sentence = format!("under {scheme} {}", first.sentence);
        }
        self
    }
}

/// The deviations that a known mistake is.
pub(super) fn of_mistake(scene: &Scene, identity: &Identity) -> Option<Explained> {
    let row = mistakes::mistake(&identity.method).filter(|_| identity.mistake)?;
    let scheme = identity.method.split_once('(');
    Some(Explained {
        scheme: scheme.map(|(_, method)| method.strip_suffix(')').unwrap_or(method).to_owned()),
        residual: identity.defect,
        largest_at: None,
        deviations: deviations_of(scene, row, identity.says.as_deref()),
        equivalent: identity.equivalent.clone(),
    })
}

/// What a known mistake changes in this scene.
fn deviations_of(scene: &Scene, row: &Mistake, says: Option<&str>) -> Vec<Deviation> {
    let deviation = |(what, factor): &(&str, f64)| Deviation {
        what: (*what).to_owned(),
        factor: *factor,
        place: None,
        sentence: says.unwrap_or(row.says).to_owned(),
    };
    let there = row.deviates.iter();
    let there = there.filter(|(what, _)| channels::has(scene, what));
    there.map(deviation).collect()
}

/// The scheme of rows that no scheme can be told from, since each follows from the one before without any error.
pub const TRUTH: &str = "truth";

/// Steps without an error, which name no scheme.
pub(super) fn of_truth(identity: &Identity) -> Found {
    Found {
        identity: None,
        explained: Some(Explained {
            scheme: Some(TRUTH.to_owned()),
            residual: identity.defect,
            largest_at: None,
            deviations: Vec::new(),
            equivalent: Vec::new(),
        }),
    }
}

fn unexplained(race: &Race, all: &[Transition]) -> Found {
    let nearest = race
        .entries
        .iter()
        .map(|e| e.quantile(0.5))
        .fold(f64::INFINITY, f64::min);
    let step = all.first().map(|t| race.replay.rows.steps[t.from]);
    let explained = Explained {
        scheme: None,
        residual: nearest,
        largest_at: step,
        deviations: Vec::new(),
        equivalent: Vec::new(),
    };
    Found {
        identity: None,
        explained: nearest.is_finite().then_some(explained),
    }
}

/// Schemes to look in.
struct Group {
    bases: Vec<Base>,
    /// How many numbers may be wrong.
    sizes: RangeInclusive<usize>,
    /// Whether single springs and particles are looked at before several numbers are.
    members: bool,
}

/// The simplest schemes first: explicit methods, the same under forces that are a known mistake, implicit ones,
/// composed ones and substeps.
fn groups(question: &Question, race: &Race) -> Vec<Group> {
    let (scene, system) = (question.scene, question.system);
    let own = |scheme| Base {
        scheme,
        mistake: None,
    };
    let plain = |n: u32| Candidate::plain(system, n);
    let (implicit, explicit): (Vec<_>, Vec<_>) = (plain(1)
        .chain(treated(system))
        .chain(restabilised(scene, system, 1)))
    .partition(Candidate::solves);
    let finer = (2..=FINER).flat_map(plain).filter(|c| !c.solves());
    let composed = composed(scene, system).into_iter().filter(|c| !c.solves());
    let usual = |c: &&Candidate| USUAL.contains(&c.id.as_str());
    let mut wrong = Vec::new();
    for mistake in MISTAKES {
        // Numbers that a mistake multiplies are channels themselves.
        if let (Wrong::Physics(_), Some(system)) = (&mistake.wrong, mistake.forces(scene)) {
            wrong.extend(explicit.iter().filter(usual).map(|scheme| Base {
                scheme: scheme.under(&system),
                mistake: Some(mistake),
            }));
        }
    }
    // A race that finds nothing may have spent nearly all.
    let mut left = race.budget.max(question.budget / 2);
    let mut group = |mut bases: Vec<Base>, sizes: RangeInclusive<usize>, members| {
        // About so many replays of each fitted transition.
        let replays = if members { 340 } else { 60 };
        bases.retain(|base| {
            let first = race.sample.first();
            let each = first.map_or(0, |t| race.replay.effort(&base.scheme, t));
            let effort = each.saturating_mul(replays * FITTED as u64);
            let holds = effort <= left;
            left -= if holds { effort } else { 0 };
            holds
        });
        Group {
            bases,
            sizes,
            members,
        }
    };
    let explicit: Vec<Base> = explicit.into_iter().map(own).collect();
    vec![
        group(explicit.clone(), 1..=1, false),
        group(explicit, 2..=MOST, true),
        group(wrong, 1..=1, false),
        group(implicit.into_iter().map(own).collect(), 1..=2, false),
        group(composed.chain(finer).map(own).collect(), 1..=1, false),
    ]
}

/// A scheme with what deviates under it.
struct Explanation {
    candidate: Candidate,
    deviations: Vec<Deviation>,
    /// Largest difference left, in units.
    worst: f64,
    /// What is left of the typical difference, as a part.
    left: f64,
    /// Whether its numbers are such as a person would have written.
    plain: bool,
    /// How many numbers were fitted.
    numbers: usize,
    /// Other schemes that explain as well with such numbers.
    equivalent: Vec<String>,
}

impl Explanation {
    fn new(model: &Model, fit: Fit) -> Self {
        let (scene, h) = (model.scene, model.replay.rows.timestep);
        let known = model
            .base
            .mistake
            .map(|row| deviations_of(scene, row, None));
        let (gravity, own): (Vec<_>, Vec<_>) =
            fit.factors.iter().partition(|(c, _)| c.is_component());
        let own = own.iter().map(|(c, factor)| c.deviation(scene, h, *factor));
        let vector = (!gravity.is_empty()).then(|| channels::gravity(scene, &gravity));
        let fitted = own.chain(vector.flatten());
        Self {
            plain: fit.plain,
            numbers: fit.numbers,
            equivalent: Vec::new(),
            deviations: known.into_iter().flatten().chain(fitted).collect(),
            worst: fit.residuals.amax(),
            left: fit.residuals.norm() / model.residuals.norm(),
            candidate: fit.candidate,
        }
    }

    fn is_exact(&self) -> bool {
        self.worst <= FIT
    }

    fn found(self, race: &Race, all: &[Transition]) -> Found {
        let defects = defects_of_all(race.replay, &self.candidate, all);
        let left = near::left(race, all, &self.candidate, &defects, self.deviations);
        let equivalent = self.equivalent;
        Found {
            identity: None,
            explained: left.map(|explained| Explained {
                equivalent,
                ..explained
            }),
        }
    }

    fn sentence(&self) -> String {
        let says = self.deviations.iter().map(|d| d.sentence.as_str());
        says.collect::<Vec<_>>().join(" and ")
    }

    /// The same, with what the data cannot tell from it.
    fn or(mut self, others: &[String]) -> Self {
        if let (Some(last), false) = (self.deviations.last_mut(), others.is_empty()) {
            let others = others.join(", or ");
            last.sentence = format!("{} (the data cannot tell it from: {others})", last.sentence);
        }
        self
    }
}

/// The fewest deviations that reach rounding; where none do, the best single one.
fn fitted(question: &Question, race: &Race) -> Option<Explanation> {
    let whole = channels::of_scene(question.scene);
    let mut best: Option<Explanation> = None;
    for group in groups(question, race) {
        let sloped = |base| {
            let model = model(question, race, base)?;
            let slopes = model.slopes(&whole)?;
            Some((model, slopes))
        };
        let bases = group.bases.into_par_iter();
        let models: Vec<(Model, Vec<Slope>)> = bases.filter_map(sloped).collect();
        if group.members {
            let single = models.par_iter().map(|(model, _)| of_one_member(model));
            let single: Vec<Vec<Explanation>> = single.collect();
            if let Some(best) = best_of(question.scene, single.into_iter().flatten()) {
                return Some(best);
            }
        }
        for size in group.sizes {
            let fits = models
                .par_iter()
                .map(|(model, slopes)| explanations(model, slopes, size));
            let (exact, rough): (Vec<_>, Vec<_>) = (fits.flatten())
                .collect::<Vec<_>>()
                .into_iter()
                .partition(Explanation::is_exact);
            if let Some(best) = best_of(question.scene, exact) {
                return Some(best);
            }
            let rough = rough.into_iter().filter(|fit| fit.deviations.len() == 1);
            let all = best.into_iter().chain(rough);
            best = all.min_by(|a, b| a.left.total_cmp(&b.left));
        }
    }
    // What is only near the truth is near no scheme.
    best.filter(|fit| fit.left <= LEFT && near::is_near(question, race, &fit.candidate))
}

/// The first of several that explain equally well, one of plain numbers and of the scene's own method if there is any,
/// with the others beside it.
fn best_of(scene: &Scene, exact: impl IntoIterator<Item = Explanation>) -> Option<Explanation> {
    let mut exact: Vec<Explanation> = exact.into_iter().collect();
    // Gravity of another direction is three numbers, which one is before.
    let rank = |explanation: &Explanation| (!explanation.plain, explanation.numbers);
    exact.sort_by_key(|e| (rank(e), e.candidate.id != scene.solver.method));
    let mut exact = exact.into_iter();
    let mut first = exact.next()?;
    let best = rank(&first);
    let mut others = Vec::new();
    for other in exact.take_while(|other| rank(other) == best) {
        let (scheme, own) = (other.candidate.label(), first.candidate.label());
        if scheme == own {
            others.push(other.sentence());
        } else if !first.equivalent.contains(&scheme) {
            first.equivalent.push(scheme);
        }
    }
    Some(first.or(&others))
}

/// What a scheme leaves at a few transitions.
fn model<'a>(question: &Question<'a>, race: &Race<'a>, base: Base) -> Option<Model<'a>> {
    let replay = race.replay;
    let at = spread(race.sample, FITTED);
    let mut replayer = base.scheme.replayer(&replay.settings);
    let units = |t: &Transition| {
        let predicted = replay.predict(&mut replayer, t).ok()?;
        let units = replay.units(&mut replayer, t, &predicted, NUDGES).ok()?;
        Some((*t, units))
    };
    let with_units: Vec<_> = at.iter().map(units).collect::<Option<_>>()?;
    let arrive = move |candidate: &Candidate| {
        let mut replayer = candidate.replayer(&replay.settings);
        let states = at.iter().map(|t| replay.predict(&mut replayer, t).ok());
        states.collect()
    };
    Model::new(question.scene, replay, base, with_units, Box::new(arrive))
}

/// Fits with this many factors, in the order of preference: all of one, the most promising of several.
fn explanations(model: &Model, slopes: &[Slope], size: usize) -> Vec<Explanation> {
    let switches = |set: &[&Slope]| set.iter().any(|slope| slope.channel.switches());
    // The components of gravity are one vector.
    let (gravity, own): (Vec<&Slope>, Vec<&Slope>) = slopes
        .iter()
        .partition(|slope| slope.channel.is_component());
    let sets = sets(own.len(), size).into_iter();
    let sets = sets.map(|set| set.into_iter().map(|k| own[k]).collect::<Vec<_>>());
    let sets = sets.chain((size == 1 && !gravity.is_empty()).then_some(gravity));
    let alone = sets.filter(|set| size == 1 || !switches(set));
    let sized = alone
        .filter_map(|set| Some((model.predicted(&set)?, set)))
        .enumerate();
    // Only a number that matters is worth a fit.
    let promising = PROMISING * model.residuals.norm();
    let worth = |(_, (left, set)): &(_, (f64, Vec<&Slope>))| *left <= promising || switches(set);
    let mut sets: Vec<_> = sized.filter(worth).collect();
    if size > 1 {
        sets.sort_by(|(_, a), (_, b)| a.0.total_cmp(&b.0));
        sets.truncate(TRIED);
        // The scene's effects come before mass, step and velocity.
        sets.sort_by_key(|(place, _)| *place);
    }
    let fits = sets.iter().filter_map(|(_, (_, set))| model.fit(set));
    let fits: Vec<Fit> = fits.collect();
    let exact = |fits: &[Fit]| fits.iter().any(|fit| fit.residuals.amax() <= FIT);
    let fits = match size {
        1 => fits,
        _ if exact(&fits) => fits,
        _ => grown(model, &own, size),
    };
    let fits = fits.into_iter();
    fits.map(|fit| Explanation::new(model, fit)).collect()
}

/// Fits that grow by one factor at a time from the best single ones: what a factor far from 1 does is not linear.
fn grown(model: &Model, slopes: &[&Slope], size: usize) -> Vec<Fit> {
    let slopes = slopes.iter().filter(|slope| !slope.channel.switches());
    let channels: Vec<Channel> = slopes.clone().map(|slope| slope.channel).collect();
    let nearest = |mut fits: Vec<Fit>| {
        fits.sort_by(|a, b| a.residuals.norm().total_cmp(&b.residuals.norm()));
        fits.truncate(GROWN);
        fits
    };
    let mut singles: Vec<_> = slopes
        .filter_map(|slope| Some((model.predicted(&[slope])?, slope)))
        .collect();
    singles.sort_by(|a, b| a.0.total_cmp(&b.0));
    singles.truncate(TRIED);
    let fits = singles.iter().filter_map(|(_, slope)| model.fit(&[slope]));
    let mut fits = nearest(fits.collect());
    for _ in 1..size {
        let larger = fits
            .iter()
            .flat_map(|fit| model.grown(fit, &channels, GROWN));
        fits = nearest(larger.collect());
    }
    fits
}

/// The fits of one spring, hinge or particle, of those where the scheme is off most.
fn of_one_member(model: &Model) -> Vec<Explanation> {
    let scene = model.scene;
    let mut off = vec![0.0_f64; scene.particles.len()];
    for (i, residual) in model.residuals.iter().enumerate() {
        let particle = i / 3 % off.len();
        off[particle] = off[particle].max(residual.abs());
    }
    let mut particles: Vec<usize> = (0..off.len()).collect();
    particles.sort_by(|&a, &b| off[b].total_cmp(&off[a]));
    particles.truncate(SUSPECTS);
    let springs = channels::of_springs(channels::springs_at(scene, &particles));
    let members = springs
        .chain(channels::of_hinges(scene, &particles))
        .chain(channels::of_particles(scene, &particles));
    let members: Vec<Channel> = members.filter(|channel| channel.is_in(scene)).collect();
    let slopes = model.slopes(&members).unwrap_or_default();
    let fits = explanations(model, &slopes, 1).into_iter();
    fits.filter(Explanation::is_exact).collect()
}

/// All sets of this many of `n` places, in order.
fn sets(n: usize, size: usize) -> Vec<Vec<usize>> {
    if size == 0 {
        return vec![Vec::new()];
    }
    let smaller = sets(n, size - 1).into_iter();
    let grown = smaller.flat_map(|set| {
        let next = set.last().map_or(0, |last| last + 1);
        (next..n).map(move |k| [set.clone(), vec![k]].concat())
    });
    grown.collect()
}
