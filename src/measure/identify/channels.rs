//! What a program may compute otherwise than the scene says: numbers of the scene, the step, a factor on
//! velocities. Each is a channel with a factor, 1 where the program is right.

use super::candidate::{Candidate, ScaledAt, Scaling};
use super::result::Deviation;
use crate::physics::ParticleSystem;
use crate::scene::{Axis, Scene};
use std::sync::Arc;

/// A number that a program may have wrong.
pub(super) struct Channel {
    /// As [`Deviation::what`].
    pub(super) what: &'static str,
    /// The member of the scene; None for all of them.
    pub(super) member: Option<usize>,
    change: Change,
}

#[derive(Clone, Copy)]
enum Change {
    /// Multiplies a number of the scene, of one member or of all.
    Scene(SetScene),
    /// Gives all members one number, so many times their mean.
    Common(fn(&mut Scene, f64)),
    /// Multiplies the length of the step.
    Timestep,
    /// Multiplies velocities once a step.
    Velocity(ScaledAt),
}

/// The members of a list that are meant.
fn each<T>(list: &mut [T], member: Option<usize>, change: impl Fn(&mut T)) {
    for (i, item) in list.iter_mut().enumerate() {
        if member.is_none_or(|member| member == i) {
            change(item);
        }
    }
}

/// A number of the scene: its name, whether the scene has it, and how it is multiplied.
type Number = (&'static str, fn(&Scene) -> bool, SetScene);
type SetScene = fn(&mut Scene, Option<usize>, f64);

const GRAVITY: Number = (
    "gravity",
    |s| s.solver.gravity != 0.0,
    |s, _, f| s.solver.gravity *= f,
);
const STIFFNESS: Number = (
    "springs.stiffness",
    |s| s.springs.iter().any(|spring| spring.stiffness != 0.0),
    |s, at, f| each(&mut s.springs, at, |spring| spring.stiffness *= f),
);
const DAMPING: Number = (
    "springs.damping",
    |s| s.springs.iter().any(|spring| spring.damping != 0.0),
    |s, at, f| each(&mut s.springs, at, |spring| spring.damping *= f),
);
const REST_LENGTH: Number = (
    "springs.rest_length",
    |s| s.springs.iter().any(|spring| spring.rest_length != 0.0),
    |s, at, f| each(&mut s.springs, at, |spring| spring.rest_length *= f),
);
const CUBIC: Number = (
    "springs.cubic",
    |s| s.springs.iter().any(|spring| spring.cubic != 0.0),
    |s, at, f| each(&mut s.springs, at, |spring| spring.cubic *= f),
);
const DRAG: Number = (
    "drag",
    |s| s.particles.iter().any(|p| !p.fixed && p.drag != 0.0),
    |s, at, f| each(&mut s.particles, at, |particle| particle.drag *= f),
);
const WIND: Number = (
    "wind",
    |s| s.wind.as_ref().is_some_and(|wind| wind.strength != 0.0),
    |s, _, f| s.wind.iter_mut().for_each(|wind| wind.strength *= f),
);
const GRAVITATIONAL: Number = (
    "gravitational",
    |s| !s.gravitational.is_empty(),
    |s, at, f| each(&mut s.gravitational, at, |pair| pair.g *= f),
);
/// Accelerations are linear in 1/m, so a fit finds that.
const MASS: Number = (
    "mass",
    |_| true,
    |s, at, f| each(&mut s.particles, at, |particle| particle.mass /= f),
);
const NUMBERS: [Number; 9] = [
    GRAVITY,
    STIFFNESS,
    DAMPING,
    REST_LENGTH,
    CUBIC,
    DRAG,
    WIND,
    GRAVITATIONAL,
    MASS,
];

/// The scene with these numbers multiplied; None if it has none of them.
pub(super) fn scaled(scene: &Scene, factors: &[(&str, f64)]) -> Option<Scene> {
    let mut wrong = scene.clone();
    for (what, factor) in factors {
        let number = NUMBERS
            .iter()
            .find(|(name, has, _)| name == what && has(scene));
        if let Some((.., set)) = number {
            set(&mut wrong, None, *factor);
        }
    }
    (wrong != *scene).then_some(wrong)
}

/// Whether the scene has what a known mistake changes, where that is a number of it.
pub(super) fn has(scene: &Scene, what: &str) -> bool {
    let number = NUMBERS.iter().find(|(name, ..)| *name == what);
    number.is_none_or(|(_, has, _)| has(scene))
}

const ONE_STIFFNESS: (&str, Change) = (
    "springs.stiffness",
    Change::Common(|s, f| {
        let k = f * mean(s.springs.iter().map(|spring| spring.stiffness));
        each(&mut s.springs, None, |spring| spring.stiffness = k);
    }),
);
const ONE_MASS: (&str, Change) = (
    "mass",
    Change::Common(|s, f| {
        let free = s.particles.iter().filter(|p| !p.fixed);
        let m = mean(free.map(|p| p.mass)) / f;
        each(&mut s.particles, None, |particle| particle.mass = m);
    }),
);
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / f64::max(count, 1.0)
}

/// Whether these are not all the same.
fn differ(mut values: impl Iterator<Item = f64>) -> bool {
    let first = values.next();
    values.any(|value| Some(value) != first)
}

/// The channels of the whole scene: its effects first, then mass, step and velocity.
pub(super) fn of_scene(scene: &Scene) -> Vec<Channel> {
    let whole = |(what, change): (&'static str, Change)| Channel {
        what,
        member: None,
        change,
    };
    let numbers = NUMBERS.iter().filter(|(_, has, _)| has(scene));
    let numbers = numbers.map(|(what, _, set)| (*what, Change::Scene(*set)));
    let others = [
        ("timestep", Change::Timestep),
        ("velocity", Change::Velocity(ScaledAt::Start)),
        ("velocity", Change::Velocity(ScaledAt::Kick)),
        ("velocity", Change::Velocity(ScaledAt::End)),
    ];
    let mut all: Vec<Channel> = numbers.chain(others).map(whole).collect();
    if differ(scene.springs.iter().map(|s| s.stiffness)) {
        all.push(whole(ONE_STIFFNESS));
    }
    if differ(scene.particles.iter().filter(|p| !p.fixed).map(|p| p.mass)) {
        all.push(whole(ONE_MASS));
    }
    all
}

/// The channels of these particles, and of the springs that pull at them.
pub(super) fn of_members(scene: &Scene, particles: &[usize]) -> Vec<Channel> {
    let mut channels = Vec::new();
    let mut add = |(what, _, set): Number, member: usize, there: bool| {
        channels.extend(there.then_some(Channel {
            what,
            member: Some(member),
            change: Change::Scene(set),
        }));
    };
    for (i, spring) in scene.springs.iter().enumerate() {
        if spring.ends.iter().any(|end| particles.contains(end)) {
            add(STIFFNESS, i, spring.stiffness != 0.0);
            add(DAMPING, i, spring.damping != 0.0);
            add(REST_LENGTH, i, spring.rest_length != 0.0);
        }
    }
    for &i in particles {
        add(MASS, i, !scene.particles[i].fixed);
        add(DRAG, i, scene.particles[i].drag != 0.0);
    }
    channels
}

/// The forces of a scene, as some program computes them; None where it has nothing for the program to get wrong.
pub(super) type Build<'a> = &'a dyn Fn(&Scene) -> Option<ParticleSystem>;

/// The scheme with these channels' factors, by a program that computes its forces so.
pub(super) fn varied(
    scene: &Scene,
    build: Build,
    base: &Candidate,
    factors: &[(&Channel, f64)],
) -> Option<Candidate> {
    let mut wrong = scene.clone();
    let mut altered = false;
    let mut candidate = base.clone();
    for (channel, factor) in factors {
        match channel.change {
            Change::Scene(change) => change(&mut wrong, channel.member, *factor),
            Change::Common(change) => change(&mut wrong, *factor),
            Change::Timestep => candidate = candidate.stretched(*factor),
            Change::Velocity(at) => {
                let rates: Arc<[f64]> = vec![*factor; 3 * scene.particles.len()].into();
                let factor = |rate: f64, _: f64| rate;
                candidate = candidate.scaled(Scaling { factor, rates, at });
            }
        }
        altered |= matches!(channel.change, Change::Scene(_) | Change::Common(_));
    }
    if altered {
        candidate = candidate.under(&build(&wrong)?);
    }
    Some(candidate)
}

/// The scheme with gravity, or the wind, along another axis, either way: with what deviates.
pub(super) fn turned(scene: &Scene, build: Build, base: &Candidate) -> Vec<(Candidate, Deviation)> {
    let mut all = Vec::new();
    for (axis, name) in [(Axis::X, "x"), (Axis::Y, "y"), (Axis::Z, "z")] {
        for factor in [1.0, -1.0] {
            let mut along = |what: &str, change: &dyn Fn(&mut Scene)| {
                let mut wrong = scene.clone();
                change(&mut wrong);
                let other = if factor < 0.0 { ", the other way" } else { "" };
                let deviation = Deviation {
                    what: if what == "gravity" { "axis" } else { what }.to_owned(),
                    factor,
                    place: Some(name.to_owned()),
                    sentence: format!("{what} is along {name}{other}"),
                };
                if wrong != *scene
                    && let Some(system) = build(&wrong)
                {
                    all.push((base.under(&system), deviation));
                }
            };
            if scene.solver.gravity != 0.0 && axis != scene.up {
                along("gravity", &|wrong| {
                    wrong.up = axis;
                    wrong.solver.gravity *= factor;
                });
            }
            along("wind", &|wrong| {
                if let Some(wind) = &mut wrong.wind {
                    let size = wind.direction.iter().map(|d| d * d).sum::<f64>().sqrt();
                    wind.direction = [0.0; 3];
                    wind.direction[axis.index()] = factor * size;
                }
            });
        }
    }
    all
}

impl Channel {
    /// Whether a factor of 1 changes the scene.
    pub(super) fn switches(&self) -> bool {
        matches!(self.change, Change::Common(_))
    }

    /// Whether it can be told from other forms of the same channel under this scheme.
    pub(super) fn suits(&self, base: &Candidate) -> bool {
        match self.change {
            Change::Velocity(ScaledAt::Kick) => base.id == "symplectic_euler",
            _ => true,
        }
    }

    pub(super) fn deviation(&self, scene: &Scene, h: f64, factor: f64) -> Deviation {
        let place = match (self.change, self.member) {
            (Change::Velocity(at), _) => Some(at.words().to_owned()),
            (Change::Common(_), _) => Some("all alike".to_owned()),
            (_, Some(i)) if self.what.starts_with("springs") => Some(format!("spring {i}")),
            (_, Some(i)) => Some(format!("particle {i}")),
            (_, None) => None,
        };
        let factor = if self.what == MASS.0 {
            1.0 / factor
        } else {
            factor
        };
        Deviation {
            what: self.what.to_owned(),
            factor,
            sentence: self.sentence(scene, h, factor, place.as_deref()),
            place,
        }
    }

    fn sentence(&self, scene: &Scene, h: f64, factor: f64, place: Option<&str>) -> String {
        if let Change::Common(change) = self.change {
            let mut alike = scene.clone();
            change(
                &mut alike,
                if self.what == MASS.0 {
                    1.0 / factor
                } else {
                    factor
                },
            );
            return if self.what == MASS.0 {
                let free = alike.particles.iter().find(|p| !p.fixed);
                format!(
                    "all particles have a mass of {} kg",
                    digits(free.map_or(0.0, |p| p.mass))
                )
            } else {
                let k = alike.springs.first().map_or(0.0, |s| s.stiffness);
                format!("all springs have a stiffness of {} N/m", digits(k))
            };
        }
        let times = times(factor);
        let of = place.map_or(String::new(), |place| format!(" of {place}"));
        let one = self.member.is_some();
        match self.what {
            "gravity" => match factor {
                0.0 => "gravity is missing".to_owned(),
                _ => {
                    let g = scene.solver.gravity.abs();
                    let found = digits(factor * g);
                    format!(
                        "gravity acts with {times} the scene's: {found} for {} m/s²",
                        digits(g)
                    )
                }
            },
            "springs.stiffness" if !one => match factor {
                0.0 => "springs do not pull".to_owned(),
                -1.0 => "springs push where they should pull".to_owned(),
                _ => format!("springs act with {times} their stiffness"),
            },
            "springs.damping" if !one => match factor {
                0.0 => "the springs' dampers are missing".to_owned(),
                _ => format!("dampers act with {times} the scene's damping"),
            },
            "springs.rest_length" if !one => match factor {
                0.0 => "the rest length of springs is taken for 0".to_owned(),
                _ => format!("springs have {times} their rest length"),
            },
            "drag" | "wind" | "gravitational" if !one && factor == 0.0 => {
                format!("{} is missing", self.what)
            }
            "springs.cubic" => format!("the cubic part of the springs is {times} the scene's"),
            "velocity" => format!(
                "velocities are multiplied by {} a step, {}",
                digits(factor),
                place.unwrap_or_default()
            ),
            "timestep" => format!("the step is {} s, not {} s", seconds(factor * h), digits(h)),
            what => {
                let quantity = what.rsplit('.').next().unwrap_or(what).replace('_', " ");
                format!("the {quantity}{of} is {times} the scene's")
            }
        }
    }
}

/// "half", "twice", "0.999 of".
fn times(factor: f64) -> String {
    if factor == 0.5 {
        "half".to_owned()
    } else if factor == 2.0 {
        "twice".to_owned()
    } else if !(0.0..=2.0).contains(&factor) {
        format!("{} times", digits(factor))
    } else {
        format!("{} of", digits(factor))
    }
}

/// Six digits, less trailing zeros.
fn digits(value: f64) -> String {
    // No minus before a zero.
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value) + 0.0;
    if rounded == 0.0 || (1e-3..1e6).contains(&rounded.abs()) {
        format!("{rounded}")
    } else {
        format!("{rounded:e}")
    }
}

/// A step as people choose it: `1/60` where it is one over a whole number.
fn seconds(h: f64) -> String {
    let rate = 1.0 / h;
    let whole = rate.round();
    let exactly = (rate - whole).abs() <= 1e-9 * whole;
    let short = digits(h).parse::<f64>().is_ok_and(|rounded| rounded == h);
    if exactly && whole > 1.0 && !short {
        format!("1/{whole}")
    } else {
        digits(h)
    }
}
