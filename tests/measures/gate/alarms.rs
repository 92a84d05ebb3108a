//! No false alarms: random scenes inside their limits.

use super::*;
use crate::testkit::Random;
use crate::testkit::scenes::{all_shipped, empty, fixed, free, spring};
use springcheck::integrators::Method;
use springcheck::measure::stability::{Effort, Limit, Linearised};
use springcheck::physics::ParticleSystem;
use springcheck::scene::{DampingModel, Wind};
use springcheck::solvers::Status;

/// A scene of 2 to 6 particles, some fixed in half of them, springs of stiffness over two decades with or without
/// dampers, gravity, drag, wind and springs that stiffen in some, and a step inside the limit of its own integrator.
/// Nothing attracts: where particles meet, such a force has no limit.
fn random(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    for _ in 0..8 {
        random.next();
    }
    let mut chance = |part: f64| 0.5 * (random.next() + 1.0) < part;
    let (anchored, damped, falls, dragged, windy, cubic) = (
        chance(0.5),
        chance(0.4),
        chance(0.6),
        chance(0.2),
        chance(0.2),
        chance(0.2),
    );
    let mut random = Random(seed.wrapping_mul(0xD134_2543_DE82_EF95) | 1);
    for _ in 0..8 {
        random.next();
    }
    let mut scene = empty();
    let count = 2 + (2.5 * (random.next() + 1.0)) as usize;
    for i in 0..count {
        let mut place = || [0, 1, 2].map(|_| random.next());
        let (at, velocity) = (place(), place());
        if anchored && i == 0 {
            scene.particles.push(fixed(at));
        } else {
            let mut particle = free(at, 0.2 + 0.9 * (random.next() + 1.0));
            particle.velocity = velocity;
            if dragged {
                particle.drag = 0.2 * (random.next() + 1.0);
            }
            scene.particles.push(particle);
        }
    }
    for b in 1..count {
        for a in 0..b {
            if a + 1 == b || random.next() > 0.3 {
                let stiffness = 10.0_f64.powf(1.5 + random.next());
                let (p, q) = (scene.particles[a].position, scene.particles[b].position);
                let length = p
                    .iter()
                    .zip(&q)
                    .map(|(p, q)| (p - q) * (p - q))
                    .sum::<f64>()
                    .sqrt();
                let mut spring = spring([a, b], stiffness, length * (1.0 + 0.2 * random.next()));
                if damped {
                    spring.damping = 0.3 * (random.next() + 1.0);
                }
                if cubic {
                    spring.cubic = 0.2 * stiffness * (random.next() + 1.0);
                }
                scene.springs.push(spring);
            }
        }
    }
    if random.next() > 0.5 {
        scene.damping_model = DampingModel::Isotropic;
    }
    if windy {
        scene.wind = Some(Wind {
            direction: [0.6, 0.8, 0.0],
            strength: random.next(),
        });
    }
    scene.solver.gravity = if falls { -9.81 } else { 0.0 };
    let methods = integrators::fixed();
    let system = ParticleSystem::new(&scene);
    let start = ParticleSystem::initial_state(&scene);
    let linearised = Linearised::new(&system, &start, Effort::FULL);
    let limit = |method: &Method| linearised.predict(method, 1e-3).limit;
    // A method that is stable at no step has no step inside its limit.
    let stable = methods.iter().cycle().skip(seed as usize % methods.len());
    let stable = stable
        .take(methods.len())
        .find(|method| limit(method) != Limit::Never);
    let method = stable.expect("implicit Euler is stable");
    scene.solver.method = method.id.to_owned();
    let limit = match limit(method) {
        Limit::At(limit) => limit,
        _ => 2.0 / linearised.omega_max().unwrap_or(1.0),
    };
    // From a twentieth to half of the limit.
    scene.solver.timestep = limit * 0.05 * 10.0_f64.powf(0.5 * (random.next() + 1.0));
    scene.duration = (100.0 + 200.0 * (random.next() + 1.0)) * scene.solver.timestep;
    scene
}

/// How many are tried; the thousand that were take 3 minutes: `SPRINGCHECK_SCENES=1000`.
fn many() -> u64 {
    let stated = std::env::var("SPRINGCHECK_SCENES")
        .ok()
        .and_then(|many| many.parse().ok());
    let whole = std::env::var_os("SPRINGCHECK_WHOLE").is_some();
    stated.unwrap_or(if whole { 200 } else { 40 })
}

#[test]
fn random_scenes_raise_none() {
    let mut left = 0;
    for seed in 0..many() {
        let scene = random(seed);
        let report = Gate::new(&scene).run(&Quiet).expect("nothing is written");
        let method = &scene.solver.method;
        let own = report.outcomes().iter().find(|o| o.engine == *method);
        if own.is_some_and(|own| own.status == Status::Diverged) {
            // The limit is that of the start, and this motion has left it: the gate is right to be red.
            left += 1;
            continue;
        }
        let alarms = failed(&report);
        let text = springcheck::scene::yaml(&scene);
        assert!(alarms.is_empty(), "seed {seed}: {alarms:#?}\n{text}");
    }
    // Measured 2 in a thousand.
    assert!(100 * left <= many().max(100), "{left}");
}

/// Scenes of single effects hold what they expect, and every law.
#[test]
fn scenes_of_effects_raise_none() {
    for scene in all_shipped(&["effects"]) {
        let report = Gate::new(&scene).run(&Quiet).expect("nothing is written");
        let alarms = failed(&report);
        assert!(alarms.is_empty(), "{}: {alarms:#?}", scene.name);
    }
}
