//! The parts of a report that all verbs use: they turn findings into bytes. Nothing here touches files or
//! the terminal, and the report alone decides what is shown.

pub mod github;
mod header;
pub mod json;
pub mod junit;
pub mod markdown;
pub mod names;
pub mod page;
pub mod svg;
pub mod table;
pub mod terminal;
pub mod verdict;
pub mod words;

pub use header::{EffectUse, Header, OWN, SceneFacts, TruthFacts, UNRANKED};

use schemars::JsonSchema;
use serde::Serialize;
use verdict::Clause;

/// The parts of a report that differ between verbs; the rest is the same for all.
pub struct View<'a> {
    /// The columns of a line in the terminal.
    pub columns: usize,
    pub header: &'a Header,
    /// The timestep of each outcome, s; empty where the verb chooses its own steps.
    pub timesteps: Vec<f64>,
    /// The clauses of the verdict in order, the most important first. Failed checks are added before them.
    pub clauses: Vec<Clause>,
    /// Facts about the whole scene: label and text.
    pub facts: Vec<(&'static str, String)>,
    /// In the terminal, the lines between the facts and the notes.
    pub lines: Vec<String>,
    /// Notes on single engines.
    pub notes: Vec<Note>,
    /// In the terminal, the lines after the checks: label and text.
    pub last: Vec<(&'static str, String)>,
}

/// One sentence, and the engines it is about.
#[derive(Debug, Clone, Serialize, JsonSchema)]
pub struct Note {
    /// The engines, such as `rapier` or `explicit_euler at h = 0.15`.
    pub subject: String,
    /// What there is to say of them.
    pub sentence: String,
}

impl Note {
    /// Notes from sentences and the engines they are about. Equal sentences become one note, with one text
    /// for all their subjects.
    pub fn of<S>(
        said: impl Iterator<Item = (S, String)>,
        subject: impl Fn(&[S]) -> String,
    ) -> Vec<Note> {
        let note = |(sentence, subjects): (String, Vec<S>)| Note {
            subject: subject(&subjects),
            sentence,
        };
        words::grouped(said).into_iter().map(note).collect()
    }
}
