//! Dampers beside contact: every method keeps order 2 on curved surfaces, and where many impacts fall into one step.

use crate::contact::{G, balance, of_order, run};
use crate::testkit::scenes::parsed;
use springcheck::integrators::Method;
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;

/// The methods of order 2 where there are dampers.
fn damped(scene: &Scene) -> impl Iterator<Item = &'static Method> {
    of_order(2, scene).filter(|method| method.order_damped >= 2)
}

/// log2 of the ratio of errors at a step and at a quarter of it, over the two halvings.
fn order(coarse: f64, fine: f64) -> f64 {
    0.5 * (coarse / fine).log2()
}

/// θ'' = (g/R) sin θ - b θ' from rest, by ten thousand steps of the classic method: to 1e-14.
fn slid(angle: f64, radius: f64, drag: f64, t: f64) -> f64 {
    let steps = 10_000;
    let h = t / f64::from(steps);
    let rate = |[angle, speed]: [f64; 2]| [speed, G / radius * angle.sin() - drag * speed];
    let ahead = |from: [f64; 2], by: f64, rate: [f64; 2]| [0, 1].map(|c| from[c] + by * rate[c]);
    let mut at = [angle, 0.0];
    for _ in 0..steps {
        let a = rate(at);
        let b = rate(ahead(at, 0.5 * h, a));
        let c = rate(ahead(at, 0.5 * h, b));
        let d = rate(ahead(at, h, c));
        at = [0, 1].map(|i| at[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
    }
    at[0]
}

#[test]
fn drag_on_a_ball_costs_no_order() {
    let (angle, radius, drag, t) = (0.3_f64, 1.1, 2.0, 0.48);
    let [x, z] = [radius * angle.sin(), radius * angle.cos()];
    let scene = parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: -{G}}}\nduration: 10\n\
         particles: [{{pos: [{x:?}, 0, {z:?}], mass: 1, radius: 0, drag: {drag}}}]\n\
         colliders: [{{ball: {{center: [0, 0, 0], radius: {radius}}}}}]\n"
    ));
    let right = slid(angle, radius, drag, t);
    for method in damped(&scene) {
        let off = |steps: u32| {
            let end = run(method.id, &scene, t / f64::from(steps), steps);
            (end.x[0].atan2(end.x[2]) - right).abs()
        };
        let (coarse, fine) = (off(60), off(240));
        // Two halvings. What is of a higher order is there already.
        let found = order(coarse, fine);
        assert!(
            found > 1.9 || fine < 1e-9,
            "{}: {coarse:e} and {fine:e}, order {found}",
            method.id
        );
    }
}

/// Pairs of 1 kg, one above the other, on springs of k with dampers of c, that fall onto a floor from different heights.
fn pairs(count: usize, [k, c]: [f64; 2]) -> Scene {
    let each = |n: usize| {
        let (x, z) = (n as f64, height(n));
        format!(
            "- {{pos: [{x:?}, 0, {z:?}], mass: 1, radius: 0}}\n\
             - {{pos: [{x:?}, 0, {:?}], mass: 1, radius: 0}}\n",
            z + 1.0
        )
    };
    let spring = |n: usize| {
        let ends = [2 * n, 2 * n + 1];
        format!("- {{particle_ids: {ends:?}, stiffness: {k}, damping: {c}, rest_length: 1}}\n")
    };
    let particles: String = (0..count).map(each).collect();
    let springs: String = (0..count).map(spring).collect();
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: -{G}}}\nduration: 10\n\
         colliders: [{{plane: {{normal: [0, 0, 1]}}}}]\n\
         particles:\n{particles}springs:\n{springs}"
    ))
}

fn height(pair: usize) -> f64 {
    0.2 + 0.003 * pair as f64
}

/// Where the upper one of a pair is at t: from the impact of the lower one on, a damped oscillator under gravity.
fn upper(pair: usize, [k, c]: [f64; 2], t: f64) -> f64 {
    let fell = (2.0 * height(pair) / G).sqrt();
    let (w, since) = ((k - 0.25 * c * c).sqrt(), t - fell);
    let (sin, cos) = (w * since).sin_cos();
    let by_sin = (-G * fell + 0.5 * c * G / k) / w;
    1.0 - G / k + (-0.5 * c * since).exp() * (G / k * cos + by_sin * sin)
}

#[test]
fn dampers_know_of_many_impacts() {
    const COUNT: usize = 40;
    let (law, t) = ([100.0, 4.0], 0.4);
    let scene = pairs(COUNT, law);
    let before = balance(&scene, &ParticleSystem::initial_state(&scene));
    for method in damped(&scene) {
        let off = |steps: u32| {
            let end = run(method.id, &scene, t / f64::from(steps), steps);
            let each = (0..COUNT).map(|n| (end.x[6 * n + 5] - upper(n, law, t)).abs());
            let mean = each.sum::<f64>() / COUNT as f64;
            [mean, (balance(&scene, &end) - before).abs()]
        };
        let (coarse, fine) = (off(100), off(400));
        for (what, (coarse, fine)) in ["way", "balance"].iter().zip(coarse.into_iter().zip(fine)) {
            let found = order(coarse, fine);
            assert!(
                found > 1.6 || fine < 1e-9,
                "{} {what}: {coarse:e} and {fine:e}, order {found}",
                method.id
            );
        }
    }
}
