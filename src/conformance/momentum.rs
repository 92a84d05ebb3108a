//! Momentum: every method conserves linear momentum, and symplectic ones conserve angular momentum.

use super::subject::{Broken, Subject};
use super::systems::{built, free_triangle};
use super::{Finding, Law, SOLVED_TO};
use crate::measure::totals;
use crate::scene::DampingModel;
use crate::truth::farthest;

const STEPS: usize = 200;

/// 200 steps, each solved to 1e-12, on momenta of order 1.
const BOUND: f64 = STEPS as f64 * SOLVED_TO;

pub(super) const LAW: Law = Law {
    id: "momentum",
    summary: "with nothing fixed and no external force momentum is kept, and angular momentum too \
              by a symplectic method where dampers are axial; isotropic dampers brake a turning",
    derivation: "200 steps solved to 1e-12 on momenta of order 1; explicit ones leave 6e-15 of \
                 rounding",
    judge: |subject| {
        // A method that claims nothing of damping is tested without it.
        let damping = subject.claims.order_damped.map_or(0.0, |_| 0.8);
        let (linear, angular) = change(subject, damping, DampingModel::Axial)?;
        let mut worst = Finding::at_most(linear, BOUND, "momentum");
        if subject.claims.symplectic && angular > linear {
            worst = Finding::at_most(angular, BOUND, "angular momentum");
        }
        if damping > 0.0 {
            let (linear, angular) = change(subject, damping, DampingModel::Isotropic)?;
            let finding = Finding::at_most(linear, BOUND, "momentum under isotropic dampers");
            if finding.measured > worst.measured {
                worst = finding;
            }
            if angular < BRAKED {
                let message = "isotropic dampers do not brake the rotation: is damping left out?";
                return Ok(Finding::of(false, angular, BRAKED, message));
            }
        }
        Ok(worst)
    },
};

/// The least loss of angular momentum to isotropic dampers in the run, kg m²/s. Every method of the
/// registry loses 0.189 or more.
const BRAKED: f64 = 0.07;

/// The change of momentum and of angular momentum over the run.
fn change(subject: &Subject, damping: f64, model: DampingModel) -> Result<(f64, f64), Broken> {
    let scene = free_triangle(damping, model);
    let (system, start) = built(&scene);
    let mut state = start.clone();
    subject.advance(&system, 0.005, STEPS, &mut state)?;
    let [before, after] = [&start, &state].map(|s| totals(&scene, &s.x, &s.v));
    Ok((farthest(&before.0, &after.0), farthest(&before.1, &after.1)))
}
