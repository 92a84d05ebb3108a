//! The series from which figures are drawn.

use super::plan::Plan;
use super::playback::playback;
use super::record::Record;
use super::truths::Truths;
use crate::measure::{EnergySeries, TrueStates};
use crate::physics::System;
use crate::scene::Scene;
use crate::scene::object::called;
use crate::solvers::Status;
use crate::verbs::run::{Curves, PlotAxis, RunSeries, TruthCurves};
use crate::verbs::shape;

/// The number of particles whose paths are drawn, at most.
const MAX_PATHS: usize = 8;

pub fn series(
    plan: &Plan,
    records: &[Record],
    energies: &[Option<EnergySeries>],
    truths: &Truths,
    scale: Option<f64>,
) -> RunSeries {
    let scene = plan.scene;
    let extents = [0, 1, 2].map(|axis| extent(scene, records, axis));
    let plane = shape::plane(scene.up, extents);
    let drawn = drawn_particles(scene);
    let phase = portrayed(scene, extents, &drawn);
    let mut curves = Vec::new();
    for (outcome, (record, energy)) in records.iter().zip(energies).enumerate() {
        let Some(trajectory) = &record.trajectory else {
            continue;
        };
        let instants = match energy {
            Some(energy) => &energy.instants,
            // Without velocities there is no energy, but still motion to draw.
            None if !trajectory.has_velocities() => &(0..trajectory.len()).collect(),
            None => continue,
        };
        curves.push(Curves {
            outcome,
            t: instants.iter().map(|&k| trajectory.time(k)).collect(),
            energy: energy
                .as_ref()
                .map_or_else(Vec::new, |energy| energy.error(scale.unwrap_or(1.0))),
            errors: truths
                .at(plan.cases[outcome].label.timestep)
                .map_or_else(Vec::new, |known| {
                    let off = |&k: &usize| known.distance(trajectory, k).filter(|d| d.is_finite());
                    instants.iter().map_while(off).collect()
                }),
            rods: plan.system.rods().map_or_else(Vec::new, |rods| {
                let off = |&k: &usize| rods.residual(trajectory.x(k), &[]).position;
                instants.iter().map(off).collect()
            }),
            plot: plotted(scene, || instants.iter().map(|&k| trajectory.x(k))),
            paths: paths(&drawn, plane, || instants.iter().map(|&k| trajectory.x(k))),
            phase: phase.filter(|_| trajectory.has_velocities()).map_or_else(
                Vec::new,
                |[particle, axis]| {
                    let at = 3 * particle + axis;
                    let point = |&k: &usize| [trajectory.x(k)[at], trajectory.v(k)[at]];
                    instants.iter().map(point).collect()
                },
            ),
        });
    }
    let timesteps = plan.cases.iter().map(|case| case.label.timestep);
    let finest = timesteps.fold(f64::INFINITY, f64::min);
    RunSeries {
        curves,
        truth: truths
            .at(finest)
            .map(|known| Box::new(truth(scene, &drawn, plane, phase, known, finest))),
        plot: scene.plot.as_ref().map(|plot| PlotAxis {
            label: format!(
                "particle {}, {} (m)",
                called(&scene.bodies, plot.particle),
                ["x", "y", "z"][plot.dof]
            ),
            y_range: plot.y_range,
        }),
        plane,
        phase: phase.map(|[particle, axis]| {
            format!(
                "particle {}, {}",
                called(&scene.bodies, particle),
                ["x", "y", "z"][axis]
            )
        }),
        fixed: std::iter::zip(&scene.particles, scene.starts())
            .filter(|(p, _)| p.fixed)
            .map(|(_, start)| plane.map(|axis| start[axis]))
            .collect(),
        playback: plan
            .played
            .then(|| playback(plan, records, truths).map(Box::new))
            .flatten(),
    }
}

/// The particle and the coordinate of the phase portrait; None where nothing is free.
fn portrayed(scene: &Scene, extents: [f64; 3], drawn: &[usize]) -> Option<[usize; 2]> {
    if let Some(plot) = &scene.plot {
        return Some([plot.particle, plot.dof]);
    }
    let widest = (0..3).max_by(|a, b| extents[*a].total_cmp(&extents[*b]))?;
    Some([*drawn.first()?, widest])
}

fn truth(
    scene: &Scene,
    drawn: &[usize],
    plane: [usize; 2],
    phase: Option<[usize; 2]>,
    known: &TrueStates,
    timestep: f64,
) -> TruthCurves {
    let states = || (0..known.steps.len()).map(|k| known.states.x(k));
    TruthCurves {
        t: known.steps.iter().map(|s| *s as f64 * timestep).collect(),
        plot: plotted(scene, states),
        paths: paths(drawn, plane, states),
        phase: phase.map_or_else(Vec::new, |[particle, axis]| {
            let at = 3 * particle + axis;
            let point = |k| [known.states.x(k)[at], known.states.v(k)[at]];
            (0..known.steps.len()).map(point).collect()
        }),
    }
}

/// The coordinate that the scene's `plot` names, m; empty without one.
fn plotted<'a, I: Iterator<Item = &'a [f64]>>(scene: &Scene, states: impl Fn() -> I) -> Vec<f64> {
    scene.plot.as_ref().map_or_else(Vec::new, |plot| {
        let at = 3 * plot.particle + plot.dof;
        states().map(|x| x[at]).collect()
    })
}

/// One polyline for each of these particles.
fn paths<'a, I: Iterator<Item = &'a [f64]>>(
    particles: &[usize],
    plane: [usize; 2],
    states: impl Fn() -> I,
) -> Vec<Vec<[f64; 2]>> {
    let path = |&particle: &usize| {
        let point = |x: &[f64]| plane.map(|axis| x[3 * particle + axis]);
        states().map(point).collect()
    };
    particles.iter().map(path).collect()
}

/// The extent of the scene's start and the first completed run along an axis, m.
fn extent(scene: &Scene, records: &[Record], axis: usize) -> f64 {
    let completed = |record: &&Record| record.status == Status::Completed;
    let first = records.iter().find(completed);
    let first = first.and_then(|record| record.trajectory.as_ref());
    let start = scene.starts().into_iter().map(|start| start[axis]);
    let moved = first.into_iter().flat_map(|run| {
        (0..run.len()).flat_map(move |k| run.x(k)[axis..].iter().step_by(3).copied())
    });
    let (lo, hi) = start
        .chain(moved)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| {
            (lo.min(x), hi.max(x))
        });
    hi - lo
}

/// The particles whose paths are drawn: the free ones, evenly chosen when there are many.
fn drawn_particles(scene: &Scene) -> Vec<usize> {
    let free: Vec<usize> = (0..scene.particles.len())
        .filter(|&i| !scene.particles[i].fixed)
        .collect();
    let count = free.len().min(MAX_PATHS);
    (0..count).map(|k| free[k * free.len() / count]).collect()
}
