//! The terminal's part of `cost`: the answers, the table of engines, and the diagram in characters.

use super::{answer, brief, evaluations, scatter, table, tried};
use crate::report::terminal::{Tone, mark, wrap};
use crate::report::words::{self, NOTHING};
use crate::verbs::Report;
use crate::verbs::cost::{Cost, CostCurve, CostRank, CostTarget};

/// The lines below the facts.
pub fn lines(report: &Report, cost: &Cost, columns: usize) -> Vec<String> {
    let mut lines = answers(cost, columns);
    lines.push(String::new());
    lines.extend(table(report, cost).in_terminal(columns, "; ", |left_out| legend(cost, left_out)));
    lines.extend(scatter::plot(report, cost, columns));
    lines
}

/// One paragraph for each target.
fn answers(cost: &Cost, columns: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for (label, text) in answer::paragraphs(cost) {
        lines.push(String::new());
        let text = format!("{label}: {text}");
        let mut paragraph = wrap(&text, columns, "  ");
        if let Some(rest) = paragraph.first().and_then(|line| line.strip_prefix(&label)) {
            let head = mark(Tone::Strong, &label) + rest;
            paragraph.splice(..1, [head]);
        }
        lines.extend(paragraph);
    }
    lines
}

fn legend(cost: &Cost, left_out: &[String]) -> String {
    let mut legend = "▸ own integrator".to_owned();
    let shown = |header: &str| !left_out.iter().any(|out| out == header);
    let any = |wanted: &dyn Fn(&CostCurve) -> bool| cost.curves.iter().any(wanted);
    if shown("order") && any(&|curve| curve.order.is_some()) {
        legend += " | order: as stated";
    }
    if shown("slope") && any(&|curve| curve.observed_order.is_some()) {
        legend += " | slope: of error over step, as found";
    }
    if any(&|curve| curve.points.iter().any(|point| point.tolerance.is_some())) {
        legend += " | tol: tolerance of an adaptive pair";
    }
    let ranks = |target: &CostTarget| {
        let ranks = target.ranking.iter().chain(&target.reference);
        ranks
            .filter_map(|rank| rank.reached.as_ref())
            .any(|reached| reached.at_most)
    };
    if cost.targets.iter().any(ranks) {
        legend += " | ≤: at the coarsest setting tried";
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
    legend
}

/// The setting at which a curve reaches the target and its cost; the cheapest is green.
pub fn cell(target: &CostTarget, curve: &CostCurve, timed: bool) -> (String, Option<Tone>) {
    let mut ranks = target.ranking.iter().chain(&target.reference);
    let of_curve = |rank: &&CostRank| rank.engine == curve.engine;
    let reached = ranks.find(of_curve).and_then(|rank| rank.reached.as_ref());
    let Some(reached) = reached else {
        return (NOTHING.into(), None);
    };
    let paid = match (timed, reached.wall_median_s, reached.force_evaluations) {
        (true, Some(wall), _) => words::seconds(wall),
        (_, _, Some(count)) if timed => evaluations(count),
        (_, _, Some(count)) => words::count(count),
        _ => NOTHING.into(),
    };
    let paid = match reached.at_most {
        true => format!("≤ {paid}"),
        false => paid,
    };
    let setting = brief(reached.timestep, reached.tolerance);
    let leads = target.ranking.first().as_ref().is_some_and(of_curve);
    (format!("{setting}  {paid:>7}"), leads.then_some(Tone::Good))
}
