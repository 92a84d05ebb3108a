//! Energy over time.

use super::chart::{Chart, chart};
use super::panels::Panel;
use super::range;
use super::scale::{Axis, HUGE, Scale};
use crate::outcome::{Report, Status};
use crate::report::words;

/// A linear axis serves until the amplitudes differ by more than this.
const RATIO: f64 = 50.0;

/// Whether anything was recorded.
pub fn wanted(report: &Report) -> bool {
    report.figures.curves.iter().any(|c| !c.energy.is_empty())
}

pub fn draw(report: &Report) -> String {
    let y_title = match report.scene.energy_scale_j {
        Some(scale) => format!("(B − B(0)) / S,  S = {} J", words::short(scale)),
        None => "B − B(0)  (J)".into(),
    };
    let energy = Chart {
        title: "energy balance over time".into(),
        y_title,
        series: |curves| &curves.energy,
        // The zero line.
        truth: |_| &[],
        axis: &axis,
    };
    chart(report, &energy)
}

/// Symmetric-logarithmic where a small bounded oscillation shares the panel with a large growth.
fn axis(panel: &Panel) -> Axis {
    let ranges = || {
        panel.runs.iter().filter_map(|(outcome, curves)| {
            let range = range::range(curves.energy.iter().copied())?;
            Some((outcome.status == Status::Completed, range))
        })
    };
    let size = |[lo, hi]: [f64; 2]| f64::max(-lo, hi);
    let finished = ranges().filter(|(done, _)| *done).map(|(_, r)| size(r));
    // Unfinished runs leave through the edge instead of setting it, if there are others.
    let cap = finished
        .reduce(f64::max)
        .map_or(f64::MAX, |largest| f64::max(100.0 * largest, 1.0));
    let clamped = |end: f64| end.clamp(-cap, cap);
    let sizes: Vec<f64> = ranges().map(|(_, r)| size(r.map(clamped))).collect();
    let ends = ranges().flat_map(|(_, r)| r).map(clamped);
    // Zero, where every run starts, is always shown.
    let all = range::range(ends.chain([0.0])).unwrap_or_default();
    match linear_part(&sizes) {
        Some(linear) => symlog(all, linear),
        None => Axis::linear(range::padded(all, 0.06)),
    }
}

/// The power of ten below the smallest amplitude worth telling from zero, if the largest dwarfs it.
fn linear_part(sizes: &[f64]) -> Option<f64> {
    let largest = sizes.iter().copied().fold(0.0, f64::max);
    let smallest = if largest > 1.0 {
        // Something gained more than the scale: a thousandth of it is small, all of it is not.
        sizes.iter().copied().fold(1.0, f64::min).max(1e-3)
    } else {
        let counts = |s: &f64| *s >= 1e-4 * largest;
        let smallest = sizes.iter().copied().filter(counts).fold(largest, f64::min);
        smallest.max(1e-3 * largest)
    };
    let spans = smallest > 1e-290 && largest > RATIO * smallest;
    spans.then(|| 10_f64.powi(smallest.log10().floor() as i32))
}

/// Half a decade of room on each side.
fn symlog([lo, hi]: [f64; 2], linear: f64) -> Axis {
    let beyond = |end: f64| 3.0 * end.abs().clamp(0.2 * linear, HUGE / 3.0);
    Axis {
        scale: Scale::SymLog { linear },
        range: [-beyond(lo), beyond(hi)],
    }
}
