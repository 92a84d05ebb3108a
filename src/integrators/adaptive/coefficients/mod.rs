//! The tableaux of the pairs and the weights of their error estimates, a file each.
//!
//! The converged truth takes DOP853 at fixed steps from here, too.

mod dop853;
mod dormand_prince54;

pub use dop853::{DORMAND_PRINCE_8, ERROR_3, ERROR_5, mixed};
pub use dormand_prince54::{DORMAND_PRINCE_5, ERROR_4};

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
