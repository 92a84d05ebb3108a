//! Where a value stands in the file: `springs[7].stiffness`.

use std::fmt;

/// A place under construction, borrowed from its parents: free until something is wrong with it.
#[derive(Debug, Clone, Copy)]
pub(super) enum At<'a> {
    Root,
    Key(&'a At<'a>, &'a str),
    Index(&'a At<'a>, usize),
    /// The key itself, not its value.
    Name(&'a At<'a>, &'a str),
}

/// One step down from the root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Step {
    Key(String),
    Index(usize),
    Name(String),
}

impl<'a> At<'a> {
    pub(super) fn key(&'a self, key: &'a str) -> At<'a> {
        At::Key(self, key)
    }

    /// Where the key stands, for what is wrong with the key itself.
    pub(super) fn name(&'a self, key: &'a str) -> At<'a> {
        At::Name(self, key)
    }

    pub(super) fn index(&'a self, index: usize) -> At<'a> {
        At::Index(self, index)
    }

    /// The steps from the root.
    pub(super) fn steps(&self) -> Vec<Step> {
        match *self {
            At::Root => Vec::new(),
            At::Key(parent, key) => [parent.steps(), vec![Step::Key(key.to_owned())]].concat(),
            At::Index(parent, index) => [parent.steps(), vec![Step::Index(index)]].concat(),
            At::Name(parent, key) => [parent.steps(), vec![Step::Name(key.to_owned())]].concat(),
        }
    }
}

impl fmt::Display for At<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            At::Root => Ok(()),
            At::Key(At::Root, key) => f.write_str(key),
            At::Key(parent, key) => write!(f, "{parent}.{key}"),
            At::Index(parent, index) => write!(f, "{parent}[{index}]"),
            // The message names the key.
            At::Name(parent, _) => parent.fmt(f),
        }
    }
}
