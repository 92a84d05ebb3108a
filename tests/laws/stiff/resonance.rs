//! Verlet's order-3 resonance: at z = h w = √3 three steps make a turn, and what bends the force
//! pushes the same way three times a turn.

use super::hard;
use crate::testkit::{advance, built, method, own};
use springcheck::physics::{State, System};
use springcheck::scene::Scene;

/// w² of small motions, 1/s²: 3 g / s.
const W2: f64 = 300.0;
/// The sag s, m.
const SAG: f64 = 0.1;
/// The scene's amplitude in units of it.
const AMPLITUDE: f64 = 0.02;
/// The scene itself is thrown out within 84 steps.
const LONG: usize = 5_000;

/// The scene let go at this displacement, in sags; downwards if positive.
fn resonant(amplitude: f64) -> Scene {
    let mut scene = hard("resonance.yml");
    scene.particles[1].position[2] = -1.0 - SAG * (1.0 + amplitude);
    scene
}

/// The same w and cubic part about a middle without bend.
fn symmetric(amplitude: f64) -> Scene {
    let mut scene = resonant(amplitude);
    scene.solver.gravity = 0.0;
    scene.springs[0].stiffness = W2;
    scene.particles[1].position[2] = -1.0 - SAG * amplitude;
    scene
}

/// Verlet's largest |H - H0| in units of the swing's energy m w² A² / 2; None once it is a hundred
/// times that.
fn energy_error(scene: &Scene, amplitude: f64, z2: f64) -> Option<f64> {
    let (system, mut state) = built(scene);
    let mut integrator = own(method("velocity_verlet"))();
    let energy = |state: &State| system.kinetic(&state.v) + system.potential(0.0, &state.x);
    let start = energy(&state);
    let swing = 0.5 * W2 * (amplitude * SAG).powi(2);
    let mut worst = 0.0_f64;
    for _ in 0..LONG {
        advance(
            integrator.as_mut(),
            &system,
            (z2 / W2).sqrt(),
            1,
            &mut state,
        );
        worst = worst.max((energy(&state) - start).abs() / swing);
        if worst.is_nan() || worst > 100.0 {
            return None;
        }
    }
    Some(worst)
}

/// The z² at which stability ends between 3, which is not, and `stable`, which is; None if that is
/// wrong.
fn border(scene: &Scene, amplitude: f64, stable: f64) -> Option<f64> {
    let holds = |z2: f64| energy_error(scene, amplitude, z2).is_some();
    let (mut inside, mut outside) = (3.0, stable);
    if holds(inside) || !holds(outside) {
        return None;
    }
    while (outside - inside).abs() > 1e-6 {
        let middle = 0.5 * (inside + outside);
        if holds(middle) {
            outside = middle;
        } else {
            inside = middle;
        }
    }
    Some(outside)
}

/// The z² at which Verlet comes back to the displacement p, at rest, after three steps: through q
/// twice, so that 2 (q - p) = -z² f(p) and p - q = -z² f(q) with f(x) = x + x² + x³/3, the force in
/// units of w² s. So f(p) + 2 f(q) = 0; about 3 - 3 p / 2.
fn three_cycle(p: f64) -> f64 {
    let f = |x: f64| x + x * x + x * x * x / 3.0;
    let mut q = -0.5 * p;
    for _ in 0..50 {
        q -= (f(p) + 2.0 * f(q)) / (2.0 * (1.0 + q) * (1.0 + q));
    }
    (q - p) / f(q)
}

/// The cycle is unstable, and beyond it everything is thrown out: where it passes through the start,
/// stability ends. As z² goes to 3 it shrinks to the equilibrium. Above 3 it points the other way, and
/// the start leaves in the middle of a side of the triangle, half as far out: at 3 + 3 p.
fn border_law(scene: &Scene, amplitude: f64) -> Result<(), String> {
    let found = [2.6, 3.4].map(|stable| border(scene, amplitude, stable));
    let [Some(low), Some(high)] = found else {
        return Err(format!("no borders: {found:?}"));
    };
    // As bisected, measured 3.7e-7: what is chaotic about a separatrix is exponentially thin.
    let cycle = (low - three_cycle(amplitude)).abs();
    // The side is bent in the next order of the amplitude: measured 9.1 of its squares.
    let side = (high - 3.0 - 3.0 * amplitude).abs() / amplitude.powi(2);
    if cycle > 1e-6 || side > 20.0 {
        return Err(format!("{amplitude}: {low}, {high}"));
    }
    Ok(())
}

#[test]
fn the_stable_region_shrinks_to_nothing_at_the_third_of_a_turn() {
    for amplitude in [AMPLITUDE, 0.5 * AMPLITUDE] {
        border_law(&resonant(amplitude), amplitude).unwrap();
        // Another amplitude; the other side; no bend.
        assert!(border_law(&resonant(0.9 * amplitude), amplitude).is_err());
        assert!(border_law(&resonant(-amplitude), amplitude).is_err());
        assert!(border_law(&symmetric(amplitude), amplitude).is_err());
    }
}

/// On either side of it the energy stays in the linear band: within z²/4 of the swing's, give or take
/// a few amplitudes. Without the bend it does at √3, too.
#[test]
fn on_either_side_nothing_happens() {
    let off = |scene: &Scene, z2: f64| energy_error(scene, AMPLITUDE, z2).map(|e| e / (z2 / 4.0));
    let scene = resonant(AMPLITUDE);
    for z in [1.5_f64, 1.6, 1.85, 1.9] {
        let found = off(&scene, z * z).expect("stable");
        // Measured up to 1.037.
        assert!((found - 1.0).abs() < 3.0 * AMPLITUDE, "{z}: {found}");
    }
    for z2 in [2.9, 2.97, 3.0, 3.03, 3.07] {
        let found = off(&symmetric(AMPLITUDE), z2).expect("stable");
        // Its own bend is of the third order: the amplitude's square.
        assert!((found - 1.0).abs() < AMPLITUDE.powi(2), "{z2}: {found}");
        let resonance = (2.975..3.06).contains(&z2);
        assert_eq!(off(&scene, z2).is_none(), resonance, "{z2}");
    }
}
