//! Explicit Runge-Kutta methods: one stepper, and a tableau for each method.

use super::{Coefficients, Integrator, MethodRow, StepError, axpy, fit};
use crate::physics::{Power, State, System};
use crate::vector;

/// A tableau for the first-order system (x, v)' = (v, a), s stages.
#[derive(Debug, Clone, Copy)]
pub struct Tableau {
    /// s rows, the first empty: row i holds a_i0 .. a_i,i-1, and for an implicit method a_ii too.
    pub a: &'static [&'static [f64]],
    /// s weights, summing to 1.
    pub b: &'static [f64],
    /// s nodes, c_i = sum of row i.
    pub c: &'static [f64],
}

pub(super) const EXPLICIT_EULER: MethodRow = MethodRow {
    id: "explicit_euler",
    name: "explicit Euler",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[]],
        b: &[1.0],
        c: &[0.0],
    }),
    energy: Some("1 + z²"),
    source: "Euler 1768; Hairer, Nørsett, Wanner, Solving ODEs I, II.1",
    not: "symplectic_euler, which drifts with the new velocity",
};

pub(super) const MIDPOINT: MethodRow = MethodRow {
    id: "midpoint",
    name: "explicit midpoint",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[0.5]],
        b: &[0.0, 1.0],
        c: &[0.0, 0.5],
    }),
    energy: Some("1 + z⁴/4"),
    source: "Runge 1895; Hairer, Nørsett, Wanner, Solving ODEs I, II.1",
    not: "implicit_midpoint; nor the common mistake that drifts with the end velocity",
};

pub(super) const HEUN: MethodRow = MethodRow {
    id: "heun",
    name: "Heun (explicit trapezoid)",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[1.0]],
        b: &[0.5, 0.5],
        c: &[0.0, 1.0],
    }),
    energy: Some("1 + z⁴/4"),
    source: "Heun 1900; the explicit trapezoidal rule",
    not: "trapezoidal, its implicit namesake",
};

pub(super) const RALSTON: MethodRow = MethodRow {
    id: "ralston",
    name: "Ralston",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[2.0 / 3.0]],
        b: &[0.25, 0.75],
        c: &[0.0, 2.0 / 3.0],
    }),
    energy: Some("1 + z⁴/4"),
    source: "Ralston 1962, Math. Comp. 16: the two-stage method of least error bound",
    not: "Ralston's third-order method",
};

pub(super) const RK3: MethodRow = MethodRow {
    id: "rk3",
    name: "Kutta's third-order method",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[0.5], &[-1.0, 2.0]],
        b: &[1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0],
        c: &[0.0, 0.5, 1.0],
    }),
    energy: Some("1 - z⁴/12 + z⁶/36"),
    source: "Kutta 1901; Hairer, Nørsett, Wanner, Solving ODEs I, II.1",
    not: "ssprk3, the same map on linear forces; Heun's third-order method",
};

pub(super) const SSPRK3: MethodRow = MethodRow {
    id: "ssprk3",
    name: "Shu-Osher, third order",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[1.0], &[0.25, 0.25]],
        b: &[1.0 / 6.0, 1.0 / 6.0, 2.0 / 3.0],
        c: &[0.0, 1.0, 0.5],
    }),
    energy: Some("1 - z⁴/12 + z⁶/36"),
    source: "Shu & Osher 1988, J. Comput. Phys. 77: the strong-stability preserving method of order 3",
    not: "rk3, the same map on linear forces; its three-step form in Euler steps is this method",
};

pub(super) const RK4: MethodRow = MethodRow {
    id: "rk4",
    name: "classical Runge-Kutta",
    coefficients: Coefficients::Tableau(Tableau {
        a: &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
        b: &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0],
        c: &[0.0, 0.5, 0.5, 1.0],
    }),
    energy: Some("1 - z⁶/72 + z⁸/576"),
    source: "Kutta 1901; Hairer, Nørsett, Wanner, Solving ODEs I, II.1",
    not: "the 3/8 rule",
};

/// The stepper that all explicit tableaux share.
#[derive(Debug, Clone)]
pub struct RungeKutta {
    tableau: Tableau,
    /// Stage slopes of x: the stage velocities.
    velocities: Vec<Vec<f64>>,
    /// Stage slopes of v: the stage accelerations.
    accelerations: Vec<Vec<f64>>,
    powers: Vec<Power>,
    /// Stage position.
    x: Vec<f64>,
}

impl RungeKutta {
    pub fn new(tableau: Tableau) -> Self {
        let stages = tableau.b.len();
        Self {
            tableau,
            velocities: vec![Vec::new(); stages],
            accelerations: vec![Vec::new(); stages],
            powers: vec![Power::default(); stages],
            x: Vec::new(),
        }
    }
}

impl Integrator for RungeKutta {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let n = state.x.len();
        fit(&mut self.x, n);
        for (v, a) in self.velocities.iter_mut().zip(&mut self.accelerations) {
            fit(v, n);
            fit(a, n);
        }
        for (stage, row) in self.tableau.a.iter().enumerate() {
            let (before, rest) = self.velocities.split_at_mut(stage);
            let velocity = &mut rest[0];
            let weighted = |&(_, weight): &(usize, f64)| weight != 0.0;
            let mut terms = row.iter().copied().enumerate().filter(weighted);
            if let Some((first, weight)) = terms.next() {
                vector::sum(&mut self.x, &state.x, h * weight, &before[first]);
                vector::sum(velocity, &state.v, h * weight, &self.accelerations[first]);
            } else {
                vector::copy(&mut self.x, &state.x);
                vector::copy(velocity, &state.v);
            }
            for (earlier, weight) in terms {
                axpy(&mut self.x, h * weight, &before[earlier]);
                axpy(velocity, h * weight, &self.accelerations[earlier]);
            }
            let t = state.t + h * self.tableau.c[stage];
            self.powers[stage] =
                system.acceleration(t, &self.x, velocity, &mut self.accelerations[stage]);
        }
        for (stage, &weight) in self.tableau.b.iter().enumerate() {
            if weight != 0.0 {
                axpy(&mut state.x, h * weight, &self.velocities[stage]);
                axpy(&mut state.v, h * weight, &self.accelerations[stage]);
                state.work.advance(self.powers[stage], h * weight);
            }
        }
        state.t += h;
        Ok(())
    }
}
