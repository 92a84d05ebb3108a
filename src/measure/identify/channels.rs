//! What a program may compute otherwise than the scene says: numbers of the scene, an axis of it, the step, a
//! factor on velocities. Each is a channel with a factor, 1 where the program is right.

use super::candidate::{Candidate, ScaledAt, Scaling};
use super::numbers::{NUMBERS, Number};
use super::result::Deviation;
use super::words::{digits, seconds, times};
use crate::scene::model::{BENDING, SPRINGS};
use crate::scene::{Axis, Scene, Vectors};

/// "spring 3 (particles 1 and 2)".
pub(super) fn spring(scene: &Scene, id: usize) -> String {
    let ends = scene.springs.get(id).map_or([0, 0], |spring| spring.ends);
    format!("spring {id} (particles {} and {})", ends[0], ends[1])
}

/// What a program may have wrong.
#[derive(Clone, Copy)]
pub(super) enum Channel {
    /// Multiplies a number in all its members.
    All(Number),
    /// Multiplies it in one; where the scene has 0, the program has so many of its unit more than 1.
    One(Number, usize),
    /// Multiplies all forces of one spring that has several.
    Spring(usize),
    /// Gives all members one number, so many times their mean.
    Alike(Number),
    /// Turns gravity, or the wind, to an axis, and multiplies it.
    Along(Number, Axis),
    /// Multiplies the length of the step.
    Timestep,
    /// Multiplies velocities once a step.
    Velocity(ScaledAt),
}
use Channel::{Alike, All, Along, One, Spring, Timestep, Velocity};

/// The numbers that a spring's forces are linear in.
const FORCES: [Number; 3] = [Number::Stiffness, Number::Cubic, Number::Damping];

/// The number that a known mistake changes, if it is one.
fn named(what: &str) -> Option<Number> {
    NUMBERS.into_iter().find(|number| number.what() == what)
}

/// Whether the scene has what a known mistake changes, where that is a number of it.
pub(super) fn has(scene: &Scene, what: &str) -> bool {
    named(what).is_none_or(|number| number.is_in(scene))
}

/// The scene with these numbers multiplied; None if it has none of them.
pub(super) fn scaled(scene: &Scene, factors: &[(&str, f64)]) -> Option<Scene> {
    let numbers = factors
        .iter()
        .filter_map(|(what, factor)| Some((named(what)?, *factor)));
    let there = numbers.filter(|(number, _)| number.is_in(scene));
    changed(scene, there.map(|(number, factor)| (All(number), factor)))
}

/// The scene with these factors; None where they leave it as it is.
pub(super) fn changed(
    scene: &Scene,
    factors: impl IntoIterator<Item = (Channel, f64)>,
) -> Option<Scene> {
    let mut wrong = scene.clone();
    for (channel, factor) in factors {
        channel.change(&mut wrong, factor);
    }
    (wrong != *scene).then_some(wrong)
}

/// The channels of the whole scene, in the order of preference: its effects first, then mass, step and
/// velocity.
pub(super) fn of_scene(scene: &Scene) -> Vec<Channel> {
    let numbers = NUMBERS.into_iter().filter(|number| number.is_in(scene));
    let others = [
        Timestep,
        Velocity(ScaledAt::Start),
        Velocity(ScaledAt::Kick),
        Velocity(ScaledAt::End),
    ];
    let differ = |number: &Number| {
        let values = number.values(scene);
        values.iter().any(|value| *value != values[0])
    };
    let alike = [Number::Stiffness, Number::Mass].into_iter().filter(differ);
    let axes = |number: Number| [Axis::X, Axis::Y, Axis::Z].map(|axis| Along(number, axis));
    let turned = [Number::Gravity, Number::Wind].into_iter().flat_map(axes);
    let turned = turned.filter(|channel| channel.is_in(scene));
    let numbers = numbers.map(All).chain(others).chain(alike.map(Alike));
    numbers.chain(turned).collect()
}

/// The springs that pull at these particles.
pub(super) fn springs_at(scene: &Scene, particles: &[usize]) -> Vec<usize> {
    let springs = scene.springs.iter().enumerate();
    let at = springs.filter(|(_, spring)| spring.ends.iter().any(|end| particles.contains(end)));
    at.map(|(id, _)| id).collect()
}

/// The channels of these springs; those that the scene has 0 of too.
pub(super) fn of_springs(springs: Vec<usize>) -> impl Iterator<Item = Channel> {
    let numbers = [
        Number::Stiffness,
        Number::RestLength,
        Number::Damping,
        Number::Cubic,
    ];
    let of = move |id| {
        let each = numbers.map(|number| One(number, id));
        std::iter::once(Spring(id)).chain(each)
    };
    springs.into_iter().flat_map(of)
}

/// The channels of the hinges at these particles.
pub(super) fn of_hinges(scene: &Scene, particles: &[usize]) -> impl Iterator<Item = Channel> {
    let numbers = [Number::Bend, Number::RestAngle, Number::BendDamping];
    let hinges = scene.bending.iter().enumerate();
    let at = hinges.filter(|(_, hinge)| hinge.particles.iter().any(|p| particles.contains(p)));
    at.flat_map(move |(id, _)| numbers.map(|number| One(number, id)))
}

/// The channels of these particles; those that the scene has 0 of too.
///
/// Of quadratic drag, of charges and of the triangles at them only where the scene has some, or a field: nobody adds those
/// by mistake.
pub(super) fn of_particles(scene: &Scene, particles: &[usize]) -> Vec<Channel> {
    let squared = Some(Number::QuadraticDrag).filter(|number| number.is_in(scene));
    let charge = scene.magnetic.as_ref().map(|_| Number::Charge);
    let numbers = [Some(Number::Mass), Some(Number::Drag), squared, charge];
    let numbers = || numbers.into_iter().flatten();
    let own = particles
        .iter()
        .flat_map(|&i| numbers().map(move |number| One(number, i)));
    let triangles = scene.triangles.iter().enumerate();
    let at = triangles.filter(|(_, t)| t.corners.iter().any(|corner| particles.contains(corner)));
    own.chain(at.map(|(id, _)| One(Number::AirDrag, id)))
        .collect()
}

impl Channel {
    /// Whether a factor of 1 changes the scene.
    pub(super) fn switches(self) -> bool {
        matches!(self, Alike(_) | Along(..))
    }

    /// Whether the scene has something of the kind to multiply, and to turn.
    pub(super) fn is_in(self, scene: &Scene) -> bool {
        match self {
            All(number) | Alike(number) => number.is_in(scene),
            One(number, at) => number.value(scene, at) != 0.0,
            Spring(id) => forces(scene, id) > 1,
            Along(number, axis) => {
                let direction = match (number, &scene.wind) {
                    (Number::Wind, Some(wind)) => wind.direction,
                    _ => scene.gravity(),
                };
                let across = |at: usize| at != axis.index() && direction[at] != 0.0;
                number.is_in(scene) && (0..3).any(across)
            }
            Timestep | Velocity(_) => true,
        }
    }

    /// Whether it can be told from other forms of the same channel under this scheme.
    pub(super) fn suits(self, base: &Candidate) -> bool {
        !matches!(self, Velocity(ScaledAt::Kick)) || base.id == "symplectic_euler"
    }

    fn change(self, scene: &mut Scene, factor: f64) {
        match self {
            All(number) => number.change(scene, None, |value| number.times(value, factor)),
            One(number, at) => number.change(scene, Some(at), |value| found(number, value, factor)),
            Spring(id) => {
                for number in FORCES {
                    number.change(scene, Some(id), |value| value * factor);
                }
            }
            Alike(number) => {
                let value = number.times(number.mean(scene), factor);
                number.change(scene, None, |_| value);
            }
            Along(number, axis) => {
                number.change(scene, None, |value| value * factor);
                if number == Number::Gravity {
                    scene.solver.gravity = number.value(scene, 0);
                    scene.solver.gravities = Vectors::default();
                    scene.up = axis;
                } else if let Some(wind) = &mut scene.wind {
                    wind.direction = [0.0; 3];
                    wind.direction[axis.index()] = 1.0;
                }
            }
            Timestep | Velocity(_) => {}
        }
    }

    /// The scheme with this factor, of a channel that is none of the scene.
    pub(super) fn step(self, scheme: Candidate, coordinates: usize, factor: f64) -> Candidate {
        match self {
            Timestep => scheme.stretched(factor),
            Velocity(at) => scheme.scaled(Scaling {
                factor: |rate, _| rate,
                rates: vec![factor; coordinates].into(),
                at,
            }),
            _ => scheme,
        }
    }

    /// What deviates where steps of `h` seconds have this factor.
    pub(super) fn deviation(self, scene: &Scene, h: f64, factor: f64) -> Deviation {
        let (what, place) = match self {
            All(number) => (number.what(), None),
            One(number, at) => (number.what(), Some(member(number, at))),
            Spring(id) => ("springs", Some(format!("spring {id}"))),
            Alike(number) => (number.what(), Some("all alike".to_owned())),
            Along(Number::Gravity, axis) => ("axis", Some(letter(axis))),
            Along(number, axis) => (number.what(), Some(letter(axis))),
            Timestep => ("timestep", None),
            Velocity(at) => ("velocity", Some(at.words().to_owned())),
        };
        let factor = match self {
            All(number) | One(number, _) | Alike(number) => number.times(1.0, factor),
            _ => factor,
        };
        let sentence = match self {
            All(number) => number.sentence(scene, factor),
            One(Number::Stiffness, id) if factor == 0.0 && forces(scene, id) == 1 => {
                of_spring(scene, id, factor)
            }
            Spring(id) => of_spring(scene, id, factor),
            One(number, at) => {
                format!(
                    "{} is {} the scene's",
                    name(scene, number, at),
                    times(factor)
                )
            }
            Alike(number) => {
                let noun = number.noun().replacen("the ", "a ", 1);
                let (value, unit) = (digits(factor * number.mean(scene), 6), number.unit());
                format!("all {} have {noun} of {value} {unit}", number.part().key)
            }
            Along(number, axis) => {
                let (what, axis) = (number.what(), letter(axis));
                let also = match factor {
                    1.0 => String::new(),
                    -1.0 => ", the other way".to_owned(),
                    _ => format!(", with {}", number.beside(scene, factor)),
                };
                format!("{what} is along {axis}{also}")
            }
            Timestep => format!(
                "the step is {} s, not {} s",
                seconds(factor * h),
                digits(h, 6)
            ),
            Velocity(at) => {
                let factor = digits(factor, 6);
                format!(
                    "velocities are multiplied by {factor} a step, {}",
                    at.words()
                )
            }
        };
        Deviation {
            what: what.to_owned(),
            factor,
            place,
            sentence,
        }
    }

    /// Its value with this factor beside the right one, in words; None where four digits do not tell them apart,
    /// and of what has no value of its own.
    pub(super) fn value(self, scene: &Scene, h: f64, factor: f64) -> Option<String> {
        let (name, unit, wrong, right) = match self {
            One(number, at) => {
                let right = number.value(scene, at);
                (
                    name(scene, number, at),
                    number.unit(),
                    found(number, right, factor),
                    right,
                )
            }
            Timestep => ("the timestep".to_owned(), "s", h * factor, h),
            _ => return None,
        };
        let (wrong, right) = (digits(wrong, 4), digits(right, 4));
        (wrong != right).then(|| format!("{name} is {wrong} {unit}, not {right}"))
    }
}

/// How many forces a spring has: its linear and cubic pull, and its damper.
fn forces(scene: &Scene, id: usize) -> usize {
    let there = FORCES
        .iter()
        .filter(|number| number.value(scene, id) != 0.0);
    there.count()
}

/// What is said of a program that has so many times the forces of one spring.
fn of_spring(scene: &Scene, id: usize, factor: f64) -> String {
    let spring = spring(scene, id);
    match factor {
        0.0 => format!("{spring} is missing"),
        2.0 => format!("{spring} acts twice"),
        _ => format!("{spring} acts with {} its force", times(factor)),
    }
}

/// What a program has in one member where the scene has `value`.
fn found(number: Number, value: f64, factor: f64) -> f64 {
    if value == 0.0 {
        factor - 1.0
    } else {
        number.times(value, factor)
    }
}

/// "spring 3".
fn member(number: Number, at: usize) -> String {
    if number.part().key == BENDING.key {
        return format!("hinge {at}");
    }
    format!("{} {at}", number.part().key.trim_end_matches('s'))
}

/// "the stiffness of spring 3 (particles 1 and 2)".
fn name(scene: &Scene, number: Number, at: usize) -> String {
    let noun = number.noun();
    match number.part() {
        part if !part.list => noun,
        part if part.key == SPRINGS.key => format!("{noun} of {}", spring(scene, at)),
        _ => format!("{noun} of {}", member(number, at)),
    }
}

fn letter(axis: Axis) -> String {
    ["x", "y", "z"][axis.index()].to_owned()
}
