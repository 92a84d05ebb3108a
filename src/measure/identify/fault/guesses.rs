//! What may have gone wrong in a step: changes without free numbers, each tried as it stands.

use super::super::candidate::Candidate;
use super::super::mistakes::{MISTAKES, Mistake, Wrong};
use super::spot::Spot;
use super::words::{rows_lost, spring_name};
use crate::integrators::fixed;
use crate::physics::ParticleSystem;
use crate::scene::{Scene, Spring};

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
/// Substeps that are tried.
const SUBSTEPS: u32 = 16;

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

/// Each effect missing, with the wrong sign, twice.
fn effects(spot: &Spot) -> Vec<Guess> {
    let mut guesses = Vec::new();
    for (row, _) in spot.question.system.effects() {
        for (factor, what) in [
            (0.0, "is missing"),
            (-1.0, "has the wrong sign"),
            (2.0, "acts twice"),
        ] {
            let of = |other: &crate::physics::effects::EffectRow| {
                if other.id == row.id { factor } else { 1.0 }
            };
            let wrong = ParticleSystem::scaled(spot.question.scene, &of);
            let says = format!("the effect `{}` {what}", row.id);
            guesses.push(scheme(says, spot.followed.under(&wrong)));
        }
    }
    guesses
}

/// The places of the springs that pull at the worst particle.
pub(super) fn springs_at(spot: &Spot) -> Vec<usize> {
    let springs = spot.question.scene.springs.iter().enumerate();
    springs
        .filter(|(_, spring)| spring.ends.contains(&spot.worst))
        .map(|(id, _)| id)
        .collect()
}

/// The scheme in a scene changed so.
pub(super) fn in_scene(spot: &Spot, change: impl FnOnce(&mut Scene)) -> Candidate {
    let mut wrong = spot.question.scene.clone();
    change(&mut wrong);
    spot.followed.under(&ParticleSystem::new(&wrong))
}

type Change = (&'static str, fn(&mut Spring));

const SPRING: [Change; 3] = [
    ("is missing", |s| {
        s.stiffness = 0.0;
        s.cubic = 0.0;
        s.damping = 0.0;
    }),
    ("has the wrong sign", |s| {
        s.stiffness = -s.stiffness;
        s.cubic = -s.cubic;
        s.damping = -s.damping;
    }),
    ("acts twice", |s| {
        s.stiffness *= 2.0;
        s.cubic *= 2.0;
        s.damping *= 2.0;
    }),
];

const DAMPER: [Change; 3] = [
    ("lacks its damper", |s| s.damping = 0.0),
    ("has a damper of the wrong sign", |s| s.damping = -s.damping),
    ("has its rest length ignored", |s| s.rest_length = 0.0),
];

/// Each spring at the worst particle, alone.
fn springs(spot: &Spot) -> Vec<Guess> {
    let mut guesses = Vec::new();
    for id in springs_at(spot) {
        let spring = &spot.question.scene.springs[id];
        for (what, change) in SPRING.iter().chain(&DAMPER) {
            let mut changed = spring.clone();
            change(&mut changed);
            if changed != *spring {
                let wrong = in_scene(spot, |scene| scene.springs[id] = changed);
                let says = format!("{} {what}", spring_name(id, spring));
                guesses.push(scheme(says, wrong));
            }
        }
    }
    guesses
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

/// The mistakes of the registry, made here.
fn mistakes(spot: &Spot) -> Vec<Guess> {
    let (scene, followed) = (spot.question.scene, spot.followed);
    let wrong = |mistake: &Mistake| match mistake.wrong {
        Wrong::Length(factor) => Some(followed.stretched(factor)),
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
    let mut guesses: Vec<Guess> = fixed()
        .iter()
        .filter(|method| method.id != followed.id)
        .map(|method| {
            let says = format!("the step is one of {}", method.id);
            scheme(says, Candidate::method(system, method, followed.substeps))
        })
        .collect();
    let own = fixed().iter().find(|method| method.id == followed.id);
    if let Some(method) = own {
        for substeps in (1..=SUBSTEPS).filter(|n| *n != followed.substeps) {
            let says = match substeps {
                1 => "the step is taken whole, not in substeps".to_owned(),
                n => format!("the step is taken in {n} substeps"),
            };
            guesses.push(scheme(says, Candidate::method(system, method, substeps)));
        }
    }
    for mistake in MISTAKES {
        if let Some(candidate) = mistake.as_step(system) {
            let says = format!("the step is `{}`: {}", mistake.id, mistake.says);
            guesses.push(scheme(says, candidate));
        }
    }
    guesses
}
