//! What a scene says that every engine must do, and the words of other stages that it may use. The scene
//! module knows none of them by itself: [`verbs::names`](crate::verbs::names) is what this
//! program knows.

use std::fmt;

/// The line of `expect` about every integrator.
pub(super) const ALL: &str = "all";
/// The line about every integrator without a line of its own.
pub(super) const REST: &str = "rest";

/// What a scene may name.
#[derive(Debug, Clone, Default)]
pub struct Names {
    /// Ids of integrators: what `solver.type` may be, and what `expect` may be about.
    pub methods: Vec<&'static str>,
    /// Ids of reference engines, which `expect` may be about.
    pub engines: Vec<&'static str>,
    /// What `expect` may say of them.
    pub keys: Vec<Key>,
}

/// A key of an outcome that a scene may expect something of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Key {
    /// Dotted, as `energy.class`.
    pub path: String,
    pub kind: KeyKind,
}

/// What stands under a key, and so how an expectation of it looks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum KeyKind {
    /// One of these words: a word or a list of those allowed.
    Word(Vec<&'static str>),
    /// A number: `below` and `above`.
    Number,
    /// A sentence: `contains`.
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

/// The engines an expectation is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Scope {
    /// Every integrator, but for the keys given for it otherwise.
    All,
    /// Every integrator that has no line of its own.
    Rest,
    /// The integrator or reference engine of this id.
    Engine(String),
}

/// What must stand under the key.
#[derive(Debug, Clone, PartialEq)]
pub enum Wanted {
    /// One of these; not empty.
    Words(Vec<String>),
    /// A number strictly between these, in the key's unit; at least one is given.
    Bounds {
        above: Option<f64>,
        below: Option<f64>,
    },
    /// A text with this in it; not empty.
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
