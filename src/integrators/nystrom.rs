//! Explicit tableaux in Nyström form, for steppers with many stages.
//!
//! As (x, v)' = (v, a), stage velocities are sums of stage accelerations, so positions are
//! x + c h v + h² Σ ā a with ā = a a, and only accelerations are kept. Where forces depend on
//! velocity it is the same Runge-Kutta method, but for rounding.

use super::Tableau;

/// The number of coordinates processed at once, so that sums over stages stay in registers.
pub(crate) const LANES: usize = 8;

/// The node and weights of a stage.
pub(crate) struct NystromStage {
    /// c.
    pub node: f64,
    /// The weights of the stages before it.
    pub row: Vec<Weight>,
}

/// The weights with which one stage's acceleration is added to a position (times h²) and to a velocity
/// (times h).
pub(crate) struct Weight {
    pub stage: usize,
    pub position: f64,
    pub velocity: f64,
}

/// All stages of a tableau.
pub(crate) fn stages(tableau: &Tableau) -> Vec<NystromStage> {
    let rows = tableau.a.iter().zip(tableau.c);
    rows.map(|(row, &node)| NystromStage {
        node,
        row: weights(tableau, row),
    })
    .collect()
}

/// A combination of stage slopes as weights of stage accelerations, without those that are 0.
pub(crate) fn weights(tableau: &Tableau, row: &[f64]) -> Vec<Weight> {
    let through = |at: usize| -> f64 {
        let slopes = row.iter().zip(tableau.a);
        slopes.map(|(w, a)| w * a.get(at).unwrap_or(&0.0)).sum()
    };
    let all = (0..tableau.b.len()).map(|stage| Weight {
        stage,
        position: through(stage),
        velocity: row.get(stage).copied().unwrap_or(0.0),
    });
    all.filter(|w| w.position != 0.0 || w.velocity != 0.0)
        .collect()
}

/// The weighted sums of accelerations, for positions and for velocities, at the `LANES` coordinates from
/// `start` on. Accelerations are padded to a multiple of `LANES`.
#[inline(always)]
pub(crate) fn sums(
    accelerations: &[Vec<f64>],
    weights: &[Weight],
    start: usize,
) -> ([f64; LANES], [f64; LANES]) {
    let (mut dx, mut dv) = ([0.0; LANES], [0.0; LANES]);
    for weight in weights {
        let a = &accelerations[weight.stage][start..start + LANES];
        for (lane, a) in a.iter().enumerate() {
            dx[lane] += weight.position * a;
            dv[lane] += weight.velocity * a;
        }
    }
    (dx, dv)
}
