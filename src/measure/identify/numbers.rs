//! The numbers of a scene that a program may have wrong, each a key of the scene's table, with the sentences that
//! say so.

use super::words::{digits, times};
use crate::scene::model::{
    AIR, BENDING, DRIVEN, GRAVITATIONAL, PARTICLES, Part, Row, SINE, SOLVER, SPRINGS, TRIANGLES,
    ValueKind, WIND,
};
use crate::scene::{Scene, Value};

/// A number of a scene, in one member of its part or in all. Of a vector it is the length, with the sign of its
/// largest component.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Gravity,
    Stiffness,
    Damping,
    RestLength,
    Cubic,
    /// The stiffness of hinges.
    Bend,
    RestAngle,
    BendDamping,
    Drag,
    QuadraticDrag,
    AirDrag,
    AirVelocity,
    Charge,
    Wind,
    Attraction,
    /// The amplitude of driven particles' sines, their rate and phase; the velocity of those that move steadily.
    Amplitude,
    Omega,
    Phase,
    Steady,
    Mass,
}
use Number::{
    AirDrag, AirVelocity, Amplitude, Attraction, Bend, BendDamping, Charge, Cubic, Damping, Drag,
    Gravity, Mass, Omega, Phase, QuadraticDrag, RestAngle, RestLength, Steady, Stiffness, Wind,
};

/// In the order in which they are suspected.
pub(super) const NUMBERS: [Number; 20] = [
    Gravity,
    Stiffness,
    Damping,
    RestLength,
    Cubic,
    Bend,
    RestAngle,
    BendDamping,
    Drag,
    QuadraticDrag,
    AirDrag,
    AirVelocity,
    Charge,
    Wind,
    Attraction,
    Amplitude,
    Omega,
    Phase,
    Steady,
    Mass,
];

impl Number {
    /// As deviations name it, and its place in the scene's table.
    fn key(self) -> (&'static str, &'static Part, &'static str) {
        match self {
            Gravity => ("gravity", &SOLVER, "gravity"),
            Stiffness => ("springs.stiffness", &SPRINGS, "stiffness"),
            Damping => ("springs.damping", &SPRINGS, "damping"),
            RestLength => ("springs.rest_length", &SPRINGS, "rest_length"),
            Cubic => ("springs.cubic", &SPRINGS, "cubic"),
            Bend => ("bending.stiffness", &BENDING, "stiffness"),
            RestAngle => ("bending.rest_angle", &BENDING, "rest_angle"),
            BendDamping => ("bending.damping", &BENDING, "damping"),
            Drag => ("drag", &PARTICLES, "drag"),
            QuadraticDrag => ("quadratic_drag", &PARTICLES, "quadratic_drag"),
            AirDrag => ("air_drag", &TRIANGLES, "air_drag"),
            AirVelocity => ("air.velocity", &AIR, "velocity"),
            Charge => ("charge", &PARTICLES, "charge"),
            Wind => ("wind", &WIND, "strength"),
            Attraction => ("gravitational", &GRAVITATIONAL, "G"),
            Amplitude => ("driven.sine.amplitude", &SINE, "amplitude"),
            Omega => ("driven.sine.omega", &SINE, "omega"),
            Phase => ("driven.sine.phase", &SINE, "phase"),
            Steady => ("driven.velocity", &DRIVEN, "velocity"),
            Mass => ("mass", &PARTICLES, "mass"),
        }
    }

    /// As [`Deviation::what`](super::Deviation::what).
    pub(super) fn what(self) -> &'static str {
        self.key().0
    }

    pub(super) fn part(self) -> &'static Part {
        self.key().1
    }

    /// Its rows: a second one where vectors may stand in the place of a number.
    fn rows(self) -> impl Iterator<Item = &'static Row> {
        let (_, part, key) = self.key();
        part.rows.iter().filter(move |row| row.key == key)
    }

    /// The row that holds it in this scene.
    fn row(self, scene: &Scene, at: usize) -> Option<&'static Row> {
        let given = |row: &&Row| (row.get)(scene, at, 0).is_some();
        self.rows().filter(given).last()
    }

    /// A value in its unit, as people write it.
    pub(super) fn written(self, value: f64, count: usize) -> String {
        let value = digits(value, count);
        match self.rows().next().map(|row| &row.kind) {
            Some(ValueKind::Number(bounds) | ValueKind::Numbers(_, bounds))
                if bounds.unit != "a pure number" =>
            {
                format!("{value} {}", bounds.unit)
            }
            _ => value,
        }
    }

    /// Whether it is the length of a vector.
    pub(super) fn is_vector(self) -> bool {
        let kinds = self.rows().map(|row| &row.kind);
        kinds
            .last()
            .is_some_and(|kind| !matches!(kind, ValueKind::Number(_)))
    }

    /// In the member of this index; 0 where there is none.
    pub(super) fn value(self, scene: &Scene, at: usize) -> f64 {
        let Some(row) = self.row(scene, at) else {
            return 0.0;
        };
        let mut sum = [0.0_f64; 3];
        for (component, value) in row.values(scene, at).filter_map(number).enumerate() {
            sum[component % 3] += value;
        }
        let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        let sign = sum.into_iter().fold(0.0, larger).signum();
        sum[0].hypot(sum[1]).hypot(sum[2]) * sign
    }

    /// In every member that it acts on: a fixed particle has neither inertia nor drag.
    pub(super) fn values(self, scene: &Scene) -> Vec<f64> {
        let part = self.part();
        let acts = |at: &usize| match self {
            AirVelocity => [Drag, QuadraticDrag, AirDrag]
                .iter()
                .any(|drag| drag.is_in(scene)),
            _ => part.key != PARTICLES.key || !scene.particles[*at].fixed,
        };
        let members = (0..(part.count)(scene)).filter(acts);
        members.map(|at| self.value(scene, at)).collect()
    }

    /// The mean over the members that it acts on.
    pub(super) fn mean(self, scene: &Scene) -> f64 {
        let values = self.values(scene);
        values.iter().sum::<f64>() / values.len().max(1) as f64
    }

    pub(super) fn is_in(self, scene: &Scene) -> bool {
        // A charge does nothing without a field.
        let acts = self != Charge || scene.magnetic.is_some();
        acts && self.values(scene).iter().any(|value| *value != 0.0)
    }

    /// Replaces it in one member, or in all.
    pub(super) fn change(self, scene: &mut Scene, at: Option<usize>, to: impl Fn(f64) -> f64) {
        for at in at.map_or(0..(self.part().count)(scene), |at| at..at + 1) {
            let Some(row) = self.row(scene, at).or_else(|| self.rows().next()) else {
                return;
            };
            let (before, after) = (self.value(scene, at), to(self.value(scene, at)));
            if let ValueKind::Number(_) = row.kind {
                (row.set)(scene, at, 0, Value::Number(after));
            } else if before != 0.0 {
                let components: Vec<f64> = row.values(scene, at).filter_map(number).collect();
                for (component, value) in components.into_iter().enumerate() {
                    let value = Value::Number(value * (after / before));
                    (row.set)(scene, at, component, value);
                }
            }
        }
    }

    /// A value with a fit's factor: forces are linear in the inverse of a mass.
    pub(super) fn times(self, value: f64, factor: f64) -> f64 {
        match self {
            Mass => value / factor,
            _ => value * factor,
        }
    }

    /// "the stiffness".
    pub(super) fn noun(self) -> String {
        match self {
            Gravity => "gravity".to_owned(),
            Cubic => "the cubic stiffness".to_owned(),
            QuadraticDrag => "the quadratic drag".to_owned(),
            AirDrag => "the drag of the air at triangles".to_owned(),
            AirVelocity => "the velocity of the air".to_owned(),
            Wind => "the strength of the wind".to_owned(),
            Bend => "the bending stiffness".to_owned(),
            BendDamping => "the bending damping".to_owned(),
            Omega => "the rate of the phase".to_owned(),
            Steady => "the velocity of what is driven".to_owned(),
            Attraction => "the constant of attraction".to_owned(),
            _ => format!("the {}", self.key().2.replace('_', " ")),
        }
    }

    /// What is said of a program that has so many times as much of it, in all members.
    pub(super) fn sentence(self, scene: &Scene, factor: f64) -> String {
        let times = times(factor);
        match (self, factor) {
            (Stiffness, 0.0) => "springs do not pull".to_owned(),
            (Stiffness, -1.0) => "springs push where they should pull".to_owned(),
            (Stiffness, _) => format!("springs act with {times} their stiffness"),
            (Damping, 0.0) => "the springs' dampers are missing".to_owned(),
            (Damping, -1.0) => "the springs' dampers have the wrong sign".to_owned(),
            (Damping, _) => format!("dampers act with {times} the scene's damping"),
            (RestLength, 0.0) => "the rest length of springs is taken for 0".to_owned(),
            (RestLength, _) => format!("springs have {times} their rest length"),
            (Cubic, 0.0) => "the cubic part of the springs is missing".to_owned(),
            (Cubic, _) => format!("the cubic part of the springs is {times} the scene's"),
            (AirVelocity, 0.0) => "drag acts as if the air were at rest".to_owned(),
            (AirVelocity, -1.0) => "the air moves the other way".to_owned(),
            (AirVelocity, _) => format!("the air moves with {}", self.beside(scene, factor)),
            (Steady, 0.0) => "what is driven at a velocity does not move".to_owned(),
            (Steady, -1.0) => "what is driven at a velocity moves the other way".to_owned(),
            (Phase, 0.0) => "the phase of the drive is taken for 0".to_owned(),
            (Amplitude, -1.0) => "the drive swings the other way".to_owned(),
            (Amplitude | Omega | Phase | Steady, _) => {
                let noun = self
                    .noun()
                    .replace(" of the phase", "")
                    .replace(" of what is driven", "");
                format!("{noun} of the drive is {}", self.beside(scene, factor))
            }
            (QuadraticDrag | AirDrag, 0.0) => format!("{} is missing", self.noun()),
            (QuadraticDrag | AirDrag, _) => format!("{} is {times} the scene's", self.noun()),
            (Bend, 0.0) => "hinges do not resist bending".to_owned(),
            (Bend, -1.0) => "hinges push away from their rest angle".to_owned(),
            (Bend, _) => format!("hinges act with {times} their bending stiffness"),
            (BendDamping, 0.0) => "the hinges' dampers are missing".to_owned(),
            (BendDamping, _) => format!("the hinges' dampers act with {times} their damping"),
            (RestAngle, 0.0) => "the rest angle of hinges is taken for 0".to_owned(),
            (RestAngle, _) => {
                let times = self
                    .beside(scene, factor)
                    .replace("the scene's", "their rest angle");
                format!("hinges have {times}")
            }
            (Charge, 0.0) => "the magnetic force is missing".to_owned(),
            (Charge, -1.0) => "the magnetic force has the wrong sign: it is q v x B".to_owned(),
            (Charge, _) => format!("the magnetic force is {times} the scene's"),
            (_, 0.0) => format!("{} is missing", self.what()),
            (Gravity, _) => format!("gravity acts with {}", self.beside(scene, factor)),
            _ => format!("the {} is {times} the scene's", self.what()),
        }
    }

    /// Its value where all that have it have the same.
    pub(super) fn common(self, scene: &Scene) -> Option<f64> {
        let there = self.values(scene).into_iter().filter(|value| *value != 0.0);
        let there: Vec<f64> = there.collect();
        let first = *there.first()?;
        there.iter().all(|value| *value == first).then_some(first)
    }

    /// "half the scene's: 4.905 for 9.81 m/s²", without values where a scene has several.
    pub(super) fn beside(self, scene: &Scene, factor: f64) -> String {
        let times = times(factor);
        let Some(value) = self.common(scene) else {
            return format!("{times} the scene's");
        };
        // Of a vector its length.
        let value = if self.is_vector() { value.abs() } else { value };
        let (found, right) = (digits(factor * value, 6), self.written(value, 6));
        format!("{times} the scene's: {found} for {right}")
    }
}

fn number(value: Value) -> Option<f64> {
    match value {
        Value::Number(value) => Some(value),
        _ => None,
    }
}
