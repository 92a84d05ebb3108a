//! The classic picture: one panel an engine, one line a timestep, the truth in black, and below it the
//! difference to the truth on an axis of its own.

use super::canvas::{Anchor, Canvas, FAINT, INK};
use super::grid::{Layout, Panel, Sides};
use super::line::{self, Window};
use super::panels::budget;
use super::range;
use super::scale::Axis;
use super::{TRUTH_NAME, WIDTH, heading, palette, shortened};
use crate::outcome::{CostLine, CostPanel, CostPanels, Report, Status};
use crate::report::words;

/// Panels in one row; each has labels of its own.
const COLUMNS: usize = 3;
const LEFT: f64 = 70.0;
const GAP: f64 = 56.0;
const TOP: f64 = 58.0;
const ABOVE: f64 = 30.0;
const BELOW: f64 = 40.0;
/// Heights of the curves' part and of the differences', and between them.
const CURVES: f64 = 110.0;
const DIFFERENCES: f64 = 70.0;
const BETWEEN: f64 = 8.0;

/// Whether there are curves to show.
pub fn wanted(report: &Report) -> bool {
    panels(report).is_some()
}

fn panels(report: &Report) -> Option<&CostPanels> {
    let panels = report.cost.as_ref()?.panels.as_ref()?;
    let mut lines = panels.panels.iter().flat_map(|panel| &panel.lines);
    lines.any(|line| !line.curve.is_empty()).then_some(panels)
}

pub fn draw(report: &Report) -> String {
    let mut canvas = Canvas::default();
    let title = heading(report, "each step beside the truth");
    canvas.text([LEFT, 24.0], Anchor::Start, 15.0, INK, &title);
    let Some(panels) = panels(report) else {
        return canvas.finish(WIDTH, TOP, &title);
    };
    let timesteps = timesteps(panels);
    key(&mut canvas, panels, &timesteps);
    let differs = !panels.truth.is_empty();
    let count = panels.panels.len();
    let columns = count.min(COLUMNS);
    let high = if differs {
        CURVES + BETWEEN + DIFFERENCES
    } else {
        CURVES
    };
    let layout = Layout {
        count,
        columns,
        left: LEFT,
        top: TOP,
        above: ABOVE,
        gap: GAP,
        size: [Layout::width(columns, LEFT, GAP).min(420.0), high],
    };
    let lines = panels
        .panels
        .iter()
        .map(|panel| panel.lines.len())
        .sum::<usize>();
    let points = budget(2 * (lines + count));
    let [x, y] = ranges(panels);
    for (at, panel) in panels.panels.iter().enumerate() {
        let window = layout.window(at);
        let sides = layout.sides(at);
        let upper = Panel {
            window: Window {
                bottom: window.top + CURVES,
                ..window
            },
            x: Axis::linear(x),
            y: Axis::linear(y),
        };
        curve(
            &mut canvas,
            &panels.truth,
            &upper,
            palette::TRUTH_LINE,
            points,
        );
        draw_lines(&mut canvas, panel, &timesteps, &upper, points, |line| {
            &line.curve
        });
        let own = panel.engine == report.scene.own_method;
        let name = shortened(&words::one_line(&panel.engine), 32);
        let name = if own { format!("▸ {name}") } else { name };
        let outer = Sides {
            left: true,
            below: sides.below && !differs,
        };
        upper.frame_with(&mut canvas, &name, outer, 20.0);
        if differs {
            let lower = Panel {
                window: Window {
                    top: window.bottom - DIFFERENCES,
                    ..window
                },
                x: Axis::linear(x),
                y: Axis::linear(difference(panel, y)),
            };
            let [from, to] = x.map(|t| lower.place([t, 0.0]));
            canvas.line(from, to, "#b4b4b4", 1.0);
            draw_lines(&mut canvas, panel, &timesteps, &lower, points, |line| {
                &line.difference
            });
            let outer = Sides {
                left: true,
                below: sides.below,
            };
            lower.frame_with(&mut canvas, "", outer, 17.0);
        }
    }
    let bottom = layout.bottom();
    let at = [layout.middle(), bottom + 32.0];
    canvas.text(at, Anchor::Middle, 12.0, FAINT, "time (s)");
    let label = shortened(&words::one_line(&panels.label), 40);
    let label = if differs {
        format!("{label}, and its difference to the truth")
    } else {
        label
    };
    canvas.text_upward([16.0, TOP + (bottom - TOP) / 2.0], 12.0, FAINT, &label);
    canvas.finish(WIDTH, bottom + BELOW, &title)
}

/// Every step some panel has, the coarsest first.
fn timesteps(panels: &CostPanels) -> Vec<f64> {
    let lines = panels.panels.iter().flat_map(|panel| &panel.lines);
    let mut timesteps: Vec<f64> = lines.map(|line| line.timestep).collect();
    timesteps.sort_by(|a, b| b.total_cmp(a));
    timesteps.dedup();
    timesteps
}

fn key(canvas: &mut Canvas, panels: &CostPanels, timesteps: &[f64]) {
    let truth = (TRUTH_NAME.to_owned(), palette::TRUTH_LINE);
    let truth = (!panels.truth.is_empty()).then_some(truth);
    let steps = timesteps.iter().enumerate();
    let steps = steps.map(|(at, h)| (format!("h = {} s", words::short(*h)), palette::timestep(at)));
    let (mut x, y) = (LEFT, 44.0);
    for (text, stroke) in truth.into_iter().chain(steps) {
        let wide = 30.0 + 6.9 * text.chars().count() as f64 + 18.0;
        // More steps than fit are in the table.
        if x + wide > WIDTH {
            return;
        }
        canvas.path(&format!("M{x:.1} {y:.1}h24"), stroke);
        canvas.text([x + 30.0, y + 4.0], Anchor::Start, 12.0, INK, &text);
        x += wide;
    }
}

/// Time and coordinate all panels share: what the truth spans, and a little of what leaves it.
fn ranges(panels: &CostPanels) -> [[f64; 2]; 2] {
    let lines = || panels.panels.iter().flat_map(|panel| &panel.lines);
    let span = |points: &[[f64; 2]], axis: usize| range::range(points.iter().map(|p| p[axis]));
    let times = lines().filter_map(|line| span(&line.curve, 0));
    let times = times.fold(span(&panels.truth, 0), |all, t| range::union(all, Some(t)));
    let of_line = |line: &CostLine| span(&line.curve, 1);
    let calm = span(&panels.truth, 1).or_else(|| {
        let done = lines().filter(|line| line.status == Status::Completed);
        done.filter_map(of_line)
            .reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    });
    let wild: Vec<[f64; 2]> = lines().filter_map(of_line).collect();
    let shown = range::tamed(calm, &wild).unwrap_or([0.0, 1.0]);
    [times.unwrap_or([0.0, 1.0]), range::padded(shown, 0.05)]
}

/// What the differences of one panel span; those larger than what the curves' axis shows are cut.
fn difference(panel: &CostPanel, shown: [f64; 2]) -> [f64; 2] {
    let most = shown[1] / 2.0 - shown[0] / 2.0;
    let spans = panel.lines.iter().filter_map(|line| {
        let range = range::range(line.difference.iter().map(|p| p[1]))?;
        Some((line.status, range))
    });
    let is_calm = |(status, [lo, hi]): &(Status, [f64; 2])| {
        *status == Status::Completed && -most <= *lo && *hi <= most
    };
    let (calm, wild): (Vec<_>, Vec<_>) = spans.partition(is_calm);
    let calm = calm.into_iter().map(|(_, range)| range);
    let calm = calm.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]);
    let wild: Vec<[f64; 2]> = wild
        .into_iter()
        .map(|(_, range)| range.map(|end| end.clamp(-most, most)))
        .collect();
    let [lo, hi] = range::tamed(calm, &wild).unwrap_or([0.0, 0.0]);
    range::padded([lo.min(0.0), hi.max(0.0)], 0.06)
}

fn draw_lines(
    canvas: &mut Canvas,
    panel: &CostPanel,
    timesteps: &[f64],
    place: &Panel,
    points: usize,
    series: fn(&CostLine) -> &Vec<[f64; 2]>,
) {
    for line in &panel.lines {
        let at = timesteps.iter().position(|h| *h == line.timestep);
        let stroke = palette::timestep(at.unwrap_or(0));
        let end = curve(canvas, series(line), place, stroke, points);
        if let Some(end) = end.filter(|_| line.status != Status::Completed) {
            canvas.cross(end, 3.0, stroke.colour);
        }
    }
}

/// Draws the curve; its last point, where that is inside.
fn curve(
    canvas: &mut Canvas,
    values: &[[f64; 2]],
    panel: &Panel,
    stroke: super::canvas::Stroke,
    points: usize,
) -> Option<[f64; 2]> {
    let finite = values.iter().filter(|p| p.iter().all(|c| c.is_finite()));
    let pixels: Vec<[f64; 2]> = finite.map(|p| panel.place(*p)).collect();
    let last = pixels.last().copied();
    let pixels = line::until_far(pixels, panel.window);
    let heights: Vec<[f64; 1]> = pixels.iter().map(|p| [p[1]]).collect();
    let kept = line::thinned(&heights, points);
    let pixels: Vec<[f64; 2]> = kept
        .into_iter()
        .filter_map(|i| pixels.get(i).copied())
        .collect();
    let drawn = line::draw(&pixels, panel.window);
    canvas.path(&drawn.data, stroke);
    drawn.end.filter(|_| drawn.end == last)
}
