//! Balance: the work integrals close E + dissipated - injected to the order of the motion.

use super::order::{HORIZON, INSTANTS, judge_at_least, refined, rounding};
use super::subject::advance;
use super::systems::{built, dragged_triangle};
use super::{Finding, Law};
use crate::physics::{State, System};
use crate::scene::Wind;

pub(super) const LAW: Law = Law {
    id: "balance",
    summary: "dissipated and injected work keep the balance of energy to the order with damping",
    derivation: "as of the order; energy may converge faster than position, never slower",
    judge: |subject| {
        let Some(order) = subject.claims.order_damped else {
            return Ok(Finding::skip("the order with damping"));
        };
        // The scene has dampers, drag and wind.
        let mut scene = dragged_triangle(0.8);
        scene.wind = Some(Wind {
            direction: [0.6, 0.8, 0.0],
            strength: 2.0,
        });
        let (system, start) = built(&scene);
        let balance = |s: &State| {
            let energy = system.kinetic(&s.v) + system.potential(s.t, &s.x);
            s.work.balance(energy)
        };
        let mut least = f64::INFINITY;
        let observed = refined(subject, order, |steps| {
            let (mut state, mut integrator) = (start.clone(), subject.fresh());
            let (initial, mut off) = (balance(&start), 0.0_f64);
            for _ in 0..INSTANTS {
                let h = HORIZON / steps as f64;
                let n = steps / INSTANTS;
                advance(integrator.as_mut(), &system, h, n, &mut state)?;
                off = off.max((balance(&state) - initial).abs());
            }
            least = least
                .min(state.work.dissipated)
                .min(state.work.injected.abs());
            Ok((off, rounding(steps, initial.abs())))
        })?;
        // The dampers dissipate and the wind injects more than 2 J each.
        if least < 1.0 {
            let message = format!("only {least:.1e} J of work by dampers or wind in `state.work`");
            return Ok(Finding::of(false, least, 1.0, message));
        }
        Ok(judge_at_least(&observed, order))
    },
};
