//! What the strain limit left of the strain, in words.

use crate::measure::Strain;
use crate::report::words::{self, escape};
use crate::verbs::Report;
use crate::verbs::run::Outcome;

const INTRO: &str = "\
After each step springs that are beyond the limit are corrected one after the other, in sweeps: their ends are moved, and
the velocity that stretches them is taken out (Provot 1995). A correction disturbs the neighbours, so that what is left
depends on the timestep and the number of sweeps. The *largest* is (l - L)/L after the sweeps, at the recorded instants;
the limit is *met* where that is beyond it by no more than a hundredth of it, or 1e-6.
What the limit takes out is part of the balance: B = E + dissipated - injected + limited.";

fn rows(report: &Report) -> Vec<(&Outcome, &Strain)> {
    let outcomes = report.outcomes().iter();
    outcomes
        .filter_map(|outcome| Some((outcome, outcome.strain.as_ref()?)))
        .collect()
}

/// The table of all engines; empty without a strain limit.
pub fn table(report: &Report) -> String {
    let rows = rows(report);
    if rows.is_empty() {
        return String::new();
    }
    let mut table = super::beside(report, &rows);
    table.markdown("limit", |(_, strain)| words::percent(strain.ratio));
    table.markdown("largest", |(_, strain)| strain.largest.map(words::percent));
    table.markdown("spring", |(_, strain)| strain.spring.to_string());
    table.markdown("at (s)", |(_, strain)| words::short(strain.t_s));
    table.markdown("met", |(_, strain)| {
        let met = if strain.met { "yes" } else { "no" };
        met.to_owned()
    });
    table.markdown("corrections", |(_, strain)| {
        strain.corrections.map(words::count)
    });
    table.markdown("sweeps", |(_, strain)| strain.sweeps.map(words::count));
    table.markdown("limited (J)", |(o, _)| limited(o).map(words::short));
    table.markdown("impulse on what is fixed (N s)", |(_, strain)| {
        strain.impulse_n_s.map(|p| escape(&vector(p)))
    });
    format!("{INTRO}\n\n{}", table.in_markdown())
}

/// The strain of one engine, for the terminal.
pub fn own(report: &Report) -> Vec<(&'static str, String)> {
    let spoken = super::spoken_of(report, |o| o.strain.is_some());
    let Some((outcome, strain)) = spoken.and_then(|o| Some((o, o.strain.as_ref()?))) else {
        return Vec::new();
    };
    let most = strain.largest.map_or("unknown".to_owned(), words::percent);
    let verdict = match (strain.met, strain.largest) {
        (true, Some(most)) if most.abs() > strain.ratio + SLACK => "met to a hundredth of it",
        (true, _) => "met",
        (false, _) => "NOT met",
    };
    let mut text = format!(
        "{}: largest {most} (spring {} at {} s), limit {} {verdict}",
        words::one_line(&outcome.engine),
        strain.spring,
        words::short(strain.t_s),
        words::percent(strain.ratio)
    );
    if let (Some(springs), Some(sweeps)) = (strain.corrections, strain.sweeps) {
        text += &format!(
            "; {} in {}",
            words::plural(springs, "correction"),
            words::plural(sweeps, "sweep")
        );
    }
    if let Some(joules) = limited(outcome) {
        let way = if joules < 0.0 { "put in" } else { "taken out" };
        text += &format!(", {} J {way}", words::short(joules.abs()));
    }
    let mut lines = vec![("strain", text)];
    let time = outcome.work.steps as f64 * outcome.timestep;
    if let Some(sum) = strain
        .impulse_n_s
        .filter(|sum| *sum != [0.0; 3] && time > 0.0)
    {
        let mean = vector(sum.map(|p| p / time));
        let text = format!(
            "its limit acts on what is fixed with {mean} N on average, {} N s in all",
            vector(sum)
        );
        lines.push(("", text));
    }
    lines
}

/// A strain beyond the limit by no more than this is rounding.
const SLACK: f64 = 1e-8;

fn limited(outcome: &Outcome) -> Option<f64> {
    outcome.energy.as_ref()?.limited_j
}

fn vector(of: [f64; 3]) -> String {
    format!("({})", of.map(words::short).join(", "))
}
