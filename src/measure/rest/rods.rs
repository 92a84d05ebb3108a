//! Rests of scenes with rods: stiff springs stand for these, whose rest lengths are shortened by their own stretch until
//! the rods have their lengths (the method of multipliers: Hestenes 1969, J. Optim. Theory Appl. 4).

use super::{Rest, RestError};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Scene, Spring};

/// Stand-ins stretch by about this part of their lengths at first, and by as little of what is left in each round. Stiffer
/// ones would turn roundings of positions into larger forces.
const STRETCH: f64 = 1e-3;
/// Those of oscillations: frequencies are off by about half of this part.
const STIFF: f64 = 1e-7;
/// The most rounds: six leave rounding where stand-ins are that stiff.
const ROUNDS: usize = 40;
/// Roundings of a coordinate that a length may be off.
const ROUNDINGS: f64 = 4.0;

/// The scene with springs in place of its rods, of which `stiffness` and `pull`, N/m and N, tell each by its length and
/// place: at its length each pulls so much.
fn stood_in(scene: &Scene, stiffness: impl Fn(f64) -> f64, pull: impl Fn(usize) -> f64) -> Scene {
    let mut stiff = scene.clone();
    stiff.rods.clear();
    stiff
        .springs
        .extend(scene.rods.iter().enumerate().map(|(at, rod)| {
            let stiffness = stiffness(rod.length);
            Spring {
                ends: rod.ends,
                stiffness,
                rest_length: rod.length - pull(at) / stiffness,
                ..Spring::default()
            }
        }));
    stiff
}

/// The sum of all forces at the start, N: about what a rod may have to pull.
fn load(scene: &Scene) -> f64 {
    let free = Scene {
        rods: Vec::new(),
        ..scene.clone()
    };
    let system = ParticleSystem::new(&free);
    let State { x, v, .. } = ParticleSystem::initial_state(scene);
    let mut forces = vec![0.0; x.len()];
    system.forces(0.0, &x, &v, &mut forces);
    let moving = forces
        .iter()
        .zip(system.inverse_mass())
        .filter(|(_, w)| **w > 0.0);
    let sum: f64 = moving.map(|(f, _)| f.abs()).sum();
    if sum > 0.0 { sum } else { 1.0 }
}

/// The rest of a scene that nothing drives.
pub(super) fn find(
    scene: &Scene,
    settle: impl Fn(&Scene) -> Result<Rest, RestError>,
) -> Result<Rest, RestError> {
    let load = load(scene);
    let mut stiff = stood_in(scene, |length| load / (STRETCH * length), |_| 0.0);
    let first = scene.springs.len();
    let mut iterations = 0;
    let mut before = f64::INFINITY;
    for _ in 0..ROUNDS {
        let found = settle(&stiff)?;
        iterations += found.iterations;
        let largest = found.x.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
        let mut worst = 0.0_f64;
        for (rod, spring) in scene.rods.iter().zip(&mut stiff.springs[first..]) {
            let [a, b] = rod.ends.map(|end| 3 * end);
            let d = [0, 1, 2].map(|axis| found.x[b + axis] - found.x[a + axis]);
            let off = d[0].hypot(d[1]).hypot(d[2]) - rod.length;
            worst = worst.max(off.abs() / largest.max(rod.length));
            // The pull that this length gave is what the next one starts from.
            spring.rest_length -= off;
        }
        let rounded = worst <= ROUNDINGS * f64::EPSILON;
        if rounded || worst > 0.5 * before {
            return Ok(Rest {
                iterations,
                ..found
            });
        }
        before = worst;
        for (particle, x) in stiff.particles.iter_mut().zip(found.x.chunks_exact(3)) {
            particle.position.copy_from_slice(x);
        }
    }
    settle(&stiff)
}

/// The system whose oscillations about this rest are those of the scene, but for those of its stand-ins: as many as rods.
/// None where the tensions are not determined.
pub fn about(scene: &Scene, x: &[f64]) -> Option<ParticleSystem> {
    let system = ParticleSystem::new(scene);
    let tensions = system.rod_tensions(0.0, x, &vec![0.0; x.len()]).ok()?;
    let largest = tensions
        .iter()
        .fold(load(scene), |most, t| most.max(t.abs()));
    let stiff = stood_in(
        scene,
        |length| largest / (STIFF * length),
        |at| tensions[at],
    );
    Some(ParticleSystem::new(&stiff))
}
