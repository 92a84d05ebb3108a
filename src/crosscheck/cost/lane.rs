//! One engine's way through its settings, and what that is expected to take.

use super::CostChoice;
use super::entrant::Entrant;
use super::setting::Setting;
use super::{ladder, price};
use crate::measure::stability::Linearised;
use crate::scene::Scene;
use crate::system::{ParticleSystem, System};
use std::sync::Arc;

/// One line of the diagram, planned.
pub(super) struct Lane {
    pub entrant: Entrant,
    /// Coarse to fine.
    pub ladder: Vec<Setting>,
    /// Nominal nanoseconds a step.
    each: f64,
}

impl Lane {
    /// Nominal microseconds of the run that finds the error.
    pub fn of_error(&self, setting: &Setting) -> u64 {
        (1e-3 * self.run(setting)) as u64
    }

    /// Nominal microseconds of the runs that are timed.
    pub fn of_timing(&self, setting: &Setting) -> u64 {
        (1e-3 * (price::TIMED * self.run(setting)).max(price::TIMED_LEAST)) as u64
    }

    /// Nominal microseconds of all.
    pub fn work(&self) -> u64 {
        let each = |setting| self.of_error(setting) + self.of_timing(setting);
        self.ladder.iter().map(each).sum()
    }

    /// Nanoseconds.
    fn run(&self, setting: &Setting) -> f64 {
        self.each * setting.steps() as f64
    }
}

/// Everybody's, in the order of the curves.
pub(super) fn lanes(scene: &Scene, system: &ParticleSystem, choice: &CostChoice) -> Vec<Lane> {
    let damped = system.is_damped();
    let methods = choice.methods.iter().map(|m| Entrant::method(m, damped));
    let own = choice
        .own
        .iter()
        .map(|own| Entrant::own(&own.name, Arc::clone(&own.build)));
    // They choose their own steps: with steps named there is nothing to sweep.
    let named = choice.timesteps.is_some();
    let pairs = choice
        .pairs
        .iter()
        .filter(|_| !named)
        .map(|p| Entrant::pair(p));
    let engines = choice.engines.iter().map(Entrant::engine);
    let ours = methods.chain(own).chain(pairs);
    let entrants: Vec<Entrant> = ours.chain(engines).collect();
    let share = choice.budget_s / entrants.len().max(1) as f64;
    let start = ParticleSystem::initial_state(scene);
    let linearised = Linearised::brief(system, start.t, &start.x, &start.v);
    let lane = |entrant: Entrant| {
        let coarsest = ladder::coarsest(scene, &linearised, &entrant);
        let each = price::of_step(scene, system, &entrant, &coarsest);
        let coarsest = ladder::afforded(scene, &linearised, &entrant, coarsest, each, share);
        let (settings, adapts) = (choice.settings, entrant.adapts());
        let ladder = match (&choice.timesteps, adapts) {
            (Some(timesteps), _) => ladder::named(scene, timesteps),
            (None, Some(order)) => {
                ladder::tolerances(scene, &linearised, order, each, settings, share)
            }
            (None, None) => ladder::spaced(scene, &coarsest, each, settings, share),
        };
        Lane {
            entrant,
            ladder,
            each,
        }
    };
    entrants.into_iter().map(lane).collect()
}
