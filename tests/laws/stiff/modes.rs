//! The chain with its soft springs made linear: every mode is an oscillator of its own, and a step
//! multiplies its energy by |R(i h w)|², whatever the other modes do.

use super::hard;
use crate::testkit::{advance, built, method, own};
use nalgebra::{DMatrix, DVector};
use springcheck::integrators::{EnergyLaw, Integrator};
use springcheck::physics::State;
use springcheck::scene::Scene;

/// Soft springs of 1 N/m for the quartic ones: slow modes below 2 rad/s beside fast ones at 50.
fn linear() -> Scene {
    let mut scene = hard("fput.yml");
    for spring in scene.springs.iter_mut().filter(|s| s.cubic > 0.0) {
        (spring.cubic, spring.stiffness) = (0.0, 1.0);
    }
    scene
}

/// Frequencies, rad/s, rising, and shapes of the chain's modes along x; unit masses.
fn modes(scene: &Scene) -> Vec<(f64, DVector<f64>)> {
    let n = scene.particles.len();
    let mut stiffness = DMatrix::<f64>::zeros(n, n);
    for spring in &scene.springs {
        let [a, b] = spring.ends;
        for (row, column, sign) in [(a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)] {
            stiffness[(row, column)] += sign * spring.stiffness;
        }
    }
    // The walls are its first and last particle.
    let eigen = stiffness
        .view((1, 1), (n - 2, n - 2))
        .into_owned()
        .symmetric_eigen();
    let shape = |j: usize| eigen.eigenvectors.column(j).into_owned();
    let mut modes: Vec<(f64, DVector<f64>)> = (0..n - 2)
        .map(|j| (eigen.eigenvalues[j].sqrt(), shape(j)))
        .collect();
    modes.sort_by(|a, b| a.0.total_cmp(&b.0));
    modes
}

/// Position, m, and velocity over frequency, m, of a mode.
fn phase(scene: &Scene, state: &State, (w, shape): &(f64, DVector<f64>)) -> (f64, f64) {
    let rest = |i: usize| scene.springs[0].rest_length * i as f64;
    let free = 1..scene.particles.len() - 1;
    free.fold((0.0, 0.0), |(x, v), i| {
        let weight = shape[i - 1];
        (
            x + weight * (state.x[3 * i] - rest(i)),
            v + weight * state.v[3 * i] / w,
        )
    })
}

/// What is left of each mode's amplitude after so many steps, and by how much it turned in the last
/// one, rad.
fn left(scene: &Scene, integrator: &mut dyn Integrator, h: f64, steps: usize) -> Vec<(f64, f64)> {
    let (system, start) = built(scene);
    let mut state = start.clone();
    advance(integrator, &system, h, steps - 1, &mut state);
    let before = state.clone();
    advance(integrator, &system, h, 1, &mut state);
    let each = modes(scene).into_iter().map(|mode| {
        let [first, before, last] = [&start, &before, &state].map(|s| phase(scene, s, &mode));
        let (sin, cos) = (
            before.1 * last.0 - before.0 * last.1,
            before.0 * last.0 + before.1 * last.1,
        );
        (
            last.0.hypot(last.1) / first.0.hypot(first.1),
            sin.atan2(cos),
        )
    });
    each.collect()
}

/// s: z = 5 and 10 on the stiff springs.
const COARSE: [f64; 2] = [0.1, 0.2];
const STEPS: usize = 20;

/// Every mode has the amplitude its row's energy law leaves it.
fn amplitude_law(
    id: &str,
    scene: &Scene,
    integrator: &mut dyn Integrator,
    h: f64,
) -> Result<(), String> {
    let EnergyLaw::Factor { factor, .. } = method(id).oscillator.energy else {
        return Err("no factor".into());
    };
    for ((w, _), (found, _)) in modes(scene).iter().zip(left(scene, integrator, h, STEPS)) {
        let law = factor(h * w).powf(0.5 * STEPS as f64);
        // A step may leave 1e-12 of an impulse of 2 N s, 4e-12 m of the slowest mode; most leave only
        // rounding. Measured 3.3e-12.
        if (found - law).abs() > 1e-11 {
            return Err(format!("{id}, h = {h}, w = {w:.3}: {found:e}, not {law:e}"));
        }
    }
    Ok(())
}

#[test]
fn modes_keep_what_the_stability_function_says() {
    let scene = linear();
    let ids = [
        "implicit_euler",
        "implicit_midpoint",
        "trapezoidal",
        "tr_bdf2",
    ];
    for h in COARSE {
        for id in ids {
            amplitude_law(id, &scene, own(method(id))().as_mut(), h).unwrap();
            // No other method's law.
            for other in ids {
                let law = amplitude_law(other, &scene, own(method(id))().as_mut(), h);
                let factor = |id| method(id).oscillator.energy;
                let (EnergyLaw::Factor { formula: a, .. }, EnergyLaw::Factor { formula: b, .. }) =
                    (factor(id), factor(other))
                else {
                    panic!()
                };
                assert_eq!(law.is_ok(), a == b, "{id} as {other}: {law:?}");
            }
        }
    }
}

/// What that buys: of slow and fast motion 20 coarse steps keep both, neither, or the slow one alone.
#[test]
fn only_tr_bdf2_tells_slow_from_fast() {
    let scene = linear();
    let found: Vec<f64> = modes(&scene).iter().map(|(w, _)| *w).collect();
    assert!(found[0] > 0.5 && found[2] < 1.4 && found[3] > 50.0);
    for h in COARSE {
        let energy = |id: &str| {
            let kept = left(&scene, own(method(id))().as_mut(), h, STEPS);
            let square = |(a, _): &(f64, f64)| a * a;
            let fast = kept[3..].iter().map(square).fold(0.0, f64::max);
            (square(&kept[0]), fast)
        };
        // 20 times z² = 0.05² = 2.5e-3 at least, and 26 times less a step at least.
        let (slow, fast) = energy("implicit_euler");
        assert!(slow < 0.955 && fast < 1e-20, "{slow} {fast}");
        let (slow, fast) = energy("implicit_midpoint");
        let off = (slow - 1.0).abs().max((fast - 1.0).abs());
        assert!(off < 1e-9, "{slow} {fast}");
        // 20 times (z²/11.66)² with z = 0.11 at most, and 0.535 a step at most.
        let (slow, fast) = energy("tr_bdf2");
        assert!(1.0 - slow < 2.2e-5 && fast < 4e-6, "{slow} {fast}");
    }
}

/// What the midpoint rule keeps of the fast modes turns by 2 atan(z/2) a step, not by z: at h = 0.1 the
/// chain rings at 24 rad/s instead of 50.
#[test]
fn what_the_midpoint_rule_keeps_rings_at_a_wrong_frequency() {
    let scene = linear();
    for h in COARSE {
        let turned = left(
            &scene,
            own(method("implicit_midpoint"))().as_mut(),
            h,
            STEPS,
        );
        for ((w, _), (_, angle)) in modes(&scene).iter().zip(turned) {
            let law = 2.0 * (0.5 * h * w).atan();
            // As of amplitudes, over those of the weakest mode.
            assert!((angle - law).abs() < 1e-9, "{w}: {angle} {law}");
            if *w > 50.0 {
                let rings = angle / h;
                assert!(rings < 24.0, "{rings}");
            }
        }
    }
}
