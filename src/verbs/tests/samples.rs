//! Reports to render, with real motion in them.

use super::motion::{Run, SCHEMES, implicit, motion, symplectic};
use crate::verbs::tests::data::*;
use std::collections::BTreeMap;

/// The oscillator under the first `engines` schemes at every timestep.
pub fn oscillator(timesteps: &[f64], duration: f64, engines: usize) -> Report {
    let mut report = empty("circle");
    report.header.scene.timestep = timesteps[0];
    report.header.scene.duration = duration;
    report.series_mut().plot = Some(PlotAxis {
        label: "particle 1, x (m)".into(),
        y_range: None,
    });
    for &h in timesteps {
        let rapier = motion(h, duration, 4.0, implicit);
        let forces = motion(h, duration, 1.0, symplectic);
        for (name, kind, substeps, step) in SCHEMES.into_iter().take(engines) {
            let run = motion(h, duration, substeps, step);
            let mut outcome = outcome(name, kind, h);
            outcome.substep = h / substeps;
            outcome.energy = Some(judged(&run));
            outcome.deviation_m = [("rapier", &rapier), ("rapier-forces", &forces)]
                .map(|(name, other)| (name.to_string(), deviation(&run, other)))
                .into();
            outcome.deviation_m.remove(name);
            outcome.work.steps = run.t.len() as u64 - 1;
            let joints = name == "rapier";
            outcome.work.force_evaluations = (!joints).then_some(outcome.work.steps);
            if run.diverged {
                outcome.status = Status::Diverged;
                outcome.stopped_at_s = run.t.last().copied();
                outcome.reason =
                    Some("kinetic and elastic energy passed 1e12 times the scale".into());
            }
            let at = report.outcomes().len();
            report.series_mut().curves.push(Curves {
                rods: Vec::new(),
                outcome: at,
                plot: run.path.iter().map(|p| p[0]).collect(),
                t: run.t,
                energy: run.energy,
                errors: Vec::new(),
                phase: Vec::new(),
                paths: vec![run.path],
            });
            report.outcomes_mut().push(outcome);
        }
    }
    for outcome in report
        .outcomes_mut()
        .iter_mut()
        .filter(|o| o.engine == "rapier")
    {
        outcome.remarks.push(
            "its spring joint is linearly implicit Euler at h = dt/4 and dissipates by design; \
             symplectic_euler does not."
                .into(),
        );
    }
    report
}

fn judged(run: &Run) -> Energy {
    let largest = run.energy.iter().fold(0.0, |a: f64, e| a.max(e.abs()));
    let last = run.energy.last().copied().unwrap_or(0.0);
    let class = match last {
        _ if largest < 0.5 => EnergyClass::Bounded,
        l if l > 0.9 => EnergyClass::Growing,
        l if l < -0.4 => EnergyClass::Dissipating,
        _ => EnergyClass::Drifting,
    };
    Energy {
        initial_j: Some(10.75),
        final_j: Some(10.75 * (1.0 + last)),
        relative_error_max: Some(largest),
        drift_per_s: Some(last),
        drift_per_s_ci: Some([last, last]),
        fluctuation: Some(1e-3),
        class: Some(class),
        samples: Some(run.energy.len()),
        kinetic_final_j: Some(1.0),
        potential_final_j: BTreeMap::from([("springs".to_owned(), 3.0)]),
        dissipated_j: Some(0.0),
        projected_j: None,
        limited_j: None,
        impacts_j: None,
        friction_j: None,
        injected_j: Some(0.0),
    }
}

fn deviation(a: &Run, b: &Run) -> Deviation {
    let distances: Vec<f64> = a
        .path
        .iter()
        .zip(&b.path)
        .map(|(a, b)| f64::hypot(a[0] - b[0], a[1] - b[1]))
        .collect();
    Deviation {
        last: distances.last().copied().unwrap_or(0.0),
        max: distances.iter().copied().fold(0.0, f64::max),
        first_exceeds_s: None,
    }
}

/// Motion along a vertical line, a range for the plot, and no particle that never moves.
pub fn upright() -> Report {
    let mut report = oscillator(&[0.02], 5.0, 8);
    for curves in &mut report.series_mut().curves {
        let path = curves.plot.iter().map(|x| [0.0, 2.0 + x]).collect();
        curves.paths = vec![path];
    }
    report.series_mut().fixed.clear();
    report.series_mut().plot.as_mut().unwrap().y_range = Some([-0.3, 0.6]);
    report
}

/// More engines than colours, several paths each.
pub fn crowd() -> Report {
    let mut report = oscillator(&[0.02], 5.0, 8);
    for round in 1..3 {
        for i in 0..8 {
            let mut outcome = report.outcomes()[i].clone();
            outcome.engine += &format!("_{round}");
            let mut curves = report.run_series().curves[i].clone();
            curves.outcome = report.outcomes().len();
            let shift = 1.2 * f64::from(round);
            let moved = |[x, z]: &[f64; 2]| [x + shift, *z];
            curves
                .paths
                .push(curves.paths[0].iter().map(moved).collect());
            report.outcomes_mut().push(outcome);
            report.series_mut().curves.push(curves);
        }
    }
    report
}

/// An outcome with nothing measured.
pub fn outcome(engine: &str, kind: SolverKind, timestep: f64) -> Outcome {
    Outcome {
        engine: engine.into(),
        kind,
        timestep,
        substep: timestep,
        status: Status::Completed,
        stopped_at_s: None,
        reason: None,
        position_error_m: None,
        velocity_error_m_s: None,
        deviation_m: BTreeMap::new(),
        energy: None,
        momentum: None,
        contact: None,
        strain: None,
        loads: None,
        rods: None,
        work: WorkSummary {
            steps: 100,
            force_evaluations: Some(100),
            linear_solves: Some(0),
            world: None,
            wall_s: Some(WallTime {
                min: 1.1e-3,
                median: 1.234e-3,
                mad: Some(2.0e-4),
            }),
        },
        identified: None,
        explained: None,
        remarks: Vec::new(),
    }
}

/// A report with facts, checks and no outcome.
pub fn empty(name: &str) -> Report {
    Report {
        header: Header {
            scene: SceneFacts {
                objects: Vec::new(),
                name: name.into(),
                file: format!("scenes/oscillator/{name}.yml"),
                particles: 2,
                springs: 1,
                rods: 0,
                effects: vec![EffectUse {
                    id: "springs".into(),
                    members: 1,
                    evaluations: 70_000,
                    wall_ns: Some(11.4),
                }],
                timestep: 0.01,
                duration: 5.0,
                energy_scale_j: Some(10.75),
                description: Some(
                    "A spring of rest length 0, started sideways: the truth is an ellipse.".into(),
                ),
                own_integrator: "symplectic_euler".into(),
            },
            truth: TruthFacts {
                kind: TruthKind::None,
                method: None,
                error_bound_m: None,
                horizon_s: None,
                reason: Some("not asked for".into()),
            },
            checks: vec![
                twin("twin_forces", CheckStatus::Pass),
                twin("twin_converged", CheckStatus::Pass),
            ],
            advice: Vec::new(),
        },
        body: Body::Run {
            outcomes: Vec::new(),
        },
        series: SeriesState::Loaded(Series::Curves(RunSeries {
            plane: [0, 2],
            fixed: vec![[0.0, 0.0]],
            ..RunSeries::default()
        })),
    }
}

/// Into the parts of a report that its verb has.
pub trait Reach {
    fn outcomes_mut(&mut self) -> &mut Vec<Outcome>;
    fn stability_mut(&mut self) -> &mut Stability;
    fn cost_mut(&mut self) -> &mut Cost;
    fn series_mut(&mut self) -> &mut RunSeries;
    fn panels_mut(&mut self) -> &mut CostPanels;
}

impl Reach for Report {
    fn outcomes_mut(&mut self) -> &mut Vec<Outcome> {
        match &mut self.body {
            Body::Run { outcomes } | Body::Compare { outcomes, .. } => outcomes,
            _ => panic!("no outcomes"),
        }
    }

    fn stability_mut(&mut self) -> &mut Stability {
        match &mut self.body {
            Body::Stability { stability, .. } => stability,
            _ => panic!("no stability"),
        }
    }

    fn cost_mut(&mut self) -> &mut Cost {
        match &mut self.body {
            Body::Cost { cost, .. } => cost,
            _ => panic!("no cost"),
        }
    }

    fn series_mut(&mut self) -> &mut RunSeries {
        match &mut self.series {
            SeriesState::Loaded(Series::Curves(series)) => series,
            _ => panic!("no figures"),
        }
    }

    fn panels_mut(&mut self) -> &mut CostPanels {
        match &mut self.series {
            SeriesState::Loaded(Series::Panels(panels)) => panels,
            _ => panic!("no panels"),
        }
    }
}

pub fn twin(id: &str, status: CheckStatus) -> Check {
    Check {
        id: id.into(),
        subject: "rapier-forces = symplectic_euler, 20 steps".into(),
        status,
        measured: Some(1.1e-16),
        bound: Some(3.0e-13),
        derivation: "16 eps per step and particle".into(),
        message: String::new(),
        ..Check::default()
    }
}
