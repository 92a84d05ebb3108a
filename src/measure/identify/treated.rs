//! Splitting methods with other treatments of what depends on velocity: dampers, a magnetic field, rods.

use super::candidate::{Candidate, Forces};
use super::step::Step;
use crate::integrators::{DampingTreatment, DampingTreatment::Explicit, Method, Stage, fixed};
use crate::physics::{ForceKinds, ParticleSystem, System};
use std::sync::Arc;

/// Velocity Verlet with the second force at this velocity.
const fn verlet(velocity: &'static [f64]) -> Step {
    const X: &[f64] = &[1.0, 0.5];
    Step::formula(Some([X, velocity]), [X, &[1.0, 0.5, 0.5]])
}

/// Treatments of dampers and drag in splitting methods that are not the exact flow: methods of their own where
/// there is damping. The id, the method without damping, what it does, and how.
const TREATED: [(&str, &str, &str, Step); 6] = [
    (
        "velocity_verlet_explicit_damping",
        "velocity_verlet",
        "each half kick takes the dampers at the velocity before it, which is of order 1",
        Step::splitting(Stage::VERLET, Explicit),
    ),
    (
        "velocity_verlet_predicted_velocity",
        "velocity_verlet",
        "the second half kick takes the dampers at the predicted velocity v0 + h a0: of order 2, but stable for \
         smaller steps",
        verlet(&[1.0, 1.0]),
    ),
    (
        "velocity_verlet_old_velocity",
        "velocity_verlet",
        "the second half kick takes the dampers at the velocity from the start of the step, which is of order 1",
        verlet(&[1.0]),
    ),
    (
        "position_verlet_explicit_damping",
        "position_verlet",
        "the kick takes the dampers at the velocity before it, which is of order 1",
        Step::splitting(Stage::POSITION_VERLET, Explicit),
    ),
    (
        "yoshida4_explicit_damping",
        "yoshida4",
        "each kick takes the dampers at the velocity before it, which is of order 1",
        Step::splitting(Stage::YOSHIDA4, Explicit),
    ),
    (
        "pefrl_explicit_damping",
        "pefrl",
        "each kick takes the dampers at the velocity before it, which is of order 1",
        Step::splitting(Stage::PEFRL, Explicit),
    ),
];

/// Boris' turn in other compositions, where there is a magnetic field.
const TURNED: [(&str, &str, &str, Step); 2] = [
    (
        "boris_staggered",
        "boris",
        "velocities half a step behind positions, as Boris wrote it: kick with its turn, then drift",
        Step::splitting(Stage::SYMPLECTIC_EULER, DampingTreatment::Boris),
    ),
    (
        "boris_kick_first",
        "boris",
        "kick half, drift, kick half, with Boris' turn in each kick",
        Step::splitting(Stage::VERLET, DampingTreatment::Boris),
    ),
];

/// The splitting methods with other treatments of damping; none where nothing is damped.
pub(super) fn treated(system: &ParticleSystem) -> Vec<Candidate> {
    if !system.kinds().depends_on_velocity() {
        return Vec::new();
    }
    let forces: Forces = Arc::new(system.clone());
    let turned = TURNED
        .iter()
        .filter(|_| system.kinds().has(ForceKinds::GYROSCOPIC));
    let treated = TREATED.iter().chain(turned);
    let named = |(id, meant, says, step): &(&'static str, &'static str, &str, Step)| {
        let says = said_of(system.kinds(), says);
        Candidate::new(&forces, *step, meant).named(*id, says)
    };
    treated.map(named).collect()
}

/// Velocity Verlet on rods whose second half kick takes their forces at another velocity than that after the first.
pub(super) fn two_kicks(system: &ParticleSystem) -> Vec<Candidate> {
    // With dampers they are among the treated.
    if system.kinds().depends_on_velocity() {
        return Vec::new();
    }
    let forces: Forces = Arc::new(system.clone());
    let named = |id, at: &str, step| {
        let says = format!("the second half kick takes the forces of rods at {at}");
        Candidate::new(&forces, step, "velocity_verlet").named(id, says)
    };
    vec![
        named(
            "velocity_verlet_predicted_velocity",
            "the predicted velocity v0 + h a0",
            verlet(&[1.0, 1.0]),
        ),
        named(
            "velocity_verlet_old_velocity",
            "the velocity from the start of the step, which is of order 1",
            verlet(&[1.0]),
        ),
    ]
}

/// What a treatment of dampers does, where the only force that depends on velocity may be the magnetic one.
pub(super) fn said_of(kinds: ForceKinds, says: &str) -> String {
    if kinds.damps() {
        return says.to_owned();
    }
    let says = says.replace("dampers and drag are", "the magnetic force is");
    says.replace("dampers", "magnetic force")
}

/// The methods whose steps solve nothing, and are their own under forces of these kinds.
pub(super) fn explicit(kinds: ForceKinds) -> impl Iterator<Item = &'static Method> {
    let methods = fixed().iter();
    methods.filter(move |method| method.is_its_own(kinds) && !Step::Method(method).solves())
}
