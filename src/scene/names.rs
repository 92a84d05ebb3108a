//! The words of other stages that a scene may use. The scene module knows none of them by itself:
//! [`verbs::names`](crate::verbs::names) is what this program knows.

/// What a scene may name.
#[derive(Debug, Clone, Default)]
pub struct Names {
    /// Ids of integrators: what `solver.type` may be, and whom `expect` may be about.
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
