//! rapier worlds that mirror a scene.
//!
//! Three engines, because each answers another question: `rapier` is what people ship,
//! `rapier-converged` proves that its world is the same scene (its sweeps are raised until the
//! joint solve converges), `rapier-forces` proves that the harness is unbiased (rapier only adds
//! up forces computed here). None of them is the truth: see [`RapierEngine`] for the method that
//! rapier's joints are.
//!
//! rapier speaks glam; its types stay inside this folder.

mod forces;
mod joints;
mod mirrors;
mod settings;
mod world;

pub use forces::RapierForces;
pub use joints::RapierEngine;
pub use settings::Settings;

use super::solver::{Solver, Source};
use crate::integrators;
use crate::outcome::Kind;

/// The ids of rapier's worlds at fixed settings, in the order reports list them.
pub const IDS: [&str; 3] = ["rapier", "rapier-forces", "rapier-converged"];

/// Those worlds.
pub(super) fn solvers() -> [Solver; 3] {
    let converged = Solver {
        id: IDS[2].into(),
        summary: "rapier's spring joints swept until they converge: linearly implicit Euler",
        follows: integrators::find("linearized_implicit_material"),
        ..joints(Settings::CONVERGED)
    };
    let forces = Solver {
        id: IDS[1].into(),
        summary: "rapier's bodies under this program's forces: symplectic Euler",
        follows: integrators::find("symplectic_euler"),
        substeps: Settings::FORCES.iterations,
        dissipates: None,
        source: Source::Forces,
        ..joints(Settings::FORCES)
    };
    [joints(Settings::DEFAULT), forces, converged]
}

/// rapier's spring joints under these settings; only at the defaults is it what people ship.
pub(super) fn joints(settings: Settings) -> Solver {
    Solver {
        kind: Kind::Rapier,
        substeps: settings.iterations.max(1),
        reference: true,
        dissipates: Some(
            "rapier's spring joint is linearly implicit Euler at h = dt/{n}, which loses energy by \
             design: distance from it is no error of yours",
        ),
        ..Solver::integrator(
            IDS[0].into(),
            "rapier at its defaults: spring joints, 4 substeps, one sweep each",
            Source::Joints(settings),
        )
    }
}
