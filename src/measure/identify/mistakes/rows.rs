//! The registry of mistakes.

use super::{Mistake, Wrong, physics, springs};
use crate::integrators::{Coefficients, DampingTreatment, ImplicitScheme, Stage, StepError};
use crate::measure::identify::altered::{Altered, Altering, OneStep};
use crate::measure::identify::keeping::{Kept, Moved};
use crate::measure::identify::step::{Place, Step, plus};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;

/// A row, and the parts of the scene that it changes.
const fn row(
    id: &'static str,
    wrong: Wrong,
    deviates: &'static [(&'static str, f64)],
    says: &'static str,
) -> Mistake {
    Mistake {
        id,
        says,
        wrong,
        deviates,
    }
}

/// A wrong step of one method.
const fn step(id: &'static str, meant: &'static str, step: Step, says: &'static str) -> Mistake {
    let wrong = Wrong::Step {
        meant,
        step,
        around: None,
    };
    row(id, wrong, &[], says)
}

/// A wrong formula of one force, by where it leads.
const fn first(x: &'static [f64], v: &'static [f64]) -> Step {
    Step::formula(None, [x, v])
}

/// A wrong formula of two forces, by where the second is taken and where it leads.
const fn second(at: Place, end: Place) -> Step {
    Step::formula(Some(at), end)
}

/// Numbers of the scene that are wrong by a factor, in any method.
const fn scaled(
    id: &'static str,
    deviates: &'static [(&'static str, f64)],
    says: &'static str,
) -> Mistake {
    row(id, Wrong::Scaled, deviates, says)
}

/// Wrong forces or masses in any method.
const fn physics(
    id: &'static str,
    build: fn(&Scene) -> Option<ParticleSystem>,
    deviates: &'static [(&'static str, f64)],
    says: &'static str,
) -> Mistake {
    row(id, Wrong::Physics(build), deviates, says)
}

/// Rods kept wrongly, with any method.
const fn rods(id: &'static str, kept: Kept, says: &'static str) -> Mistake {
    row(id, Wrong::Rods(kept), &[], says)
}

/// A projection in place of forces.
const ALONE: Kept = Kept {
    forces: false,
    ..Kept::PROJECTED
};

/// Every mistake. No two are the same map in general, nor is one a method of the registry.
pub static MISTAKES: &[Mistake] = &[
    step(
        "midpoint_end_velocity",
        "midpoint",
        second([&[0.5], &[1.0, 0.5]], [&[1.0, 0.0, 1.0], &[1.0, 0.0, 1.0]]),
        "the position moves with the velocity at the end of the step: move it with the velocity at \
         the midpoint",
    ),
    step(
        "midpoint_half_last_stage",
        "midpoint",
        Step::tableau(&[&[], &[0.5]], &[0.0, 0.5], &[0.0, 0.5]),
        "the last stage advances by half a step: take the slope at the midpoint for the whole step, \
         x0 + h v_mid and v0 + h a_mid",
    ),
    step(
        "midpoint_from_the_middle",
        "midpoint",
        Step::tableau(&[&[], &[0.5]], &[0.5, 1.0], &[0.0, 0.5]),
        "the whole step starts from the midpoint state: go back to the state at the start of the \
         step before adding h times the midpoint's slope",
    ),
    step(
        "explicit_euler_accumulating",
        "explicit_euler",
        first(&[1.0], ACCUMULATED),
        "forces add up from step to step: set the force array to zero before each evaluation",
    ),
    step(
        "explicit_euler_stale_force",
        "explicit_euler",
        first(&[1.0], STALE),
        "the velocity is kicked with the force of the previous step: evaluate the forces at the \
         current state before the kick",
    ),
    step(
        "symplectic_euler_accumulating",
        "symplectic_euler",
        first(ACCUMULATED, ACCUMULATED),
        "forces add up from step to step: set the force array to zero before each evaluation",
    ),
    step(
        "symplectic_euler_stale_force",
        "symplectic_euler",
        first(STALE, STALE),
        "the velocity is kicked with the force of the previous step: evaluate the forces at the \
         current positions before the kick",
    ),
    step(
        "heun_not_halved",
        "heun",
        Step::tableau(&[&[], &[1.0]], &[1.0, 1.0], &[0.0, 1.0]),
        "the two slopes are added, not averaged: multiply their sum by h/2",
    ),
    step(
        "ralston_swapped_weights",
        "ralston",
        Step::tableau(&[&[], &[2.0 / 3.0]], &[0.75, 0.25], &[0.0, 2.0 / 3.0]),
        "the two weights are exchanged: the first slope counts 1/4, the one at 2/3 h counts 3/4",
    ),
    step(
        "rk4_equal_weights",
        "rk4",
        Step::tableau(
            &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 1.0]],
            &[0.25, 0.25, 0.25, 0.25],
            &[0.0, 0.5, 0.5, 1.0],
        ),
        "all four slopes count the same: weigh them 1, 2, 2, 1 and divide by 6",
    ),
    step(
        "rk4_half_last_stage",
        "rk4",
        Step::tableau(
            &[&[], &[0.5], &[0.0, 0.5], &[0.0, 0.0, 0.5]],
            RK4_WEIGHTS,
            &[0.0, 0.5, 0.5, 0.5],
        ),
        "the fourth slope is taken half a step ahead: take it at the end of the step, \
         x0 + h v3 and v0 + h a3",
    ),
    step(
        "rk4_stage_on_stage",
        "rk4",
        Step::tableau(
            &[&[], &[0.5], &[0.5, 0.5], &[0.5, 0.5, 1.0]],
            RK4_WEIGHTS,
            &[0.0, 0.5, 0.5, 1.0],
        ),
        "each stage starts from the stage before it: start every stage from the state at the start \
         of the step",
    ),
    step(
        "velocity_verlet_stale_force",
        "velocity_verlet",
        first(&[1.0, 0.5], &[1.0, 1.0]),
        "the second half kick reuses the force from before the drift: evaluate the forces again at \
         the new positions",
    ),
    step(
        "velocity_verlet_new_force_only",
        "velocity_verlet",
        second([&[1.0, 0.5], &[1.0]], [&[1.0, 0.5], &[1.0, 0.0, 1.0]]),
        "the velocity changes by the new force alone: use the mean of the force before and the \
         force after the drift",
    ),
    step(
        "velocity_verlet_missing_half",
        "velocity_verlet",
        second([&[1.0, 1.0], &[1.0, 0.5]], [&[1.0, 1.0], &[1.0, 0.5, 0.5]]),
        "the position moves by h v + h² a: the second term is h² a / 2",
    ),
    step(
        "yoshida4_swapped_coefficients",
        "yoshida4",
        Step::splitting(YOSHIDA4_SWAPPED, DampingTreatment::Sweeps),
        "the coefficients stand in the wrong order: the negative one, 1 - 2 w1 = -1.70, belongs in \
         the middle",
    ),
    row(
        "implicit_euler_old_velocity",
        Wrong::Step {
            meant: "implicit_euler",
            step: Step::Coefficients(Coefficients::Implicit(ImplicitScheme::Euler)),
            around: Some(drifted_before),
        },
        &[],
        "the position moves with the velocity from before the solve: move it with the new one, \
         x0 + h v1",
    ),
    step(
        "implicit_euler_one_pass",
        "implicit_euler",
        second([&[1.0], &[1.0, 1.0]], [&[1.0, 0.0, 1.0], &[1.0, 0.0, 1.0]]),
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
    physics(
        "drive_forgotten",
        physics::drive_forgotten,
        &[("driven", 0.0)],
        "forces see a driven particle at its `pos`: at time t it is there plus its displacement at t",
    ),
    physics(
        "drive_at_rest",
        physics::drive_at_rest,
        &[("driven.velocity", 0.0)],
        "a driven particle moves, but dampers take it to be at rest: they resist the velocity relative to its own",
    ),
    physics(
        "drive_late",
        physics::drive_late,
        &[],
        "forces see a driven particle where it was one step before: at time t it is at `pos` plus its displacement at t",
    ),
    physics(
        "drive_early",
        physics::drive_early,
        &[],
        "forces see a driven particle where it is one step later: at time t it is at `pos` plus its displacement at t",
    ),
    physics(
        "drive_straight",
        physics::drive_unbent,
        &[],
        "forces see a driven particle go straight from row to row of its table: it passes them on a natural cubic spline",
    ),
    row(
        "drive_held",
        Wrong::Applied(|step, f, h, _, s| step(&Altered::new(f, Altering::TimeHeld(s.t)), h, s)),
        &[],
        "all stages of a step see a driven particle where it is at its start: each stage has a time of its own",
    ),
    scaled(
        "damping_sign",
        &[
            ("springs.damping", -1.0),
            ("drag", -1.0),
            ("quadratic_drag", -1.0),
            ("air_drag", -1.0),
        ],
        "damping has the wrong sign, so it drives: a damper's force opposes the velocity",
    ),
    scaled(
        "damping_forgotten",
        &[
            ("springs.damping", 0.0),
            ("drag", 0.0),
            ("quadratic_drag", 0.0),
            ("air_drag", 0.0),
        ],
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
        "both_ends_alike",
        springs::both_ends_alike,
        &[("springs.second_end", -1.0)],
        "springs push both their ends the same way: the force on the second end is the opposite of that on the first",
    ),
    physics(
        "strain_limit_forgotten",
        physics::strain_limit_forgotten,
        &[],
        "the strain limit is left out: shorten springs that are beyond it after each step",
    ),
    physics(
        "strain_limit_of_positions",
        physics::strain_limit_of_positions,
        &[],
        "the strain limit moves positions alone: take the velocity out that goes on stretching a spring, or what hangs \
         at rest falls faster and faster",
    ),
    physics(
        "strain_limit_by_halves",
        physics::strain_limit_by_halves,
        &[],
        "the strain limit moves both free ends by half: move each by its 1/m, or the centre of mass moves",
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
    physics(
        "rods_forgotten",
        physics::rods_forgotten,
        &[("rods", 0.0)],
        "rods are missing: nothing keeps their ends at a distance",
    ),
    physics(
        "rod_turning_forgotten",
        physics::turning_forgotten,
        &[("rods.turning", 0.0)],
        "the tension of a rod is without its part |u|²/l, by which the velocity u of its ends turns it: the rod keeps \
         n·a + |u|²/l = 0",
    ),
    rods(
        "positions_projected",
        Kept {
            velocities: Moved::Not,
            ..Kept::PROJECTED
        },
        "positions are moved onto the rods, velocities are left: take the velocity along rods out as well, each \
         particle by its 1/m",
    ),
    rods(
        "velocities_projected",
        Kept {
            positions: Moved::Not,
            ..Kept::PROJECTED
        },
        "the velocity along rods is taken out, positions are left: move them onto the rods as well, each particle by \
         its 1/m",
    ),
    rods(
        "projected_without_masses",
        Kept {
            masses: false,
            ..Kept::PROJECTED
        },
        "the projection moves both ends of a rod by the same, whatever their mass: each moves by its 1/m",
    ),
    rods(
        "projected_in_one_sweep",
        Kept {
            positions: Moved::Swept(1),
            velocities: Moved::Swept(1),
            ..Kept::PROJECTED
        },
        "the projection takes one rod after the other once: repeat its sweeps until all lengths hold, or solve for all \
         rods together",
    ),
    rods(
        "positions_projected_alone",
        Kept {
            velocities: Moved::Not,
            ..ALONE
        },
        "rods have no forces, and positions alone are moved onto them: velocities along rods add up; take them out as \
         well, or use (x1 - x0) / h",
    ),
    rods(
        "positions_swept_alone",
        Kept {
            positions: Moved::Swept(1),
            velocities: Moved::Not,
            ..ALONE
        },
        "rods have no forces, and positions alone are moved onto one rod after the other, once: velocities along rods \
         add up; take them out as well, or use (x1 - x0) / h",
    ),
    rods(
        "velocities_projected_alone",
        Kept {
            positions: Moved::Not,
            ..ALONE
        },
        "rods have no forces, and the velocity along them alone is taken out: lengths drift; move positions onto the \
         rods as well",
    ),
    rods(
        "projected_alone_without_masses",
        Kept {
            masses: false,
            ..ALONE
        },
        "rods have no forces, and the projection moves both ends of a rod by the same, whatever their mass: each moves \
         by its 1/m",
    ),
    rods(
        "projected_alone_in_one_sweep",
        Kept {
            positions: Moved::Swept(1),
            velocities: Moved::Swept(1),
            ..ALONE
        },
        "rods have no forces, and the projection takes one rod after the other once: repeat its sweeps until all \
         lengths hold",
    ),
    row(
        "springs_for_rods",
        Wrong::SpringsForRods,
        &[("rods", 0.0)],
        "springs stand in for rods: their lengths change, and stiffer ones need smaller steps",
    ),
    row(
        "step_halved",
        Wrong::Length(0.5),
        &[("timestep", 0.5)],
        "each step advances the state by h/2 only: use the whole timestep, or write a row \
         every second step",
    ),
    row(
        "step_doubled",
        Wrong::Length(2.0),
        &[("timestep", 2.0)],
        "each step advances the state by 2 h: use the timestep the rows are apart",
    ),
];

/// Where forces add up from step to step, v1 = v0 + h (a0 + all accelerations before): their sum is what the last
/// step added to v, over h.
const ACCUMULATED: &[f64] = &[2.0, 1.0, 0.0, 0.0, -1.0];

/// v1 = v0 + h a, with the acceleration one step before.
const STALE: &[f64] = &[1.0, 0.0, 0.0, 1.0];

const RK4_WEIGHTS: &[f64] = &[1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0];

/// Position Verlet over 1 - 2 w1, w1 and w1 of the step.
const YOSHIDA4_SWAPPED: &[Stage] = {
    const W1: f64 = 1.351_207_191_959_657_8;
    const W0: f64 = 1.0 - 2.0 * W1;
    &[
        Stage::Drift(0.5 * W0),
        Stage::Kick(W0),
        Stage::Drift(0.5 * (W0 + W1)),
        Stage::Kick(W1),
        Stage::Drift(W1),
        Stage::Kick(W1),
        Stage::Drift(0.5 * W1),
    ]
};

/// The step's velocity, and the position that the velocity before it leads to.
fn drifted_before(
    step: &OneStep,
    system: &dyn System,
    h: f64,
    _: u32,
    state: &mut State,
) -> Result<(), StepError> {
    let x = plus(&state.x, h, &state.v);
    step(system, h, state)?;
    state.x = x;
    Ok(())
}
