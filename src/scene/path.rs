//! Where a value stands in the file: `springs[7].stiffness`.

use std::fmt;

/// A place under construction, borrowed from its parents: free until something is wrong with it.
#[derive(Debug, Clone, Copy)]
pub(super) enum At<'a> {
    Root,
    Key(&'a At<'a>, &'static str),
    Index(&'a At<'a>, usize),
}

/// One step down from the root.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Step {
    Key(&'static str),
    Index(usize),
}

impl<'a> At<'a> {
    pub(super) fn key(&'a self, key: &'static str) -> At<'a> {
        At::Key(self, key)
    }

    pub(super) fn index(&'a self, index: usize) -> At<'a> {
        At::Index(self, index)
    }

    /// The steps from the root.
    pub(super) fn steps(&self) -> Vec<Step> {
        match *self {
            At::Root => Vec::new(),
            At::Key(parent, key) => [parent.steps(), vec![Step::Key(key)]].concat(),
            At::Index(parent, index) => [parent.steps(), vec![Step::Index(index)]].concat(),
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
        }
    }
}
