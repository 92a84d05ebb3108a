//! Reports made to break a renderer.

use super::samples::{Reach, oscillator, outcome};
use crate::verbs::tests::data::*;

const NASTY: &str =
    "a|b<c>&\"d\" `e` *f* _g_ [h](i)\n#j \u{1b}[31mred\u{1b}[0m \u{e0102}\u{202e} 漢字漢字 ";

/// Long and hostile names, missing numbers, huge and constant curves.
pub fn hostile() -> Report {
    let mut report = oscillator(&[0.01, 0.15], 40.0, 7);
    let long = NASTY.repeat(6);
    report.header.scene.name = long.clone();
    report.header.scene.file = long.clone();
    report.header.scene.description = Some(long.repeat(3) + &"x".repeat(300));
    report.header.scene.energy_scale_j = None;
    report.header.scene.own_integrator = long.clone();
    report.header.truth.reason = Some(long.clone());
    report.outcomes_mut()[0].engine = long.clone();
    report.outcomes_mut()[0].position_error_m = Some(ErrorSummary {
        last: 0.0,
        max: 1e-17,
        rms: 0.0,
    });
    report.header.truth.error_bound_m = Some(1e-15);
    report.outcomes_mut()[1].remarks = (0..40).map(|i| format!("{i} {long}")).collect();
    report.outcomes_mut()[2].deviation_m.clear();
    report.outcomes_mut()[3].work = WorkSummary {
        steps: u64::MAX,
        force_evaluations: Some(u64::MAX),
        linear_solves: None,
        world: None,
        wall_s: None,
    };
    let mut unsupported = outcome(&long, SolverKind::Rapier, f64::MIN_POSITIVE);
    unsupported.status = Status::Unsupported;
    unsupported.reason = Some(long.clone());
    report.outcomes_mut().push(unsupported);
    for (i, values) in [
        [f64::MAX, -f64::MAX],
        [0.0, 0.0],
        [1e-320, -1e-320],
        [1.0, 1.0],
    ]
    .into_iter()
    .enumerate()
    {
        report
            .outcomes_mut()
            .push(outcome(&format!("odd{i}"), SolverKind::External, 0.01));
        let outcome = report.outcomes().len() - 1;
        report.series_mut().curves.push(Curves {
            rods: Vec::new(),
            outcome,
            t: vec![0.0, f64::MAX],
            energy: values.into(),
            errors: values.into(),
            plot: values.into(),
            paths: vec![vec![values, values], vec![values], vec![]],
            phase: vec![values, values],
        });
    }
    report.series_mut().curves.push(Curves {
        rods: Vec::new(),
        outcome: 9_999,
        t: vec![],
        energy: vec![],
        errors: vec![],
        plot: vec![],
        paths: vec![],
        phase: vec![],
    });
    // Errors of instants that are not there.
    let mut errors_alone = report.series_mut().curves[0].clone();
    errors_alone.t.clear();
    report.series_mut().curves.push(errors_alone);
    report.series_mut().plane = [7, 2];
    report.series_mut().plot = Some(PlotAxis {
        label: long.clone(),
        y_range: Some([1.0, 1.0]),
    });
    report.header.checks.push(Check {
        id: long.clone(),
        subject: long.clone(),
        status: CheckStatus::Fail,
        measured: Some(2.0),
        bound: Some(1.0),
        derivation: long.clone(),
        message: long,
        ..Check::default()
    });
    report
}

/// Nothing ran, and every number and name is as wide as it gets.
pub fn extreme() -> Report {
    let mut report = oscillator(&[0.01, 0.05], 1.0, 3);
    for outcome in report.outcomes_mut() {
        let least = Deviation {
            last: 1e-300,
            max: 1e-300,
            first_exceeds_s: None,
        };
        outcome.deviation_m = ["dt=0.001,iterations=1234,pgs=56", "another very long name"]
            .map(|name| (name.to_string(), least.clone()))
            .into();
        outcome.status = Status::Unsupported;
        outcome.position_error_m = Some(ErrorSummary {
            last: 1e-300,
            max: 1e-300,
            rms: 1e-300,
        });
    }
    report.header.scene.particles = usize::MAX;
    report.header.scene.springs = usize::MAX;
    report.header.scene.timestep = f64::MIN_POSITIVE;
    report.header.scene.duration = 1.234567e-300;
    report.header.scene.own_integrator = "symplectic_euler_drift_first".into();
    report
}
