//! The entries of legends and labels: a text, and the look of what it names.

use super::canvas::{Align, Canvas, FAINT, INK, Stroke, Symbol};

/// Width of the piece of line before a text, and of a character (a generous estimate), pixels.
pub const SWATCH: f64 = 24.0;
pub const CHARACTER: f64 = 6.9;

/// A text and the look of what it names.
pub struct LegendEntry {
    pub text: String,
    pub look: Look,
    /// The engine it names, by its id on a page.
    pub engine: Option<String>,
}

/// The sign before a text that shows what it names.
#[derive(Clone, Copy)]
pub enum Look {
    /// No sign: the text is a remark.
    Remark,
    Line(Stroke),
    /// A line whose points are marked.
    Marked(Stroke, Symbol),
    Symbol(Symbol),
    Fill(&'static str),
}

impl LegendEntry {
    pub fn new(text: impl Into<String>, look: Look) -> LegendEntry {
        LegendEntry {
            text: text.into(),
            look,
            engine: None,
        }
    }

    /// The same, of this engine.
    #[must_use]
    pub fn of(self, engine: Option<String>) -> LegendEntry {
        LegendEntry { engine, ..self }
    }

    /// Draws the look within `wide` pixels from `at` on, and the text after it.
    pub fn draw(&self, canvas: &mut Canvas, at: [f64; 2], wide: f64) {
        let [x, y] = at;
        let (middle, piece) = ([x + wide / 2.0, y], format!("M{x:.1} {y:.1}h{wide}"));
        let mut colour = INK;
        canvas.open(self.engine.as_deref(), &[]);
        match self.look {
            Look::Remark => colour = FAINT,
            Look::Line(stroke) => canvas.path(&piece, stroke),
            Look::Marked(stroke, symbol) => {
                canvas.path(&piece, stroke);
                canvas.symbol(middle, symbol);
            }
            Look::Symbol(symbol) => canvas.symbol(middle, symbol),
            Look::Fill(fill) => canvas.rectangle([x, y - 6.0], [12.0, 12.0], fill, FAINT),
        }
        let at = [x + wide + 6.0, y + 4.0];
        canvas.text(at, Align::Start, 12.0, colour, &self.text);
        canvas.close(self.engine.as_deref());
    }

    /// Width of the text with the gaps before and after it, pixels.
    pub fn width(&self) -> f64 {
        6.0 + CHARACTER * self.text.chars().count() as f64 + 10.0
    }
}
