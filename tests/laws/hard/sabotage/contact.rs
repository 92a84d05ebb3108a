//! What must not go unseen where particles meet obstacles and each other. Where no force acts a step of half its length is
//! what breaks the motion.

use super::{Row, mutants};

pub const SABOTAGES: &[Row] = &[
    (
        "closing_walls",
        "symplectic_euler",
        mutants::symplectic_euler_at_half_the_step,
    ),
    (
        "grazing_impact",
        "symplectic_euler",
        mutants::symplectic_euler_at_half_the_step,
    ),
    ("grazing_impact", "rk4", mutants::frozen),
    (
        "corner_of_a_box",
        "symplectic_euler",
        mutants::symplectic_euler_at_half_the_step,
    ),
    ("corner_of_a_box", "rk4", mutants::rk4_with_a_wrong_weight),
    ("stack_of_balls", "symplectic_euler", passes_through),
    (
        "mesh_seam",
        "symplectic_euler",
        mutants::symplectic_euler_at_half_the_step,
    ),
    ("stiff_at_a_wall", "symplectic_euler", passes_through),
    (
        "thin_box",
        "symplectic_euler",
        mutants::symplectic_euler_at_half_the_step,
    ),
    ("thin_box", "rk4", mutants::frozen),
    ("far_contact", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "far_contact",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
];

/// What holds a particle in its own coordinates is forgotten: all drift down by a millionth of a metre a step.
fn passes_through(
    _: &dyn springcheck::physics::System,
    _: f64,
    s: &mut springcheck::physics::State,
) {
    s.x.iter_mut().for_each(|x| *x -= 1e-6);
}
