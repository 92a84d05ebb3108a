//! The answers, the table of engines, the diagram in characters, and the reasons.

use super::notes::notes;
use super::{
    answer, brief, evaluations, facts, is_timed, nearest_energy, nearest_error, order, scatter,
    slope, tried,
};
use crate::outcome::{Cost, CostCurve, CostRank, CostTarget, Report};
use crate::report::terminal::columns::{Column, fitted, laid_out};
use crate::report::terminal::fit::wrap;
use crate::report::terminal::paint::{Tone, mark};
use crate::report::terminal::{WIDTH, checks, finished, scene};
use crate::report::words::{self, NOTHING};
use comfy_table::CellAlignment::{Left, Right};

const INDENT: &str = "         ";

/// The report with ANSI colours. Ends with the verdict and a newline.
pub fn render(report: &Report) -> String {
    let mut lines = scene(report);
    if let Some(cost) = &report.cost {
        for (label, text) in facts(report, cost) {
            let line = format!("{label:<9}{}", words::one_line(&text));
            lines.extend(wrap(&line, WIDTH, INDENT));
        }
        lines.extend(answers(cost));
        lines.push(String::new());
        lines.extend(table(report, cost));
        lines.extend(scatter::plot(report, cost));
        lines.extend(reasons(cost));
    }
    lines.extend(checks(&report.checks));
    finished(report, lines)
}

/// One paragraph a target.
fn answers(cost: &Cost) -> Vec<String> {
    let mut lines = Vec::new();
    for (label, text) in answer::paragraphs(cost) {
        lines.push(String::new());
        let text = format!("{label}: {text}");
        let mut paragraph = wrap(&text, WIDTH, "  ");
        if let Some(rest) = paragraph.first().and_then(|line| line.strip_prefix(&label)) {
            let head = mark(Tone::Strong, &label) + rest;
            paragraph.splice(..1, [head]);
        }
        lines.extend(paragraph);
    }
    lines
}

fn table(report: &Report, cost: &Cost) -> Vec<String> {
    let column = |header: &str, alignment, spare, cell: &dyn Fn(&CostCurve) -> _| Column {
        header: header.into(),
        alignment,
        spare,
        cells: cost.curves.iter().map(cell).collect(),
    };
    let plain = |text: String| (text, None);
    let timed = is_timed(cost);
    let paid = if timed { "time" } else { "evaluations" };
    let mut columns = vec![
        column("  engine", Left, 0, &|curve| engine(report, curve)),
        column("order", Right, 4, &|curve| plain(order(curve))),
        column("slope", Right, 2, &|curve| plain(slope(curve))),
    ];
    for target in cost.targets.iter().filter(|target| target.reason.is_none()) {
        let header = format!("{}\nh (s), {paid}", answer::label(target));
        columns.push(column(&header, Right, 1, &|curve| {
            cell(target, curve, timed)
        }));
    }
    columns.extend([
        column("smallest\nerror (m)", Right, 3, &|curve| {
            plain(nearest_error(curve))
        }),
        column("energy\nerror", Right, 5, &|curve| {
            plain(nearest_energy(curve))
        }),
        column("settings", Right, 6, &|curve| plain(tried(curve))),
    ]);
    columns.retain(|column| !column.is_empty());
    let (columns, left_out) = fitted(columns);
    let mut lines = laid_out(&columns);
    let legend = wrap(&legend(cost, &left_out), WIDTH, "");
    lines.extend(legend.iter().map(|line| mark(Tone::Dim, line)));
    lines
}

fn legend(cost: &Cost, left_out: &[String]) -> String {
    let mut legend = "▸ own integrator".to_owned();
    let shown = |header: &str| !left_out.iter().any(|out| out == header);
    if shown("order") && cost.curves.iter().any(|curve| curve.order.is_some()) {
        legend += " | order: as stated";
    }
    if shown("slope")
        && cost
            .curves
            .iter()
            .any(|curve| curve.observed_order.is_some())
    {
        legend += " | slope: of error over step, as found";
    }
    let any = |wanted: &dyn Fn(&CostCurve) -> bool| cost.curves.iter().any(wanted);
    if any(&|curve| curve.points.iter().any(|point| point.tolerance.is_some())) {
        legend += " | tol: tolerance of an adaptive pair";
    }
    let floored = |curve: &CostCurve| super::nearest(curve).is_some_and(|point| point.at_floor);
    if shown("smallest error (m)") && any(&floored) {
        legend += " | floor: not told from the truth";
    }
    if any(&|curve| !curve.is_ranked()) {
        legend += " | † explained, not ranked";
    }
    if shown("settings") && any(&|curve| tried(curve).contains("of")) {
        legend += " | settings: completed of tried";
    }
    if !left_out.is_empty() {
        legend += &format!(" | left out for width: {}", left_out.join("; "));
    }
    legend
}

fn engine(report: &Report, curve: &CostCurve) -> (String, Option<Tone>) {
    let name = words::one_line(&curve.engine);
    if curve.engine == report.scene.own_method {
        (format!("▸ {name}"), Some(Tone::Strong))
    } else if curve.is_ranked() {
        (format!("  {name}"), None)
    } else {
        (format!("† {name}"), None)
    }
}

/// Setting and price at which a curve reaches the target; the cheapest in green.
fn cell(target: &CostTarget, curve: &CostCurve, timed: bool) -> (String, Option<Tone>) {
    let ranks = target.ranking.iter().chain(&target.reference);
    let of_curve = |rank: &&CostRank| rank.engine == curve.engine;
    let Some(reached) = ranks
        .clone()
        .find(of_curve)
        .and_then(|r| r.reached.as_ref())
    else {
        return (NOTHING.into(), None);
    };
    let paid = match (timed, reached.wall_median_s, reached.force_evaluations) {
        (true, Some(wall), _) => words::seconds(wall),
        (_, _, Some(count)) if timed => evaluations(count),
        (_, _, Some(count)) => words::count(count),
        _ => NOTHING.into(),
    };
    let setting = brief(reached.timestep, reached.tolerance);
    let leads = target
        .ranking
        .first()
        .is_some_and(|rank| rank.engine == curve.engine);
    (format!("{setting}  {paid:>7}"), leads.then_some(Tone::Good))
}

fn reasons(cost: &Cost) -> Vec<String> {
    let mut lines = Vec::new();
    for (subject, sentence) in notes(cost) {
        let text = match subject.as_str() {
            "" => sentence,
            subject => format!("{subject}: {sentence}"),
        };
        lines.extend(wrap(&format!("- {text}"), WIDTH, "  "));
    }
    if !lines.is_empty() {
        lines.insert(0, String::new());
    }
    lines
}
