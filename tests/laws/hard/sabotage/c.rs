//! What must not go unseen where steps are far too long for explicit methods, so that all hangs on how the
//! implicit ones are solved.

use super::{Row, mutants};
use crate::testkit::method;
use springcheck::integrators::Settings;
use springcheck::physics::{ForceKinds, Jacobian, Linearization, Power, State, System};

pub const SABOTAGES: &[Row] = &[
    ("chain_20", "implicit_euler", euler_with_one_iteration),
    (
        "chain_20",
        "linearized_implicit_at_start",
        linearized_with_negative_tension,
    ),
    ("chain_20", "implicit_midpoint", euler),
    ("chain_20", "tr_bdf2", trapezoidal),
    ("chain_1000", "implicit_euler", euler_without_turning),
    (
        "chain_1000",
        "linearized_implicit_at_start",
        linearized_with_negative_tension,
    ),
    ("chain_1000", "trapezoidal", euler),
    ("cloth", "implicit_euler", euler_with_one_iteration),
    (
        "cloth",
        "linearized_implicit_at_start",
        linearized_with_negative_tension,
    ),
    ("cloth", "implicit_midpoint", euler),
    ("stiff_hair", "implicit_midpoint", euler),
    ("stiff_hair", "tr_bdf2", trapezoidal),
    ("compressed", "implicit_euler", euler_with_one_iteration),
    ("compressed", "implicit_midpoint", trapezoidal),
    (
        "compressed",
        "velocity_verlet",
        mutants::verlet_with_a_stale_force,
    ),
    ("stretched", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "stretched",
        "velocity_verlet",
        mutants::verlet_with_a_stale_force,
    ),
    ("stretched", "implicit_midpoint", euler),
    ("stretched", "tr_bdf2", trapezoidal),
    (
        "nearly_massless",
        "linearized_implicit_at_start",
        euler_without_turning,
    ),
    (
        "nearly_massless",
        "implicit_midpoint",
        midpoint_solved_to_a_tenth,
    ),
    ("nearly_massless", "tr_bdf2", euler),
    (
        "stiff_pair",
        "explicit_euler",
        mutants::euler_drifting_with_the_new_velocity,
    ),
    (
        "stiff_pair",
        "midpoint",
        mutants::midpoint_drifting_with_the_end_velocity,
    ),
    ("stiff_pair", "rk4", mutants::rk4_with_swapped_weights),
    ("stiff_pair", "tr_bdf2", trapezoidal),
];

/// One step of this row; where it cannot take it, nothing moves.
fn implicit(id: &str, tolerance: f64, system: &dyn System, h: f64, state: &mut State) {
    let t = state.t;
    let mut own = method(id).build(&Settings::stated(Some(tolerance)));
    let _ = own.step(system, h, state);
    // The caller counts time.
    state.t = t;
}

/// Sound, in the place of another.
fn euler(system: &dyn System, h: f64, state: &mut State) {
    implicit("implicit_euler", 1e-12, system, h, state);
}

/// Sound, in the place of another.
fn trapezoidal(system: &dyn System, h: f64, state: &mut State) {
    implicit("trapezoidal", 1e-12, system, h, state);
}

fn euler_with_one_iteration(system: &dyn System, h: f64, state: &mut State) {
    implicit("linearized_implicit_at_start", 1e-12, system, h, state);
}

/// One iteration, and no stiffness across a spring.
fn euler_without_turning(system: &dyn System, h: f64, state: &mut State) {
    implicit("linearized_implicit_material", 1e-12, system, h, state);
}

fn midpoint_solved_to_a_tenth(system: &dyn System, h: f64, state: &mut State) {
    implicit("implicit_midpoint", 0.1, system, h, state);
}

/// One iteration, with the wrong sign of the stiffness across a spring, its tension over its length.
fn linearized_with_negative_tension(system: &dyn System, h: f64, state: &mut State) {
    euler_with_one_iteration(&NegativeTension(system), h, state);
}

struct NegativeTension<'a>(&'a dyn System);

impl System for NegativeTension<'_> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(t, x, v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
    fn jacobian(&self, t: f64, x: &[f64], v: &[f64], kept: Linearization, out: &mut Jacobian) {
        for (kept, share) in [(Linearization::Material, 2.0), (kept, -1.0)] {
            let mut part = Jacobian::default();
            self.0.jacobian(t, x, v, kept, &mut part);
            let scaled = part.position.into_iter();
            out.position
                .extend(scaled.map(|(row, column, value)| (row, column, share * value)));
        }
    }
}
