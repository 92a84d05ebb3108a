//! Every law fails on integrators with the faults people write.

use crate::testkit::mutants::{self, Step, mutant};
use crate::testkit::{Build, method, own};
use springcheck::conformance::{self, Claims};
use springcheck::integrators::{Integrator, StepError};
use springcheck::measure::CheckStatus;
use springcheck::physics::{State, System};

/// What a law says of an integrator that claims to be a row's.
fn status(law: &str, id: &str, build: Build) -> CheckStatus {
    let law = conformance::find(law).expect(law);
    let finding = law.check(build, &Claims::from(method(id)));
    assert!(finding.measured.is_none_or(f64::is_finite));
    finding.status
}

fn fails(law: &str, id: &str, build: Build) {
    assert_eq!(status(law, id, build), CheckStatus::Fail, "{law}: {id}");
}

#[test]
fn every_law_kills_mutants() {
    let cases: [(&str, &str, Step); 29] = [
        (
            "order",
            "midpoint",
            mutants::midpoint_drifting_with_the_end_velocity,
        ),
        ("order", "rk4", mutants::rk4_with_a_wrong_weight),
        ("order", "rk4", mutants::rk4_with_swapped_weights),
        (
            "order",
            "yoshida4",
            mutants::yoshida_with_swapped_coefficients,
        ),
        (
            "order",
            "velocity_verlet",
            mutants::verlet_with_a_stale_force,
        ),
        (
            "order-damped",
            "velocity_verlet",
            mutants::verlet_with_explicit_damping,
        ),
        (
            "order-damped",
            "velocity_verlet",
            mutants::verlet_without_damping,
        ),
        (
            "balance",
            "velocity_verlet",
            mutants::verlet_with_explicit_damping,
        ),
        (
            "energy",
            "explicit_euler",
            mutants::euler_drifting_with_the_new_velocity,
        ),
        (
            "energy",
            "symplectic_euler",
            mutants::euler_drifting_with_the_old_velocity,
        ),
        (
            "energy",
            "symplectic_euler",
            mutants::symplectic_euler_at_half_the_step,
        ),
        (
            "energy",
            "midpoint",
            mutants::midpoint_drifting_with_the_end_velocity,
        ),
        (
            "energy",
            "velocity_verlet",
            mutants::verlet_with_a_stale_force,
        ),
        ("energy", "rk4", mutants::rk4_with_a_wrong_weight),
        ("energy", "yoshida4", mutants::rk4_with_swapped_weights),
        ("energy", "pefrl", mutants::verlet_with_a_stale_force),
        ("energy", "implicit_euler", mutants::frozen),
        (
            "stability",
            "symplectic_euler",
            mutants::symplectic_euler_at_half_the_step,
        ),
        (
            "stability",
            "velocity_verlet",
            mutants::verlet_with_a_stale_force,
        ),
        ("stability", "rk4", mutants::rk4_with_swapped_weights),
        ("stability", "yoshida4", mutants::rk4_with_a_wrong_weight),
        (
            "stability",
            "explicit_euler",
            mutants::euler_drifting_with_the_new_velocity,
        ),
        (
            "stability",
            "implicit_euler",
            mutants::euler_drifting_with_the_old_velocity,
        ),
        (
            "symplecticity",
            "velocity_verlet",
            mutants::verlet_with_a_stale_force,
        ),
        (
            "symplecticity",
            "explicit_euler",
            mutants::euler_drifting_with_the_new_velocity,
        ),
        (
            "reversal",
            "velocity_verlet",
            mutants::verlet_with_a_stale_force,
        ),
        ("reversal", "rk4", mutants::frozen),
        (
            "exactness",
            "velocity_verlet",
            mutants::euler_drifting_with_the_new_velocity,
        ),
        // Two evaluations where the row says one: nothing kept between steps.
        (
            "evaluations",
            "velocity_verlet",
            mutants::verlet_with_explicit_damping,
        ),
    ];
    for (law, id, step) in cases {
        fails(law, id, &mutant(step));
    }
    let half = mutant(mutants::symplectic_euler_at_half_the_step);
    fails("stability-across", "linearized_implicit_material", &half);
    // Nothing returns like that which never left, and that is no reversibility.
    fails("reversal", "velocity_verlet", &mutant(mutants::frozen));
}

#[test]
fn one_method_does_not_pass_for_another() {
    let one = |law: &str, id: &str, other: &str| fails(law, id, &own(method(other)));
    one("energy", "implicit_midpoint", "implicit_euler");
    one("reversal", "symplectic_euler", "velocity_verlet");
    // With the whole stiffness there is no limit to state, and without it there is one.
    one(
        "stability-across",
        "linearized_implicit_material",
        "linearized_implicit_at_start",
    );
    one(
        "stability-across",
        "linearized_implicit_at_start",
        "linearized_implicit_material",
    );
    one(
        "stability-across",
        "linearized_implicit_predicted",
        "linearized_implicit_material",
    );
    // One evaluation more than iterations is not two, nor two one; and a step needs an iteration.
    one("evaluations", "implicit_midpoint", "trapezoidal");
    one("evaluations", "trapezoidal", "implicit_midpoint");
    one("evaluations", "implicit_midpoint", "symplectic_euler");
}

#[test]
fn the_law_of_momentum_kills_mutants() {
    // Explicit Euler does not keep angular momentum: claimed as Verlet it is caught.
    let euler = mutant(mutants::euler_drifting_with_the_old_velocity);
    fails("momentum", "velocity_verlet", &euler);
    // Nor is linear momentum what a force on one particle alone leaves.
    let pushed = mutant(mutants::euler_forgetting_a_reaction);
    fails("momentum", "explicit_euler", &pushed);
    // Without the dampers nothing brakes the rotation, and nothing is lost where none should be.
    let undamped = mutant(mutants::verlet_without_damping);
    fails("momentum", "velocity_verlet", &undamped);
    let claims = Claims {
        order_damped: None,
        ..Claims::from(method("velocity_verlet"))
    };
    let law = conformance::find("momentum").expect("a law");
    assert_eq!(law.check(&undamped, &claims).status, CheckStatus::Pass);
}

/// A second-order step whose work is taken at its start.
struct EarlyWork(Box<dyn Integrator>);

impl Integrator for EarlyWork {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let mut work = state.work;
        let mut a = vec![0.0; system.dim()];
        work.advance(system.acceleration(state.t, &state.x, &state.v, &mut a), h);
        self.0.step(system, h, state)?;
        state.work = work;
        Ok(())
    }
}

#[test]
fn the_balance_law_kills_work_of_first_order() {
    let verlet = own(method("velocity_verlet"));
    fails("balance", "velocity_verlet", &|| {
        Box::new(EarlyWork(verlet()))
    });
}

/// Verlet that ends each step with all velocities a little larger.
struct Inflated(Box<dyn Integrator>, f64);

impl Integrator for Inflated {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        self.0.step(system, h, state)?;
        for v in &mut state.v {
            *v *= 1.0 + self.1;
        }
        Ok(())
    }
}

#[test]
fn what_is_nearly_so_is_neither_believed_nor_refuted_when_denied() {
    let verlet = own(method("velocity_verlet"));
    let inflated = |by: f64| {
        let verlet = &verlet;
        move || -> Box<dyn Integrator> { Box::new(Inflated(verlet(), by)) }
    };
    // The form grows by that much times the largest mass, 1: tolerance 1e-7, a hundredfold above.
    for (by, claimed, denied) in [
        (0.9e-7, CheckStatus::Pass, CheckStatus::Fail),
        (1.1e-7, CheckStatus::Fail, CheckStatus::Inconclusive),
        (0.9e-5, CheckStatus::Fail, CheckStatus::Inconclusive),
        (1.1e-5, CheckStatus::Fail, CheckStatus::Pass),
    ] {
        let build = inflated(by);
        assert_eq!(
            status("symplecticity", "velocity_verlet", &build),
            claimed,
            "{by}"
        );
        assert_eq!(status("symplecticity", "midpoint", &build), denied, "{by}");
    }
}

/// Velocity Verlet that starts a step with the force at the end of the last one, and does not forget it where a step is cut.
#[derive(Default)]
struct KeepsForce(Option<Vec<f64>>);

impl Integrator for KeepsForce {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let mut a = self.0.take().unwrap_or_else(|| {
            let mut a = vec![0.0; state.x.len()];
            system.acceleration(state.t, &state.x, &state.v, &mut a);
            a
        });
        for ((x, v), a) in state.x.iter_mut().zip(&mut state.v).zip(&a) {
            *v += 0.5 * h * a;
            *x += h * *v;
        }
        state.t += h;
        system.acceleration(state.t, &state.x, &state.v, &mut a);
        for (v, a) in state.v.iter_mut().zip(&a) {
            *v += 0.5 * h * a;
        }
        self.0 = Some(a);
        Ok(())
    }
}

#[test]
fn a_force_kept_across_a_cut_is_caught() {
    let build = || Box::new(KeepsForce::default()) as Box<dyn Integrator>;
    let claims = Claims::from(method("velocity_verlet"));
    let judged = |law: &str| {
        conformance::find(law)
            .expect(law)
            .check(&build, &claims)
            .status
    };
    assert_eq!(judged("order"), CheckStatus::Pass);
    assert_ne!(judged("contact"), CheckStatus::Pass);
}
