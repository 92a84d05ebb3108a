//! The report as GitHub shows it.

mod ledger;

use super::cost;
use super::identity;
use super::notes::{notes, references, several_timesteps};
use super::stability;
use super::svg::FIGURES;
use super::verdict::verdict;
use super::words::{self, NOTHING};
use crate::outcome::{Check, CheckStatus, Outcome, Report};

const LEGEND: &str = "\
## How to read this

- **Energy** is the balance B = E + dissipated - injected, so that damping and wind do not count as errors. The
  *energy error* is the largest |B - B(0)| over the run, relative to the scene's energy scale S.
- **Class** is the fitted trend of B set against its fluctuation: *bounded* (no trend to speak of), *drifting*,
  *dissipating* or *growing* (the trend outweighs the fluctuation).
- **Deviation** is the largest distance of any particle from the same particle in the named rapier engine.
  It is not an error: rapier's spring joint is linearly implicit Euler at h = dt/n, which dissipates by design, so a
  good integrator departs from it. `rapier-forces` applies the scene's own forces to rapier's bodies and must
  equal symplectic Euler bit for bit.
- **Error** is the largest distance from the truth; *floor* means below ten times the truth's own error bar.
- *Diverged*, *failed* and *unsupported* are results, not fast runs: their time is not shown.
- Times vary from run to run; everything else is reproducible.
";

/// One report, with its figures linked as files beside it.
pub fn render(report: &Report) -> String {
    if let Some(stability) = report
        .stability
        .as_ref()
        .filter(|_| stability::is_alone(report))
    {
        return stability::markdown::render(report, stability);
    }
    if let Some(cost) = report.cost.as_ref().filter(|_| cost::is_alone(report)) {
        return cost::markdown::render(report, cost);
    }
    let text = heading(report) + &facts(report);
    let text = text + &images(report) + "## Outcomes\n\n" + &outcomes(report);
    let text = text + &remarks(report) + &checks(&report.checks) + &fault(report);
    text + &ledger::energies(report) + &ledger::effects(report) + LEGEND
}

/// Name, description and verdict.
pub(super) fn heading(report: &Report) -> String {
    let scene = &report.scene;
    let mut text = format!("# {}\n\n", escape(&scene.name));
    if let Some(description) = &scene.description {
        text += &format!("{}\n\n", escape(description));
    }
    text + &format!("**Verdict:** {}\n\n", escape(&verdict(report)))
}

fn facts(report: &Report) -> String {
    let scene = &report.scene;
    let scale = scene
        .energy_scale_j
        .map_or("none".into(), |s| format!("{} J", words::short(s)));
    let rows = [
        ["file", &escape(&scene.file)],
        ["particles", &scene.particles.to_string()],
        ["springs", &scene.springs.to_string()],
        ["own integrator", &escape(&scene.own_method)],
        ["timestep", &words::timestep(report)],
        ["duration", &format!("{} s", words::short(scene.duration))],
        ["energy scale S", &scale],
        ["truth", &escape(&words::truth(&report.truth))],
    ]
    .map(|row| row.map(str::to_string).to_vec());
    table(&["scene", ""], &rows)
}

pub(super) fn images(report: &Report) -> String {
    let wanted = FIGURES.iter().filter(|figure| figure.wanted(report));
    wanted
        .map(|figure| format!("![{}]({})\n\n", figure.description, figure.file))
        .collect()
}

fn outcomes(report: &Report) -> String {
    let references = references(report);
    let timesteps = several_timesteps(report);
    let truth = report.outcomes.iter().any(|o| o.position_error_m.is_some());
    let mut header = vec!["engine".to_string()];
    header.extend(timesteps.then(|| "h (s)".to_string()));
    header.extend(["status", "energy", "energy error"].map(str::to_string));
    header.extend(
        references
            .iter()
            .map(|r| format!("deviation from {} (m)", escape(r))),
    );
    header.extend(truth.then(|| "error (m)".to_string()));
    header.extend(["steps", "force evaluations", "time"].map(str::to_string));
    let row = |outcome: &Outcome| {
        let mut row = vec![engine(report, outcome)];
        row.extend(timesteps.then(|| words::short(outcome.timestep)));
        row.push(words::status(outcome.status).into());
        row.extend(energy(outcome));
        row.extend(references.iter().map(|r| deviation(outcome, r)));
        row.extend(truth.then(|| error(report, outcome)));
        row.extend(work(outcome));
        row
    };
    let rows: Vec<Vec<String>> = report.outcomes.iter().map(row).collect();
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    table(&header, &rows)
}

fn engine(report: &Report, outcome: &Outcome) -> String {
    let name = escape(&words::engine(outcome));
    if outcome.engine == report.scene.own_method {
        format!("**{name}**")
    } else {
        name
    }
}

fn energy(outcome: &Outcome) -> [String; 2] {
    let energy = outcome.energy.as_ref();
    let class = energy.and_then(|e| e.class).map_or(NOTHING, words::class);
    let error = energy
        .map(words::energy_error)
        .filter(|text| !text.is_empty());
    [class.into(), error.unwrap_or(NOTHING.into())]
}

fn deviation(outcome: &Outcome, reference: &str) -> String {
    match outcome.deviation_m.get(reference) {
        Some(deviation) if outcome.engine != reference => words::sci(deviation.max),
        _ => NOTHING.into(),
    }
}

fn error(report: &Report, outcome: &Outcome) -> String {
    let error = outcome.position_error_m.as_ref();
    error.map_or(NOTHING.into(), |e| words::truth_error(e.max, &report.truth))
}

fn work(outcome: &Outcome) -> [String; 3] {
    let evaluations = outcome.work.force_evaluations;
    [
        words::count(outcome.work.steps),
        evaluations.map_or(NOTHING.into(), words::count),
        words::wall_time(outcome),
    ]
}

fn remarks(report: &Report) -> String {
    let notes = notes(report);
    if notes.is_empty() {
        return String::new();
    }
    let line = |note: &super::notes::Note| {
        format!(
            "- **{}**: {}\n",
            escape(&note.subject),
            escape(&note.sentence)
        )
    };
    format!(
        "## Remarks\n\n{}\n",
        notes.iter().map(line).collect::<String>()
    )
}

pub(super) fn checks(checks: &[Check]) -> String {
    if checks.is_empty() {
        return String::new();
    }
    let number = |n: Option<f64>| n.map_or(NOTHING.into(), words::quantity);
    let row = |check: &Check| {
        let status = match check.status {
            CheckStatus::Pass => "pass",
            CheckStatus::Fail => "**fail**",
            CheckStatus::Skip => "skip",
            CheckStatus::Inconclusive => "inconclusive",
        };
        vec![
            escape(&check.id),
            escape(&check.subject),
            status.into(),
            number(check.measured),
            number(check.bound),
            escape(&check.derivation),
            escape(&check.message),
        ]
    };
    let rows: Vec<Vec<String>> = checks.iter().map(row).collect();
    let header = [
        "check",
        "subject",
        "status",
        "measured",
        "bound",
        "bound from",
        "message",
    ];
    format!("## Checks\n\n{}", table(&header, &rows))
}

fn fault(report: &Report) -> String {
    let lines = identity::fault(report);
    if lines.is_empty() {
        return String::new();
    }
    let item = |line: &String| format!("- {}\n", escape(line));
    format!(
        "## First fault\n\n{}\n",
        lines.iter().map(item).collect::<String>()
    )
}

pub(super) fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let rule = "---|".repeat(header.len());
    let rows: String = rows.iter().map(|row| line(row)).collect();
    format!("| {} |\n|{rule}\n{rows}\n", header.join(" | "))
}

/// Text with nothing left that Markdown or HTML would read as its own, on one line.
pub(super) fn escape(text: &str) -> String {
    let text = words::one_line(text);
    let mut escaped = String::with_capacity(text.len());
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let after = rest.peek().copied().unwrap_or(' ');
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '\\' | '`' | '*' | '[' | ']' | '|' | '~' | '#' | '$' => escaped.extend(['\\', c]),
            // Inside a word an underscore is itself: ids stay legible in the source.
            '_' if !(before.is_alphanumeric() && after.is_alphanumeric()) => escaped += "\\_",
            '+' | '-' if escaped.is_empty() && after == ' ' => escaped.extend(['\\', c]),
            c => escaped.push(c),
        }
        before = c;
    }
    escaped
}
