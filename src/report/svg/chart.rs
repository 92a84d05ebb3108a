//! Curves over time, one panel per timestep, with a label at each line's end.

use super::canvas::{Anchor, Canvas, INK};
use super::frame::{BELOW, Frame, LEFT};
use super::labels::{self, Label, PITCH};
use super::line::{self, Window};
use super::palette;
use super::panels::{Panel, budget, panels};
use super::range;
use super::scale::Axis;
use super::{TRUTH_NAME, WIDTH, heading, name};
use crate::outcome::{Curves, Report, Status, TruthCurves};

/// Which curves, and how their axis looks.
pub struct Chart<'a> {
    pub title: String,
    pub y_title: String,
    /// The series of a run, as long as its `t`; shorter ones end early.
    pub series: fn(&Curves) -> &[f64],
    /// The truth's, where it has this curve.
    pub truth: fn(&TruthCurves) -> &[f64],
    /// The vertical axis of a panel.
    pub axis: &'a dyn Fn(&Panel) -> Axis,
}

/// The chart as an SVG file.
pub fn chart(report: &Report, chart: &Chart) -> String {
    let panels = panels(report);
    let names = panels.iter().flat_map(|p| &p.runs).map(|(o, _)| name(o));
    let names: Vec<String> = names.chain([TRUTH_NAME.to_owned()]).collect();
    let right = WIDTH - labels::margin(names.iter().map(String::as_str));
    let rows = panels.iter().map(|p| p.runs.len() + 1).max().unwrap_or(0);
    let tall = if panels.len() > 1 { 230.0 } else { 340.0 };
    let height = f64::max(tall, (rows as f64 + 0.5) * PITCH);
    let points = budget(names.len());

    let mut canvas = Canvas::default();
    let title = heading(report, &chart.title);
    canvas.text([LEFT, 24.0], Anchor::Start, 15.0, INK, &title);
    let mut top = 40.0;
    for panel in &panels {
        if !panel.title.is_empty() {
            top += 16.0;
        }
        let window = Window {
            left: LEFT,
            top,
            right,
            bottom: top + height,
        };
        let times = panel.runs.iter().flat_map(|(_, curves)| &curves.t);
        let x = range::range(times.copied()).unwrap_or([0.0, 1.0]);
        let frame = Frame {
            window,
            x: Axis::linear(x),
            y: (chart.axis)(panel),
        };
        frame.ground(&mut canvas, &panel.title, "time (s)", &chart.y_title);
        draw(&mut canvas, report, panel, &frame, chart, points);
        frame.outline(&mut canvas);
        top += height + BELOW;
    }
    canvas.finish(WIDTH, top + 2.0, &title)
}

fn draw(
    canvas: &mut Canvas,
    report: &Report,
    panel: &Panel,
    frame: &Frame,
    chart: &Chart,
    points: usize,
) {
    let mut runs = panel.runs.clone();
    runs.sort_by_key(|(outcome, _)| palette::layer(report, outcome));
    let mut notes = Vec::new();
    let w = frame.window;
    if let Some(truth) = &report.figures.truth {
        let pixels = pixels(frame, &truth.t, (chart.truth)(truth));
        let drawn = line::draw(&thinned(&pixels, points), w);
        canvas.path(&drawn.data, palette::TRUTH);
        notes.extend(pixels.last().map(|last| {
            let [x, y] = drawn.end.unwrap_or(*last);
            Label {
                text: TRUTH_NAME.to_owned(),
                stroke: palette::TRUTH,
                mark: None,
                exit: (drawn.end.is_some() && x > w.right - 3.0).then_some(y),
                wish: y.clamp(w.top, w.bottom),
            }
        }));
    }
    for (outcome, curves) in runs {
        let stroke = palette::stroke(report, outcome);
        let mut pixels = pixels(frame, &curves.t, (chart.series)(curves));
        let Some(&last) = pixels.last() else { continue };
        if palette::is_wild(outcome) {
            pixels = line::until_far(pixels, w);
        }
        let drawn = line::draw(&thinned(&pixels, points), w);
        canvas.path(&drawn.data, stroke);
        if outcome.status != Status::Completed && drawn.end == Some(last) {
            canvas.cross(last, 4.0, stroke.colour);
        }
        let [x, y] = drawn.end.unwrap_or(last);
        notes.push(Label {
            text: name(outcome),
            stroke,
            mark: None,
            exit: (drawn.end.is_some() && x > w.right - 3.0).then_some(y),
            wish: y.clamp(w.top, w.bottom),
        });
    }
    labels::draw(canvas, notes, w.right, w.top, w.bottom);
}

fn pixels(frame: &Frame, t: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    let points = t.iter().zip(values).map(|(&t, &v)| [t, v]);
    let finite = points.filter(|p| p.iter().all(|c| c.is_finite()));
    finite.map(|p| frame.place(p)).collect()
}

/// Thinned by the extremes of the height alone: time only runs on.
fn thinned(pixels: &[[f64; 2]], points: usize) -> Vec<[f64; 2]> {
    let heights: Vec<[f64; 1]> = pixels.iter().map(|p| [p[1]]).collect();
    let kept = line::thinned(&heights, points);
    kept.into_iter().map(|i| pixels[i]).collect()
}
