//! The settings of rapier's solver that change the result.

use crate::integrators::RapierContact;

/// The settings of rapier's solver, besides the timestep.
///
/// Where a scene has obstacles, its world changes what contact needs: there is at least one sweep after the drift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RapierSettings {
    /// `num_solver_iterations`, n: *substeps* of h = dt / n, each with a solve of its own. Not to
    /// be confused with sweeps of one solve, which are `pgs`. At least 1; 0 counts as 1.
    pub iterations: u32,
    /// `num_internal_pgs_iterations`: Gauss-Seidel sweeps over the joints in each substep. At
    /// least 1; 0 counts as 1.
    pub pgs: u32,
    /// `num_internal_stabilization_iterations`: sweeps over the joints *after* the drift of each substep, which
    /// change velocities once more.
    pub stabilization: u32,
    /// `normalized_max_linear_velocity`, m/s: faster bodies are slowed down to it in every substep.
    /// rapier's default is 400. None, the default here, switches it off, since it hides divergence.
    pub speed: Option<f64>,
}

impl RapierSettings {
    /// rapier's own defaults (0.36), without its limit of speed.
    pub const DEFAULT: Self = Self {
        iterations: 4,
        pgs: 1,
        stabilization: 1,
        speed: None,
    };

    /// The same with as many sweeps as rods take, which are stiff joints: with one, a double pendulum is off by 39 mm after
    /// 5 s at 1 ms, with 16 by 0.7 mm.
    pub const RODS: Self = Self {
        pgs: 16,
        ..Self::DEFAULT
    };

    /// Enough sweeps for the joint solve of a soft network to converge to rounding, and none after the drift, but one where
    /// there are obstacles, whose friction acts there. The method is then linearly implicit Euler at dt / 4.
    pub const CONVERGED: Self = Self {
        iterations: 4,
        pgs: 64,
        stabilization: 0,
        speed: None,
    };

    /// Settings of a world without joints: one substep, and no need for sweeps.
    pub const FORCES: Self = Self {
        iterations: 1,
        pgs: 1,
        stabilization: 0,
        speed: None,
    };

    /// The settings that differ from [`DEFAULT`](Self::DEFAULT), as the command line writes them:
    /// `pgs=4,stabilization=0`, or `defaults`.
    pub fn changes(&self) -> String {
        let usual = Self::DEFAULT;
        let counts = [
            ("iterations", self.iterations, usual.iterations),
            ("pgs", self.pgs, usual.pgs),
            ("stabilization", self.stabilization, usual.stabilization),
        ];
        let changed = counts.iter().filter(|(_, own, usual)| own != usual);
        let changes: Vec<String> = changed
            .map(|(key, own, _)| format!("{key}={own}"))
            .chain(self.speed.map(|speed| format!("speed={speed}")))
            .collect();
        if changes.is_empty() {
            "defaults".to_owned()
        } else {
            changes.join(",")
        }
    }

    /// The step of rapier's contact at these settings, written here; it sweeps at least once after the drift.
    pub fn contact(&self) -> RapierContact {
        RapierContact::new(self.iterations, self.pgs, self.stabilization)
    }

    /// The length of a substep, s, of a step of `timestep` seconds.
    pub fn substep(&self, timestep: f64) -> f64 {
        timestep / f64::from(self.iterations.max(1))
    }
}

impl Default for RapierSettings {
    fn default() -> Self {
        Self::DEFAULT
    }
}
