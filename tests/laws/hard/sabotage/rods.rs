//! What must not go unseen where rods fold, are parallel or in one line, join masses far apart, or are tiny.

use super::{Row, mutants};

pub const SABOTAGES: &[Row] = &[
    ("folded_rods", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "folded_rods",
        "midpoint",
        mutants::midpoint_drifting_with_the_end_velocity,
    ),
    (
        "folded_rods",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
    ("parallel_rods", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "parallel_rods",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
    ("rods_mass_ratio", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "rods_mass_ratio",
        "explicit_euler",
        mutants::euler_drifting_with_the_new_velocity,
    ),
    ("dead_point", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "dead_point",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
    ("tiny_rod", "rk4", mutants::rk4_with_a_wrong_weight),
    (
        "tiny_rod",
        "symplectic_euler",
        mutants::euler_drifting_with_the_old_velocity,
    ),
];
