//! Fixed particles that move: no scheme does that.

use crate::measure::identify::{Fault, Quantity};
use crate::scene::Scene;
use crate::trajectory::Rows;

/// A fixed particle may be this many of its roundings away from where the scene has it: its own, and
/// that of the file's number for it.
const ROUNDINGS: f64 = 4.0;

/// The first row in which a fixed particle is not where the scene has it; None if there is none.
pub fn moved_anchor(scene: &Scene, rows: &Rows) -> Option<Fault> {
    let fixed: Vec<usize> = (0..scene.particles.len())
        .filter(|&i| scene.particles[i].fixed && 3 * i + 3 <= rows.dim)
        .collect();
    (0..rows.len()).find_map(|k| fixed.iter().find_map(|&i| moved(scene, rows, k, i)))
}

fn moved(scene: &Scene, rows: &Rows, k: usize, particle: usize) -> Option<Fault> {
    let expected = scene.particles[particle].position;
    let at = &rows.x(k)[3 * particle..3 * particle + 3];
    let found = [at[0], at[1], at[2]];
    let away = expected.iter().zip(&found).any(|(place, x)| {
        let rounding = rows.precision.half_unit(*place).max(f64::MIN_POSITIVE);
        // A program in single precision puts it at the nearest single, whatever it prints.
        let near = |place: f64| (x - place).abs() <= ROUNDINGS * rounding;
        !near(*place) && !near(f64::from(*place as f32))
    });
    away.then(|| Fault {
        step: rows.steps[k].saturating_sub(1),
        t_s: rows.steps[k].saturating_sub(1) as f64 * rows.timestep,
        particle,
        quantity: Quantity::Position,
        expected,
        found: found.map(|c| Some(c).filter(|c| c.is_finite())),
        explanation: format!(
            "particle {particle} is fixed in the scene, but moves: leave fixed particles out of \
             every update"
        ),
    })
}
