//! The figure of `rest`: how a quantity changes as links become more.

use crate::report::svg::{
    Chart, ChartAxis, Figure, LegendEntry, Look, Mark, Panel, Stroke, Symbol, SymbolShape, heading,
};
use crate::report::words::digits;
use crate::scene::Scene;
use crate::verbs::Report;
use crate::verbs::rest::{AtRest, Refined, RestShape};
use crate::verbs::shape::shape;

/// The lines of the two scalings.
const SCALINGS: [(&str, &str, Stroke); 2] = [
    ("continuum", "with scaling", Stroke::new("#0072b2", "", 1.8)),
    ("none", "without", Stroke::new("#d55e00", "6 3", 1.8)),
];

pub const FIGURES: &[Figure<Report>] = &[
    ("rest.svg", "at rest", at_rest),
    ("refine.svg", "what refining does", refine),
];

/// The scene at rest over its start.
fn at_rest(report: &Report) -> Option<Chart> {
    let RestShape { scene, start } = report.shape()?.clone();
    // The file does not have the names of particles; the report has.
    let bodies = report.header.scene.objects.clone();
    let scene = Scene { bodies, ..*scene };
    let rest = scene.starts().concat();
    Some(shape(&scene, &[("start", &start), ("at rest", &rest)]))
}

/// A panel for each quantity over the number of links, with what it tends to.
fn refine(report: &Report) -> Option<Chart> {
    let rest = report.rest()?;
    let most = rest.refined.iter().map(|row| row.links).max()? as f64;
    let quantities = rest.refined.iter().map(|row| row.omega_rad_s.len()).max()?;
    let mut panels: Vec<Panel> = (0..=quantities)
        .filter_map(|at| panel(rest, at, most))
        .collect();
    panels.truncate(3);
    if panels.is_empty() {
        return None;
    }
    let legend = SCALINGS.map(|(_, words, stroke)| LegendEntry::new(words, Look::Line(stroke)));
    Some(Chart {
        title: heading(&report.header, "what refining does"),
        legend: legend.into(),
        titles: ["links in the place of each".into(), String::new()],
        columns: panels.len(),
        own_y: true,
        panels,
        note: note(rest),
        ..Chart::default()
    })
}

/// The panel of one quantity: 0 is the distance moved, the others the frequencies.
fn panel(rest: &AtRest, at: usize, most: f64) -> Option<Panel> {
    let value = |row: &Refined| match at {
        0 => row.moved_m,
        at => row.omega_rad_s.get(at - 1).copied(),
    };
    let name = match at {
        0 => "moved (m)".to_owned(),
        1 => "lowest frequency (rad/s)".to_owned(),
        at => format!("frequency {at} (rad/s)"),
    };
    let points = |scaling: &str| -> Vec<[f64; 2]> {
        let rows = rest.refined.iter().filter(|row| row.scaling == scaling);
        let points = rows.filter_map(|row| Some([row.links as f64, value(row)?]));
        points.filter(|[_, y]| *y > 0.0).collect()
    };
    let all: Vec<f64> = SCALINGS
        .iter()
        .flat_map(|(id, ..)| points(id))
        .map(|[_, y]| y)
        .collect();
    let low = all.iter().copied().fold(f64::INFINITY, f64::min);
    let high = all.iter().copied().fold(0.0, f64::max);
    if all.is_empty() {
        return None;
    }
    let marks = SCALINGS.into_iter().flat_map(|(id, _, stroke)| {
        let disc = Symbol::new(SymbolShape::Disc, stroke.colour, stroke.colour);
        [
            Mark::line(points(id), stroke),
            Mark::Symbols(disc, points(id)),
        ]
    });
    let axes = [
        ChartAxis::logarithmic([1.0, most.max(2.0)]),
        ChartAxis::logarithmic([low / 1.5, high * 1.5]),
    ];
    Some(Panel::new(name, 220.0, axes, marks.collect()))
}

/// What the first quantity tends to.
fn note(rest: &AtRest) -> String {
    let limits = rest
        .trends
        .iter()
        .filter(|trend| trend.scaling == "continuum");
    let said = limits.filter_map(|trend| {
        let (limit, order) = (trend.limit?, trend.order?);
        let what = super::text::quantity(&trend.quantity);
        Some(format!(
            "{what} tends to {} at order {order:.1}",
            digits(limit)
        ))
    });
    let said: Vec<String> = said.take(2).collect();
    said.join("; ")
}
