//! A panel's frame: two axes with ticks, grid, titles, and the way from values to pixels.

use super::canvas::{Anchor, Canvas, FAINT, GRID, INK};
use super::line::Window;
use super::scale::Axis;

/// Pixels left of the panel, for tick labels and the axis title.
pub const LEFT: f64 = 84.0;
/// Pixels below it.
pub const BELOW: f64 = 46.0;
const TICK: f64 = 11.0;

/// A panel in place.
pub struct Frame {
    pub window: Window,
    pub x: Axis,
    pub y: Axis,
}

impl Frame {
    /// Pixels of a pair of values; may lie outside the window.
    pub fn place(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let w = self.window;
        [
            w.left + self.x.place(x) * (w.right - w.left),
            w.bottom - self.y.place(y) * (w.bottom - w.top),
        ]
    }

    /// Grid, tick labels and titles; lines are drawn over it, the outline after them.
    pub fn ground(&self, canvas: &mut Canvas, title: &str, x_title: &str, y_title: &str) {
        let w = self.window;
        let (width, height) = (w.right - w.left, w.bottom - w.top);
        for (value, label) in self.x.ticks((width / 75.0) as usize) {
            let [x, _] = self.place([value, 0.0]);
            canvas.line([x, w.top], [x, w.bottom], GRID, 1.0);
            canvas.text([x, w.bottom + 16.0], Anchor::Middle, TICK, INK, &label);
        }
        for (value, label) in self.y.ticks((height / 32.0) as usize) {
            let [_, y] = self.place([0.0, value]);
            let colour = if value == 0.0 { "#b4b4b4" } else { GRID };
            canvas.line([w.left, y], [w.right, y], colour, 1.0);
            canvas.text([w.left - 6.0, y + 4.0], Anchor::End, TICK, INK, &label);
        }
        let middle = [(w.left + w.right) / 2.0, (w.top + w.bottom) / 2.0];
        canvas.text(
            [middle[0], w.bottom + 34.0],
            Anchor::Middle,
            12.0,
            FAINT,
            x_title,
        );
        canvas.text_upward([w.left - 66.0, middle[1]], 12.0, FAINT, y_title);
        if !title.is_empty() {
            canvas.text([w.left, w.top - 7.0], Anchor::Start, 12.0, INK, title);
        }
    }

    pub fn outline(&self, canvas: &mut Canvas) {
        let w = self.window;
        canvas.frame([w.left, w.top], [w.right - w.left, w.bottom - w.top]);
    }
}
