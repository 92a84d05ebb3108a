//! The curve the scene asks for.

use super::chart::{Chart, chart};
use super::palette::is_wild;
use super::panels::Panel;
use super::range;
use super::scale::Axis;
use super::shortened;
use crate::outcome::{PlotAxis, Report};
use crate::report::words;

/// Whether the scene asks for a curve and there is one.
pub fn wanted(report: &Report) -> bool {
    let figures = &report.figures;
    figures.plot.is_some() && figures.curves.iter().any(|c| !c.plot.is_empty())
}

pub fn draw(report: &Report) -> String {
    let asked = report.figures.plot.as_ref();
    let label = asked
        .map(|plot| shortened(&words::one_line(&plot.label), 40))
        .unwrap_or_default();
    let plot = Chart {
        title: format!("{label} over time"),
        y_title: label,
        series: |curves| &curves.plot,
        truth: |truth| &truth.plot,
        axis: &|panel| axis(panel, asked),
    };
    chart(report, &plot)
}

/// The range the scene states, else what the calm runs span.
fn axis(panel: &Panel, asked: Option<&PlotAxis>) -> Axis {
    if let Some([lo, hi]) = asked.and_then(|plot| plot.y_range)
        && lo < hi
    {
        return Axis::linear([lo, hi]);
    }
    let mut calm = None;
    let mut wild = Vec::new();
    for (outcome, curves) in &panel.runs {
        let range = range::range(curves.plot.iter().copied());
        if is_wild(outcome) {
            wild.extend(range);
        } else {
            calm = range::union(calm, range);
        }
    }
    let shown = range::tamed(calm, &wild).unwrap_or([0.0, 1.0]);
    Axis::linear(range::padded(shown, 0.05))
}
