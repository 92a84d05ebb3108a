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
    Scene(fn(&mut Scene, Option<usize>, f64)),
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

const STIFFNESS: (&str, Change) = (
    "springs.stiffness",
    Change::Scene(|s, at, f| each(&mut s.springs, at, |spring| spring.stiffness *= f)),
);
const DAMPING: (&str, Change) = (
    "springs.damping",
    Change::Scene(|s, at, f| each(&mut s.springs, at, |spring| spring.damping *= f)),
);
const REST_LENGTH: (&str, Change) = (
    "springs.rest_length",
    Change::Scene(|s, at, f| each(&mut s.springs, at, |spring| spring.rest_length *= f)),
);
const CUBIC: (&str, Change) = (
    "springs.cubic",
    Change::Scene(|s, at, f| each(&mut s.springs, at, |spring| spring.cubic *= f)),
);
const DRAG: (&str, Change) = (
    "drag",
    Change::Scene(|s, at, f| each(&mut s.particles, at, |particle| particle.drag *= f)),
);
const MASS: (&str, Change) = (
    "mass",
    // Accelerations are linear in 1/m, so a fit finds that.
    Change::Scene(|s, at, f| each(&mut s.particles, at, |particle| particle.mass /= f)),
);
const GRAVITY: (&str, Change) = ("gravity", Change::Scene(|s, _, f| s.solver.gravity *= f));
const WIND: (&str, Change) = (
    "wind",
    Change::Scene(|s, _, f| {
        if let Some(wind) = &mut s.wind {
            wind.strength *= f;
        }
    }),
);
const GRAVITATIONAL: (&str, Change) = (
    "gravitational",
    Change::Scene(|s, at, f| each(&mut s.gravitational, at, |pair| pair.g *= f)),
);

/// Whether the scene has what a channel, or a known mistake, changes.
pub(super) fn has(scene: &Scene, what: &str) -> bool {
    match what {
        "gravity" => scene.solver.gravity != 0.0,
        "springs.stiffness" => scene.springs.iter().any(|s| s.stiffness != 0.0),
        "springs.damping" => scene.springs.iter().any(|s| s.damping != 0.0),
        "springs.rest_length" => scene.springs.iter().any(|s| s.rest_length != 0.0),
        "springs.cubic" => scene.springs.iter().any(|s| s.cubic != 0.0),
        "drag" => scene.particles.iter().any(|p| !p.fixed && p.drag != 0.0),
        "wind" => scene.wind.as_ref().is_some_and(|w| w.strength != 0.0),
        "gravitational" => !scene.gravitational.is_empty(),
        _ => true,
    }
}

/// The channels of the whole scene: its effects first, then mass, step and velocity.
pub(super) fn of_scene(scene: &Scene) -> Vec<Channel> {
    let velocity = |at| ("velocity", Change::Velocity(at));
    let all = [
        GRAVITY,
        STIFFNESS,
        DAMPING,
        REST_LENGTH,
        CUBIC,
        DRAG,
        WIND,
        GRAVITATIONAL,
        MASS,
        ("timestep", Change::Timestep),
        velocity(ScaledAt::Start),
        velocity(ScaledAt::Kick),
        velocity(ScaledAt::End),
    ];
    let there = all.into_iter().filter(|(what, _)| has(scene, what));
    there
        .map(|(what, change)| Channel {
            what,
            member: None,
            change,
        })
        .collect()
}

/// The channels of these particles, and of the springs that pull at them.
pub(super) fn of_members(scene: &Scene, particles: &[usize]) -> Vec<Channel> {
    let mut channels = Vec::new();
    let mut add = |(what, change): (&'static str, Change), member: usize, there: bool| {
        let member = Some(member);
        channels.extend(there.then_some(Channel {
            what,
            member,
            change,
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

/// The scheme with these channels' factors.
pub(super) fn varied(scene: &Scene, base: &Candidate, factors: &[(&Channel, f64)]) -> Candidate {
    let mut wrong = scene.clone();
    let mut altered = false;
    let mut candidate = base.clone();
    for (channel, factor) in factors {
        match channel.change {
            Change::Scene(change) => {
                change(&mut wrong, channel.member, *factor);
                altered = true;
            }
            Change::Timestep => candidate = candidate.stretched(*factor),
            Change::Velocity(at) => {
                let rates: Arc<[f64]> = vec![*factor; 3 * scene.particles.len()].into();
                let factor = |rate: f64, _: f64| rate;
                candidate = candidate.scaled(Scaling { factor, rates, at });
            }
        }
    }
    if altered {
        candidate = candidate.under(&ParticleSystem::new(&wrong));
    }
    candidate
}

/// The scheme with gravity along another axis, either way: with what deviates.
pub(super) fn turned(scene: &Scene, base: &Candidate) -> Vec<(Candidate, Deviation)> {
    let axes = [Axis::X, Axis::Y, Axis::Z].into_iter();
    let others = axes.filter(|axis| scene.solver.gravity != 0.0 && *axis != scene.up);
    let ways = others.flat_map(|axis| [(axis, 1.0), (axis, -1.0)]);
    ways.map(|(axis, factor)| {
        let mut wrong = scene.clone();
        wrong.up = axis;
        wrong.solver.gravity *= factor;
        let name = ["x", "y", "z"][axis.index()];
        let against = if factor < 0.0 { ", the other way" } else { "" };
        let deviation = Deviation {
            what: "axis".to_owned(),
            factor,
            place: Some(name.to_owned()),
            sentence: format!("gravity is along {name}{against}"),
        };
        (base.under(&ParticleSystem::new(&wrong)), deviation)
    })
    .collect()
}

impl Channel {
    /// Whether it can be told from other forms of the same channel under this scheme.
    pub(super) fn suits(&self, base: &Candidate) -> bool {
        match self.change {
            Change::Velocity(ScaledAt::Kick) => base.id == "symplectic_euler",
            _ => true,
        }
    }

    pub(super) fn deviation(&self, scene: &Scene, h: f64, factor: f64) -> Deviation {
        let place = match (self.change, self.member) {
            (Change::Velocity(ScaledAt::Start), _) => Some("before the kick".to_owned()),
            (Change::Velocity(ScaledAt::Kick), _) => Some("after the kick".to_owned()),
            (Change::Velocity(ScaledAt::End), _) => Some("at the end of the step".to_owned()),
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
                0.0 => "springs are missing".to_owned(),
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
            "drag" | "wind" if !one && factor == 0.0 => format!("{} is missing", self.what),
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
    } else if factor < 0.0 || factor > 2.0 {
        format!("{} times", digits(factor))
    } else {
        format!("{} of", digits(factor))
    }
}

/// Six digits, less trailing zeros.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded != 0.0 && (1e-3..1e6).contains(&rounded.abs()) {
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
