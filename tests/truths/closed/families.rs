//! Scenes with a closed form, by family, from random numbers.

pub use crate::testkit::scenes::{empty, fixed};
use crate::testkit::{Random, scenes};
use springcheck::scene::{DampingModel, Magnetic, Particle, Scene, Spring, Wind};

pub fn free(position: [f64; 3], velocity: [f64; 3], mass: f64) -> Particle {
    Particle {
        velocity,
        ..scenes::free(position, mass)
    }
}

pub fn spring(a: usize, b: usize, stiffness: f64, damping: f64, rest_length: f64) -> Spring {
    Spring {
        damping,
        ..scenes::spring([a, b], stiffness, rest_length)
    }
}

/// Uniform in [low, high).
pub fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * 0.5 * (1.0 + random.next())
}

pub fn vector(random: &mut Random, size: f64) -> [f64; 3] {
    [(); 3].map(|()| size * random.next())
}

/// One particle under gravity and wind, with drag of this rate b / m.
pub fn fall(random: &mut Random, rate: f64) -> Scene {
    let mut scene = empty();
    scene.solver.gravity = -9.81;
    let mass = between(random, 0.1, 3.0);
    let particle = free(vector(random, 2.0), vector(random, 5.0), mass);
    scene.particles = vec![Particle {
        drag: rate * mass,
        ..particle
    }];
    scene.wind = Some(Wind {
        direction: [0.6, 0.0, 0.8],
        strength: random.next(),
    });
    scene
}

/// The same with a charge in a field of any direction that turns it at `w`, rad/s.
pub fn charged(random: &mut Random, w: f64, rate: f64) -> Scene {
    let mut scene = fall(random, rate);
    let field = vector(random, 1.0);
    let size = field.iter().map(|b| b * b).sum::<f64>().sqrt();
    let sign = if random.next() < 0.0 { -1.0 } else { 1.0 };
    scene.particles[0].charge = sign * w * scene.particles[0].mass / size;
    scene.magnetic = Some(Magnetic { field });
    scene
}

/// One particle under its anchor with a rest length of 1 m, too slow and too light to come near it;
/// damping is `zeta` times the critical, along the spring.
pub fn hanging(random: &mut Random, w: f64, zeta: f64) -> Scene {
    let mut scene = empty();
    // Sags and swings by g / w² and v / w: 0.2 of the length at most.
    scene.solver.gravity = -0.1 * w * w * between(random, 0.2, 1.0);
    let mass = between(random, 0.1, 3.0);
    let speed = 0.2 * w * random.next();
    scene.particles = vec![
        fixed([0.0, 0.0, 2.0]),
        free([0.0, 0.0, 1.0], [0.0, 0.0, speed], mass),
    ];
    scene.springs = vec![spring(0, 1, mass * w * w, 2.0 * zeta * w * mass, 1.0)];
    scene
}

/// One particle on a spring of rest length 0, in any direction through its anchor.
pub fn isotropic(random: &mut Random, w: f64, zeta: f64) -> Scene {
    let mut scene = hanging(random, w, zeta);
    scene.damping_model = DampingModel::Isotropic;
    scene.springs[0].rest_length = 0.0;
    scene.particles[1].position = vector(random, 1.0);
    scene.particles[1].velocity = vector(random, w);
    scene
}

/// `n` unlike masses in a row between two walls, `damping` times K for C, on springs of 1 m that
/// start up to 10 % off their length, along (1, 2, 2) / 3, whose lengths are whole numbers.
pub fn chain(random: &mut Random, n: usize, damping: f64) -> Scene {
    let mut scene = empty();
    let at = |s: f64| [s / 3.0, s / 1.5, s / 1.5];
    scene.particles = (0..n + 2)
        .map(|i| {
            // Thirds are exact where the distance is three times a short binary fraction.
            let off = (25.0 * random.next()).round() / 256.0;
            let inner = (1..=n).contains(&i);
            let s = 3.0 * (i as f64 + if inner { off } else { 0.0 });
            let mass = between(random, 0.5, 2.0);
            let mut particle = free(at(s), [0.0; 3], mass);
            particle.fixed = !inner;
            particle
        })
        .collect();
    scene.springs = (0..=n)
        .map(|i| {
            let stiffness = between(random, 50.0, 200.0);
            spring(i, i + 1, stiffness, damping * stiffness, 3.0)
        })
        .collect();
    scene
}

/// The same equal masses, held by nothing, thrown under gravity across the line, with drag of this
/// rate; wind may blow since the masses are equal.
pub fn thrown(random: &mut Random, n: usize, rate: f64) -> Scene {
    let mut scene = chain(random, n, 0.0);
    scene.solver.gravity = -9.81;
    scene.wind = Some(Wind {
        direction: [0.0, 1.0, 0.0],
        strength: 0.7,
    });
    for particle in &mut scene.particles {
        particle.fixed = false;
        particle.mass = 0.75;
        particle.drag = 0.75 * rate;
        particle.velocity = [3.0, -1.0, 4.0];
    }
    scene
}

/// Two unlike masses on one spring, turned nowhere, thrown.
pub fn two(random: &mut Random) -> Scene {
    let mut scene = thrown(random, 0, 0.0);
    scene.wind = None;
    scene.particles[1].mass = 2.5;
    // Towards the other along (1, 2, 2).
    scene.particles[1].velocity = [2.5, -2.0, 3.0];
    scene.springs[0].stiffness = 60.0;
    scene
}

/// `n` masses joined at random in space by springs of rest length 0, one to an anchor; `damping`
/// times K for C and drag of this rate.
pub fn network(random: &mut Random, n: usize, damping: f64, rate: f64) -> Scene {
    let mut scene = empty();
    scene.solver.gravity = -9.81;
    scene.damping_model = DampingModel::Isotropic;
    scene.particles = vec![fixed(vector(random, 1.0))];
    for i in 1..=n {
        let mass = between(random, 0.5, 2.0);
        let particle = free(vector(random, 1.0), vector(random, 1.0), mass);
        scene.particles.push(Particle {
            drag: rate * mass,
            ..particle
        });
        let other = between(random, 0.0, i as f64) as usize;
        for other in [i - 1, other.min(i - 1)] {
            let stiffness = between(random, 20.0, 400.0);
            scene
                .springs
                .push(spring(other, i, stiffness, damping * stiffness, 0.0));
        }
    }
    scene
}

/// A fall, a hanging particle and a network in one scene, none touching another.
pub fn together(random: &mut Random) -> Scene {
    let mut scene = network(random, 3, 0.0, 0.0);
    for other in [fall(random, 0.3), isotropic(random, 3.0, 0.0)] {
        let first = scene.particles.len();
        scene.particles.extend(other.particles);
        scene
            .springs
            .extend(other.springs.into_iter().map(|s| Spring {
                ends: s.ends.map(|end| end + first),
                ..s
            }));
        scene.wind = scene.wind.or(other.wind);
    }
    scene
}
