//! The curves behind the plots.

use super::execute::Run;
use super::plan::Plan;
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
    let plane = plane(scene);
    let drawn = drawn(scene);
    let mut curves = Vec::new();
    for (outcome, (run, energy)) in runs.iter().zip(energies).enumerate() {
        let (Run::Ran { trajectory, .. }, Some(energy)) = (run, energy) else {
            continue;
        };
        // Both skip what is not finite, so the shorter of the two is what both have.
        let len = energy.t.len().min(trajectory.len());
        curves.push(Curves {
            outcome,
            t: energy.t[..len].to_vec(),
            energy: energy.error(scale.unwrap_or(1.0))[..len].to_vec(),
            plot: scene.plot.as_ref().map_or_else(Vec::new, |plot| {
                let at = 3 * plot.particle + plot.dof;
                (0..len).map(|k| trajectory.x(k)[at]).collect()
            }),
            paths: drawn
                .iter()
                .map(|&particle| path(trajectory, particle, plane, len))
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

fn path(run: &Trajectory, particle: usize, plane: [usize; 2], len: usize) -> Vec<[f64; 2]> {
    let point = |k| plane.map(|axis| run.x(k)[3 * particle + axis]);
    (0..len).map(point).collect()
}

/// `up` vertically; horizontally the wider of the other two axes, in positions and velocities.
fn plane(scene: &Scene) -> [usize; 2] {
    let up = scene.up.index();
    let extent = |axis: usize| {
        let along = scene.particles.iter().map(|p| p.position[axis]);
        let (lo, hi) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
            (lo.min(x), hi.max(x))
        });
        let speed = scene.particles.iter().map(|p| p.velocity[axis].abs());
        (hi - lo) + speed.fold(0.0, f64::max) * scene.duration
    };
    let others: Vec<usize> = (0..3).filter(|&axis| axis != up).collect();
    let wider = if extent(others[1]) > extent(others[0]) {
        others[1]
    } else {
        others[0]
    };
    [wider, up]
}

/// Free particles, evenly chosen when there are many.
fn drawn(scene: &Scene) -> Vec<usize> {
    let free: Vec<usize> = (0..scene.particles.len())
        .filter(|&i| !scene.particles[i].fixed)
        .collect();
    let count = free.len().min(PATHS);
    (0..count).map(|k| free[k * free.len() / count]).collect()
}
