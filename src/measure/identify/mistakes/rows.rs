//! The registry of mistakes.

use super::{Map, Mistake, Wrong, maps, physics, springs};
use crate::physics::ParticleSystem;
use crate::scene::Scene;

/// A wrong step of one method.
const fn step(id: &'static str, meant: &'static str, map: Map, says: &'static str) -> Mistake {
    let wrong = Wrong::Step {
        meant,
        map,
        remembers: false,
    };
    Mistake {
        id,
        says,
        wrong,
        deviates: &[],
    }
}

/// One that needs the state before the last.
const fn late(id: &'static str, meant: &'static str, map: Map, says: &'static str) -> Mistake {
    let wrong = Wrong::Step {
        meant,
        map,
        remembers: true,
    };
    Mistake {
        id,
        says,
        wrong,
        deviates: &[],
    }
}

/// Numbers of the scene that are wrong by a factor, in any method.
const fn scaled(
    id: &'static str,
    deviates: &'static [(&'static str, f64)],
    says: &'static str,
) -> Mistake {
    let wrong = Wrong::Scaled;
    Mistake {
        id,
        says,
        wrong,
        deviates,
    }
}

/// Wrong forces or masses in any method, and the part of the scene that they change.
const fn physics(
    id: &'static str,
    build: fn(&Scene) -> Option<ParticleSystem>,
    deviates: &'static [(&'static str, f64)],
    says: &'static str,
) -> Mistake {
    let wrong = Wrong::Physics(build);
    Mistake {
        id,
        says,
        wrong,
        deviates,
    }
}

/// Every mistake. No two are the same map in general, nor is one a method of the registry.
pub static MISTAKES: &[Mistake] = &[
    step(
        "midpoint_end_velocity",
        "midpoint",
        maps::midpoint_end_velocity,
        "the position moves with the velocity at the end of the step: move it with the velocity at \
         the midpoint",
    ),
    step(
        "midpoint_half_last_stage",
        "midpoint",
        |f, h, _, s| maps::tableau(maps::MIDPOINT_HALF_LAST_STAGE, f, h, s),
        "the last stage advances by half a step: take the slope at the midpoint for the whole step, \
         x0 + h v_mid and v0 + h a_mid",
    ),
    step(
        "midpoint_from_the_middle",
        "midpoint",
        |f, h, _, s| maps::tableau(maps::MIDPOINT_FROM_THE_MIDDLE, f, h, s),
        "the whole step starts from the midpoint state: go back to the state at the start of the \
         step before adding h times the midpoint's slope",
    ),
    late(
        "explicit_euler_accumulating",
        "explicit_euler",
        maps::explicit_euler_accumulating,
        "forces add up from step to step: set the force array to zero before each evaluation",
    ),
    late(
        "explicit_euler_stale_force",
        "explicit_euler",
        maps::explicit_euler_stale_force,
        "the velocity is kicked with the force of the previous step: evaluate the forces at the \
         current state before the kick",
    ),
    late(
        "symplectic_euler_accumulating",
        "symplectic_euler",
        maps::symplectic_euler_accumulating,
        "forces add up from step to step: set the force array to zero before each evaluation",
    ),
    late(
        "symplectic_euler_stale_force",
        "symplectic_euler",
        maps::symplectic_euler_stale_force,
        "the velocity is kicked with the force of the previous step: evaluate the forces at the \
         current positions before the kick",
    ),
    step(
        "heun_not_halved",
        "heun",
        |f, h, _, s| maps::tableau(maps::HEUN_NOT_HALVED, f, h, s),
        "the two slopes are added, not averaged: multiply their sum by h/2",
    ),
    step(
        "ralston_swapped_weights",
        "ralston",
        |f, h, _, s| maps::tableau(maps::RALSTON_SWAPPED_WEIGHTS, f, h, s),
        "the two weights are exchanged: the first slope counts 1/4, the one at 2/3 h counts 3/4",
    ),
    step(
        "rk4_equal_weights",
        "rk4",
        |f, h, _, s| maps::tableau(maps::RK4_EQUAL_WEIGHTS, f, h, s),
        "all four slopes count the same: weigh them 1, 2, 2, 1 and divide by 6",
    ),
    step(
        "rk4_half_last_stage",
        "rk4",
        |f, h, _, s| maps::tableau(maps::RK4_HALF_LAST_STAGE, f, h, s),
        "the fourth slope is taken half a step ahead: take it at the end of the step, \
         x0 + h v3 and v0 + h a3",
    ),
    step(
        "rk4_stage_on_stage",
        "rk4",
        |f, h, _, s| maps::tableau(maps::RK4_STAGE_ON_STAGE, f, h, s),
        "each stage starts from the stage before it: start every stage from the state at the start \
         of the step",
    ),
    step(
        "velocity_verlet_stale_force",
        "velocity_verlet",
        maps::verlet_stale_force,
        "the second half kick reuses the force from before the drift: evaluate the forces again at \
         the new positions",
    ),
    step(
        "velocity_verlet_new_force_only",
        "velocity_verlet",
        maps::verlet_new_force_only,
        "the velocity changes by the new force alone: use the mean of the force before and the \
         force after the drift",
    ),
    step(
        "velocity_verlet_missing_half",
        "velocity_verlet",
        maps::verlet_missing_half,
        "the position moves by h v + h² a: the second term is h² a / 2",
    ),
    step(
        "yoshida4_swapped_coefficients",
        "yoshida4",
        maps::yoshida4_swapped_coefficients,
        "the coefficients stand in the wrong order: the negative one, 1 - 2 w1 = -1.70, belongs in \
         the middle",
    ),
    step(
        "implicit_euler_old_velocity",
        "implicit_euler",
        maps::implicit_euler_old_velocity,
        "the position moves with the velocity from before the solve: move it with the new one, \
         x0 + h v1",
    ),
    step(
        "implicit_euler_one_pass",
        "implicit_euler",
        maps::implicit_euler_one_pass,
        "the implicit equation is not solved: the force is evaluated once, at the state explicit \
         Euler predicts; iterate, or solve with Newton's method",
    ),
    scaled(
        "gravity_forgotten",
        &[("gravity", 0.0)],
        "gravity is missing: add m g to every free particle",
    ),
    scaled(
        "gravity_twice",
        &[("gravity", 2.0)],
        "gravity acts twice: add m g once per force evaluation, and no g to the velocity besides",
    ),
    scaled(
        "gravity_upward",
        &[("gravity", -1.0)],
        "gravity has the wrong sign: the scene's value is signed, along the axis `up`",
    ),
    physics(
        "gravity_without_mass",
        physics::gravity_without_mass,
        &[("gravity", 1.0)],
        "gravity is added as a force of g newtons whatever the mass: the force is m g",
    ),
    scaled(
        "damping_sign",
        &[("springs.damping", -1.0), ("drag", -1.0)],
        "damping has the wrong sign, so it drives: a damper's force opposes the velocity",
    ),
    scaled(
        "damping_forgotten",
        &[("springs.damping", 0.0), ("drag", 0.0)],
        "damping is missing: add the springs' dampers and the drag to the forces",
    ),
    physics(
        "damping_isotropic",
        physics::damping_isotropic,
        &[("damping_model", 1.0)],
        "the dampers resist the whole relative velocity of a spring's ends: the scene asks for its \
         part along the spring alone (`damping_model: axial`)",
    ),
    physics(
        "damping_axial",
        physics::damping_axial,
        &[("damping_model", 1.0)],
        "the dampers resist only the relative velocity along the spring: the scene asks for all of \
         it (`damping_model: isotropic`)",
    ),
    scaled(
        "rest_length_ignored",
        &[("springs.rest_length", 0.0)],
        "springs pull as if their rest length were 0: the force is k (length - rest length)",
    ),
    scaled(
        "springs_twice",
        &[
            ("springs.stiffness", 2.0),
            ("springs.cubic", 2.0),
            ("springs.damping", 2.0),
        ],
        "springs act twice, as when each is visited from both its ends: add the force of a spring \
         once to either end",
    ),
    scaled(
        "springs_forgotten",
        &[
            ("springs.stiffness", 0.0),
            ("springs.cubic", 0.0),
            ("springs.damping", 0.0),
        ],
        "springs are missing: add the force of each to both its ends",
    ),
    scaled(
        "spring_reversed",
        &[("springs.stiffness", -1.0), ("springs.cubic", -1.0)],
        "springs push where they should pull: the force on the first end is k (length - rest length) along the \
         direction to the second",
    ),
    physics(
        "spring_direction_not_normalised",
        springs::not_normalised,
        &[("springs.direction", 1.0)],
        "the direction of a spring is not normalised, so its force grows with its length besides: divide the \
         separation of the ends by its length",
    ),
    physics(
        "spring_tension_only",
        springs::tension_only,
        &[("springs.compression", 0.0)],
        "springs pull, but do not push when they are compressed: the force k (length - rest length) has either \
         sign",
    ),
    physics(
        "damper_own_velocity",
        springs::own_velocity,
        &[("springs.relative_velocity", 0.0)],
        "each end is damped by its own velocity: a damper resists the difference of its ends' velocities",
    ),
    physics(
        "first_end_only",
        springs::first_end_only,
        &[("springs.second_end", 0.0)],
        "only the first end of each spring feels it: the second feels the opposite force",
    ),
    physics(
        "second_end_only",
        springs::second_end_only,
        &[("springs.first_end", 0.0)],
        "only the second end of each spring feels it: the first feels the opposite force",
    ),
    physics(
        "mass_ignored",
        physics::mass_ignored,
        &[("mass", 1.0)],
        "mass is ignored: divide every particle's force by its mass; only gravity is an \
         acceleration already",
    ),
    physics(
        "force_as_acceleration",
        physics::force_as_acceleration,
        &[("mass", 1.0)],
        "forces, weight included, are taken for accelerations: divide their sum by the particle's \
         mass",
    ),
    Mistake {
        id: "step_halved",
        says: "each step advances the state by h/2 only: use the whole timestep, or write a row \
               every second step",
        wrong: Wrong::Length(0.5),
        deviates: &[("timestep", 0.5)],
    },
    Mistake {
        id: "step_doubled",
        says: "each step advances the state by 2 h: use the timestep the rows are apart",
        wrong: Wrong::Length(2.0),
        deviates: &[("timestep", 2.0)],
    },
];
