//! Trajectories that follow no known scheme: near one, or explained by the fewest numbers that a program
//! has wrong, fitted through one-step replays.

use super::candidate::Candidate;
use super::channels::{self, Channel};
use super::compose::{composed, treated};
use super::mistakes::{self, MISTAKES, Mistake, Wrong};
use super::race::{Race, defects_of_all, quantile};
use super::replay::{FIT, Replay};
use super::result::{Deviation, Explained, Undecided};
use super::transition::{Transition, spread};
use super::{Found, Identity, Question, median, median_relative};
use crate::integrators;
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

/// Transitions that factors are fitted to.
const FITTED: usize = 8;
/// Most numbers that are wrong at once.
const MOST: usize = 3;
/// Of the sets of several channels, so many are fitted that the linear model finds best.
const TRIED: usize = 4;
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
/// Most Gauss-Newton steps.
const STEPS: usize = 12;
/// A step that leaves more than this part of the difference is slow.
const SLOW: f64 = 0.5;
/// Most times that one of them is halved.
const HALVINGS: usize = 3;
/// Directions in which a fit's units are measured.
const NUDGES: u64 = 4;
/// A trajectory is near a scheme whose steps it misses by this part of the scheme's own error. What is only
/// near the truth is near no scheme.
const NEAR: f64 = 0.02;
/// Where the truth of a step is not known, it has to be this small a part of what the step moves.
const SMALL: f64 = 1e-3;
/// Deviations that do not reach rounding have to leave at most this part.
const LEFT: f64 = 0.05;

/// Why a trajectory follows none of the candidates of a race: what it deviates in, or what it is near.
pub(super) fn of_none(question: &Question, race: &Race, all: &[Transition]) -> Found {
    if question.hint.is_some() {
        // An engine whose scheme is known is held to that alone.
        let own: Vec<Candidate> = super::expected(question).into_iter().collect();
        return near(question, race, all, &own).unwrap_or_else(|| unexplained(race, all));
    }
    let fitted = fitted(question, race);
    if let Some(exact) = fitted.as_ref().filter(|fit| fit.worst <= FIT) {
        return exact.found(race, all);
    }
    let plain = Candidate::plain(question.system, 1).filter(|c| race.tried(&c.id));
    let plain: Vec<Candidate> = plain.collect();
    near(question, race, all, &plain)
        .or_else(|| fitted.map(|fit| fit.found(race, all)))
        .unwrap_or_else(|| unexplained(race, all))
}

/// The deviations that a known mistake is.
pub(super) fn of_mistake(scene: &Scene, identity: &Identity) -> Option<Explained> {
    let row = mistakes::mistake(&identity.method).filter(|_| identity.mistake)?;
    let scheme = identity.method.split_once('(');
    Some(Explained {
        scheme: scheme.map(|(_, method)| method.trim_end_matches(')').to_owned()),
        residual: identity.defect,
        largest_at: None,
        deviations: deviations_of(scene, row),
    })
}

/// What a known mistake changes in this scene.
fn deviations_of(scene: &Scene, row: &Mistake) -> Vec<Deviation> {
    let deviation = |(what, factor): &(&str, f64)| Deviation {
        what: (*what).to_owned(),
        factor: *factor,
        place: None,
        sentence: row.says.to_owned(),
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
    };
    Found {
        identity: None,
        explained: nearest.is_finite().then_some(explained),
    }
}

/// A scheme that deviations are looked for in.
#[derive(Clone)]
struct Base {
    scheme: Candidate,
    /// What its forces are, where they are not the scene's own.
    mistake: Option<&'static Mistake>,
}

/// The forces of a scene, as a program computes them that makes this mistake.
fn forces(scene: &Scene, mistake: Option<&Mistake>) -> Option<ParticleSystem> {
    match mistake {
        Some(mistake) => mistake.forces(scene),
        None => Some(ParticleSystem::new(scene)),
    }
}

/// Schemes to look in, in turn: of each group all sets of up to so many channels.
struct Group {
    bases: Vec<Base>,
    most: usize,
    /// Whether single springs and particles are looked at.
    members: bool,
}

/// The simplest schemes first: explicit methods, implicit ones, composed ones and substeps, and methods under
/// forces that are a known mistake.
fn groups(question: &Question, race: &Race) -> Vec<Group> {
    let (scene, system) = (question.scene, question.system);
    let own = |scheme| Base {
        scheme,
        mistake: None,
    };
    let plain = |n: u32| Candidate::plain(system, n);
    let (implicit, explicit): (Vec<_>, Vec<_>) =
        plain(1).chain(treated(system)).partition(Candidate::solves);
    let finer = (2..=FINER).flat_map(plain).filter(|c| !c.solves());
    let composed = composed(scene, system).into_iter().filter(|c| !c.solves());
    let usual = |c: &&Candidate| USUAL.contains(&c.id.as_str());
    let mut wrong = Vec::new();
    for mistake in MISTAKES {
        if let (Wrong::Physics(_) | Wrong::Scaled, Some(system)) =
            (&mistake.wrong, mistake.forces(scene))
        {
            wrong.extend(explicit.iter().filter(usual).map(|scheme| Base {
                scheme: scheme.under(&system),
                mistake: Some(mistake),
            }));
        }
    }
    let group = |bases, most, members| Group {
        bases,
        most,
        members,
    };
    let mut groups = vec![
        group(explicit.into_iter().map(own).collect(), MOST, true),
        group(implicit.into_iter().map(own).collect(), 2, false),
        group(composed.chain(finer).map(own).collect(), 1, false),
        group(wrong, 1, false),
    ];
    // About so many replays of each fitted transition.
    let mut left = race.budget;
    for group in &mut groups {
        let replays = if group.members { 400 } else { 60 };
        group.bases.retain(|base| {
            let first = race.sample.first();
            let each = first.map_or(0, |t| race.replay.effort(&base.scheme, t));
            let effort = each.saturating_mul(replays * FITTED as u64);
            let holds = effort <= left;
            left -= if holds { effort } else { 0 };
            holds
        });
    }
    groups
}

/// The scheme whose steps the trajectory nearly takes.
fn near(
    question: &Question,
    race: &Race,
    all: &[Transition],
    schemes: &[Candidate],
) -> Option<Found> {
    let truth = truth(question)?;
    let (candidate, _) = schemes
        .par_iter()
        .filter_map(|scheme| {
            let part = typical_part_of_error(race, scheme, &truth)?;
            let hinted = question.hint.is_some();
            (part <= NEAR || (hinted && part.is_finite())).then_some((scheme, part))
        })
        .collect::<Vec<_>>()
        .into_iter()
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let defects = defects_of_all(race.replay, candidate, all);
    let followed = defects.iter().filter(|d| d.fits()).count();
    let identity = Identity {
        defect: quantile(&defects, 0.5),
        relative: median_relative(&defects),
        undecided: Some(Undecided::Near),
        transitions: all.len(),
        followed,
        left_out: race.left_out.clone(),
        steps: race.replay.steps(),
        ..Identity::of(candidate)
    };
    let explained = Explained {
        scheme: Some(candidate.label()),
        residual: identity.defect,
        largest_at: largest_at(race, all, &defects),
        deviations: Vec::new(),
    };
    identity.defect.is_finite().then_some(Found {
        identity: Some(identity),
        explained: Some(explained),
    })
}

/// Steps so much finer that their error is none beside a scheme's.
fn truth(question: &Question) -> Option<Candidate> {
    let rk4 = integrators::find("rk4")?;
    Some(Candidate::method(question.system, rk4, 16))
}

/// The median over a few steps of [`part_of_error`].
fn typical_part_of_error(race: &Race, scheme: &Candidate, truth: &Candidate) -> Option<f64> {
    let few = spread(race.sample, FITTED);
    median(
        few.iter()
            .filter_map(|t| part_of_error(race.replay, scheme, truth, t)),
    )
}

/// The step with the largest defect; None where all fit.
fn largest_at(race: &Race, all: &[Transition], defects: &[super::Defect]) -> Option<u64> {
    let pairs = all.iter().zip(defects);
    let worst = pairs.max_by(|a, b| a.1.relative.total_cmp(&b.1.relative))?;
    (!worst.1.fits()).then(|| race.replay.rows.steps[worst.0.from])
}

/// How far the data is from a scheme's step, in parts of how far that is from the truth; None where the
/// scheme cannot take it.
fn part_of_error(
    replay: &Replay,
    scheme: &Candidate,
    truth: &Candidate,
    at: &Transition,
) -> Option<f64> {
    let mut replayer = scheme.replayer(&replay.settings);
    let predicted = replay.predict(&mut replayer, at).ok()?;
    let units = replay.units(&mut replayer, at, &predicted, 1).ok()?;
    let off = replay.farthest(at, &predicted, &units);
    let mut exact = truth.replayer(&replay.settings);
    let error = match replay.predict(&mut exact, at) {
        Ok(exact) => {
            let numbers = exact
                .x
                .iter()
                .chain(&exact.v)
                .zip(predicted.x.iter().chain(&predicted.v));
            let errors = numbers
                .zip(&units)
                .map(|((a, b), unit)| (a - b).abs() / unit);
            errors.fold(0.0, f64::max)
        }
        Err(_) => f64::NAN,
    };
    let part = off / error;
    if part.is_finite() {
        return Some(part);
    }
    // The truth is beyond the numbers, or the scheme exact.
    let relative = replay.defect(&mut replayer, at).relative;
    Some(if relative <= SMALL {
        NEAR * relative / SMALL
    } else {
        f64::INFINITY
    })
}

/// Factors that bring a scheme nearer to the data.
struct Fit {
    candidate: Candidate,
    scheme: String,
    deviations: Vec<Deviation>,
    /// Largest difference left, in units.
    worst: f64,
    /// What is left of the typical difference, as a part.
    left: f64,
}

impl Fit {
    /// Whether what it leaves is small against its scheme's own error.
    fn is_of_its_scheme(&self, question: &Question, race: &Race) -> bool {
        truth(question).is_some_and(|truth| {
            let truth = truth.forced_as(&self.candidate);
            let part = typical_part_of_error(race, &self.candidate, &truth);
            part.is_some_and(|part| part <= NEAR)
        })
    }

    fn found(&self, race: &Race, all: &[Transition]) -> Found {
        let defects = defects_of_all(race.replay, &self.candidate, all);
        Found {
            identity: None,
            explained: Some(Explained {
                scheme: Some(self.scheme.clone()),
                residual: quantile(&defects, 0.5),
                largest_at: largest_at(race, all, &defects),
                deviations: self.deviations.clone(),
            })
            .filter(|explained| explained.residual.is_finite()),
        }
    }
}

/// The fewest deviations that reach rounding; where none do, the best single one.
fn fitted(question: &Question, race: &Race) -> Option<Fit> {
    let whole = channels::of_scene(question.scene);
    let mut best: Option<Fit> = None;
    for group in groups(question, race) {
        let (most, members) = (group.most, group.members);
        let model = |base| Model::new(question, race, base, &whole);
        let models: Vec<Model> = group.bases.into_par_iter().filter_map(model).collect();
        for size in 1..=most {
            let fits: Vec<Vec<Fit>> = models.par_iter().map(|model| model.fits(size)).collect();
            for fits in fits {
                let mut exact = fits.iter().filter(|fit| fit.worst <= FIT);
                if let Some(first) = exact.next() {
                    let others: Vec<String> = exact.map(Fit::sentence).collect();
                    return Some(first.or(&others));
                }
                let left = best.as_ref().map_or(1.0, |best| best.left);
                let rough = fits.into_iter().filter(|fit| size == 1 && fit.left < left);
                best = rough.min_by(|a, b| a.left.total_cmp(&b.left)).or(best);
            }
            if size == 1 && members {
                let single = models.par_iter().map(Model::of_one_member);
                let single: Vec<Option<Fit>> = single.collect();
                if let Some(fit) = single.into_iter().flatten().next() {
                    return Some(fit);
                }
            }
        }
    }
    // What is only near the truth is near no scheme.
    best.filter(|fit| fit.left <= LEFT && fit.is_of_its_scheme(question, race))
}

impl Fit {
    fn sentence(&self) -> String {
        let says: Vec<&str> = self
            .deviations
            .iter()
            .map(|d| d.sentence.as_str())
            .collect();
        says.join(" and ")
    }

    /// The same, with what the data cannot tell from it.
    fn or(&self, others: &[String]) -> Self {
        let mut deviations = self.deviations.clone();
        if let (Some(last), false) = (deviations.last_mut(), others.is_empty()) {
            let others = others.join(", or ");
            last.sentence = format!("{} (the data cannot tell it from: {others})", last.sentence);
        }
        Self {
            deviations,
            candidate: self.candidate.clone(),
            scheme: self.scheme.clone(),
            ..*self
        }
    }
}

/// A scheme's residuals at the fitted transitions, and their slopes by every channel's factor.
struct Model<'a> {
    question: &'a Question<'a>,
    replay: &'a Replay<'a>,
    base: Base,
    channels: Vec<&'a Channel>,
    at: Vec<Transition>,
    /// Of each transition's numbers.
    units: Vec<Vec<f64>>,
    residuals: DVector<f64>,
    slopes: Vec<DVector<f64>>,
}

/// Step of the slopes' differences.
const STEP: f64 = 1e-4;

impl<'a> Model<'a> {
    /// None where the scheme cannot take the steps.
    fn new(
        question: &'a Question<'a>,
        race: &Race<'a>,
        base: Base,
        channels: &'a [Channel],
    ) -> Option<Self> {
        let replay = race.replay;
        let at = spread(race.sample, FITTED);
        let mut replayer = base.scheme.replayer(&replay.settings);
        let units = |t: &Transition| {
            let predicted = replay.predict(&mut replayer, t).ok()?;
            replay.units(&mut replayer, t, &predicted, NUDGES).ok()
        };
        let units: Vec<Vec<f64>> = at.iter().map(units).collect::<Option<_>>()?;
        let model = Self {
            question,
            replay,
            base,
            channels: Vec::new(),
            at,
            units,
            residuals: DVector::zeros(0),
            slopes: Vec::new(),
        };
        let residuals = model.residuals_of(&model.base.scheme)?;
        Self { residuals, ..model }.with(channels)
    }

    /// The same scheme with these channels.
    fn with(mut self, channels: &'a [Channel]) -> Option<Self> {
        let suits = |channel: &&Channel| channel.suits(&self.base.scheme);
        self.channels = channels.iter().filter(suits).collect();
        let slope = |k| {
            let moved = self.residuals_at(&[(k, 1.0 + STEP)])?;
            Some((moved - self.unvaried(&[k])?) / STEP)
        };
        self.slopes = (0..self.channels.len()).map(slope).collect::<Option<_>>()?;
        Some(self)
    }

    /// The residuals where the factors of these channels are 1.
    fn unvaried(&self, set: &[usize]) -> Option<DVector<f64>> {
        if !set.iter().any(|&k| self.channels[k].switches()) {
            return Some(self.residuals.clone());
        }
        let factors: Vec<(usize, f64)> = set.iter().map(|&k| (k, 1.0)).collect();
        self.residuals_at(&factors)
    }

    /// The fit of one spring or particle, of those where the scheme is off most.
    fn of_one_member(&self) -> Option<Fit> {
        let scene = self.question.scene;
        let numbers = self.residuals.len() / self.at.len().max(1);
        let mut off = vec![0.0_f64; scene.particles.len()];
        for (i, residual) in self.residuals.iter().enumerate() {
            let particle = i % numbers / 3 % off.len();
            off[particle] = off[particle].max(residual.abs());
        }
        let mut particles: Vec<usize> = (0..off.len()).collect();
        particles.sort_by(|&a, &b| off[b].total_cmp(&off[a]));
        particles.truncate(SUSPECTS);
        let members = channels::of_members(scene, &particles);
        // Only the channels are others.
        let own = Model {
            base: self.base.clone(),
            at: self.at.clone(),
            units: self.units.clone(),
            residuals: self.residuals.clone(),
            channels: Vec::new(),
            slopes: Vec::new(),
            ..*self
        };
        own.with(&members)?
            .fits(1)
            .into_iter()
            .find(|fit| fit.worst <= FIT)
    }

    fn varied(&self, factors: &[(usize, f64)]) -> Option<Candidate> {
        let factors = factors
            .iter()
            .map(|&(k, factor)| (self.channels[k], factor));
        let factors: Vec<(&Channel, f64)> = factors.collect();
        let Base { scheme, mistake } = &self.base;
        let build = |scene: &Scene| forces(scene, *mistake);
        channels::varied(self.question.scene, &build, scheme, &factors)
    }

    fn residuals_at(&self, factors: &[(usize, f64)]) -> Option<DVector<f64>> {
        self.residuals_of(&self.varied(factors)?)
    }

    /// Predicted minus recorded, in units.
    fn residuals_of(&self, candidate: &Candidate) -> Option<DVector<f64>> {
        let mut replayer = candidate.replayer(&self.replay.settings);
        let mut all = Vec::new();
        for (t, units) in self.at.iter().zip(&self.units) {
            let predicted = self.replay.predict(&mut replayer, t).ok()?;
            let numbers = predicted.x.iter().chain(&predicted.v).zip(units);
            let pairs = self.replay.recorded(t).zip(numbers);
            all.extend(
                pairs.map(|(recorded, (predicted, unit))| match predicted - recorded {
                    0.0 => 0.0,
                    off => off / unit,
                }),
            );
        }
        all.iter()
            .all(|r| r.is_finite())
            .then(|| DVector::from_vec(all))
    }

    /// Fits with this many factors, in the order of preference: all of one, the most promising of several.
    fn fits(&self, size: usize) -> Vec<Fit> {
        let alone =
            |set: &Vec<usize>| size == 1 || !set.iter().any(|&k| self.channels[k].switches());
        let mut sets: Vec<(f64, Vec<usize>)> = sets(self.channels.len(), size)
            .into_iter()
            .filter(alone)
            .filter_map(|set| Some((self.predicted(&set)?, set)))
            .collect();
        // Only a number that matters is worth a fit.
        let matters = |set: &[usize]| set.iter().any(|&k| self.channels[k].switches());
        sets.retain(|(left, set)| *left <= PROMISING * self.residuals.norm() || matters(set));
        if size > 1 {
            sets.sort_by(|a, b| a.0.total_cmp(&b.0));
            sets.truncate(TRIED);
            // The scene's effects come before mass, step and velocity.
            sets.sort_by(|a, b| a.1.cmp(&b.1));
        }
        let mut fits: Vec<Fit> = sets.iter().filter_map(|(_, set)| self.fit(set)).collect();
        if size == 1 {
            let turned = channels::turned(
                self.question.scene,
                &|scene| forces(scene, self.base.mistake),
                &self.base.scheme,
            );
            fits.extend(turned.into_iter().filter_map(|(candidate, deviation)| {
                let residuals = self.residuals_of(&candidate)?;
                Some(self.result(candidate, vec![deviation], &residuals))
            }));
        }
        fits
    }

    /// What the linear model leaves.
    fn predicted(&self, set: &[usize]) -> Option<f64> {
        let slopes: Vec<DVector<f64>> = set.iter().map(|&k| self.slopes[k].clone()).collect();
        let step = least_squares(&slopes, &self.residuals)?;
        let mut left = self.residuals.clone();
        for (slope, step) in slopes.iter().zip(step.iter()) {
            left -= slope * *step;
        }
        Some(left.norm())
    }

    /// Gauss-Newton from the scene's own numbers.
    fn fit(&self, set: &[usize]) -> Option<Fit> {
        let mut factors: Vec<(usize, f64)> = set.iter().map(|&k| (k, 1.0)).collect();
        let mut residuals = self.unvaried(set)?;
        let mut slopes: Vec<DVector<f64>> = set.iter().map(|&k| self.slopes[k].clone()).collect();
        for taken in 0..STEPS {
            let mut step = least_squares(&slopes, &residuals)?;
            let here = residuals.norm();
            for halving in 0..=HALVINGS {
                let moved = factors.iter().zip(step.iter());
                let moved: Vec<(usize, f64)> = moved.map(|((k, f), s)| (*k, f - s)).collect();
                let next = self.residuals_at(&moved);
                let nearer = next.as_ref().is_some_and(|next| next.norm() <= here);
                if let (true, Some(next)) = (nearer || halving == HALVINGS, next) {
                    (factors, residuals) = (moved, next);
                    break;
                }
                step *= 0.5;
            }
            if step.amax() <= 1e-13 * (1.0 + factors.iter().fold(0.0, |m: f64, f| m.max(f.1.abs())))
            {
                break;
            }
            if taken > 1 && residuals.norm() > SLOW * here {
                // It converges to something else than rounding.
                break;
            }
            for (place, slope) in slopes.iter_mut().enumerate() {
                let mut moved = factors.clone();
                let by = STEP.min(step.amax().max(1e-7));
                moved[place].1 += by;
                *slope = (self.residuals_at(&moved)? - &residuals) / by;
            }
        }
        // A number that a person would have written is taken for the one meant, if it does as well.
        let rounded: Vec<(usize, f64)> = factors.iter().map(|&(k, f)| (k, plain(f))).collect();
        if let Some(plain) = self.residuals_at(&rounded)
            && plain.amax() <= FIT
        {
            (factors, residuals) = (rounded, plain);
        }
        let (scene, h) = (self.question.scene, self.replay.rows.timestep);
        let deviations = factors
            .iter()
            .map(|&(k, factor)| self.channels[k].deviation(scene, h, factor));
        let deviations: Vec<Deviation> = deviations.collect();
        let candidate = self.varied(&factors)?;
        let finite = deviations.iter().all(|d| d.factor.is_finite());
        finite.then(|| self.result(candidate, deviations, &residuals))
    }

    fn result(
        &self,
        candidate: Candidate,
        deviations: Vec<Deviation>,
        residuals: &DVector<f64>,
    ) -> Fit {
        let of_mistake = self
            .base
            .mistake
            .map(|row| deviations_of(self.question.scene, row));
        Fit {
            candidate,
            scheme: self.base.scheme.label(),
            deviations: of_mistake.into_iter().flatten().chain(deviations).collect(),
            worst: residuals.amax(),
            left: residuals.norm() / self.residuals.norm(),
        }
    }
}

/// The number of few digits that a fitted one is within rounding of.
fn plain(factor: f64) -> f64 {
    let rounded: f64 = format!("{factor:.6}").parse().unwrap_or(factor);
    if (rounded - factor).abs() <= 1e-9 {
        rounded
    } else {
        factor
    }
}

/// The steps that make slopes times them the residuals, in the sense of least squares; None where slopes
/// are no numbers, or one changes nothing.
fn least_squares(slopes: &[DVector<f64>], residuals: &DVector<f64>) -> Option<DVector<f64>> {
    let norms: Vec<f64> = slopes.iter().map(|slope| slope.norm()).collect();
    if norms.iter().any(|norm| !norm.is_finite() || *norm < 1.0) {
        return None;
    }
    let columns: Vec<DVector<f64>> = slopes.iter().zip(&norms).map(|(s, n)| s / *n).collect();
    let matrix = DMatrix::from_columns(&columns);
    // Channels that are nearly parallel together explain no more than one of them.
    let mut step = matrix.svd(true, true).solve(residuals, 1e-9).ok()?;
    for (step, norm) in step.iter_mut().zip(&norms) {
        *step /= norm;
    }
    step.iter().all(|s| s.is_finite()).then_some(step)
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
