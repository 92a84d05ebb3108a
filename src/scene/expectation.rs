//! The expectations a scene states of each engine, and the ids and words it may use in them. These come
//! from other modules, by [`verbs::names`](crate::verbs::names): the scene module defines none itself.

use std::fmt;

/// The line of `expect` about every integrator.
pub(crate) const ALL: &str = "all";
/// The line about every integrator without a line of its own.
pub(crate) const REST: &str = "rest";
/// The line that names checks which are not made.
pub(crate) const SKIP: &str = "skip";

/// The ids, keys and words of other modules that a scene may name.
#[derive(Debug, Clone, Default)]
pub struct Names {
    /// Ids of integrators, for `solver.type` and for `expect`.
    pub methods: Vec<&'static str>,
    /// Short ids, each with the id it means, which the scene then holds.
    pub aliases: &'static [(&'static str, &'static str)],
    /// Ids of reference engines, for `expect`.
    pub engines: Vec<&'static str>,
    /// Names of other programs that run beside them, for `expect`.
    pub externals: Vec<String>,
    /// Ids of checks, for `expect.skip`.
    pub checks: Vec<&'static str>,
    /// The keys an expectation may be about.
    pub keys: Vec<OutcomeKey>,
}

impl Names {
    /// The id that a word of the file means.
    pub(super) fn meant<'a>(&self, word: &'a str) -> &'a str {
        let alias = self.aliases.iter().find(|(short, _)| *short == word);
        alias.map_or(word, |(_, id)| id)
    }
}

/// A key of an outcome that an expectation may be about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OutcomeKey {
    /// Dotted, as `energy.class`.
    pub path: String,
    pub kind: KeyKind,
}

/// The kind of value under a key, which decides how an expectation of it is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KeyKind {
    /// One of these words. The expectation is a word, or a list of those allowed.
    Word(Vec<&'static str>),
    /// A number. The expectation has `below` and `above`.
    Number,
    /// A sentence. The expectation has `contains`.
    Text,
}

/// One key of one line of `expect`, about the outcome at the scene's own timestep.
#[derive(Debug, Clone, PartialEq)]
pub struct Expectation {
    pub scope: Scope,
    /// Dotted path into an outcome, as `energy.class`.
    pub key: String,
    pub wanted: Wanted,
}

/// A check that a scene does not want, as its `expect.skip` says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Skipped {
    /// The id of the check.
    pub check: String,
    /// Why it says nothing about this scene; not empty.
    pub reason: String,
}

/// The engines an expectation is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// Every integrator, except for keys that its own line or `rest` states.
    All,
    /// Every integrator that has no line of its own.
    Rest,
    /// The integrator, reference engine or other program of this id.
    Engine(String),
}

/// The value that is expected under the key.
#[derive(Debug, Clone, PartialEq)]
pub enum Wanted {
    /// One of these words; the list is not empty.
    Words(Vec<String>),
    /// A number strictly between these, in the key's unit; at least one is given.
    Bounds {
        above: Option<f64>,
        below: Option<f64>,
    },
    /// A text that contains this one, which is not empty.
    Contains(String),
}

impl fmt::Display for Scope {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::All => ALL,
            Self::Rest => REST,
            Self::Engine(id) => id,
        })
    }
}

impl fmt::Display for Wanted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Words(words) => f.write_str(&words.join(" or ")),
            Self::Bounds { above, below } => match (above, below) {
                (Some(above), Some(below)) => write!(f, "above {above:?} and below {below:?}"),
                (Some(above), None) => write!(f, "above {above:?}"),
                (None, Some(below)) => write!(f, "below {below:?}"),
                (None, None) => f.write_str("anything"),
            },
            Self::Contains(text) => write!(f, "text with `{text}` in it"),
        }
    }
}
