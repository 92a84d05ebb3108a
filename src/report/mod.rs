//! What the reports of all verbs share: how findings become bytes. Nothing here touches files or the
//! terminal, and nothing but the report decides what is shown.
//!
//! What is particular to one verb's reports is its [`View`].

mod header;
pub mod json;
pub mod markdown;
pub mod notes;
pub mod svg;
pub mod table;
pub mod terminal;
pub mod verdict;
pub mod words;

pub use header::{EffectUse, Header, SceneFacts, TruthFacts};

use notes::Note;
use svg::Figure;
use verdict::Clause;

/// What can be shown: a report of some verb.
pub trait Shown: Sized + 'static {
    fn header(&self) -> &Header;

    /// The one place that tells verbs apart.
    fn view(&self) -> &dyn View<Self>;
}

/// How what one verb found is shown: the findings themselves know.
pub trait View<R: Shown> {
    /// What its files are called, without the dot and what follows: verbs do not write over each
    /// other's.
    fn stem(&self) -> &'static str;

    /// The step of each outcome, s; none where the verb takes steps of its own choice.
    fn timesteps(&self) -> Vec<f64> {
        Vec::new()
    }

    /// The figures it may have, in the order they are shown.
    fn figures(&self) -> &'static [Figure<R>];

    /// The verdict, but for failed checks, which come first: in the order they are said, which is mostly
    /// that of their importance.
    fn clauses(&self, report: &R) -> Vec<Clause>;

    /// What holds of the whole scene: label and text.
    fn facts(&self, report: &R) -> Vec<(&'static str, String)>;

    /// In the terminal: what stands between the facts and the notes.
    fn lines(&self, report: &R) -> Vec<String>;

    /// What there is to say of single engines.
    fn notes(&self, report: &R) -> Vec<Note>;

    /// In the terminal: what follows the checks, label and text.
    fn last(&self, _report: &R) -> Vec<(&'static str, String)> {
        Vec::new()
    }

    /// The whole page, with its figures linked as files beside it.
    fn markdown(&self, report: &R) -> String;
}
