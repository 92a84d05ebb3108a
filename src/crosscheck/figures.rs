//! The curves behind the plots.

use super::execute::Run;
use super::plan::Plan;
use crate::engines::Ended;
use crate::measure::EnergySeries;
use crate::outcome::{Curves, Figures, PlotAxis};
use crate::scene::Scene;
use crate::trajectory::Trajectory;

/// At most so many particles' paths are drawn.
const PATHS: usize = 8;

pub(super) fn figures(
    plan: &Plan,
    runs: &[Run],
    energies: &[Option<EnergySeries>],
    scale: Option<f64>,
) -> Figures {
    let scene = plan.scene;
    let plane = plane(scene, runs);
    let drawn = drawn(scene);
    let mut curves = Vec::new();
    for (outcome, (run, energy)) in runs.iter().zip(energies).enumerate() {
        let (Run::Ran(ran), Some(energy)) = (run, energy) else {
            continue;
        };
        let trajectory = &ran.trajectory;
        let instants = &energy.instants;
        curves.push(Curves {
            outcome,
            t: energy.t.clone(),
            energy: energy.error(scale.unwrap_or(1.0)),
            plot: scene.plot.as_ref().map_or_else(Vec::new, |plot| {
                let at = 3 * plot.particle + plot.dof;
                instants.iter().map(|&k| trajectory.x(k)[at]).collect()
            }),
            paths: drawn
                .iter()
                .map(|&particle| path(trajectory, particle, plane, instants))
                .collect(),
        });
    }
    Figures {
        curves,
        plot: scene.plot.as_ref().map(|plot| PlotAxis {
            label: format!(
                "particle {}, {} (m)",
                plot.particle,
                ["x", "y", "z"][plot.dof]
            ),
            y_range: plot.y_range,
        }),
        plane,
        fixed: scene
            .particles
            .iter()
            .filter(|p| p.fixed)
            .map(|p| plane.map(|axis| p.position[axis]))
            .collect(),
    }
}

fn path(run: &Trajectory, particle: usize, plane: [usize; 2], instants: &[usize]) -> Vec<[f64; 2]> {
    let point = |&k: &usize| plane.map(|axis| run.x(k)[3 * particle + axis]);
    instants.iter().map(point).collect()
}

/// Beside motion this much wider, an axis shows nothing.
const FLAT: f64 = 0.02;

/// The two coordinates that show the motion: `up` vertically where anything happens along it, and
/// the wider of the other two; without `up`, those two.
fn plane(scene: &Scene, runs: &[Run]) -> [usize; 2] {
    let extents = [0, 1, 2].map(|axis| extent(scene, runs, axis));
    let up = scene.up.index();
    let [first, second] = match up {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    };
    if extents[up] < FLAT * extents[first].min(extents[second]) {
        [first, second]
    } else if extents[second] > extents[first] {
        [second, up]
    } else {
        [first, up]
    }
}

/// How wide the scene's start and the first completed run are along an axis, m.
fn extent(scene: &Scene, runs: &[Run], axis: usize) -> f64 {
    let calm = runs.iter().find_map(|run| match run {
        Run::Ran(ran) if ran.ended == Ended::Completed => Some(&ran.trajectory),
        _ => None,
    });
    let start = scene.particles.iter().map(|p| p.position[axis]);
    let moved = calm.into_iter().flat_map(|run| {
        (0..run.len()).flat_map(move |k| run.x(k)[axis..].iter().step_by(3).copied())
    });
    let (lo, hi) = start
        .chain(moved)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
            (lo.min(x), hi.max(x))
        });
    hi - lo
}

/// Free particles, evenly chosen when there are many.
fn drawn(scene: &Scene) -> Vec<usize> {
    let free: Vec<usize> = (0..scene.particles.len())
        .filter(|&i| !scene.particles[i].fixed)
        .collect();
    let count = free.len().min(PATHS);
    (0..count).map(|k| free[k * free.len() / count]).collect()
}
