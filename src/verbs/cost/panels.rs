//! The picture of a few steps: a coordinate over time, engine by engine, beside the truth.

use super::runs::{Curve, Setup};
use super::samples::Samples;
use super::settings::Sweep;
use crate::scene::Scene;
use crate::scene::object::called;
use crate::verbs::cost::{CostLine, CostPanel, CostPanels, CostPoint};

/// Points of the truth's curve.
const POINTS: u32 = 600;

pub fn panels(setup: &Setup, sweeps: &[Sweep], curves: &[Curve]) -> CostPanels {
    let [particle, axis] = shown(setup.scene, curves);
    let at = 3 * particle + axis;
    let panel = |(sweep, curve): (&Sweep, &Curve)| CostPanel {
        engine: sweep.solver.id.to_string(),
        lines: curve
            .points
            .iter()
            .zip(&curve.kept)
            .map(|(point, kept)| line(setup, point, kept, at))
            .collect(),
    };
    CostPanels {
        label: format!(
            "particle {}, {} (m)",
            called(&setup.scene.bodies, particle),
            ["x", "y", "z"][axis]
        ),
        truth: truth(setup, at),
        panels: sweeps.iter().zip(curves).map(panel).collect(),
    }
}

/// The coordinate the scene asks for, else the one that moves farthest: particle and axis.
fn shown(scene: &Scene, curves: &[Curve]) -> [usize; 2] {
    if let Some(plot) = &scene.plot {
        return [plot.particle, plot.dof];
    }
    let finest = curves.iter().filter_map(|curve| curve.kept.last());
    let mut best = ([0, 0], -1.0);
    for kept in finest {
        for at in 0..kept.states.dim {
            let values = (0..kept.t.len()).map(|k| kept.states.x(k)[at]);
            let [low, high] = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            });
            if high - low > best.1 {
                best = ([at / 3, at % 3], high - low);
            }
        }
    }
    best.0
}

fn line(setup: &Setup, point: &CostPoint, kept: &Samples, at: usize) -> CostLine {
    let finite = |p: &[f64; 2]| p.iter().all(|c| c.is_finite());
    let curve = (0..kept.t.len()).map(|k| [kept.t[k], kept.states.x(k)[at]]);
    let difference = setup.truth_beside(kept).map(|(times, states)| {
        let off = |k: usize| [times[k], kept.states.x(k + 1)[at] - states.x(k)[at]];
        (0..times.len()).map(off).filter(finite).collect()
    });
    CostLine {
        timestep: point.timestep,
        status: point.status,
        curve: curve.filter(finite).collect(),
        difference: difference.unwrap_or_default(),
    }
}

fn truth(setup: &Setup, at: usize) -> Vec<[f64; 2]> {
    let Some(motion) = setup.truth.motion() else {
        return Vec::new();
    };
    let until = setup.truth.horizon;
    let part = |k: u32| until * f64::from(k) / f64::from(POINTS);
    let times: Vec<f64> = (0..=POINTS).map(part).collect();
    let states = motion.states(&times);
    let points = times.iter().enumerate().map(|(k, t)| [*t, states.x(k)[at]]);
    points.filter(|p| p.iter().all(|c| c.is_finite())).collect()
}
