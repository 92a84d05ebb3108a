//! Explicit embedded Runge-Kutta pairs that choose their own steps from a tolerance: a file for each pair,
//! and one stepper.
//!
//! At a given step a pair is its advancing formula, a method like any other. With a tolerance in place of a
//! step it is compared with other methods only where accuracy is compared with cost.

mod dop853;
mod dormand_prince54;
mod stepper;
mod trial;

pub use dop853::{DORMAND_PRINCE_8, ERROR_3, ERROR_5, mixed};
pub use dormand_prince54::{DORMAND_PRINCE_5, ERROR_4};
pub use stepper::Adaptive;
pub(super) use {dop853::DOP853, dormand_prince54::DORMAND_PRINCE_54};

use super::Tableau;

/// The coefficients of a pair.
#[derive(Debug, Clone, Copy)]
pub struct Pair {
    /// The stages, and the weights of the advancing formula.
    pub tableau: Tableau,
    pub estimate: ErrorEstimate,
    /// Whether the last stage is evaluated at the step's end, with the weights as its row, and so is the
    /// first stage of the next step.
    pub first_same_as_last: bool,
}

/// The error estimate of a step, by sums Σ e k over its stages.
#[derive(Debug, Clone, Copy)]
pub enum ErrorEstimate {
    /// The difference from an embedded formula of this order.
    Embedded { order: u32, weights: &'static [f64] },
    /// DOP853's combination of the differences from formulas of order 5 and 3.
    Mixed53 {
        fifth: &'static [f64],
        third: &'static [f64],
    },
}

impl ErrorEstimate {
    /// The power of h that the estimate is proportional to.
    pub fn order(&self) -> u32 {
        match self {
            Self::Embedded { order, .. } => order + 1,
            // The estimate is e5² / e3 for small h: 2 * 6 - 4.
            Self::Mixed53 { .. } => 8,
        }
    }
}

impl Pair {
    pub fn stages(&self) -> u32 {
        self.tableau.b.len() as u32
    }

    /// The force evaluations of an accepted and of a rejected step. A run takes one more to choose its first
    /// step, and with first same as last another one for its first stage.
    pub fn evaluations(&self) -> [u32; 2] {
        let again = self.stages().saturating_sub(1);
        [self.stages() - u32::from(self.first_same_as_last), again]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrators::Tableau;

    /// Σ e c^(q-1) = 0 for the weights of an error estimate up to the order it belongs to, and not
    /// beyond.
    fn vanishing_law(tableau: &Tableau, weights: &[f64], order: i32) -> Result<(), String> {
        for q in 1..=order + 1 {
            let terms = weights.iter().zip(tableau.c);
            let sum: f64 = terms.map(|(w, c)| w * c.powi(q - 1)).sum();
            // Sums of twelve roundings of weights up to 6, measured 2.2e-16; the first sum that does
            // not vanish is 4.5e-4 and more.
            if (q <= order) != (sum.abs() < 7e-16) {
                return Err(format!("condition {q}: {sum:.1e}"));
            }
        }
        Ok(())
    }

    #[test]
    fn error_estimates_vanish_up_to_their_order() {
        vanishing_law(&DORMAND_PRINCE_8, &ERROR_5, 5).unwrap();
        vanishing_law(&DORMAND_PRINCE_8, &ERROR_3, 3).unwrap();
        vanishing_law(&DORMAND_PRINCE_5, &ERROR_4, 4).unwrap();
        let mut wrong = ERROR_5;
        wrong[7] += 1e-13;
        vanishing_law(&DORMAND_PRINCE_8, &wrong, 5).unwrap_err();
        let mut wrong = ERROR_4;
        wrong[6] = -wrong[6];
        vanishing_law(&DORMAND_PRINCE_5, &wrong, 4).unwrap_err();
    }
}
