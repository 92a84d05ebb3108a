//! What an integrator says of itself.

use crate::integrators::{Exact, Method, Oscillator, PerStep};

/// The facts an integrator claims. What is `None` is not claimed, and the laws on it are skipped;
/// `false` is a claim.
#[derive(Debug, Clone, Copy)]
pub struct Claims {
    /// Order of the global error on smooth problems without damping, also where forces depend on
    /// time.
    pub order: u32,
    /// Order with dampers or drag, of the motion and of the balance of energy.
    pub order_damped: Option<u32>,
    /// Keeps the symplectic form on undamped problems, and with it angular momentum.
    pub symplectic: bool,
    /// Stepping h, flipping velocities, stepping h again returns to the start.
    pub reversible: bool,
    /// Force evaluations a step costs on an undamped system, once running.
    pub evaluations: Option<PerStep>,
    /// On x'' = -w² x, with z = h w: how far it is stable, and what becomes of the energy.
    pub oscillator: Option<Oscillator>,
    pub exact: Exact,
}

impl Claims {
    /// Of this order, with the exactness that comes with it, neither symplectic nor reversible, and
    /// nothing said of damping, cost and the oscillator: the start of `Claims { .., ..of_order(p) }`.
    pub const fn of_order(order: u32) -> Self {
        Self {
            order,
            order_damped: None,
            symplectic: false,
            reversible: false,
            evaluations: None,
            oscillator: None,
            exact: Exact::of_order(order),
        }
    }
}

impl From<&Method> for Claims {
    /// Everything a row states.
    fn from(method: &Method) -> Self {
        Self {
            order: method.order,
            order_damped: Some(method.order_damped),
            symplectic: method.symplectic,
            reversible: method.reversible,
            evaluations: Some(method.evaluations),
            oscillator: Some(method.oscillator),
            exact: method.exact,
        }
    }
}
