//! The starts of a twin proof: a scene set in motion, so that a few steps exercise all of it, and the same
//! one rounding away.

use crate::scene::{Particle, Scene, Spring};

/// The scene with small pseudo-random velocities added to its free particles', the same every time.
///
/// Fast enough to stretch springs by up to a hundredth in `time` seconds or in the time scale of
/// the stiffest particle, whichever is longer: seen well above rounding, far from turning a spring
/// over.
pub(super) fn set_in_motion(scene: &Scene, time: f64) -> Scene {
    let scale = per_mass(scene, |spring| spring.stiffness);
    let time = if scale > 0.0 {
        time.max(1.0 / scale.sqrt())
    } else {
        time
    };
    let speed = 0.01 * shortest(scene) / time;
    let mut random = Random(1);
    let mut moving = scene.clone();
    for particle in moving.particles.iter_mut().filter(|p| !p.fixed) {
        for v in &mut particle.velocity {
            *v += speed * random.symmetric();
        }
    }
    moving
}

/// The scene from a start one rounding away: each free coordinate and velocity by one part in 2⁵²
/// of the largest, in a direction that the seed picks.
pub(super) fn disturbed(scene: &Scene, seed: u64) -> Scene {
    let largest = |part: fn(&Particle) -> [f64; 3]| {
        let all = scene.particles.iter().flat_map(part);
        all.fold(0.0_f64, |most, c| most.max(c.abs()))
    };
    let x = largest(|p| p.position);
    let v = largest(|p| if p.fixed { [0.0; 3] } else { p.velocity });
    let mut random = Random(seed);
    let mut disturbed = scene.clone();
    for particle in disturbed.particles.iter_mut().filter(|p| !p.fixed) {
        for axis in 0..3 {
            particle.position[axis] += f64::EPSILON * x * random.symmetric().signum();
            particle.velocity[axis] += f64::EPSILON * v * random.symmetric().signum();
        }
    }
    disturbed
}

/// An upper bound of the condition number of the implicit step's matrix M + h C + h² K relative to
/// M (Gershgorin: a spring acts on both its ends).
pub(super) fn condition(scene: &Scene, h: f64) -> f64 {
    let springs = per_mass(scene, |spring| h * (spring.damping + h * spring.stiffness));
    let free = scene.particles.iter().filter(|p| !p.fixed);
    let drag = free.fold(0.0, |most, p| f64::max(most, h * p.drag / p.mass));
    1.0 + springs + drag
}

/// The largest over the free particles of twice the sum of `of` over the springs at it, per mass:
/// with stiffnesses an upper bound of the springs' largest w², 1/s². 0 without springs.
fn per_mass(scene: &Scene, of: impl Fn(&Spring) -> f64) -> f64 {
    let mut sums = vec![0.0; scene.particles.len()];
    for spring in &scene.springs {
        for end in spring.ends {
            sums[end] += of(spring);
        }
    }
    let free = scene.particles.iter().zip(sums);
    free.filter(|(p, _)| !p.fixed)
        .fold(0.0, |most, (p, sum)| f64::max(most, 2.0 * sum / p.mass))
}

/// The shortest spring that has a length, m; else the scene's size; else 1.
fn shortest(scene: &Scene) -> f64 {
    let starts = scene.starts();
    let length = |ends: [usize; 2]| {
        let [a, b] = ends.map(|end| starts[end]);
        let squares = (0..3).map(|axis| (a[axis] - b[axis]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let springs = scene.springs.iter().map(|spring| length(spring.ends));
    let shortest = springs.filter(|&l| l > 0.0).fold(f64::INFINITY, f64::min);
    let size = scene.size();
    match (shortest.is_finite(), size > 0.0) {
        (true, _) => shortest,
        (false, true) => size,
        (false, false) => 1.0,
    }
}

/// A linear congruential generator (Knuth's MMIX constants): only to spread directions.
struct Random(u64);

impl Random {
    /// The next number, in [-1, 1).
    fn symmetric(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / 2f64.powi(52) - 1.0
    }
}
