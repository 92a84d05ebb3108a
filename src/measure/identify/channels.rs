//! What a program may compute otherwise than the scene says: numbers of the scene, an axis of it, the step, a
//! factor on velocities. Each is a channel with a factor, 1 where the program is right.

use super::candidate::{Candidate, ScaledAt, Scaling};
use super::numbers::{NUMBERS, Number};
use super::result::Deviation;
use super::words::{digits, seconds, times};
use crate::scene::model::{BENDING, DRIVEN, SPRINGS, TRIANGLES};
use crate::scene::{Axis, Scene};

/// "spring 3 (particles 1 and 2)".
pub(super) fn spring(scene: &Scene, id: usize) -> String {
    let ends = scene.springs.get(id).map_or([0, 0], |spring| spring.ends);
    format!("spring {id} (particles {} and {})", ends[0], ends[1])
}

/// What a program may have wrong.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Channel {
    /// Multiplies a number in all its members.
    All(Number),
    /// Multiplies it in one; where the scene has 0, the program has so many of its unit more than 1.
    One(Number, usize),
    /// Multiplies all forces of one spring or hinge, named by its stiffness, that has several.
    Whole(Number, usize),
    /// Gives all members one number, so many times their mean.
    Alike(Number),
    /// Adds to gravity along an axis, so many times [`G`] as the factor is more than 1. All three are fitted together.
    Gravity(Axis),
    /// Turns the wind to an axis, and multiplies it.
    Wind(Axis),
    /// Multiplies the length of the step.
    Timestep,
    /// Multiplies velocities once a step.
    Velocity(ScaledAt),
}
use Channel::{Alike, All, Gravity, One, Timestep, Velocity, Whole, Wind};

/// m/s².
const G: f64 = 9.81;
const AXES: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];
/// Most digits of a number that a person would write.
const PLAIN: usize = 4;

/// The numbers that the forces of a spring or a hinge are linear in.
pub(super) fn forces(stiffness: Number) -> &'static [Number] {
    match stiffness {
        Number::Bend => &[Number::Bend, Number::BendDamping],
        _ => &[Number::Stiffness, Number::Cubic, Number::Damping],
    }
}

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
    let turned = AXES.map(Wind).into_iter().chain(AXES.map(Gravity));
    let turned = turned.filter(|channel| channel.is_in(scene));
    // A phase that the scene has 0 of too.
    let phase = |at: &usize| {
        scene.driven[*at]
            .sine
            .as_ref()
            .is_some_and(|sine| sine.phase == 0.0)
    };
    let phases = (0..scene.driven.len())
        .filter(phase)
        .map(|at| One(Number::Phase, at));
    let numbers = numbers
        .map(All)
        .chain(phases)
        .chain(others)
        .chain(alike.map(Alike));
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
        std::iter::once(Whole(Number::Stiffness, id)).chain(each)
    };
    springs.into_iter().flat_map(of)
}

/// The hinges at these particles.
pub(super) fn hinges_at(scene: &Scene, particles: &[usize]) -> Vec<usize> {
    let hinges = scene.bending.iter().enumerate();
    let at = hinges.filter(|(_, hinge)| hinge.particles.iter().any(|p| particles.contains(p)));
    at.map(|(id, _)| id).collect()
}

/// The channels of the hinges at these particles.
pub(super) fn of_hinges(
    scene: &Scene,
    particles: &[usize],
) -> impl Iterator<Item = Channel> + use<> {
    let numbers = [Number::Bend, Number::RestAngle, Number::BendDamping];
    hinges_at(scene, particles).into_iter().flat_map(move |id| {
        let each = numbers.map(|number| One(number, id));
        std::iter::once(Whole(Number::Bend, id)).chain(each)
    })
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
        matches!(self, Alike(_) | Wind(_))
    }

    /// Whether it is one of the three components of gravity.
    pub(super) fn is_component(self) -> bool {
        matches!(self, Gravity(_))
    }

    /// The number of the scene that it multiplies, with its value where that is one.
    fn number(self, scene: &Scene) -> Option<(Number, Option<f64>)> {
        match self {
            All(number) => Some((number, number.common(scene))),
            One(number, at) => Some((number, Some(number.value(scene, at)))),
            Alike(number) => Some((number, Some(number.mean(scene)))),
            Wind(_) => Some((Number::Wind, Some(Number::Wind.value(scene, 0)))),
            Whole(..) | Gravity(_) | Timestep | Velocity(_) => None,
        }
    }

    /// The factor nearest to this one that a person would have chosen, for itself or for the value that it makes:
    /// the one of fewest digits `within` so much. None if all have many.
    pub(super) fn rounded(self, scene: &Scene, h: f64, factor: f64, within: f64) -> Option<f64> {
        let number = self.number(scene);
        let inverse = matches!(number, Some((Number::Mass, _)));
        let (f, within) = match inverse {
            true => (1.0 / factor, within / (factor * factor)),
            false => (factor, within),
        };
        // The value is `one` at a factor of 1, and changes by so much with it.
        let (one, by) = match (self, number.and_then(|(_, value)| value)) {
            (Gravity(axis), _) => (scene.gravity()[axis.index()], G),
            (Timestep, _) => (h, h),
            (_, Some(0.0)) => (0.0, 1.0),
            (_, value) => (value.unwrap_or(1.0), value.unwrap_or(1.0)),
        };
        let value = one + by * (f - 1.0);
        let back = |value: f64| 1.0 + (value - one) / by;
        let whole = |count: usize| 1.0 / round(1.0 / value, count);
        let own = one == by && !matches!(self, Gravity(_));
        let near = |f_near: &f64| (f_near - f).abs() <= within;
        let found = (0..=PLAIN).find_map(|count| {
            let own = own.then(|| round(f, count));
            let per = (self == Timestep).then(|| back(whole(count)));
            let all = own
                .into_iter()
                .chain([back(round(value, count))])
                .chain(per);
            all.into_iter().find(near)
        })?;
        Some(if inverse { 1.0 / found } else { found }).filter(|found| found.is_finite())
    }

    /// Whether the scene has something of the kind to multiply, and to turn.
    pub(super) fn is_in(self, scene: &Scene) -> bool {
        match self {
            All(number) | Alike(number) => number.is_in(scene),
            One(number, at) => number.value(scene, at) != 0.0,
            Whole(stiffness, id) => count(scene, stiffness, id) > 1,
            Gravity(_) => Number::Gravity.is_in(scene),
            Wind(axis) => {
                let across = |direction: [f64; 3]| {
                    (0..3).any(|at| at != axis.index() && direction[at] != 0.0)
                };
                let wind = scene.wind.as_ref().map(|wind| wind.direction);
                Number::Wind.is_in(scene) && wind.is_some_and(across)
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
            Whole(stiffness, id) => {
                for number in forces(stiffness) {
                    number.change(scene, Some(id), |value| value * factor);
                }
            }
            Alike(number) => {
                let value = number.times(number.mean(scene), factor);
                number.change(scene, None, |_| value);
            }
            Gravity(axis) => {
                let mut more = [0.0; 3];
                more[axis.index()] = (factor - 1.0) * G;
                scene.solver.gravities.0.push(more);
            }
            Wind(axis) => {
                if let Some(wind) = &mut scene.wind {
                    wind.strength *= factor;
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
            Whole(stiffness, id) => (stiffness.part().key, Some(member(stiffness, id))),
            Alike(number) => (number.what(), Some("all alike".to_owned())),
            Gravity(axis) => ("gravity", Some(letter(axis))),
            Wind(axis) => ("wind", Some(letter(axis))),
            Timestep => ("timestep", None),
            Velocity(at) => ("velocity", Some(at.words().to_owned())),
        };
        let factor = match self {
            All(number) | One(number, _) | Alike(number) => number.times(1.0, factor),
            _ => factor,
        };
        let sentence = match self {
            All(number) => number.sentence(scene, factor),
            One(number @ (Number::Stiffness | Number::Bend), id)
                if factor == 0.0 && count(scene, number, id) == 1 =>
            {
                of_whole(scene, number, id, factor)
            }
            Whole(stiffness, id) => of_whole(scene, stiffness, id, factor),
            One(number, at) => of_member(scene, number, at, factor, 6),
            Alike(number) => {
                let noun = number.noun().replacen("the ", "a ", 1);
                let value = number.written(factor * number.mean(scene), 6);
                format!("all {} have {noun} of {value}", number.part().key)
            }
            Gravity(axis) => format!("gravity along {} is another", letter(axis)),
            Wind(axis) => along(scene, Number::Wind, axis, factor),
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
        match self {
            One(number, at) => {
                let right = number.value(scene, at);
                let wrong = found(number, right, factor);
                let told = digits(wrong, 4) != digits(right, 4);
                told.then(|| of_member(scene, number, at, factor, 4))
            }
            Timestep => {
                let (wrong, right) = (digits(h * factor, 4), digits(h, 4));
                (wrong != right).then(|| format!("the timestep is {wrong} s, not {right}"))
            }
            _ => None,
        }
    }
}

/// What is said of a number of one member, where its forces come with this factor.
fn of_member(scene: &Scene, number: Number, at: usize, factor: f64, count: usize) -> String {
    let right = number.value(scene, at);
    let wrong = found(number, right, factor);
    let name = name(scene, number, at);
    let vector = match number {
        Number::Gravity => !scene.solver.gravities.0.is_empty(),
        _ => number.is_vector(),
    };
    if vector {
        return number.sentence(scene, factor);
    }
    match number {
        Number::AirDrag if wrong == 0.0 => format!("{name} is missing"),
        _ => {
            let (wrong, right) = (number.written(wrong, count), digits(right, count));
            format!("{name} is {wrong}, not {right}")
        }
    }
}

/// "gravity is along y, the other way".
fn along(scene: &Scene, number: Number, axis: Axis, factor: f64) -> String {
    let also = match factor {
        1.0 => String::new(),
        -1.0 => ", the other way".to_owned(),
        _ => format!(", with {}", number.beside(scene, factor.abs())),
    };
    format!("{} is along {}{also}", number.what(), letter(axis))
}

/// What deviates where gravity has these components more than the scene's, each a factor.
pub(super) fn gravity(scene: &Scene, factors: &[(Channel, f64)]) -> Option<Deviation> {
    let right = scene.gravity();
    let mut wrong = right;
    for (channel, factor) in factors {
        if let Gravity(axis) = channel {
            let at = axis.index();
            let sum = right[at] + (factor - 1.0) * G;
            // What a difference of numbers leaves.
            let rest = 4.0 * f64::EPSILON * (right[at].abs() + G);
            wrong[at] = if sum.abs() <= rest { 0.0 } else { sum };
        }
    }
    let only = |g: [f64; 3]| {
        let along = |axis: &Axis| (0..3).all(|at| (g[at] != 0.0) == (at == axis.index()));
        AXES.into_iter().find(along)
    };
    let vector = |g: [f64; 3]| {
        let [x, y, z] = g.map(|g| digits(g, 6));
        format!("({x}, {y}, {z})")
    };
    let is = |sum: [f64; 3]| (0..3).all(|at| (sum[at] - wrong[at]).abs() <= 1e-6 * G);
    let vectors = &scene.solver.gravities.0;
    let plus = |times: f64| {
        let sum = |v: &&[f64; 3]| is([0, 1, 2].map(|at| right[at] + times * v[at]));
        vectors.iter().find(sum).map(|v| vector(*v))
    };
    let [x, y, z] = right;
    let swapped = [
        ([y, x, z], "x and y"),
        ([z, y, x], "x and z"),
        ([x, z, y], "y and z"),
    ];
    let turned = [([-x, y, z], "x"), ([x, -y, z], "y"), ([x, y, -z], "z")];
    let missing = || plus(-1.0).map(|v| format!(": the vector {v} is missing"));
    let twice = || plus(1.0).map(|v| format!(": the vector {v} acts twice"));
    let reversed = || plus(-2.0).map(|v| format!(": the vector {v} has the wrong sign"));
    let alone = || {
        let alone = vectors.iter().find(|v| is(**v))?;
        Some(format!(": the vector {} acts alone", vector(*alone)))
    };
    let exchanged = || {
        let (_, axes) = swapped.into_iter().find(|(g, _)| is(*g))?;
        Some(format!(": {axes} are exchanged"))
    };
    let sign = || {
        let (_, axis) = turned.into_iter().find(|(g, _)| is(*g))?;
        Some(format!(": its {axis} has the wrong sign"))
    };
    let why = missing().or_else(alone).or_else(twice).or_else(reversed);
    let why = why.or_else(exchanged).or_else(sign);
    let length = |g: [f64; 3]| g[0].hypot(g[1]).hypot(g[2]);
    let (what, factor, place) = match only(wrong) {
        Some(axis) => {
            let factor = wrong[axis.index()] / Number::Gravity.value(scene, 0);
            ("axis", factor, Some(letter(axis)))
        }
        None => ("gravity", length(wrong) / length(right), None),
    };
    let sentence = match (only(right), only(wrong)) {
        (Some(_), Some(axis)) => along(scene, Number::Gravity, axis, factor),
        _ => {
            let why = why.unwrap_or_default();
            format!(
                "gravity is {} m/s², not {}{why}",
                vector(wrong),
                vector(right)
            )
        }
    };
    factor.is_finite().then(|| Deviation {
        what: what.to_owned(),
        factor,
        place,
        sentence,
    })
}

/// How many forces a spring or a hinge has: its pull or its bending, and its damper.
fn count(scene: &Scene, stiffness: Number, id: usize) -> usize {
    let there = forces(stiffness).iter();
    there
        .filter(|number| number.value(scene, id) != 0.0)
        .count()
}

/// "spring 3 (particles 1 and 2)", "hinge 1".
pub(super) fn whole(scene: &Scene, stiffness: Number, id: usize) -> String {
    match stiffness {
        Number::Bend => member(stiffness, id),
        _ => spring(scene, id),
    }
}

/// A number rounded to so many digits; 0 has none.
fn round(value: f64, count: usize) -> f64 {
    match count {
        0 => 0.0,
        _ => format!("{value:.*e}", count - 1).parse().unwrap_or(value),
    }
}

/// What is said of a program that has so many times the forces of one spring or hinge.
fn of_whole(scene: &Scene, stiffness: Number, id: usize, factor: f64) -> String {
    let spring = whole(scene, stiffness, id);
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
    let noun = number.noun().replace(" at triangles", "");
    match number.part() {
        part if !part.list => noun,
        part if part.key.starts_with(DRIVEN.key) => {
            let drive = scene.driven.get(at).map_or(at, |driven| driven.particle);
            format!("{noun} of driven particle {drive}")
        }
        part if part.key == SPRINGS.key => format!("{noun} of {}", spring(scene, at)),
        part if part.key == TRIANGLES.key => format!("{noun} at {}", member(number, at)),
        _ => format!("{noun} of {}", member(number, at)),
    }
}

fn letter(axis: Axis) -> String {
    ["x", "y", "z"][axis.index()].to_owned()
}
