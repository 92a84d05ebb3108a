//! Panels full of cells, as small multiples: ticks on every panel's outside only where neighbours do
//! not share them, and cells of one colour as one path.

use super::WIDTH;
use super::canvas::{Anchor, Canvas, FAINT, INK, px};
use super::line::Window;
use super::scale::Axis;

const TICK: f64 = 10.0;

/// A panel in place, cells from edge to edge.
pub struct Panel {
    pub window: Window,
    pub x: Axis,
    pub y: Axis,
}

/// Panels of one size, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    pub count: usize,
    pub columns: usize,
    /// Pixels: left of the first panel, and above the title of the first row.
    pub left: f64,
    pub top: f64,
    /// Room for a panel's title, and between panels of one row.
    pub above: f64,
    pub gap: f64,
    /// Width and height of one.
    pub size: [f64; 2],
}

impl Layout {
    /// The width one of `columns` panels may have.
    pub fn width(columns: usize, left: f64, gap: f64) -> f64 {
        let columns = columns.max(1) as f64;
        (WIDTH - left - 12.0 - gap * (columns - 1.0)) / columns
    }

    pub fn window(&self, at: usize) -> Window {
        let columns = self.columns.max(1);
        let [wide, high] = self.size;
        let left = self.left + (at % columns) as f64 * (wide + self.gap);
        let top = self.top + self.above + (at / columns) as f64 * (high + self.above);
        Window {
            left,
            top,
            right: left + wide,
            bottom: top + high,
        }
    }

    /// Labels stand where no neighbour has the same.
    pub fn sides(&self, at: usize) -> Sides {
        Sides {
            left: at.is_multiple_of(self.columns.max(1)),
            below: at + self.columns >= self.count,
        }
    }

    /// Where the last row ends.
    pub fn bottom(&self) -> f64 {
        let rows = self.count.div_ceil(self.columns.max(1));
        self.top + rows as f64 * (self.size[1] + self.above)
    }

    /// Halfway along a full row.
    pub fn middle(&self) -> f64 {
        let full = self.columns as f64 * (self.size[0] + self.gap) - self.gap;
        self.left + full / 2.0
    }
}

/// Which sides of a panel carry tick labels.
#[derive(Debug, Clone, Copy)]
pub struct Sides {
    pub left: bool,
    pub below: bool,
}

impl Panel {
    /// Pixels of a pair of values; may lie outside.
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let w = self.window;
        [
            w.left + self.x.place(x) * (w.right - w.left),
            w.bottom - self.y.place(y) * (w.bottom - w.top),
        ]
    }

    /// The cells for which `belongs` holds as one path; runs along y are one rectangle. `counts` are
    /// columns along x and rows along y, the first row below.
    pub fn cells(&self, counts: [usize; 2], belongs: impl Fn(usize, usize) -> bool) -> String {
        let w = self.window;
        let [columns, rows] = counts;
        let x = |i: usize| w.left + (w.right - w.left) * i as f64 / columns as f64;
        let y = |j: usize| w.bottom - (w.bottom - w.top) * j as f64 / rows as f64;
        let mut data = String::new();
        for i in 0..columns {
            let mut j = 0;
            while j < rows {
                let start = j;
                while j < rows && belongs(i, j) {
                    j += 1;
                }
                if j == start {
                    j += 1;
                    continue;
                }
                let (left, right, top, bottom) = (px(x(i)), px(x(i + 1)), px(y(j)), px(y(start)));
                data += &format!("M{left} {bottom}H{right}V{top}H{left}Z");
            }
        }
        data
    }

    /// Title above, outline, ticks outside.
    pub fn frame(&self, canvas: &mut Canvas, title: &str, sides: Sides) {
        self.frame_with(canvas, title, sides, 24.0);
    }

    /// The same with ticks along y about `pitch` pixels apart.
    pub fn frame_with(&self, canvas: &mut Canvas, title: &str, sides: Sides, pitch: f64) {
        let w = self.window;
        let (width, height) = (w.right - w.left, w.bottom - w.top);
        canvas.frame([w.left, w.top], [width, height]);
        canvas.text([w.left, w.top - 6.0], Anchor::Start, 11.0, INK, title);
        for (value, label) in self.x.ticks((width / 42.0) as usize) {
            let [x, _] = self.place([value, self.y.range[0]]);
            if x < w.left - 0.5 || x > w.right + 0.5 {
                continue;
            }
            canvas.line([x, w.bottom], [x, w.bottom + 4.0], FAINT, 1.0);
            if sides.below {
                // Pushed inward at the edges: the next panel's labels begin there.
                let half = 3.0 * label.chars().count() as f64;
                let x = x.max(w.left - 4.0 + half).min(w.right + 4.0 - half);
                canvas.text([x, w.bottom + 15.0], Anchor::Middle, TICK, INK, &label);
            }
        }
        for (value, label) in self.y.ticks((height / pitch) as usize) {
            let [_, y] = self.place([self.x.range[0], value]);
            if y < w.top - 0.5 || y > w.bottom + 0.5 {
                continue;
            }
            canvas.line([w.left - 4.0, y], [w.left, y], FAINT, 1.0);
            if sides.left {
                canvas.text([w.left - 7.0, y + 3.5], Anchor::End, TICK, INK, &label);
            }
        }
    }
}

/// A swatch and what it stands for; returns where the next may start.
pub fn legend(canvas: &mut Canvas, [x, y]: [f64; 2], colour: &str, text: &str) -> f64 {
    canvas.square([x + 6.0, y], 6.0, colour);
    canvas.frame([x, y - 6.0], [12.0, 12.0]);
    canvas.text([x + 18.0, y + 4.0], Anchor::Start, 12.0, INK, text);
    x + 18.0 + 6.9 * text.chars().count() as f64 + 20.0
}
