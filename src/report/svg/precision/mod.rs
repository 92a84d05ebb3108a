//! Work-precision diagrams: error over cost, both axes logarithmic, one line an engine with a point a
//! setting.

mod lines;

pub use lines::{Diagram, EVALUATIONS, TIME, energy, wanted};

use super::canvas::{Anchor, Canvas, FAINT, INK, Mark};
use super::frame::{BELOW, Frame, LEFT};
use super::labels::{self, Label, PITCH};
use super::line::{self, Window};
use super::{NAME, WIDTH, heading, palette, shortened};
use crate::outcome::{Cost, CostCurve, Report};
use crate::report::cost::metres;
use crate::report::words;
use lines::{Line, SMALLEST, axis, costs, errors, lines};

/// Above the panel: title and key.
const TOP: f64 = 64.0;

pub fn draw(report: &Report, diagram: Diagram) -> String {
    let lines = lines(report, diagram);
    let mut canvas = Canvas::default();
    let title = heading(report, diagram.title);
    canvas.text([LEFT, 24.0], Anchor::Start, 15.0, INK, &title);
    let Some(cost) = &report.cost else {
        return canvas.finish(WIDTH, TOP, &title);
    };
    let names: Vec<String> = lines.iter().map(|line| name(line, diagram)).collect();
    let right = WIDTH - labels::margin(names.iter().map(String::as_str));
    let height = f64::max(430.0, (lines.len() as f64 + 0.5) * PITCH);
    let frame = Frame {
        window: Window {
            left: LEFT,
            top: TOP,
            right,
            bottom: TOP + height,
        },
        x: axis(lines.iter().flat_map(costs)),
        y: errors(cost, &lines, diagram),
    };
    floor(&mut canvas, cost, &frame, diagram);
    frame.ground(&mut canvas, "", diagram.x_title, diagram.y_title);
    targets(&mut canvas, cost, &frame, diagram);
    // The scene's own last: its line lies over the others.
    let own = |line: &Line| line.curve.engine == report.scene.own_method;
    for line in lines.iter().filter(|line| !own(line)) {
        draw_line(&mut canvas, line, &frame, diagram);
    }
    for line in lines.iter().filter(|line| own(line)) {
        draw_line(&mut canvas, line, &frame, diagram);
    }
    frame.outline(&mut canvas);
    let notes = lines.iter().zip(names);
    let notes: Vec<Label> = notes
        .filter_map(|(line, text)| label(&mut canvas, line, text, &frame))
        .collect();
    labels::draw(&mut canvas, notes, right, TOP, frame.window.bottom);
    key(&mut canvas, &lines, diagram);
    let bottom = frame.window.bottom + BELOW + 2.0;
    let Some(note) = silent(cost, &lines) else {
        return canvas.finish(WIDTH, bottom, &title);
    };
    let at = [LEFT, bottom + 6.0];
    canvas.text(at, Anchor::Start, 11.0, FAINT, &note);
    canvas.finish(WIDTH, bottom + 16.0, &title)
}

fn name(line: &Line, diagram: Diagram) -> String {
    let name = shortened(&words::one_line(&line.curve.engine), NAME);
    match line.curve.observed_order {
        Some(order) if diagram.judged && order.abs() < 99.5 => format!("{name}, slope {order:.2}"),
        _ => name,
    }
}

/// Grey from the floor down.
fn floor(canvas: &mut Canvas, cost: &Cost, frame: &Frame, diagram: Diagram) {
    let Some(floor) = cost.floor_m.filter(|floor| diagram.judged && *floor > 0.0) else {
        return;
    };
    let w = frame.window;
    let [_, y] = frame.place([1.0, floor]);
    let y = y.max(w.top);
    if y < w.bottom {
        let (left, right, bottom) = (w.left, w.right, w.bottom);
        let data = format!("M{left:.1} {bottom:.1}H{right:.1}V{y:.1}H{left:.1}Z");
        canvas.area(&data, palette::BELOW_FLOOR);
    }
}

fn targets(canvas: &mut Canvas, cost: &Cost, frame: &Frame, diagram: Diagram) {
    let w = frame.window;
    for target in cost.targets.iter().filter(|_| diagram.judged) {
        let [_, y] = frame.place([1.0, target.error_m]);
        if target.error_m > 0.0 && (w.top..=w.bottom).contains(&y) {
            let data = format!("M{:.1} {y:.1}H{:.1}", w.left, w.right);
            canvas.path(&data, palette::TARGET);
            let text = format!("{} m", metres(target.error_m));
            canvas.text([w.left + 5.0, y - 4.0], Anchor::Start, 10.0, FAINT, &text);
        }
    }
}

fn draw_line(canvas: &mut Canvas, line: &Line, frame: &Frame, diagram: Diagram) {
    let w = frame.window;
    let colour = line.stroke.colour;
    let place = |values: [f64; 2]| {
        let [x, y] = frame.place(values);
        [x, y.clamp(w.top, w.bottom)]
    };
    let pixels: Vec<[f64; 2]> = line
        .points
        .iter()
        .map(|(_, values)| place(*values))
        .collect();
    canvas.path(&line::draw(&pixels, w).data, line.stroke);
    for ((at, [_, error]), pixel) in line.points.iter().zip(&pixels) {
        let wall = line.curve.points.get(*at).and_then(|p| p.wall_s.as_ref());
        if let Some(wall) = wall.filter(|_| diagram.timed) {
            let ends = [wall.min, wall.median + wall.mad.unwrap_or(0.0)];
            let [left, right] = ends.map(|end| place([end.max(SMALLEST), *error])[0]);
            // Within the mark itself a whisker says nothing.
            if left >= w.left && right <= w.right && right - left > 12.0 {
                canvas.line([left, pixel[1]], [right, pixel[1]], colour, 1.0);
            }
        }
        let filled = !diagram.judged || line.curve.pareto.contains(at);
        let fill = if filled { colour } else { "#ffffff" };
        canvas.mark(*pixel, line.mark, fill, colour);
    }
    for cost in &line.ended {
        let [x, _] = frame.place([*cost, 1.0]);
        canvas.cross([x, w.top + 7.0], 3.5, colour);
    }
}

/// Beside the panel, led to from the line's finest point.
fn label(canvas: &mut Canvas, line: &Line, text: String, frame: &Frame) -> Option<Label> {
    let w = frame.window;
    let (_, last) = line.points.last()?;
    let [x, y] = frame.place(*last);
    let y = y.clamp(w.top, w.bottom);
    canvas.line([x + 5.0, y], [w.right, y], FAINT, 0.3);
    Some(Label {
        text,
        stroke: line.stroke,
        mark: Some(line.mark),
        exit: Some(y),
        wish: y,
    })
}

/// What the marks mean, in the line below the title.
fn key(canvas: &mut Canvas, lines: &[Line], diagram: Diagram) {
    let y = 46.0;
    let mut x = LEFT + 4.0;
    let mut entry = |canvas: &mut Canvas, text: &str| {
        canvas.text([x + 8.0, y + 4.0], Anchor::Start, 11.0, FAINT, text);
        x += 8.0 + 5.5 * text.chars().count() as f64 + 22.0;
        x
    };
    if diagram.judged {
        canvas.mark([LEFT + 4.0, y], Mark::Disc, FAINT, FAINT);
        let next = entry(
            canvas,
            "none of its settings beats it in error and evaluations",
        );
        canvas.mark([next, y], Mark::Disc, "#ffffff", FAINT);
        let next = entry(canvas, "beaten");
        if lines.iter().any(|line| !line.ended.is_empty()) {
            canvas.cross([next, y], 3.5, FAINT);
            entry(
                canvas,
                "diverged or failed, at what all its steps would cost",
            );
        }
    } else if lines.iter().any(|line| !line.ended.is_empty()) {
        canvas.cross([LEFT + 4.0, y], 3.5, FAINT);
        entry(
            canvas,
            "diverged or failed, at what all its steps would cost",
        );
    }
}

/// Who has settings but no line here.
fn silent(cost: &Cost, lines: &[Line]) -> Option<String> {
    let drawn = |curve: &&CostCurve| lines.iter().any(|line| std::ptr::eq(line.curve, *curve));
    let names = cost.curves.iter().filter(|curve| !drawn(curve));
    let names: Vec<String> = names
        .map(|curve| shortened(&words::one_line(&curve.engine), NAME))
        .collect();
    (!names.is_empty()).then(|| {
        let text = format!("without numbers for this: {}", names.join(", "));
        shortened(&text, 130)
    })
}
