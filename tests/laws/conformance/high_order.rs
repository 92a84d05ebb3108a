//! Above order 4: compositions of Verlet, and what no ladder of steps can show.

use crate::testkit::{method, own};
use springcheck::conformance::systems::Driven;
use springcheck::conformance::{self, Claims, check};
use springcheck::integrators::{Integrator, StepError};
use springcheck::measure::CheckStatus;
use springcheck::physics::{State, System};

/// Yoshida's triple jump (Phys. Lett. A 150, 1990): three steps of a symmetric method of order 2n make
/// one of order 2n + 2.
struct TripleJump {
    inner: Box<dyn Integrator>,
    /// Order of the inner method.
    order: u32,
}

impl Integrator for TripleJump {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let outer = 1.0 / (2.0 - 2.0_f64.powf(1.0 / f64::from(self.order + 1)));
        let end = state.t + h;
        for part in [outer, 1.0 - 2.0 * outer, outer] {
            self.inner.step(system, part * h, state)?;
        }
        state.t = end;
        Ok(())
    }
}

fn sixth() -> Box<dyn Integrator> {
    let yoshida4 = own(method("yoshida4"));
    Box::new(TripleJump {
        inner: yoshida4(),
        order: 4,
    })
}

fn claims(order: u32) -> Claims {
    Claims {
        symplectic: true,
        reversible: true,
        ..Claims::of_order(order)
    }
}

#[test]
fn order_six_is_measured() {
    for finding in check(&sixth, &claims(6)) {
        assert!(
            matches!(finding.status, CheckStatus::Pass | CheckStatus::Skip),
            "{finding:?}"
        );
    }
    for order in [5, 7] {
        let law = conformance::find("order").expect("a law");
        let finding = law.check(&sixth, &claims(order));
        assert_eq!(finding.status, CheckStatus::Fail, "{finding:?}");
    }
}

/// Knows the answer.
struct Oracle;

impl Integrator for Oracle {
    fn step(&mut self, _: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        *state = Driven::exact(state.t + h);
        Ok(())
    }
}

#[test]
fn what_makes_no_error_shows_no_order() {
    let law = conformance::find("order-driven").expect("a law");
    let finding = law.check(&|| Box::new(Oracle), &claims(2));
    assert_eq!(finding.status, CheckStatus::Inconclusive);
    assert!(
        finding.measured.is_none() && finding.message.contains("exact here"),
        "{finding:?}"
    );
}
