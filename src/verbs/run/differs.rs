//! Where rapier's contact differs from the laws of contact, with the numbers of a run.

use crate::integrators::Softness;
use crate::measure::Bounce;
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{ParticleSystem, System};
use crate::report::words::{quantity, short};
use crate::scene::{Collider, Scene};
use crate::trajectory::Trajectory;

/// What differs in a run of a rapier world with substeps of `h` seconds.
pub fn differs(scene: &Scene, system: &ParticleSystem, run: &Trajectory, h: f64) -> Vec<String> {
    let Some(obstacles) = system.obstacles() else {
        return Vec::new();
    };
    let mut differs = Vec::new();
    if scene.colliders.iter().any(|one| one.restitution > 0.0) {
        differs.push(bounces(scene, system, obstacles, run, h));
    }
    let rubs = |one: &&Collider| one.friction > 0.0 && one.restitution > 0.0;
    if let Some(one) = scene.colliders.iter().find(rubs) {
        differs.push(format!(
            "An impact has only {:.0} % of the friction it should have, at most. It takes µ V off the sliding speed and not \
             µ (1 + e) V, as if µ were µ/(1 + e) = {}.",
            100.0 / (1.0 + one.restitution),
            short(one.friction / (1.0 + one.restitution))
        ));
    }
    differs.extend(
        [false, true]
            .into_iter()
            .filter_map(|moves| depth(scene, moves, h)),
    );
    differs
}

fn bounces(
    scene: &Scene,
    system: &ParticleSystem,
    obstacles: &Obstacles,
    run: &Trajectory,
    h: f64,
) -> String {
    let constant = system.effects().iter().all(|(row, _)| row.constant);
    let flat = scene.colliders.iter().all(|one| one.plane.is_some());
    let bounce = Bounce::first(obstacles, run, h).filter(|_| constant && flat);
    let Some(bounce) = bounce else {
        return "A bounce may be lower or higher than e² of the height before. Restitution acts once a step, with the \
                velocity at its start."
            .to_owned();
    };
    let e = bounce.restitution;
    let [before, after] = bounce.gaps;
    let gravity = scene.gravity();
    let g = -(0..3).map(|c| bounce.normal[c] * gravity[c]).sum::<f64>();
    // Of the height that it should rise to, e² V²/2g.
    let share = 200.0 * bounce.lost() * g / (e * bounce.speed).powi(2);
    let share = if g > 0.0 && share.is_finite() {
        format!(" ({} %)", quantity(share.abs()))
    } else {
        String::new()
    };
    let way = if bounce.lost() < 0.0 {
        "higher"
    } else {
        "lower"
    };
    format!(
        "The bounce of particle {} at {} s is {} mm{share} {way} than e² of the height before, since restitution acts once a \
         step, with the velocity at its start. That is e (1 + e)/2 V h = {} m, with V = {} m/s and h = {} s, and \
         e² d0 - d1 = {} m, from the gaps d0 before that step and d1 after it.",
        bounce.particle,
        short(bounce.t),
        quantity(1e3 * bounce.lost().abs()),
        short(0.5 * e * (1.0 + e) * bounce.speed * h),
        short(bounce.speed),
        short(h),
        short(e * e * before - after),
    )
}

/// How deep what rests is inside obstacles that move, or do not.
fn depth(scene: &Scene, moves: bool, h: f64) -> Option<String> {
    let gravity = scene.gravity();
    let pressing = scene.colliders.iter().filter_map(|one| {
        let own = one.displacement().is_some() == moves;
        let along = one.plane.as_ref().map(|plane| {
            let parts = plane.normal.iter().zip(gravity);
            -parts.map(|(n, g)| n * g).sum::<f64>()
        });
        let all = gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        own.then(|| along.unwrap_or(all))
    });
    let g = pressing.fold(0.0, f64::max);
    let soft = Softness::new(moves, h);
    let w = soft.angular_frequency;
    let (hertz, what) = if moves {
        (30, "moves")
    } else {
        (60, "is fixed")
    };
    (g > 0.0).then(|| {
        format!(
            "What rests on what {what} is {} mm inside; it sinks there in about {} s. Contact is a spring of w = 2 π {hertz} Hz: \
             N/(m w²) under this gravity.",
            quantity(1e3 * g / (w * w)),
            short(soft.settles_in(h)),
        )
    })
}
