//! Figures as SVG, written by hand: no network, no fonts, equal bytes for equal input.

pub mod axis;
pub mod canvas;
pub mod chart;
pub mod key;
pub mod marks;
pub mod palette;

use super::{Shown, words};
use chart::Chart;

/// Pixels; what a page of text is wide.
pub const WIDTH: f64 = 880.0;
/// What labels call the truth.
pub const TRUTH_NAME: &str = "truth";
/// Characters of an engine's name that labels have room for.
pub const NAME: usize = 30;

/// One kind of picture.
pub struct Figure<R> {
    pub file: &'static str,
    /// What the picture shows, for those who do not see it.
    pub description: &'static str,
    /// What there is to draw; `None` where the report does not have what it takes.
    pub chart: fn(&R) -> Option<Chart>,
}

impl<R> Figure<R> {
    /// Whether the report has what it takes.
    pub fn wanted(&self, report: &R) -> bool {
        (self.chart)(report).is_some()
    }
}

/// The figures this report has data for.
pub fn wanted<R: Shown>(report: &R) -> impl Iterator<Item = &'static Figure<R>> {
    let figures = report.view().figures().iter();
    figures.filter(|figure| figure.wanted(report))
}

/// Those figures: file name and SVG.
pub fn figures<R: Shown>(report: &R) -> Vec<(&'static str, String)> {
    let drawn = |figure: &Figure<R>| Some((figure.file, (figure.chart)(report)?.draw()));
    report.view().figures().iter().filter_map(drawn).collect()
}

/// A figure's title: the scene, then what is shown.
pub fn heading<R: Shown>(report: &R, shown: &str) -> String {
    let scene = shortened(&words::one_line(&report.header().scene.name), 45);
    format!("{scene}: {}", shortened(&words::one_line(shown), 50))
}

/// A panel's title where each engine has one; the scene's own integrator is pointed at.
pub fn panel_title<R: Shown>(report: &R, engine: &str) -> String {
    let name = shortened(&words::one_line(engine), NAME);
    if engine == report.header().scene.own_integrator {
        return format!("▸ {name}");
    }
    name
}

pub fn shortened(text: &str, characters: usize) -> String {
    if text.chars().count() <= characters {
        return text.to_string();
    }
    let head: String = text.chars().take(characters - 1).collect();
    head + "…"
}
