//! Integrators that do not do what every one has to: a finding says so, and nothing panics.

use springcheck::conformance::{Claims, LAWS, check};
use springcheck::integrators::{
    EnergyLaw, Integrator, OscillatorFacts, PerStep, Stable, StepError,
};
use springcheck::measure::CheckStatus;
use springcheck::physics::{State, System};

#[derive(Clone, Copy)]
enum Fault {
    Refuses,
    NotANumber,
    StopsTheClock,
    LosesACoordinate,
}

struct Faulty(Fault);

impl Integrator for Faulty {
    fn step(&mut self, _: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        state.t += h;
        match self.0 {
            Fault::Refuses => return Err(StepError::Singular { particle: 0 }),
            Fault::NotANumber => state.v.fill(f64::NAN),
            Fault::StopsTheClock => state.t -= h,
            Fault::LosesACoordinate => {
                state.x.pop();
            }
        }
        Ok(())
    }
}

#[test]
fn a_broken_step_fails_every_law_and_says_why() {
    let claims = Claims {
        order_damped: Some(2),
        evaluations: Some(PerStep::Exactly(1)),
        oscillator: Some(OscillatorFacts {
            stable: Stable::Below(2.0),
            energy: EnergyLaw::Bounded,
        }),
        ..Claims::of_order(2)
    };
    for (fault, said) in [
        (
            Fault::Refuses,
            "could not be taken: the implicit step's matrix",
        ),
        (Fault::NotANumber, "left the range of finite numbers"),
        (Fault::StopsTheClock, "left the state's time at"),
        (Fault::LosesACoordinate, "changed the number of coordinates"),
    ] {
        let findings = check(&|| Box::new(Faulty(fault)), &claims);
        assert_eq!(findings.len(), LAWS.len());
        for finding in findings {
            assert_eq!(finding.status, CheckStatus::Fail, "{finding:?}");
            assert!(finding.message.contains(said), "{finding:?}");
            assert!(finding.measured.is_none() && !finding.derivation.is_empty());
        }
    }
}
