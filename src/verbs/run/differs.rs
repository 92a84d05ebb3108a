//! Where rapier's contact differs from the laws of contact, with the numbers of a run.

use crate::integrators::Softness;
use crate::measure::Bounce;
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{ParticleSystem, System};
use crate::report::words::short;
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
            "Friction of an impact sees its compression alone: at most µ V, as if µ were µ/(1 + e) = {}.",
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
    let once = "Restitution acts once a step, with the velocity at its start";
    let constant = system.effects().iter().all(|(row, _)| row.constant);
    let flat = scene.colliders.iter().all(|one| one.plane.is_some());
    let bounce = Bounce::first(obstacles, run, h).filter(|_| constant && flat);
    let Some(bounce) = bounce else {
        return format!("{once}.");
    };
    let e = bounce.restitution;
    let [before, after] = bounce.gaps;
    format!(
        "{once}: the bounce of particle {} at {} s rises {} m less than e² of the height before. That is e (1 + e)/2 V h = {} \
         m, with V = {} m/s and h = {} s, and e² d0 - d1 = {} m, from the gaps d0 before that step and d1 after it.",
        bounce.particle,
        short(bounce.t),
        short(bounce.lost()),
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
            "It is soft: against what {what} a spring of w = 2 π {hertz} Hz, so that what rests is N/(m w²) inside, {} m under \
             this gravity, to where it sinks with a time constant of {} s.",
            short(g / (w * w)),
            short(soft.settles_in(h)),
        )
    })
}
