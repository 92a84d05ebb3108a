//! Cloths built in memory: what the spring kernel is tested and timed on.

use super::scenes::{empty, fixed, free, spring};
use springcheck::scene::{DampingModel, Particle, Scene, SolverSpec, Spring};

/// m between neighbours.
const SPACING: f64 = 0.1;

/// n by n particles of 10 g, 10 cm apart, hung by two corners in gravity: structural, shear and
/// flexion springs of 100 N/m with these dampers, N s/m. Moved a little out of rest, so that no
/// force and no velocity is 0.
pub fn cloth(n: usize, damping: f64, model: DampingModel) -> Scene {
    let wave = |p: usize, by: usize| ((p * by) % 13) as f64 / 13.0 - 0.5;
    let particles = (0..n * n).map(|p| {
        let (row, column) = (p / n, p % n);
        let held = row == 0 && (column == 0 || column == n - 1);
        let position = [
            SPACING * (row as f64 + 0.1 * wave(p, 5)),
            SPACING * (column as f64 + 0.1 * wave(p, 7)),
            2.0 + 0.1 * SPACING * wave(p, 11),
        ];
        if held {
            return fixed(position);
        }
        Particle {
            velocity: [wave(p, 3), wave(p, 2), wave(p, 6)],
            ..free(position, 0.01)
        }
    });
    let mut springs = Vec::new();
    for (row, column) in (0..n * n).map(|p| (p / n, p % n)) {
        for (down, right) in [(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)] {
            let (to_row, to) = (row + down, column as isize + right);
            if to_row < n && (0..n as isize).contains(&to) {
                let square = (down * down) as f64 + (right * right) as f64;
                let ends = [row * n + column, to_row * n + to as usize];
                springs.push(Spring {
                    damping,
                    ..spring(ends, 100.0, SPACING * square.sqrt())
                });
            }
        }
    }
    Scene {
        name: format!("cloth {n} x {n}"),
        solver: SolverSpec {
            method: "symplectic_euler".into(),
            timestep: 1e-4,
            ..SolverSpec::default()
        },
        duration: 1.0,
        damping_model: model,
        particles: particles.collect(),
        springs,
        ..empty()
    }
}

/// The same scene with its particles and its springs numbered at random: neighbours are far apart
/// in memory.
pub fn shuffled(mut scene: Scene, seed: u64) -> Scene {
    let mut state = seed | 1;
    let mut below = |n: usize| {
        // xorshift64*, its upper bits.
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33) as usize % n
    };
    let n = scene.particles.len();
    // place[p] is where particle p goes.
    let mut place: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        place.swap(i, below(i + 1));
    }
    let old = scene.particles.clone();
    for (particle, &to) in old.into_iter().zip(&place) {
        scene.particles[to] = particle;
    }
    for spring in &mut scene.springs {
        spring.ends = spring.ends.map(|end| place[end]);
    }
    for i in (1..scene.springs.len()).rev() {
        scene.springs.swap(i, below(i + 1));
    }
    scene
}

/// A scene file of few lines: a cloth of n by n particles with all its springs and triangles.
pub fn in_few_lines(n: usize) -> String {
    format!(
        "solver: {{type: symplectic_euler, timestep: 0.0005}}
objects:
- cloth: {{name: sheet, origin: [0, 0, 1], u: [1, 0, 0], v: [0, 1, 0], particles: [{n}, {n}], mass: 0.3,
    structural: {{stiffness: 500}}, shear: {{stiffness: 200}}, flexion: {{stiffness: 50}},
    pins: [corner00, corner10], air_drag: 1}}
"
    )
}
