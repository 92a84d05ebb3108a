//! The tables of what programs do at contact. The first row of each is right.

use super::own::NUMBERS;
use super::ways::{
    after_kick, ahead, at_end, at_start, before_kick, between_kicks, interpolated, to_impact,
};
use super::{Friction, Lift, Partner, Restitution, Row, Shares, Way};
use crate::physics::constraints::contact::{Against, Beside, Hit, ImpactLaw};

const fn row<T>(id: &'static str, does: T, says: &'static str) -> Row<T> {
    Row {
        id,
        says,
        mistake: false,
        does,
    }
}

const fn mistake<T>(id: &'static str, does: T, says: &'static str) -> Row<T> {
    Row {
        id,
        says,
        mistake: true,
        does,
    }
}

/// When, and by what.
pub static WAYS: &[Row<Way>] = &[
    row("impulse", Way::Event, ""),
    row(
        "flip_at_end",
        Way::Once(at_end),
        "reverses the velocity at the end of the step, instead of by an impulse at the impact",
    ),
    row(
        "flip_at_start",
        Way::Once(at_start),
        "reverses the velocity at the start of the next step, instead of by an impulse at the impact",
    ),
    row(
        "flip_after_kick",
        Way::Once(after_kick),
        "reverses the velocity of the next step between its kick and its drift, instead of by an impulse at the impact",
    ),
    row(
        "flip_before_kick",
        Way::Once(before_kick),
        "reverses the velocity in place of the kick of the next step, whose force it leaves out, instead of by an impulse \
         at the impact",
    ),
    row(
        "flip_between_kicks",
        Way::Of("velocity_verlet", between_kicks),
        "reverses the velocity between the two kicks of a step, instead of by an impulse at the impact",
    ),
    row(
        "flip_before_drift",
        Way::Of("symplectic_euler", ahead),
        "reverses the velocity before the drift where this would end inside, instead of by an impulse at the impact",
    ),
    row(
        "impact_by_interpolation",
        Way::Within(interpolated),
        "takes gaps to change evenly over the step to find the impact, and not to rounding",
    ),
    row(
        "penalty",
        Way::Force {
            pulls: true,
            whole: false,
        },
        "pushes out what is inside by a spring and a damper, which may pull, instead of an impulse at the impact",
    ),
    row(
        "penalty_without_pull",
        Way::Force {
            pulls: false,
            whole: false,
        },
        "pushes out what is inside by a spring and a damper, which never pull, instead of an impulse at the impact",
    ),
    row(
        "penalty_in_whole_steps",
        Way::Force {
            pulls: true,
            whole: true,
        },
        "does not cut steps where a penalty begins and ends, which is of order 1",
    ),
    row(
        "penalty_in_whole_steps_without_pull",
        Way::Force {
            pulls: false,
            whole: true,
        },
        "does not cut steps where a penalty begins and ends, which is of order 1, and never pulls",
    ),
    row(
        "soft_step",
        Way::Soft,
        "steps as rapier's contact does (a soft step: a spring of 60 Hz once a gap is closed, 30 Hz where the obstacle moves, \
         and restitution once a step), instead of by an impulse at the impact",
    ),
    mistake(
        "rest_of_step_dropped",
        Way::Within(to_impact),
        "ends the step at the impact: what is left of the step has to follow it",
    ),
    mistake(
        "obstacles_forgotten",
        Way::Never,
        "does nothing: test every particle in each step against every obstacle, and against the others where these collide",
    ),
];

const fn lift(by: fn(f64, f64) -> f64) -> Lift {
    Lift {
        by,
        halves: false,
        back: false,
    }
}

/// Where what is inside is put.
pub static PLACES: &[Row<Lift>] = &[
    row("left", lift(|_, _| 0.0), ""),
    row(
        "clamped",
        lift(|gap, _| -gap),
        "puts what is inside on the surface",
    ),
    row(
        "mirrored",
        lift(|gap, _| -2.0 * gap),
        "puts what is inside as far outside",
    ),
    row(
        "mirrored_by_e",
        lift(|gap, e| -(1.0 + e) * gap),
        "puts what is inside e times as far outside",
    ),
    row(
        "clamped_by_halves",
        Lift {
            halves: true,
            ..lift(|gap, _| -gap)
        },
        "puts what is inside on the surface, of two particles each by half of it",
    ),
    row(
        "moved_back",
        Lift {
            back: true,
            ..lift(|_, _| 0.0)
        },
        "puts what is inside back where the step began",
    ),
];

const fn rebound(gains: fn(&Hit) -> f64) -> Restitution {
    Restitution {
        gains,
        leaving: false,
    }
}

/// What the normal velocity becomes.
pub static RESTITUTIONS: &[Row<Restitution>] = &[
    row("newton", rebound(ImpactLaw::newton), ""),
    mistake(
        "restitution_as_one",
        rebound(|hit| 2.0 * hit.approach),
        "leaves restitution out, as if e were 1: the normal velocity becomes -e times what it was",
    ),
    mistake(
        "restitution_as_zero",
        rebound(|hit| hit.approach),
        "leaves restitution out, as if e were 0: the normal velocity becomes -e times what it was",
    ),
    mistake(
        "velocity_kept",
        rebound(|_| 0.0),
        "leaves the velocity as it is: turn its normal part round as well, or it grows without end",
    ),
    mistake(
        "normal_reversed",
        rebound(|hit| -ImpactLaw::newton(hit)),
        "has the impulse with the wrong sign: it acts along the normal from the obstacle to the particle",
    ),
    mistake(
        "leaving_reversed",
        Restitution {
            gains: ImpactLaw::newton,
            leaving: true,
        },
        "reverses the velocity of what already leaves, too: reverse it only where it leads into the obstacle",
    ),
];

/// What the sliding velocity loses.
pub static FRICTIONS: &[Row<Friction>] = &[
    row("coulomb", ImpactLaw::coulomb, ""),
    row(
        "friction_of_compression",
        |hit, _| (hit.friction * hit.approach.max(0.0)).min(hit.sliding),
        "takes µ V off the sliding speed, V the normal speed, and not µ (1 + e) V",
    ),
    mistake(
        "friction_forgotten",
        |_, _| 0.0,
        "has no friction: take min(µ (1 + e) V, v_t) off the sliding speed, V the normal speed",
    ),
    mistake(
        "friction_unbounded",
        |hit, gained| hit.friction * gained,
        "lets friction turn the sliding round: it takes no more than the sliding speed",
    ),
    mistake(
        "friction_as_factor",
        |hit, _| hit.friction.min(1.0) * hit.sliding,
        "multiplies the sliding velocity by 1 - µ: friction is µ times the normal impulse, however fast it slides",
    ),
    mistake(
        "friction_as_factor_of_step",
        |hit, _| (hit.friction * hit.h).min(1.0) * hit.sliding,
        "multiplies the sliding velocity by 1 - µ h: friction is µ times the normal impulse, however fast it slides",
    ),
    mistake(
        "restitution_of_whole_velocity",
        |hit, _| (1.0 - hit.restitution) * hit.sliding,
        "applies restitution to the whole velocity: e belongs to the normal part alone",
    ),
    mistake(
        "whole_velocity_reversed",
        |hit, _| (1.0 + hit.restitution) * hit.sliding,
        "reverses the whole velocity: reverse its normal part alone",
    ),
];

const fn partner(shares: Shares) -> Partner {
    Partner {
        shares,
        speed: 1.0,
        meets: true,
        slopes: true,
    }
}

/// What the other of a contact is.
pub static PARTNERS: &[Row<Partner>] = &[
    row("by_mass", partner(by_mass), ""),
    mistake(
        "masses_ignored",
        partner(halves),
        "gives two particles the same change of velocity: each changes by the impulse over its own mass",
    ),
    mistake(
        "velocities_exchanged",
        partner(|beside, change, weights| match beside.against {
            Against::Obstacle(_) => by_mass(beside, change, weights),
            Against::Particle(_) => halves(beside, beside.velocity.map(|u| -2.0 * u), weights),
        }),
        "exchanges the velocities of two particles: an impulse changes their normal parts alone, each by its 1/m",
    ),
    mistake(
        "normal_velocities_exchanged",
        partner(|beside, change, weights| match beside.against {
            Against::Obstacle(_) => by_mass(beside, change, weights),
            Against::Particle(_) => {
                let parting = beside.parting();
                halves(beside, beside.normal.map(|n| -2.0 * parting * n), weights)
            }
        }),
        "exchanges the normal velocities of two particles, which is right for equal masses and e = 1 alone",
    ),
    mistake(
        "pairs_forgotten",
        Partner {
            meets: false,
            ..partner(by_mass)
        },
        "lets particles pass through each other: test every pair of them in each step",
    ),
    mistake(
        "obstacle_at_rest",
        Partner {
            speed: 0.0,
            ..partner(by_mass)
        },
        "takes a moving obstacle to be at rest: velocities at contact are those relative to it",
    ),
    mistake(
        "obstacle_backwards",
        Partner {
            speed: -1.0,
            ..partner(by_mass)
        },
        "takes a moving obstacle to move the other way: subtract its velocity from the particle's",
    ),
    mistake(
        "normal_along_axis",
        Partner {
            slopes: false,
            ..partner(by_mass)
        },
        "turns the velocity about the axis nearest to the normal of a slanting surface: turn its part along the normal",
    ),
];

/// Each by its part of both 1/m.
pub(super) fn by_mass(_: &Beside, change: [f64; 3], [own, other]: [f64; 2]) -> [[f64; 3]; 2] {
    let whole = own + other;
    [
        change.map(|c| own / whole * c),
        change.map(|c| -(other / whole) * c),
    ]
}

/// Each by half, but all of it where the other is an obstacle.
pub(super) fn halves(beside: &Beside, change: [f64; 3], weights: [f64; 2]) -> [[f64; 3]; 2] {
    match beside.against {
        Against::Obstacle(_) => by_mass(beside, change, weights),
        Against::Particle(_) => [change.map(|c| 0.5 * c), change.map(|c| -0.5 * c)],
    }
}

/// Every row that is not right in all respects: id, what it does after "at contact it", and whether it is a mistake.
pub fn treatments() -> impl Iterator<Item = (&'static str, &'static str, bool)> {
    fn of<T>(table: &'static [Row<T>]) -> impl Iterator<Item = (&'static str, &'static str, bool)> {
        let said = table.iter().filter(|row| !row.says.is_empty());
        said.map(|row| (row.id, row.says, row.mistake))
    }
    of(WAYS)
        .chain(of(PLACES))
        .chain(of(RESTITUTIONS))
        .chain(of(FRICTIONS))
        .chain(of(PARTNERS))
        .chain(NUMBERS.map(|(id, says)| (id, says, true)))
}
