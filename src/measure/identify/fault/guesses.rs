//! What may have gone wrong in a step: changes without free numbers, each tried as it stands, and numbers that
//! are fitted to it.

use super::super::MOST_SUBSTEPS;
use super::super::candidate::Candidate;
use super::super::channels::{self, Channel};
use super::super::fit::{Base, Model};
use super::super::mistakes::{MISTAKES, Mistake, Wrong};
use super::super::numbers::Number::{
    self, AirVelocity, Bend, BendDamping, Damping, Gravity, RestAngle, RestLength, Stiffness, Wind,
};
use super::spot::Spot;
use crate::integrators;
use crate::physics::ParticleSystem;
use crate::physics::effects::EffectRow;

/// A change that may explain a fault.
pub(super) struct Guess {
    /// The change, as the end of a sentence.
    pub(super) says: String,
    pub(super) way: Way,
}

/// How the transition is taken instead.
pub(super) enum Way {
    Scheme(Candidate),
    /// By the scheme itself, but in this many steps.
    Steps(u64),
}

/// Rows that may be lost in one place.
const ROWS_LOST: u64 = 16;

/// All guesses; of several that explain equally well, the first is reported.
pub(super) fn all(spot: &Spot) -> Vec<Guess> {
    let mut guesses = effects(spot);
    guesses.extend(springs(spot));
    guesses.extend(rows(spot));
    guesses.extend(mistakes(spot));
    guesses.extend(schemes(spot));
    guesses
}

fn scheme(says: impl Into<String>, candidate: Candidate) -> Guess {
    Guess {
        says: says.into(),
        way: Way::Scheme(candidate),
    }
}

/// What may become of a force.
const WRONG: [(f64, &str); 3] = [
    (0.0, "is missing"),
    (-1.0, "has the wrong sign"),
    (2.0, "acts twice"),
];

/// Each effect, wrong.
fn effects(spot: &Spot) -> Vec<Guess> {
    let mut guesses = Vec::new();
    for (row, _) in spot.question.system.effects() {
        for (factor, what) in WRONG {
            let of = |other: &EffectRow| if other.id == row.id { factor } else { 1.0 };
            let wrong = ParticleSystem::scaled(spot.question.scene, &of);
            let says = format!("the effect `{}` {what}", row.id);
            guesses.push(scheme(says, spot.followed.under(&wrong)));
        }
    }
    guesses
}

/// Each spring and hinge at the worst particle, alone: by its stiffness, its damping and what it is at rest at.
fn springs(spot: &Spot) -> Vec<Guess> {
    let scene = spot.question.scene;
    let springs = channels::springs_at(scene, &[spot.worst]).into_iter();
    let springs = springs.map(|id| (id, [Stiffness, Damping, RestLength], "rest length"));
    let hinges = channels::hinges_at(scene, &[spot.worst]).into_iter();
    let hinges = hinges.map(|id| (id, [Bend, BendDamping, RestAngle], "rest angle"));
    let mut guesses = Vec::new();
    for (id, [stiffness, damping, rest], at_rest) in springs.chain(hinges) {
        let whole =
            WRONG.map(|(factor, what)| (channels::forces(stiffness), factor, what.to_owned()));
        let parts: [(&[Number], f64, String); 3] = [
            (&[damping], 0.0, "lacks its damper".to_owned()),
            (
                &[damping],
                -1.0,
                "has a damper of the wrong sign".to_owned(),
            ),
            (&[rest], 0.0, format!("has its {at_rest} ignored")),
        ];
        for (numbers, factor, what) in whole.iter().chain(&parts) {
            let there = numbers.iter().map(|number| Channel::One(*number, id));
            let there = there.filter(|channel| channel.is_in(scene));
            let factors: Vec<(Channel, f64)> = there.map(|channel| (channel, *factor)).collect();
            let says = format!("{} {what}", channels::whole(scene, stiffness, id));
            if !factors.is_empty()
                && let Some(wrong) = own(spot).varied(scene, &factors)
            {
                guesses.push(scheme(says, wrong));
            }
        }
    }
    guesses
}

/// For each number that may be wrong here, the value that comes nearest.
pub(super) fn numbers(spot: &Spot) -> Vec<Guess> {
    let (scene, replay) = (spot.question.scene, spot.replay);
    let at = vec![(spot.at, spot.units.clone())];
    let arrive = |candidate: &Candidate| {
        let state = spot.arrive(spot.followed, candidate, spot.span())?;
        Some(vec![state])
    };
    let Some(model) = Model::new(scene, replay, own(spot), at, Box::new(arrive)) else {
        return Vec::new();
    };
    let springs = channels::springs_at(scene, &[spot.worst]);
    let mut channels: Vec<Channel> = channels::of_springs(springs).collect();
    channels.extend(channels::of_hinges(scene, &[spot.worst]));
    channels.push(Channel::One(Gravity, 0));
    channels.extend(channels::of_particles(scene, &[spot.worst]));
    channels.extend(scene.wind.as_ref().map(|_| Channel::One(Wind, 0)));
    channels.extend(
        AirVelocity
            .is_in(scene)
            .then_some(Channel::One(AirVelocity, 0)),
    );
    channels.push(Channel::Timestep);
    let fitted = channels.into_iter().filter_map(|channel| {
        let fit = model.fit(&[&model.slope(channel)?])?;
        let (_, factor) = *fit.factors.first()?;
        let says = channel.value(scene, replay.rows.timestep, factor)?;
        Some(scheme(says, fit.candidate))
    });
    fitted.collect()
}

/// The scheme that is followed.
fn own(spot: &Spot) -> Base {
    Base {
        scheme: spot.followed.clone(),
        mistake: None,
    }
}

/// Rows lost or written twice: more or fewer steps than the row says.
fn rows(spot: &Spot) -> Vec<Guess> {
    let span = spot.span();
    let fewer = (0..span).rev().take(ROWS_LOST as usize);
    let more = span + 1..=span + ROWS_LOST;
    more.chain(fewer)
        .map(|steps| Guess {
            says: rows_lost(steps, span),
            way: Way::Steps(steps),
        })
        .collect()
}

/// The row is the state after `steps` steps, not `span`.
fn rows_lost(steps: u64, span: u64) -> String {
    if steps == 0 {
        return "the row repeats the one before it: a step was skipped, or a row written twice"
            .to_owned();
    }
    let lost = steps.abs_diff(span);
    let rows = if lost == 1 { "a row" } else { "rows" };
    if steps > span {
        format!("{rows} lost before this one, which lies {steps} steps on, not {span}")
    } else {
        format!("{rows} written too often: this one lies {steps} steps on, not {span}")
    }
}

/// The mistakes of the registry, made here.
fn mistakes(spot: &Spot) -> Vec<Guess> {
    let (scene, followed) = (spot.question.scene, spot.followed);
    let wrong = |mistake: &Mistake| match mistake.wrong {
        Wrong::Length(factor) => Some(followed.stretched(factor)),
        Wrong::Applied(around) if !scene.driven.is_empty() => {
            Some(followed.clone().around(Some(around)))
        }
        _ => mistake.forces(scene).map(|system| followed.under(&system)),
    };
    MISTAKES
        .iter()
        .filter_map(|m| Some(scheme(m.says, wrong(m)?)))
        .collect()
}

/// Another method, other substeps, or a wrong form of some method.
fn schemes(spot: &Spot) -> Vec<Guess> {
    let (system, followed) = (spot.question.system, spot.followed);
    let others = Candidate::plain(system, followed.substeps).filter(|c| c.id != followed.id);
    let others = others.map(|other| scheme(format!("the step is one of {}", other.id), other));
    let plain = integrators::find(&followed.id).is_some();
    let substeps = (1..=MOST_SUBSTEPS).filter(|n| plain && *n != followed.substeps);
    let substeps = substeps.map(|n| {
        let says = match n {
            1 => "the step is taken whole, not in substeps".to_owned(),
            n => format!("the step is taken in {n} substeps"),
        };
        scheme(says, followed.clone().in_substeps(n))
    });
    let wrong = MISTAKES.iter().filter_map(|mistake| {
        let says = format!("the step is `{}`: {}", mistake.id, mistake.says);
        Some(scheme(says, mistake.as_step(system)?))
    });
    others.chain(substeps).chain(wrong).collect()
}
