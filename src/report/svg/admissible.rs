//! The classic picture of a stiff spring: from where a step from rest does not enlarge its force, one
//! panel a stiffness.

use super::canvas::{Anchor, Canvas, FAINT, INK, Stroke};
use super::grid::{Layout, Panel, legend};
use super::line;
use super::palette::HOLDS;
use super::scale::Axis;
use super::{WIDTH, heading};
use crate::outcome::{Admissible, Report};
use crate::report::words;

/// Panels in one row.
const COLUMNS: usize = 3;
const LEFT: f64 = 64.0;
const GAP: f64 = 20.0;
const TOP: f64 = 62.0;
const ABOVE: f64 = 30.0;
const BELOW: f64 = 42.0;

/// The places where the spring is as long as it wants to be.
const REST: Stroke = Stroke {
    colour: "#d55e00",
    dash: "5 3",
    width: 1.4,
};

/// Whether there is such a picture.
pub fn wanted(report: &Report) -> bool {
    admissible(report).is_some()
}

fn admissible(report: &Report) -> Option<&Admissible> {
    let admissible = report.stability.as_ref()?.admissible.as_ref()?;
    (!admissible.panels.is_empty()).then_some(admissible)
}

pub fn draw(report: &Report) -> String {
    let mut canvas = Canvas::default();
    let title = heading(report, "where a step does not enlarge the force");
    canvas.text([LEFT, 24.0], Anchor::Start, 15.0, INK, &title);
    let Some(admissible) = admissible(report) else {
        return canvas.finish(WIDTH, TOP, &title);
    };
    key(&mut canvas, admissible);
    let count = admissible.panels.len();
    let columns = count.min(COLUMNS);
    let side = Layout::width(columns, LEFT, GAP).min(380.0);
    let layout = Layout {
        count,
        columns,
        left: LEFT,
        top: TOP,
        above: ABOVE,
        gap: GAP,
        size: [side, side],
    };
    for (at, stiffness) in admissible.panels.iter().enumerate() {
        let panel = Panel {
            window: layout.window(at),
            x: axis(&admissible.x1_m),
            y: axis(&admissible.x2_m),
        };
        let counts = [admissible.x1_m.len(), admissible.x2_m.len()];
        let holds = |i: usize, j: usize| {
            let line = stiffness.admitted.get(j);
            line.and_then(|line| line.as_bytes().get(i)) == Some(&b'1')
        };
        canvas.area(&panel.cells([1, 1], |_, _| true), HOLDS[1]);
        canvas.area(&panel.cells(counts, holds), HOLDS[0]);
        rest(&mut canvas, admissible, &panel);
        let title = format!(
            "K = {} N/m: {:.1} %",
            words::short(stiffness.stiffness_n_m),
            100.0 * stiffness.share
        );
        panel.frame(&mut canvas, &title, layout.sides(at));
    }
    let bottom = layout.bottom();
    canvas.text(
        [layout.middle(), bottom + 34.0],
        Anchor::Middle,
        12.0,
        FAINT,
        "x1 (m)",
    );
    let middle = TOP + ABOVE + (bottom - TOP - ABOVE) / 2.0;
    canvas.text_upward([18.0, middle], 12.0, FAINT, "x2 (m)");
    canvas.finish(WIDTH, bottom + BELOW, &title)
}

fn key(canvas: &mut Canvas, admissible: &Admissible) {
    let y = 46.0;
    let mut x = legend(canvas, [LEFT, y], HOLDS[0], "no larger");
    x = legend(canvas, [x, y], HOLDS[1], "larger");
    canvas.path(&format!("M{x:.1} {y:.1}h24"), REST);
    let text = "at rest: |x2 − x1| = L";
    canvas.text([x + 30.0, y + 4.0], Anchor::Start, 12.0, INK, text);
    x += 30.0 + 6.9 * text.chars().count() as f64 + 14.0;
    let [m1, m2] = admissible.masses_kg.map(words::short);
    let facts = format!(
        "from rest, h = {} s, m1 = {m1} kg, m2 = {m2} kg, L = {} m",
        words::short(admissible.timestep_s),
        words::short(admissible.rest_length_m)
    );
    canvas.text([x, y + 4.0], Anchor::Start, 12.0, FAINT, &facts);
}

/// From the outer edge of the first cell to that of the last.
fn axis(middles: &[f64]) -> Axis {
    let [first, last] = [middles.first(), middles.last()].map(|v| v.copied().unwrap_or(0.0));
    let half = (last - first) / (2.0 * middles.len().saturating_sub(1).max(1) as f64);
    Axis::linear([first - half, last + half])
}

fn rest(canvas: &mut Canvas, admissible: &Admissible, panel: &Panel) {
    let length = admissible.rest_length_m;
    for sign in [1.0, -1.0] {
        let ends = panel
            .x
            .range
            .map(|x1| panel.place([x1, x1 + sign * length]));
        canvas.path(&line::draw(&ends, panel.window).data, REST);
    }
}
