//! What the reports of all verbs share: how findings become bytes. Nothing here touches files or the
//! terminal, and nothing but the report decides what is shown.

mod header;
pub mod json;
pub mod markdown;
pub mod svg;
pub mod table;
pub mod terminal;
pub mod verdict;
pub mod words;

pub use header::{EffectUse, Header, OWN, SceneFacts, TruthFacts, UNRANKED};

use verdict::Clause;

/// What one verb has to say of its findings; the rest of a report is the same for all verbs.
pub struct View<'a> {
    pub header: &'a Header,
    /// The step of each outcome, s; none where the verb takes steps of its own choice.
    pub timesteps: Vec<f64>,
    /// The verdict, but for failed checks, which come first: in the order they are said, which is mostly
    /// that of their importance.
    pub clauses: Vec<Clause>,
    /// What holds of the whole scene: label and text.
    pub facts: Vec<(&'static str, String)>,
    /// In the terminal: what stands between the facts and the notes.
    pub lines: Vec<String>,
    /// What there is to say of single engines.
    pub notes: Vec<Note>,
    /// In the terminal: what follows the checks, label and text.
    pub last: Vec<(&'static str, String)>,
}

/// One sentence, and the engines it is about.
pub struct Note {
    /// Such as `rapier` or `explicit_euler at h = 0.15`.
    pub subject: String,
    pub sentence: String,
}

impl Note {
    /// Sentences with the engines they are about. Equal sentences stand once, with one text for all
    /// their subjects.
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
