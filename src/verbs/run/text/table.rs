//! The table of outcomes, in the terminal and in Markdown.

use crate::measure::Behaviour;
use crate::report::table::Table;
use crate::report::terminal::{Tone, clip, pad};
use crate::report::words::{self, NOTHING, escape};
use crate::solvers::Status;
use crate::verbs::Report;
use crate::verbs::run::Outcome;

/// The terminal's lines and their legend.
pub fn lines(report: &Report, columns: usize) -> Vec<String> {
    let wide = table(report, ' ');
    let table = if wide.fits(columns) {
        wide
    } else {
        table(report, '\n')
    };
    table.in_terminal(columns, ", ", |_| legend(report))
}

pub fn markdown(report: &Report) -> String {
    table(report, ' ').in_markdown()
}

/// The table of outcomes. `fold` separates the parts of a header that may take two lines.
fn table(report: &Report, fold: char) -> Table<'_, Outcome> {
    let outcomes = report.outcomes();
    let mut table = Table::new(outcomes);
    let header = &report.header;
    table.engines(|o| (engine(o), header.mark(&o.engine)));
    if several_timesteps(report) {
        table.right("h (s)", "h (s)", 0, |o| words::short(o.timestep));
    }
    table.left("status", "status", status);
    let words = word_width(outcomes);
    table.left("energy", "", |o| energy(o, words));
    table.markdown("energy", |o| behaviour(o).map(|b| b.word().to_owned()));
    table.markdown("energy error", |o| words::energy_error(o.energy.as_ref()?));
    let judged = outcomes.iter().any(|o| o.position_error_m.is_some());
    for (rank, reference) in references(report).into_iter().enumerate() {
        let name = clip(&words::one_line(reference), 14);
        let header = match fold {
            '\n' => format!("m from\n{}", name.replace('-', "-\n")),
            _ => format!("m from\n{name}"),
        };
        let long = format!("deviation from {} (m)", escape(reference));
        // Where the truth is known, distance from another engine says less.
        let drop_order = rank as u8 + u8::from(judged);
        table.right(&header, &long, drop_order, |o| deviation(o, reference));
    }
    if judged {
        table.right("m from\ntruth", "error (m)", 0, |o| error(report, o));
    }
    if outcomes.iter().any(|o| o.rods.is_some()) {
        let header = "m off\nrods";
        table.right(header, "rods off by (m)", 2, super::rods::length_error);
    }
    table.markdown("steps", |o| words::count(o.work.steps));
    table.right("force\nevals", "force evaluations", 3, |o| {
        o.work.force_evaluations.map(words::count)
    });
    // A trajectory from a file has neither evaluations nor a time.
    table.toned("time", 0, |o| {
        let time = wall_time(o).map_or(NOTHING.into(), |(time, spread)| {
            // As wide as the widest spread, so that the layout is the same however times vary.
            format!("{time:>7} {spread:<4}")
        });
        (time, None)
    });
    table.markdown("time", |o| {
        let (time, spread) = wall_time(o)?;
        Some(format!("{time} {spread}").trim_end().to_owned())
    });
    table
}

fn status(outcome: &Outcome) -> (String, Option<Tone>) {
    let tone = match outcome.status {
        Status::Completed => None,
        Status::Diverged | Status::Failed => Some(Tone::Bad),
        Status::Unsupported => Some(Tone::Dim),
    };
    (words::id(outcome.status), tone)
}

fn behaviour(outcome: &Outcome) -> Option<Behaviour> {
    outcome.energy.as_ref()?.behaviour()
}

/// The width of the longest word, so that the numbers line up.
fn word_width(outcomes: &[Outcome]) -> usize {
    let behaviours = outcomes.iter().filter_map(behaviour);
    behaviours.map(|b| b.word().len()).max().unwrap_or(0)
}

fn energy(outcome: &Outcome, words: usize) -> (String, Option<Tone>) {
    let number = outcome.energy.as_ref().and_then(words::energy_error);
    let Some(behaviour) = behaviour(outcome) else {
        return (number.unwrap_or(NOTHING.into()), None);
    };
    let tone = match behaviour {
        Behaviour::Steady | Behaviour::Bounded => Tone::Good,
        Behaviour::FewSamples => Tone::Dim,
        Behaviour::Drifting => Tone::Warn,
        Behaviour::Growing | Behaviour::Unsteady => Tone::Bad,
        Behaviour::Dissipating => Tone::Cool,
    };
    let word = pad(behaviour.word(), words);
    let text = format!("{word} {}", number.unwrap_or_default());
    (text.trim_end().into(), Some(tone))
}

fn deviation(outcome: &Outcome, reference: &str) -> Option<String> {
    let deviation = outcome.deviation_m.get(reference)?;
    (outcome.engine != reference).then(|| words::sci(deviation.max))
}

fn error(report: &Report, outcome: &Outcome) -> Option<String> {
    let error = outcome.position_error_m.as_ref()?.max;
    Some(words::truth_error(error, &report.header.truth))
}

fn legend(report: &Report) -> String {
    let scale = match report.header.scene.energy_scale_j {
        Some(scale) => format!(
            "in units of the scene's energy S = {} J",
            words::short(scale)
        ),
        None => "(this scene has no scale)".into(),
    };
    let mut own = report.outcomes().iter();
    let own = own.any(|o| report.header.is_own(&o.engine));
    let own = if own { "▸ own integrator | " } else { "" };
    let mut text = format!("{own}energy: largest error {scale}");
    for (one, meaning) in [
        (Behaviour::Steady, "off by less than a millionth of S"),
        (Behaviour::Unsteady, "off by more than S, without a trend"),
        (Behaviour::FewSamples, "too few to show a trend"),
    ] {
        if report.outcomes().iter().any(|o| behaviour(o) == Some(one)) {
            text += &format!(" | {}: {meaning}", one.word());
        }
    }
    if report.outcomes().iter().any(|o| !o.deviation_m.is_empty()) {
        text += " | m from: largest distance of a particle";
    }
    let at_floor = |o: &Outcome| error(report, o).is_some_and(|error| error == "floor");
    if report.outcomes().iter().any(at_floor) {
        text += " | floor: below ten times the truth's own error";
    }
    text
}

/// A table in Markdown of what outcomes have besides: it begins with engines, and timesteps where there are several.
pub(super) fn beside<'r, T>(
    report: &Report,
    rows: &'r [(&Outcome, &T)],
) -> Table<'r, (&'r Outcome, &'r T)> {
    let mut table = Table::new(rows);
    table.engines(|(o, _)| (engine(o), report.header.mark(&o.engine)));
    if several_timesteps(report) {
        table.markdown("h (s)", |(o, _)| words::short(o.timestep));
    }
    table
}

/// Whether the outcomes have different timesteps, so that the table states them.
pub fn several_timesteps(report: &Report) -> bool {
    let mut timesteps = report.outcomes().iter().map(|o| o.timestep);
    let first = timesteps.next();
    timesteps.any(|h| Some(h) != first)
}

/// The engines that deviations are stated against, rapier's own first, at most two.
fn references(report: &Report) -> Vec<&str> {
    let mut found: Vec<&str> = Vec::new();
    let named = ["rapier", "rapier-forces"];
    let keys = || report.outcomes().iter().flat_map(|o| o.deviation_m.keys());
    for name in named.into_iter().chain(keys().map(String::as_str)) {
        if keys().any(|key| key == name) && !found.contains(&name) {
            found.push(name);
        }
    }
    found.truncate(2);
    found
}

/// The median time, and its spread where that exceeds a tenth: `12.3 ms` and `±14%`. A run that did not
/// finish has no time to compare.
fn wall_time(outcome: &Outcome) -> Option<(String, String)> {
    let wall = outcome.work.wall_s.as_ref();
    let wall = wall.filter(|_| outcome.status == Status::Completed)?;
    let mad = wall.mad.filter(|mad| *mad > 0.1 * wall.median);
    let spread = mad.map(|mad| match 100.0 * mad / wall.median {
        percent if percent < 99.5 => format!("±{percent:.0}%"),
        _ => ">99%".to_owned(),
    });
    Some((words::seconds(wall.median), spread.unwrap_or_default()))
}

/// The engine's name, with rapier's substeps where it takes any: `rapier, dt/4`.
pub fn engine(outcome: &Outcome) -> String {
    let ratio = outcome.timestep / outcome.substep;
    if ratio.is_finite() && ratio > 1.5 && ratio < 1e6 {
        return format!("{}, dt/{ratio:.0}", outcome.engine);
    }
    outcome.engine.clone()
}
