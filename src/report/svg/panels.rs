//! One panel per timestep, so that lines of one colour never mix.

use crate::outcome::{Curves, Kind, Outcome, Report};
use crate::report::notes::several_timesteps;
use crate::report::words;

/// More panels than this are not drawn; the table has them all.
const PANELS: usize = 6;
/// Points a whole figure may have: it stays below 300 kB.
const POINTS: usize = 20_000;

/// The runs one panel shows.
pub struct Panel<'a> {
    /// Such as `h = 0.05 s`; empty where the report has one timestep only.
    pub title: String,
    pub runs: Vec<(&'a Outcome, &'a Curves)>,
}

/// The recorded runs by timestep, in the order they first occur. A run at a timestep no
/// hand-written integrator has joins the first panel.
pub fn panels(report: &Report) -> Vec<Panel<'_>> {
    let runs: Vec<(&Outcome, &Curves)> = report
        .figures
        .curves
        .iter()
        .filter_map(|curves| Some((report.outcomes.get(curves.outcome)?, curves)))
        .collect();
    let mut timesteps: Vec<f64> = Vec::new();
    let all_rapier = runs.iter().all(|(o, _)| o.kind == Kind::Rapier);
    for (outcome, _) in &runs {
        let counts = all_rapier || outcome.kind != Kind::Rapier;
        if counts && !timesteps.contains(&outcome.timestep) {
            timesteps.push(outcome.timestep);
        }
    }
    let titled = several_timesteps(report);
    let panel = |(i, &h): (usize, &f64)| Panel {
        title: if titled {
            format!("h = {} s", words::short(h))
        } else {
            String::new()
        },
        runs: runs
            .iter()
            .filter(|(o, _)| o.timestep == h || (i == 0 && !timesteps.contains(&o.timestep)))
            .copied()
            .collect(),
    };
    timesteps
        .iter()
        .enumerate()
        .take(PANELS)
        .map(panel)
        .collect()
}

/// Points each of `lines` lines may have.
pub fn budget(lines: usize) -> usize {
    (POINTS / lines.max(1)).clamp(16, 1_000)
}
