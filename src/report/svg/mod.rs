//! Figures as SVG, written by hand: no network, no fonts, equal bytes for equal input.

mod axis;
mod canvas;
mod chart;
mod key;
mod marks;
pub mod palette;

pub use axis::{ChartAxis, HUGE, Scale, padded, range, span, tamed};
pub use canvas::{FAINT, INK, Stroke, Symbol, SymbolShape, WHITE};
pub use chart::{Chart, Panel};
pub use key::{LegendEntry, Look};
pub use marks::{Mark, Polyline, cells};

use super::words::one_line;
use super::{Header, OWN};

/// The width of a figure, pixels: that of a page of text.
pub const WIDTH: f64 = 880.0;
/// The name of the truth in labels.
pub const TRUTH_NAME: &str = "truth";
/// The most characters of an engine's name in a label.
const MAX_NAME: usize = 30;

/// A figure's title: the scene, then what is shown.
pub fn heading(header: &Header, shown: &str) -> String {
    format!(
        "{}: {}",
        shortened(&header.scene.name, 45),
        shortened(shown, 50)
    )
}

/// The name of an engine in labels.
pub fn engine(name: &str) -> String {
    shortened(name, MAX_NAME)
}

/// The title of an engine's panel; the scene's own integrator is marked.
pub fn panel_title(header: &Header, name: &str) -> String {
    match header.mark(name) {
        OWN => format!("{OWN} {}", engine(name)),
        _ => engine(name),
    }
}

/// The text on one line of at most this many characters.
pub fn shortened(text: &str, characters: usize) -> String {
    let text = one_line(text);
    if text.chars().count() <= characters {
        return text;
    }
    let head: String = text.chars().take(characters - 1).collect();
    head + "…"
}

/// A picture: its file name; a description for readers who do not see it; and its chart, None where the
/// report has no data for it.
pub type Figure<R> = (&'static str, &'static str, fn(&R) -> Option<Chart>);
