//! Paths of a few particles, projected on the plane that shows most of them, with equal scales.

use super::canvas::{Anchor, Canvas, FAINT, INK};
use super::frame::{BELOW, Frame, LEFT};
use super::labels::{self, Label, PITCH};
use super::line::{self, Window};
use super::palette;
use super::panels::{Panel, budget, panels};
use super::range;
use super::scale::Axis;
use super::{TRUTH_NAME, WIDTH, heading, name};
use crate::outcome::{Report, Status};

/// Smallest and largest panel, pixels; the largest height holds for a single panel.
const SMALLEST: [f64; 2] = [240.0, 160.0];
const TALLEST: [f64; 2] = [460.0, 320.0];

/// Whether anything moved on record.
pub fn wanted(report: &Report) -> bool {
    let paths = report.figures.curves.iter().flat_map(|c| &c.paths);
    paths.into_iter().any(|path| !path.is_empty())
}

pub fn draw(report: &Report) -> String {
    let panels = panels(report);
    let names: Vec<String> = panels
        .iter()
        .flat_map(|p| &p.runs)
        .map(|(outcome, _)| name(outcome))
        .collect();
    let room = WIDTH - LEFT - labels::margin(names.iter().map(String::as_str));
    let tallest = TALLEST[usize::from(panels.len() > 1)];
    let runs = panels.iter().flat_map(|p| &p.runs);
    let points = budget(runs.map(|(_, curves)| curves.paths.len()).sum());

    let mut canvas = Canvas::default();
    let title = heading(report, "trajectories");
    canvas.text([LEFT, 24.0], Anchor::Start, 15.0, INK, &title);
    let mut top = 40.0;
    for panel in &panels {
        if !panel.title.is_empty() {
            top += 16.0;
        }
        let frame = frame(report, panel, top, [room, tallest]);
        let [x, y] = report
            .figures
            .plane
            .map(|axis| ["x (m)", "y (m)", "z (m)"][axis.min(2)]);
        frame.ground(&mut canvas, &panel.title, x, y);
        let stopped = paths(&mut canvas, report, panel, &frame, points);
        frame.outline(&mut canvas);
        let legend = legend(&mut canvas, report, panel, &frame, stopped);
        top = f64::max(frame.window.bottom + BELOW, legend);
    }
    canvas.finish(WIDTH, top + 2.0, &title)
}

/// A panel with equal scales: as large as the space allows, its range grown to a least size.
fn frame(report: &Report, panel: &Panel, top: f64, space: [f64; 2]) -> Frame {
    let ranges = [0, 1].map(|axis| Axis::linear(shown(report, panel, axis)).range);
    let spans = ranges.map(|[lo, hi]| hi - lo);
    let scale = f64::min(space[0] / spans[0], space[1] / spans[1]);
    let size = [0, 1].map(|a| (spans[a] * scale).clamp(SMALLEST[a], space[a]));
    let grown = [0, 1].map(|a| {
        let [lo, hi] = ranges[a];
        let (middle, half) = (lo / 2.0 + hi / 2.0, size[a] / scale / 2.0);
        Axis::linear([middle - half, middle + half])
    });
    Frame {
        window: Window {
            left: LEFT,
            top,
            right: LEFT + size[0],
            bottom: top + size[1],
        },
        x: grown[0],
        y: grown[1],
    }
}

/// What the calm runs and the fixed particles span along one axis, and a little of the wild ones.
fn shown(report: &Report, panel: &Panel, axis: usize) -> [f64; 2] {
    let fixed = report.figures.fixed.iter().map(|p| p[axis]);
    let mut calm = None;
    let mut wild = Vec::new();
    for (outcome, curves) in &panel.runs {
        let range = range::range(curves.paths.iter().flatten().map(|p| p[axis]));
        if palette::is_wild(outcome) {
            wild.extend(range);
        } else {
            calm = range::union(calm, range);
        }
    }
    let fixed = range::range(fixed);
    let calm = calm.map(|_| range::union(calm, fixed)).unwrap_or_default();
    let tamed = range::tamed(calm, &wild);
    range::padded(range::union(tamed, fixed).unwrap_or([0.0, 1.0]), 0.06)
}

/// Returns whether a run ended early within the picture.
fn paths(
    canvas: &mut Canvas,
    report: &Report,
    panel: &Panel,
    frame: &Frame,
    points: usize,
) -> bool {
    let mut stopped = false;
    for path in report.figures.truth.iter().flat_map(|truth| &truth.paths) {
        let pixels: Vec<[f64; 2]> = path.iter().map(|p| frame.place(*p)).collect();
        let kept = line::thinned(&pixels, points);
        let pixels: Vec<[f64; 2]> = kept.into_iter().map(|i| pixels[i]).collect();
        canvas.path(&line::draw(&pixels, frame.window).data, palette::TRUTH);
    }
    let mut runs = panel.runs.clone();
    runs.sort_by_key(|(outcome, _)| palette::layer(report, outcome));
    for &(outcome, curves) in &runs {
        let stroke = palette::stroke(report, outcome);
        for path in &curves.paths {
            let finite = path.iter().filter(|p| p.iter().all(|c| c.is_finite()));
            let mut pixels: Vec<[f64; 2]> = finite.map(|p| frame.place(*p)).collect();
            let last = pixels.last().copied();
            if palette::is_wild(outcome) {
                pixels = line::until_far(pixels, frame.window);
            }
            let kept = line::thinned(&pixels, points);
            let pixels: Vec<[f64; 2]> = kept.into_iter().map(|i| pixels[i]).collect();
            let drawn = line::draw(&pixels, frame.window);
            canvas.path(&drawn.data, stroke);
            // A path that left the picture ends nowhere in it.
            let Some(end) = drawn.end.filter(|_| drawn.end == last) else {
                continue;
            };
            if outcome.status == Status::Completed {
                canvas.circle(end, 3.2, stroke.colour, "#ffffff");
            } else {
                canvas.cross(end, 4.0, stroke.colour);
                stopped = true;
            }
        }
    }
    marks(canvas, report, panel, frame);
    stopped
}

/// Where paths start, and the particles that never move.
fn marks(canvas: &mut Canvas, report: &Report, panel: &Panel, frame: &Frame) {
    let first = panel.runs.first().map(|(_, curves)| &curves.paths);
    let starts = first.into_iter().flatten().filter_map(|path| path.first());
    for start in starts
        .map(|p| frame.place(*p))
        .filter(|p| frame.window.holds(*p))
    {
        canvas.circle(start, 4.0, "#ffffff", INK);
    }
    let fixed = report.figures.fixed.iter().map(|p| frame.place(*p));
    for fixed in fixed.filter(|p| frame.window.holds(*p)) {
        canvas.square(fixed, 3.5, INK);
    }
}

/// Engines and what the marks mean, from the panel's top down; returns where it ends.
fn legend(
    canvas: &mut Canvas,
    report: &Report,
    panel: &Panel,
    frame: &Frame,
    stopped: bool,
) -> f64 {
    let w = frame.window;
    let truth = report.figures.truth.iter();
    let truth = truth.map(|_| (TRUTH_NAME.to_owned(), palette::TRUTH));
    let runs = panel.runs.iter();
    let runs = runs.map(|(outcome, _)| (name(outcome), palette::stroke(report, outcome)));
    let labels: Vec<Label> = truth
        .chain(runs)
        .enumerate()
        .map(|(i, (text, stroke))| Label {
            text,
            stroke,
            mark: None,
            exit: None,
            wish: w.top + (i as f64 + 0.5) * PITCH,
        })
        .collect();
    let mut y = w.top + (labels.len() as f64 + 1.0) * PITCH;
    let bottom = y - PITCH / 2.0;
    labels::draw(canvas, labels, w.right, w.top, bottom);
    let x = w.right + 26.0;
    let note = |canvas: &mut Canvas, y: f64, text: &str| {
        canvas.text([x + 12.0, y + 4.0], Anchor::Start, 11.0, FAINT, text);
    };
    canvas.circle([x, y], 4.0, "#ffffff", INK);
    note(canvas, y, "start");
    y += PITCH;
    canvas.circle([x, y], 3.2, FAINT, "#ffffff");
    note(canvas, y, "end");
    if !report.figures.fixed.is_empty() {
        y += PITCH;
        canvas.square([x, y], 3.5, INK);
        note(canvas, y, "fixed");
    }
    if stopped {
        y += PITCH;
        canvas.cross([x, y], 4.0, FAINT);
        note(canvas, y, "ended early");
    }
    y + PITCH
}
