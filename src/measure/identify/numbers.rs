//! The numbers of a scene that a program may have wrong, each a key of the scene's table, with the sentences that
//! say so.

use super::words::{digits, times};
use crate::scene::model::{
    BENDING, GRAVITATIONAL, PARTICLES, Part, Row, SOLVER, SPRINGS, ValueKind, WIND,
};
use crate::scene::{Scene, Value};

/// A number of a scene, in one member of its part or in all.
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
    Charge,
    Wind,
    Attraction,
    Mass,
}
use Number::{
    Attraction, Bend, BendDamping, Charge, Cubic, Damping, Drag, Gravity, Mass, RestAngle,
    RestLength, Stiffness, Wind,
};

/// In the order in which they are suspected.
pub(super) const NUMBERS: [Number; 13] = [
    Gravity,
    Stiffness,
    Damping,
    RestLength,
    Cubic,
    Bend,
    RestAngle,
    BendDamping,
    Drag,
    Charge,
    Wind,
    Attraction,
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
            Charge => ("charge", &PARTICLES, "charge"),
            Wind => ("wind", &WIND, "strength"),
            Attraction => ("gravitational", &GRAVITATIONAL, "G"),
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

    fn row(self) -> Option<&'static Row> {
        let (_, part, key) = self.key();
        part.rows.iter().find(|row| row.key == key)
    }

    /// The unit that its value is written in.
    pub(super) fn unit(self) -> &'static str {
        match self.row().map(|row| &row.kind) {
            Some(ValueKind::Number(bounds)) => bounds.unit,
            _ => "",
        }
    }

    /// In the member of this index; 0 where there is none.
    pub(super) fn value(self, scene: &Scene, at: usize) -> f64 {
        match self.row().and_then(|row| (row.get)(scene, at, 0)) {
            Some(Value::Number(value)) => value,
            _ => 0.0,
        }
    }

    /// In every member that it acts on: a fixed particle has neither inertia nor drag.
    pub(super) fn values(self, scene: &Scene) -> Vec<f64> {
        let part = self.part();
        let acts = |at: &usize| part.key != PARTICLES.key || !scene.particles[*at].fixed;
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
        let Some(row) = self.row() else { return };
        for at in at.map_or(0..(self.part().count)(scene), |at| at..at + 1) {
            let value = to(self.value(scene, at));
            (row.set)(scene, at, 0, Value::Number(value));
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
            Wind => "the strength of the wind".to_owned(),
            Bend => "the bending stiffness".to_owned(),
            BendDamping => "the bending damping".to_owned(),
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
            (Damping, _) => format!("dampers act with {times} the scene's damping"),
            (RestLength, 0.0) => "the rest length of springs is taken for 0".to_owned(),
            (RestLength, _) => format!("springs have {times} their rest length"),
            (Cubic, 0.0) => "the cubic part of the springs is missing".to_owned(),
            (Cubic, _) => format!("the cubic part of the springs is {times} the scene's"),
            (Bend, 0.0) => "hinges do not resist bending".to_owned(),
            (Bend, -1.0) => "hinges push away from their rest angle".to_owned(),
            (Bend, _) => format!("hinges act with {times} their bending stiffness"),
            (BendDamping, 0.0) => "the hinges' dampers are missing".to_owned(),
            (BendDamping, _) => format!("the hinges' dampers act with {times} their damping"),
            (RestAngle, 0.0) => "the rest angle of hinges is taken for 0".to_owned(),
            (RestAngle, _) => format!("hinges have {times} their rest angle"),
            (Charge, 0.0) => "the magnetic force is missing".to_owned(),
            (Charge, -1.0) => "the magnetic force has the wrong sign: it is q v x B".to_owned(),
            (Charge, _) => format!("the magnetic force is {times} the scene's"),
            (_, 0.0) => format!("{} is missing", self.what()),
            (Gravity, _) => format!("gravity acts with {}", self.beside(scene, factor)),
            _ => format!("the {} is {times} the scene's", self.what()),
        }
    }

    /// "half the scene's: 4.905 for 9.81 m/s²", of a number that a scene has once.
    pub(super) fn beside(self, scene: &Scene, factor: f64) -> String {
        let value = self.value(scene, 0).abs();
        let [found, right] = [factor * value, value].map(|value| digits(value, 6));
        let (times, unit) = (times(factor), self.unit());
        format!("{times} the scene's: {found} for {right} {unit}")
    }
}
