//! Figures as SVG, written by hand: no network, no fonts, equal bytes for equal input.

mod axis;
mod canvas;
mod chart;
mod key;
mod marks;
pub mod palette;

pub use axis::{Axis, HUGE, Scale, padded, range, span, tamed};
pub use canvas::{FAINT, INK, Shape, Stroke, Symbol, WHITE};
pub use chart::{Chart, Panel};
pub use key::{Key, Look};
pub use marks::{Line, Mark, cells};

use super::words::one_line;
use super::{Header, OWN};

/// Pixels; what a page of text is wide.
pub const WIDTH: f64 = 880.0;
/// What labels call the truth.
pub const TRUTH_NAME: &str = "truth";
/// Characters of an engine's name that labels have room for.
const NAME: usize = 30;

/// A figure's title: the scene, then what is shown.
pub fn heading(header: &Header, shown: &str) -> String {
    format!(
        "{}: {}",
        shortened(&header.scene.name, 45),
        shortened(shown, 50)
    )
}

/// An engine as labels call it.
pub fn engine(name: &str) -> String {
    shortened(name, NAME)
}

/// A panel's title where each engine has one; the scene's own integrator is pointed at.
pub fn panel_title(header: &Header, name: &str) -> String {
    match header.mark(name) {
        OWN => format!("{OWN} {}", engine(name)),
        _ => engine(name),
    }
}

/// One line of so many characters at most.
pub fn shortened(text: &str, characters: usize) -> String {
    let text = one_line(text);
    if text.chars().count() <= characters {
        return text;
    }
    let head: String = text.chars().take(characters - 1).collect();
    head + "…"
}

/// A picture: its file; what it shows, for those who do not see it; and what there is to draw, None where
/// the report does not have what it takes.
pub type Figure<R> = (&'static str, &'static str, fn(&R) -> Option<Chart>);
