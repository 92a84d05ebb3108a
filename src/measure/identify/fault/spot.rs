//! One transition that left the scheme: the particles that are off, by how much, and where another
//! candidate would arrive.

use super::super::Question;
use super::super::candidate::Candidate;
use super::super::replay::{FIT, Replay};
use super::super::transition::Transition;
use super::super::words::digits;
use super::NUDGES;
use crate::measure::identify::{Fault, Quantity};
use crate::physics::State;
use std::ops::Range;

/// Two errors within this fraction of each other are equally large.
const TIE: f64 = 1e-3;

/// The first transition that departs.
pub(super) struct Spot<'a> {
    pub(super) question: &'a Question<'a>,
    pub(super) replay: &'a Replay<'a>,
    pub(super) followed: &'a Candidate,
    pub(super) at: Transition,
    /// The state predicted by the scheme.
    pub(super) predicted: State,
    /// What rounding explains of each number: positions, then velocities.
    pub(super) units: Vec<f64>,
    /// How far the scheme is off, in units.
    pub(super) defect: f64,
    /// The particles that are off, in order.
    pub(super) off: Vec<usize>,
    /// The one that is off farthest.
    pub(super) worst: usize,
    pub(super) quantity: Quantity,
    pub(super) transitions: &'a [Transition],
    /// Indices of the transitions that depart, from this one on.
    pub(super) departures: &'a [usize],
}

impl<'a> Spot<'a> {
    /// The first of these departures; None without any, or if rounding explains it.
    pub(super) fn new(
        question: &'a Question<'a>,
        replay: &'a Replay<'a>,
        followed: &'a Candidate,
        transitions: &'a [Transition],
        departures: &'a [usize],
    ) -> Option<Self> {
        let at = *transitions.get(*departures.first()?)?;
        let mut replayer = followed.replayer(&replay.settings);
        let predicted = replay.predict(&mut replayer, &at).ok()?;
        let units = replay.units(&mut replayer, &at, &predicted, NUDGES).ok()?;
        let mut spot = Self {
            question,
            replay,
            followed,
            at,
            defect: replay.farthest(&at, &predicted, &units),
            predicted,
            units,
            off: Vec::new(),
            worst: 0,
            quantity: Quantity::Velocity,
            transitions,
            departures,
        };
        spot.find_worst();
        (!spot.off.is_empty()).then_some(spot)
    }

    /// Forces act on velocities, so these are looked at first.
    fn find_worst(&mut self) {
        let with = |quantity| {
            let particles = 0..self.replay.rows.dim / 3;
            let off = particles.filter(|i| self.has_off(quantity, *i));
            off.collect::<Vec<usize>>()
        };
        let (moving, moved) = (with(Quantity::Velocity), with(Quantity::Position));
        let (quantity, with) = match moving.is_empty() {
            true => (Quantity::Position, &moved),
            false => (Quantity::Velocity, &moving),
        };
        let distance = |i: &usize| {
            let axes = (0..3).map(|axis| self.difference(quantity, 3 * i + axis));
            let squares: f64 = axes.map(|d| d * d).sum();
            if squares.is_nan() {
                f64::INFINITY
            } else {
                squares.sqrt()
            }
        };
        let most = with.iter().map(distance).fold(0.0, f64::max);
        let worst = with.iter().find(|i| distance(i) >= (1.0 - TIE) * most);
        self.worst = worst.copied().unwrap_or(0);
        self.quantity = quantity;
        self.off = [moving, moved].concat();
        self.off.sort_unstable();
        self.off.dedup();
    }

    /// The numbers of the predicted state.
    pub(super) fn predicted(&self, quantity: Quantity) -> &[f64] {
        match quantity {
            Quantity::Position => &self.predicted.x,
            Quantity::Velocity => &self.predicted.v,
        }
    }

    /// The recorded number minus the predicted one; 0 of velocities that are not recorded.
    pub(super) fn difference(&self, quantity: Quantity, i: usize) -> f64 {
        match quantity {
            Quantity::Velocity if self.replay.rows.v.is_none() => 0.0,
            _ if self.replay.is_driven(i) => 0.0,
            _ => self.found(quantity, i) - self.predicted(quantity)[i],
        }
    }

    /// The part of the difference that rounding explains.
    pub(super) fn unit(&self, quantity: Quantity, i: usize) -> f64 {
        let place = match quantity {
            Quantity::Position => i,
            Quantity::Velocity => self.replay.rows.dim + i,
        };
        self.units.get(place).copied().unwrap_or(f64::INFINITY)
    }

    pub(super) fn is_off(&self, quantity: Quantity, i: usize) -> bool {
        let difference = self.difference(quantity, i).abs();
        difference.is_nan() || difference > FIT * self.unit(quantity, i)
    }

    /// Whether some number of a particle is off.
    pub(super) fn has_off(&self, quantity: Quantity, particle: usize) -> bool {
        (0..3).any(|axis| self.is_off(quantity, 3 * particle + axis))
    }

    /// The number recorded at the end of the transition.
    pub(super) fn found(&self, quantity: Quantity, i: usize) -> f64 {
        let rows = self.replay.rows;
        let row = match quantity {
            Quantity::Position => rows.x(self.at.to),
            Quantity::Velocity => rows.v(self.at.to).unwrap_or(&[]),
        };
        row.get(i).copied().unwrap_or(f64::NAN)
    }

    /// The first step of the transition.
    pub(super) fn step(&self) -> u64 {
        self.replay.rows.steps[self.at.from]
    }

    pub(super) fn span(&self) -> u64 {
        self.at.span(self.replay.rows)
    }

    /// Largest difference of a state from the recorded row, in units; infinite of none.
    pub(super) fn distance(&self, state: Option<&State>) -> f64 {
        let Some(state) = state else {
            return f64::INFINITY;
        };
        self.replay.farthest(&self.at, state, &self.units)
    }

    /// The state at the end by `candidate`, in `steps` steps; None where it cannot take them. Without
    /// velocities, `leg` leads to the start.
    pub(super) fn arrive(
        &self,
        leg: &Candidate,
        candidate: &Candidate,
        steps: u64,
    ) -> Option<State> {
        let rows = self.replay.rows;
        let mut state = self.replay.state(self.at.from, None);
        let mut before = self.at.before.map(|k| (k, self.replay.state(k, None)));
        if rows.v.is_none() {
            let (k, earlier) = before.as_mut()?;
            let mut replayer = leg.replayer(&self.replay.settings);
            let way = self.replay.leg(*k, self.at.from);
            way.find(&mut replayer, earlier, &mut state).ok()?;
        }
        let one_back = before.filter(|(k, _)| rows.steps[*k] + 1 == self.step());
        let one_back = one_back.map(|(_, state)| state);
        self.advance(candidate, 0..steps, one_back.as_ref(), state)
    }

    /// A state after these steps of the transition by `candidate`; None where it cannot take them.
    pub(super) fn advance(
        &self,
        candidate: &Candidate,
        steps: Range<u64>,
        before: Option<&State>,
        mut state: State,
    ) -> Option<State> {
        let (start, h) = (self.step() + steps.start, self.replay.rows.timestep);
        let mut replayer = candidate.replayer(&self.replay.settings);
        let count = steps.end - steps.start;
        let stepped = replayer.advance(start, count, h, before, &mut state);
        stepped.ok().filter(|()| state.is_finite()).map(|()| state)
    }

    /// Number of departures after this one that it did not cause itself.
    pub(super) fn again(&self) -> usize {
        let first = self.departures.first().copied().unwrap_or(0);
        // Without velocities a transition is seen from three rows, so one fault shows up to thrice.
        let echo = if self.replay.rows.v.is_some() { 0 } else { 2 };
        let own = |&&place: &&usize| place <= first + echo;
        self.departures.len() - self.departures.iter().filter(own).count()
    }

    /// How long a change lasts that does: to the end, or to the last step of an unbroken row of
    /// departures.
    pub(super) fn how_long(&self) -> String {
        let first = self.departures.first().copied().unwrap_or(0);
        let mut unbroken = (first..).zip(self.departures).take_while(|(a, b)| a == *b);
        let last = unbroken.by_ref().last().map_or(first, |(place, _)| place);
        let follows = self.transitions.len() - 1 - last;
        let whole = last - first + 1 == self.departures.len();
        match self.transitions.get(last) {
            Some(end) if whole && follows > 0 && last > first => {
                let until = self.replay.rows.steps[end.to].saturating_sub(1);
                format!("from this step to step {until}")
            }
            _ if self.span() > 1 => format!("from these {} steps on", self.span()),
            _ => "from this step on".to_owned(),
        }
    }

    /// When it happens, as the beginning of a sentence.
    pub(super) fn how_often(&self) -> String {
        let here = match self.span() {
            0 | 1 => "in this step".to_owned(),
            span => format!("within these {span} steps"),
        };
        let first = self.departures.first().copied().unwrap_or(0);
        match (
            self.again(),
            self.transitions.len().saturating_sub(first + 1),
        ) {
            (0, 0) => here,
            (0, _) => format!("{here} only"),
            (again, after) => {
                format!(
                    "{here}, and {again} of the {after} transitions after it leave the scheme too"
                )
            }
        }
    }

    /// The fault of a scheme that is wrong in every step.
    pub(super) fn throughout(&self, says: String) -> Fault {
        Fault {
            explanation: says,
            ..self.fault(self.step(), String::new())
        }
    }

    /// The fault of a treatment of contact, with the number of steps that show it.
    pub(super) fn counted(&self, says: String) -> Fault {
        let steps = match self.departures.len() {
            1 => "in one step".to_owned(),
            all => format!("in {all} steps"),
        };
        self.throughout(format!("{says}: {steps}"))
    }

    /// The fault with this step and explanation; the number of particles that are off is added.
    pub(super) fn fault(&self, step: u64, says: String) -> Fault {
        let at = 3 * self.worst;
        let row = self.predicted(self.quantity);
        let found =
            |axis: usize| Some(self.found(self.quantity, at + axis)).filter(|c| c.is_finite());
        let particles = self.replay.rows.dim / 3;
        let count = match self.off.len() {
            0 | 1 => String::new(),
            off if off == particles => format!("; all {particles} particles leave the scheme"),
            off => format!("; {off} of {particles} particles leave the scheme"),
        };
        Fault {
            step,
            t_s: step as f64 * self.replay.rows.timestep,
            particle: self.worst,
            quantity: self.quantity,
            expected: [0, 1, 2].map(|axis| row.get(at + axis).copied().unwrap_or(0.0)),
            found: [0, 1, 2].map(found),
            explanation: says + &count,
        }
    }
}

/// (x, y, z) with what rounding explains as 0.
pub(super) fn vector(spot: &Spot, quantity: Quantity, factor: f64) -> String {
    let axis = |axis: usize| {
        let at = 3 * spot.worst + axis;
        let difference = spot.difference(quantity, at);
        if difference.abs() > spot.unit(quantity, at) {
            digits(factor * difference, 4)
        } else {
            "0".to_owned()
        }
    };
    format!("({}, {}, {})", axis(0), axis(1), axis(2))
}
