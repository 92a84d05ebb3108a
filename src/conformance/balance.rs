//! Balance: the work integrals close E + dissipated - injected to the order of the motion.

use super::Law;
use super::finding::Verdict;
use super::order::{HORIZON, INSTANTS, climb, judge_at_least, rounding};
use super::subject::advance;
use super::systems::swinging_triangle;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{DampingModel, Scene, Wind};

pub(super) const LAW: Law = Law {
    id: "balance",
    summary: "dissipated and injected work keep the balance of energy to the order with damping",
    derivation: "as of the order; energy may converge faster than position, never slower",
    judge: |subject| {
        let Some(order) = subject.claims.order_damped else {
            return Ok(Verdict::skip("the order with damping"));
        };
        let scene = windy();
        let system = ParticleSystem::new(&scene);
        let start = ParticleSystem::initial_state(&scene);
        let balance = |s: &State| {
            let energy = system.kinetic(&s.v) + system.potential(s.t, &s.x);
            energy + s.work.dissipated - s.work.injected
        };
        let mut least = f64::INFINITY;
        let observed = climb(subject, order, |steps| {
            let (mut state, mut integrator) = (start.clone(), subject.fresh());
            let (initial, mut off) = (balance(&start), 0.0_f64);
            for _ in 0..INSTANTS {
                let h = HORIZON / steps as f64;
                advance(
                    integrator.as_mut(),
                    &system,
                    h,
                    steps / INSTANTS,
                    &mut state,
                )?;
                off = off.max((balance(&state) - initial).abs());
            }
            least = least
                .min(state.work.dissipated)
                .min(state.work.injected.abs());
            Ok((off, rounding(steps, initial.abs())))
        })?;
        // Dampers take and the wind gives more than 2 J each.
        if least < 1.0 {
            let message = format!("only {least:.1e} J of work by dampers or wind in `state.work`");
            return Ok(Verdict::fail(least, 1.0, message));
        }
        Ok(judge_at_least(&observed, order))
    },
};

/// Dampers, drag and wind.
fn windy() -> Scene {
    let mut scene = swinging_triangle(0.8, DampingModel::Axial);
    for particle in scene.particles.iter_mut().skip(2).take(1) {
        particle.drag = 0.5;
    }
    scene.wind = Some(Wind {
        direction: [0.6, 0.8, 0.0],
        strength: 2.0,
    });
    scene
}
