//! The result of `rest` in words.

mod facts;
mod refined;

pub use refined::quantity;

use crate::report::markdown::{findings, opening, section};
use crate::report::table::Table;
use crate::report::terminal::{Tone, mark, wrap};
use crate::report::verdict::Clause;
use crate::report::words::{self, digits, listed, one_line};
use crate::report::{Note, View};
use crate::scene::object::{Body, called};
use crate::verbs::Report;
use crate::verbs::rest::{AtRest, Balance, Moved, Oscillation};
use facts::facts;
use refined::{REFINED, refinement, sentence, tendency, trends};
use std::f64::consts::TAU;

const LEGEND: &str = "\
## How to read this

- **Rest**: positions in which no force is left, found by Newton's iteration on the potential from the start. Dampers do
  nothing at rest, moving air pulls, and what is driven stands still where it starts.
- **Oscillations** are small ones about it, without dampers: x'' = -K x of the forces linearised there. A frequency of 0 is
  a motion that costs no energy, at first; one that *grows* is a fall.
- **Moved**: how far the particle that moves farthest is from its start.
";

/// The parts that the terminal and the page have in common.
pub fn view<'a>(report: &'a Report, rest: &'a AtRest, columns: usize) -> View<'a> {
    let bodies = &report.header.scene.objects;
    let found = rest.found.as_ref();
    View {
        columns,
        header: &report.header,
        timesteps: Vec::new(),
        clauses: clauses(rest, bodies),
        facts: found.map_or_else(Vec::new, |found| facts(found, bodies)),
        lines: lines(rest, bodies, columns),
        notes: notes(rest),
        last: Vec::new(),
    }
}

/// The page in Markdown.
pub fn page(report: &Report, rest: &AtRest, view: &View) -> String {
    let bodies = &report.header.scene.objects;
    let table = |balance: &Balance| oscillations(&balance.oscillations, bodies).in_markdown();
    let refined = if rest.refined.is_empty() {
        String::new()
    } else {
        let trends = trends(&rest.trends).in_markdown();
        format!("{REFINED}\n{}\n{trends}", refinement(rest).in_markdown())
    };
    [
        opening(view, view.facts.clone()),
        section(
            "Oscillations",
            rest.found.as_ref().map(table).unwrap_or_default(),
        ),
        findings(view),
        section("Refining", refined),
        report.images(),
        LEGEND.to_owned(),
    ]
    .concat()
}

fn clauses(rest: &AtRest, bodies: &[Body]) -> Vec<Clause> {
    let Some(found) = &rest.found else {
        let reason = rest.reason.as_deref().unwrap_or_default();
        return vec![vec![format!("NO REST: {}", one_line(reason))]];
    };
    let moved = match &found.farthest {
        Some(moved) => format!(
            "at rest particle {} is {} from its start",
            called(bodies, moved.particle),
            distance(moved)
        ),
        None => "all forces are balanced at the start".to_owned(),
    };
    let mut clauses = vec![vec![moved]];
    let grows = |o: &&Oscillation| o.growth_per_s.is_some();
    let free = |o: &&Oscillation| o.omega_rad_s == Some(0.0);
    let many = |count: usize, which: &dyn Fn(&&Oscillation) -> bool| {
        let more = if found.counted || count < found.oscillations.len() {
            ""
        } else {
            "at least "
        };
        let first = found.oscillations.iter().find(which);
        first.map(|first| (format!("{more}{count}"), *first))
    };
    if let Some((count, first)) = many(found.growing, &grows) {
        let time = first
            .growth_per_s
            .map_or(f64::NAN, |rate| 2.0_f64.ln() / rate);
        clauses.push(vec![format!(
            "IT IS UNSTABLE: a nudge grows in {count} of its motions, fastest of particle {} along {}, twice as far every {}",
            called(bodies, first.particle),
            axis(first.axis),
            words::seconds(time)
        )]);
    }
    if let Some((count, first)) = many(found.free, &free) {
        let motions = if count == "1" {
            "motion costs"
        } else {
            "motions cost"
        };
        clauses.push(vec![format!(
            "{count} {motions} no energy that rounding shows, such as particle {} along {}: a mechanism",
            called(bodies, first.particle),
            axis(first.axis)
        )]);
    }
    let slowest = found
        .oscillations
        .iter()
        .find_map(|o| o.omega_rad_s.filter(|w| *w > 0.0));
    if let Some(omega) = slowest {
        clauses.push(vec![
            format!(
                "its slowest oscillation takes {}",
                words::seconds(TAU / omega)
            ),
            String::new(),
        ]);
    }
    clauses.extend(tendency(rest));
    clauses
}

/// `0.0981 m along -z`, or without a direction.
fn distance(moved: &Moved) -> String {
    let length = digits(moved.distance());
    moved.along().map_or_else(
        || format!("{length} m"),
        |at| {
            let sign = if moved.by_m[at] < 0.0 { "-" } else { "" };
            format!("{length} m along {sign}{}", axis(at))
        },
    )
}

fn axis(at: usize) -> &'static str {
    ["x", "y", "z"].get(at).copied().unwrap_or("x")
}

fn lines(rest: &AtRest, bodies: &[Body], columns: usize) -> Vec<String> {
    let mut lines = Vec::new();
    if let Some(found) = &rest.found {
        lines.extend(
            oscillations(&found.oscillations, bodies).in_terminal(columns, ", ", |_| {
                "small oscillations about the rest, without dampers".to_owned()
            }),
        );
    }
    if !rest.refined.is_empty() {
        lines.push(String::new());
        lines.push(mark(Tone::Strong, "what refining does"));
        lines.extend(refinement(rest).in_terminal(columns, ", ", |_| {
            "continuum: stiffness and mass are scaled; none: each link keeps its own".to_owned()
        }));
        lines.push(String::new());
        let sentences = rest.trends.iter().filter_map(sentence);
        lines.extend(sentences.flat_map(|text| wrap(&text, columns, "  ")));
    }
    lines
}

fn oscillations<'r>(rows: &'r [Oscillation], bodies: &[Body]) -> Table<'r, Oscillation> {
    let mut table = Table::new(rows);
    let omega = |row: &Oscillation| match row.omega_rad_s {
        None => "grows".to_owned(),
        Some(0.0) => "0".to_owned(),
        Some(omega) => digits(omega),
    };
    let moving = |row: &Oscillation| row.omega_rad_s.filter(|omega| *omega > 0.0);
    table.right("frequency\n(rad/s)", "frequency (rad/s)", 0, omega);
    table.right("(Hz)", "(Hz)", 2, |row| {
        moving(row).map(|omega| digits(omega / TAU))
    });
    table.right("period\n(s)", "period (s)", 1, |row| {
        moving(row).map(|omega| digits(TAU / omega))
    });
    table.left("moves most", "moves most", |row| {
        (
            format!(
                "particle {} along {}",
                called(bodies, row.particle),
                axis(row.axis)
            ),
            None,
        )
    });
    table
}

/// What the frequencies leave out, what to do with an unstable rest, and refinements without one.
fn notes(rest: &AtRest) -> Vec<Note> {
    let found = rest.found.iter();
    let left_out = found.clone().flat_map(|found| found.left_out.clone());
    let falls = found
        .filter(|found| found.growing > 0)
        .map(|_| "start it a little aside, and the rest that it falls to is found".to_owned());
    let said = left_out.chain(falls).map(|said| ("rest".to_owned(), said));
    let refined = rest.refined.iter().filter_map(|row| {
        let what = format!("{} links, {}", row.links, one_line(&row.scaling));
        Some((what, one_line(row.reason.as_ref()?)))
    });
    Note::of(said.chain(refined), listed)
}
