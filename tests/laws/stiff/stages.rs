//! The two stages of TR-BDF2, read off what a step leaves.

use crate::testkit::{advance, built, method, own, swinging_triangle};
use springcheck::integrators::{Integrator, Settings};
use springcheck::physics::{State, System};
use springcheck::scene::{DampingModel, Scene};

const H: f64 = 0.02;

/// x1 and v1 at t + g h, g = 2 - √2, are what the backward difference
/// y(t + h) = y1 + (√2 - 1)/2 (y1 - y0) + (g/2) h y'(t + h) of Hosea and Shampine goes back to; and they
/// are where the trapezoidal rule leads. Returns by how much they are not, relative to the way.
fn defect(scene: &Scene, integrator: &mut dyn Integrator) -> f64 {
    let (system, start) = built(scene);
    let mut end = start.clone();
    advance(integrator, &system, H, 1, &mut end);
    let root = 2.0_f64.sqrt();
    let (d, beyond) = ((2.0 - root) / 2.0 * H, (root - 1.0) / 2.0);
    let slope = |state: &State| {
        let mut a = vec![0.0; state.x.len()];
        system.acceleration(0.0, &state.x, &state.v, &mut a);
        (state.v.clone(), a)
    };
    let back = |end: &[f64], slope: &[f64], start: &[f64]| -> Vec<f64> {
        let one = |i: usize| (end[i] - d * slope[i] + beyond * start[i]) / (1.0 + beyond);
        (0..end.len()).map(one).collect()
    };
    let at_end = slope(&end);
    let stage = State::new(
        back(&end.x, &at_end.0, &start.x),
        back(&end.v, &at_end.1, &start.v),
    );
    let (before, after) = (slope(&start), slope(&stage));
    let mut worst = 0.0_f64;
    for (stage, start, before, after) in [
        (&stage.x, &start.x, &before.0, &after.0),
        (&stage.v, &start.v, &before.1, &after.1),
    ] {
        for i in 0..stage.len() {
            let way = d * (before[i] + after[i]);
            worst = worst.max((stage[i] - start[i] - way).abs());
        }
    }
    let way = end.v.iter().zip(&start.v).map(|(a, b)| (a - b).abs());
    worst / way.fold(0.0, f64::max)
}

#[test]
fn a_trapezoidal_stage_and_a_backward_difference() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = swinging_triangle(0.8, model);
        let found = defect(&scene, own(method("tr_bdf2"))().as_mut());
        // Two stages solved to 1e-12 of the way; Newton's last correction squares that, and measured
        // are 2.6e-15.
        assert!(found < 4e-12, "{found:e}");
        // Loosely solved, and other methods of the second order.
        let loose = Settings::stated(Some(1e-3));
        let mutants = [
            method("tr_bdf2").build(&loose),
            own(method("trapezoidal"))(),
            own(method("implicit_midpoint"))(),
        ];
        for mut mutant in mutants {
            assert!(defect(&scene, mutant.as_mut()) > 1e-8);
        }
    }
}
