//! One step of all particles: a method of the registry, one of its families with other coefficients, or a formula
//! of one or two forces.

use crate::integrators::{
    Coefficients, DampingTreatment, Integrator, Method, Settings, Stage, StepError, Tableau,
};
use crate::physics::{State, System};
use crate::vector::axpy;

/// A step that candidates take.
#[derive(Clone, Copy)]
pub enum Step {
    Method(&'static Method),
    Coefficients(Coefficients),
    Formula(Formula),
}

/// An explicit step of one or two forces, and of the step before: Nyström's form, with a memory.
///
/// Not to be confused with [`Tableau`], whose positions move with its stages' velocities.
#[derive(Clone, Copy)]
pub struct Formula {
    /// Where the second acceleration a1 is taken; the first, a0, is that at the start.
    second: Option<Place>,
    end: Place,
}

/// A position x0 + h (c0 v0 + c1 h a0 + c2 h a1 + c3 h a + c4 v) and a velocity of the same form without x0, by
/// their c; a and v are those one step before, a0 and v0 in the first step. c0 h after the start.
pub type Place = [&'static [f64]; 2];

impl Step {
    pub(super) const fn formula(second: Option<Place>, end: Place) -> Self {
        Self::Formula(Formula { second, end })
    }

    pub(super) const fn splitting(stages: &'static [Stage], damping: DampingTreatment) -> Self {
        Self::Coefficients(Coefficients::Composition(stages, damping))
    }

    pub(super) const fn tableau(
        a: &'static [&'static [f64]],
        b: &'static [f64],
        c: &'static [f64],
    ) -> Self {
        Self::Coefficients(Coefficients::Tableau(Tableau { a, b, c }))
    }

    pub(super) fn method(&self) -> Option<&'static Method> {
        match self {
            Self::Method(method) => Some(method),
            _ => None,
        }
    }

    /// Whether it solves linear systems.
    pub(super) fn solves(&self) -> bool {
        match self {
            Self::Method(method) => matches!(method.coefficients, Coefficients::Implicit(_)),
            Self::Coefficients(own) => matches!(own, Coefficients::Implicit(_)),
            Self::Formula(_) => false,
        }
    }

    /// Whether it depends on the state one step before.
    pub(super) fn looks_back(&self) -> bool {
        matches!(self, Self::Formula(formula) if formula.looks_back())
    }

    /// A fresh integrator for a step after this state, where that is known.
    pub(super) fn build(&self, settings: &Settings, before: Option<&State>) -> Box<dyn Integrator> {
        match *self {
            Self::Method(method) => method.build(settings),
            Self::Coefficients(coefficients) => coefficients.build(settings),
            Self::Formula(formula) => Box::new(After {
                formula,
                before: before.filter(|_| formula.looks_back()).cloned(),
            }),
        }
    }
}

impl Formula {
    fn looks_back(&self) -> bool {
        let mut places = self.second.iter().chain([&self.end]).flatten();
        places.any(|shares| shares.len() > 3)
    }
}

/// A formula and the state one step before.
struct After {
    formula: Formula,
    before: Option<State>,
}

impl Integrator for After {
    fn step(&mut self, system: &dyn System, h: f64, s: &mut State) -> Result<(), StepError> {
        let a0 = acceleration(system, s.t, &s.x, &s.v);
        let (a, v) = match &self.before {
            Some(b) => (acceleration(system, s.t - h, &b.x, &b.v), b.v.clone()),
            None => (a0.clone(), s.v.clone()),
        };
        let velocity = |shares: &[f64], a1: &[f64]| {
            let mut sum = vec![0.0; s.v.len()];
            let parts = [(1.0, &s.v[..]), (h, &a0), (h, a1), (h, &a), (1.0, &v)];
            for (share, (unit, part)) in shares.iter().zip(parts) {
                axpy(&mut sum, share * unit, part);
            }
            sum
        };
        let place = |[x, v]: Place, a1: &[f64]| {
            let x = plus(&s.x, h, &velocity(x, a1));
            (x, velocity(v, a1))
        };
        let a1 = self.formula.second.map(|second| {
            let (x, v) = place(second, &a0);
            acceleration(system, s.t + second[0][0] * h, &x, &v)
        });
        let (x, v) = place(self.formula.end, a1.as_ref().unwrap_or(&a0));
        (s.x, s.v) = (x, v);
        s.t += h;
        Ok(())
    }
}

pub(super) fn acceleration(system: &dyn System, t: f64, x: &[f64], v: &[f64]) -> Vec<f64> {
    let mut a = vec![0.0; x.len()];
    system.acceleration(t, x, v, &mut a);
    a
}

/// y + h x.
pub(super) fn plus(y: &[f64], h: f64, x: &[f64]) -> Vec<f64> {
    y.iter().zip(x).map(|(y, x)| y + h * x).collect()
}
