//! One cell of a stability map.

use super::limit::Make;
use super::passive::Single;
use super::probe::{Budget, Fate, Watch, probe};
use super::shake::Shake;
use crate::measure::energy_scale;
use crate::outcome::Cell;
use crate::scene::Scene;
use crate::system::ParticleSystem;

/// Rise of ln(energy) over the second half of a run that counts as growth.
const CLEAR: f64 = 0.1;
/// As for a run that counts as diverged.
const DIVERGED: f64 = 1e12;
/// Share of S.
const LOST: f64 = 0.5;

/// What becomes of the scene at step `h`, s, in at most `steps` steps: one run, slightly disturbed so
/// that motions a symmetry hides show, and shorter where it fails. Deterministic. Quicker and coarser
/// than [`measure`](super::measure): growth by less than a tenth over half the run is not seen.
/// `tick` is called with steps taken.
pub fn classify(
    scene: &Scene,
    make: &Make,
    h: f64,
    steps: u64,
    tick: &(dyn Fn(u64) + Sync),
) -> Cell {
    let system = ParticleSystem::new(scene);
    let scale = energy_scale(scene, &system, None).unwrap_or(1.0);
    let shaken = Shake::slight(&system, scale).apply(scene);
    let Ok(engine) = make(&shaken, h) else {
        return Cell::Failed;
    };
    let mut budget = Budget {
        left: u64::MAX,
        taken: 0,
        tick,
    };
    let watch = Watch {
        steps,
        extensions: 0,
        clear: CLEAR,
    };
    let mut run = Single::new(engine, system, &shaken, scale, DIVERGED);
    let before = run.balance();
    run.keep_from(0.75 * steps as f64 * h);
    let probed = probe(&mut run, watch, &mut budget);
    match probed.fate {
        Fate::Grows { lost: true, .. } => Cell::Failed,
        Fate::Grows { .. } => Cell::Growing,
        _ if run.kept() - before < -LOST * scale => Cell::Dissipating,
        _ => Cell::Stable,
    }
}
