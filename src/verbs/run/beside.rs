//! What is done beside the runs of a plan, counted before they start, for the progress.

use super::budget::{of_limits, of_proofs, of_replays};
use super::plan::{Beside, Plan};
use super::{checks, remarks};
use crate::measure::identify::solve_effort;
use crate::truth::{self, Store};

/// Replays of a step in all: of up to 16 steps, each twice, and of a few probes.
const REPLAYS: u64 = 40;
/// Evaluations that replays of steps beside obstacles take each particle of a run: up to 64 steps, by some 300 treatments.
const AT_CONTACT: u64 = 20_000;
/// Sweeps of a twin proof together, where a few doublings are enough.
const SWEEPS: u64 = 192;

impl Plan<'_> {
    /// The same plan with what is done beside the runs, which are saved if `saving`.
    #[must_use]
    pub fn expecting(mut self, saving: bool, store: &dyn Store) -> Self {
        self.beside = beside(&self, saving, store);
        self
    }
}

/// About what a plan takes beside its runs.
fn beside(plan: &Plan, saving: bool, store: &dyn Store) -> Beside {
    let scene = plan.scene;
    let (particles, springs) = (scene.particles.len() as u64, scene.springs.len() as u64);
    let ends = plan.cases.iter().map(|case| case.label.end());
    let until = ends.fold(0.0, f64::max);
    let truth = truth::expected(scene, &plan.system, plan.choice.truth, until, store);
    let proof = 32 * particles + 48 * particles * solve_effort(particles) + 48 * springs * SWEEPS;
    let replays = plan.cases.iter().map(|case| {
        let replays = REPLAYS.saturating_mul(case.replay(scene));
        replays.min(of_replays(plan, case))
    });
    let replays = replays.fold(0, u64::saturating_add);
    let bounces = if scene.collides() {
        AT_CONTACT * particles
    } else {
        0
    };
    let replays = replays.saturating_add(bounces.saturating_mul(plan.cases.len() as u64));
    let limits = remarks::effort(plan).filter(|effort| *effort <= of_limits(plan));
    let runs = plan.effort();
    Beside {
        // An evaluation of three coordinates is about a step of a particle.
        truth: truth / 3,
        proofs: if checks::proves(plan) {
            proof.min(of_proofs(plan))
        } else {
            0
        },
        orders: if checks::measures_orders(plan) {
            plan.effort_of_integrators().saturating_mul(2)
        } else {
            0
        },
        judging: limits
            .unwrap_or(0)
            .saturating_add(if plan.choice.identify { replays } else { 0 }),
        saving: if saving { runs } else { 0 },
    }
}
