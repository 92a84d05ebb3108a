//! What must not go unseen where particles meet obstacles and each other. Where no force acts, standing still is what breaks
//! the motion.

use super::{Row, mutants};

pub const SABOTAGES: &[Row] = &[
    ("closing_walls", "symplectic_euler", mutants::frozen),
    ("grazing_impact", "symplectic_euler", mutants::frozen),
    ("grazing_impact", "rk4", mutants::frozen),
    ("corner_of_a_box", "rk4", mutants::rk4_with_a_wrong_weight),
    ("stack_of_balls", "symplectic_euler", drifting),
    ("mesh_seam", "symplectic_euler", mutants::frozen),
    ("stiff_at_a_wall", "symplectic_euler", drifting),
    ("thin_box", "symplectic_euler", mutants::frozen),
    ("thin_box", "rk4", mutants::frozen),
    ("far_contact", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "far_contact",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
];

/// All coordinates drift by a millionth of a metre a step, those that contacts leave free.
fn drifting(_: &dyn springcheck::physics::System, _: f64, s: &mut springcheck::physics::State) {
    s.x.iter_mut().for_each(|x| *x -= 1e-6);
}
