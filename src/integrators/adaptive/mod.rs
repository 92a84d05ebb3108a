//! Explicit embedded Runge-Kutta pairs that choose their own steps from a tolerance.
//!
//! They are no rows of [`integrators::REGISTRY`](super::REGISTRY): a method there is a map of a
//! state at a given step, which can be replayed and has an order and a limit in h. These have a
//! tolerance instead, and stand beside the others only where accuracy is held against cost.

pub mod coefficients;
mod control;
mod scale;
mod stepper;
mod trial;

pub use stepper::Adaptive;

use super::Tableau;
use coefficients::{DORMAND_PRINCE_5, DORMAND_PRINCE_8, ERROR_3, ERROR_4, ERROR_5};

/// One pair's facts.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    /// The id reports and the command line use.
    pub id: &'static str,
    pub name: &'static str,
    /// Of the formula that is advanced.
    pub order: u32,
    pub tableau: Tableau,
    pub estimate: Estimate,
    /// The last stage is evaluated at the step's end, with these weights as its row, and is the first
    /// of the next step.
    pub first_same_as_last: bool,
    /// Paper or textbook.
    pub source: &'static str,
    /// What it must not be confused with.
    pub not: &'static str,
}

/// How a step's error is estimated from its stages, by sums Σ e k.
#[derive(Debug, Clone, Copy)]
pub enum Estimate {
    /// The distance from a formula of this order.
    Embedded { order: u32, weights: &'static [f64] },
    /// DOP853's mixture of distances from formulas of order 5 and 3.
    Mixed53 {
        fifth: &'static [f64],
        third: &'static [f64],
    },
}

impl Estimate {
    /// The power of h it falls with.
    pub fn order(&self) -> u32 {
        match self {
            Self::Embedded { order, .. } => order + 1,
            // 2 * 6 - 4.
            Self::Mixed53 { .. } => 8,
        }
    }
}

impl Pair {
    pub fn stages(&self) -> u32 {
        self.tableau.b.len() as u32
    }

    /// Force evaluations of a step that is accepted, and of one that is not. A run costs one more for
    /// the length of its first step, and one for its first stage where others have theirs from the
    /// step before.
    pub fn evaluations(&self) -> [u32; 2] {
        let again = self.stages().saturating_sub(1);
        [self.stages() - u32::from(self.first_same_as_last), again]
    }
}

/// Every pair, in the order reports list them.
pub static REGISTRY: &[Pair] = &[
    Pair {
        id: "dormand_prince54",
        name: "Dormand-Prince 5(4)",
        order: 5,
        tableau: DORMAND_PRINCE_5,
        estimate: Estimate::Embedded {
            order: 4,
            weights: &ERROR_4,
        },
        first_same_as_last: true,
        source: "Dormand, Prince 1980, J. Comput. Appl. Math. 6, 19; Hairer, Nørsett, Wanner, \
                 Solving ODEs I, II.5 (DOPRI5)",
        not: "the pair of Fehlberg, which advances the fourth order",
    },
    Pair {
        id: "dop853",
        name: "Dormand-Prince 8(5,3)",
        order: 8,
        tableau: DORMAND_PRINCE_8,
        estimate: Estimate::Mixed53 {
            fifth: &ERROR_5,
            third: &ERROR_3,
        },
        first_same_as_last: false,
        source: "Hairer, Nørsett, Wanner, Solving ODEs I, 2nd ed., II.5 and II.10 (DOP853)",
        not: "Dormand and Prince's 8(7) of 1981 with 13 stages",
    },
];

/// The pair of this id.
pub fn find(id: &str) -> Option<&'static Pair> {
    REGISTRY.iter().find(|pair| pair.id == id)
}

/// All ids, in registry order.
pub fn ids() -> Vec<&'static str> {
    REGISTRY.iter().map(|pair| pair.id).collect()
}
