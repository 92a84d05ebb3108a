//! The table of outcomes, in the terminal and in Markdown.

use super::{references, several_timesteps};
use crate::measure::EnergyClass;
use crate::report::table::{Mark, Table};
use crate::report::terminal::fit::{clip, pad};
use crate::report::terminal::paint::Tone;
use crate::report::words::escape;
use crate::report::words::{self, NOTHING};
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::Outcome;
use crate::verbs::run::text::naming;

/// The terminal's lines and their legend.
pub fn lines(report: &Report) -> Vec<String> {
    let wide = table(report, ' ');
    let table = if wide.fits() {
        wide
    } else {
        table(report, '\n')
    };
    table.in_terminal(", ", |_| legend(report))
}

pub fn markdown(report: &Report) -> String {
    table(report, ' ').in_markdown()
}

/// `fold` stands between the parts of a header that may go on two lines.
fn table(report: &Report, fold: char) -> Table<'_, Outcome> {
    let outcomes = report.outcomes();
    let mut table = Table::new(outcomes);
    let own = &report.header.scene.own_integrator;
    table.engines(|o| (naming::engine(o), Mark::of(&o.engine, own)));
    if several_timesteps(report) {
        table.right("h (s)", "h (s)", 0, |o| words::short(o.timestep));
    }
    table.left("status", "status", status);
    let classes = class_width(outcomes);
    table.left("energy", "", |o| energy(o, classes));
    table.markdown("energy", |o| {
        let class = o.energy.as_ref().and_then(|e| e.class);
        class.map_or(NOTHING, words::class).into()
    });
    table.markdown("energy error", |o| {
        let error = o.energy.as_ref().map(words::energy_error);
        let error = error.filter(|text| !text.is_empty());
        error.unwrap_or(NOTHING.into())
    });
    for (rank, reference) in references(report).into_iter().enumerate() {
        let name = clip(&words::one_line(reference), 14);
        let header = match fold {
            '\n' => format!("m from\n{}", name.replace('-', "-\n")),
            _ => format!("m from\n{name}"),
        };
        let long = format!("deviation from {} (m)", escape(reference));
        table.right(&header, &long, rank as u8, |o| deviation(o, reference));
    }
    if outcomes.iter().any(|o| o.position_error_m.is_some()) {
        table.right("m from\ntruth", "error (m)", 0, |o| error(report, o));
    }
    table.markdown("steps", |o| words::count(o.work.steps));
    table.right("force\nevals", "force evaluations", 2, |o| {
        let evaluations = o.work.force_evaluations;
        evaluations.map_or(NOTHING.into(), words::count)
    });
    // A trajectory from a file has neither.
    table.right("time", "time", 0, naming::wall_time);
    table
}

fn status(outcome: &Outcome) -> (String, Option<Tone>) {
    let tone = match outcome.status {
        Status::Completed => None,
        Status::Diverged | Status::Failed => Some(Tone::Bad),
        Status::Unsupported => Some(Tone::Dim),
    };
    (words::status(outcome.status).into(), tone)
}

/// Columns of the longest class word, so that the numbers line up.
fn class_width(outcomes: &[Outcome]) -> usize {
    let classes = outcomes.iter().filter_map(|o| o.energy.as_ref()?.class);
    classes.map(|c| words::class(c).len()).max().unwrap_or(0)
}

fn energy(outcome: &Outcome, classes: usize) -> (String, Option<Tone>) {
    let Some(energy) = &outcome.energy else {
        return (NOTHING.into(), None);
    };
    let number = words::energy_error(energy);
    let Some(class) = energy.class else {
        let number = if number.is_empty() { NOTHING } else { &number };
        return (number.into(), None);
    };
    let tone = match class {
        EnergyClass::Bounded => Tone::Good,
        EnergyClass::Drifting => Tone::Warn,
        EnergyClass::Growing => Tone::Bad,
        EnergyClass::Dissipating => Tone::Cool,
    };
    let text = format!("{} {number}", pad(words::class(class), classes));
    (text.trim_end().into(), Some(tone))
}

fn deviation(outcome: &Outcome, reference: &str) -> String {
    match outcome.deviation_m.get(reference) {
        Some(deviation) if outcome.engine != reference => words::sci(deviation.max),
        _ => NOTHING.into(),
    }
}

fn error(report: &Report, outcome: &Outcome) -> String {
    let error = outcome.position_error_m.as_ref();
    error.map_or(NOTHING.into(), |e| {
        words::truth_error(e.max, &report.header.truth)
    })
}

fn legend(report: &Report) -> String {
    let scale = match report.header.scene.energy_scale_j {
        Some(scale) => format!("over S = {} J", words::short(scale)),
        None => "(this scene has no scale)".into(),
    };
    let mut text = format!("▸ own integrator | energy: largest error {scale}");
    if report.outcomes().iter().any(|o| !o.deviation_m.is_empty()) {
        text += " | m from: largest distance of a particle";
    }
    let at_floor = |o: &Outcome| error(report, o) == "floor";
    if report.outcomes().iter().any(at_floor) {
        text += " | floor: below ten times the truth's own error";
    }
    text
}
