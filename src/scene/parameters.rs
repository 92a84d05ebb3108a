//! The one table of what a scene file may say: every key with its kind, unit and bounds, its place in the
//! [`Scene`], its default and what it is for.
//!
//! Reading and its messages, `--vary`, the flat arrays of [`external`](crate::solvers::external) and the key of
//! the [converged truth](crate::truth::converged) are derived from it. The model declares its fields
//! and their rows in one place, so that there is no field without a row.

use super::error::Refusal;
use super::expectation::Names;
use super::limits::Quantity;
use super::model::{Axis, DampingModel, Scene};
pub use super::model::{GRAVITATIONAL, PARTICLES, PLOT, SCENE, SOLVER, SPRINGS, WIND};

/// All parts: the file itself, then what it has rows for, in the order of its keys.
pub static PARTS: [&Part; 7] = [
    &SCENE,
    &SOLVER,
    &PLOT,
    &PARTICLES,
    &SPRINGS,
    &GRAVITATIONAL,
    &WIND,
];

/// One mapping of the file, or each of a list of them.
pub struct Part {
    /// `springs`; `file` for the file itself.
    pub key: &'static str,
    /// Whether the file has a list of such mappings.
    pub list: bool,
    /// What stands there, in a message's words.
    pub(super) expected: &'static str,
    /// Keys the format names, but this version does not read.
    pub(super) later: &'static [&'static str],
    pub rows: &'static [Row],
    /// How many members the scene has: 0 or 1 of what is no list.
    pub count: fn(&Scene) -> usize,
    /// Adds one with all its defaults, where there can be more.
    pub add: fn(&mut Scene),
}

/// One key of a mapping.
pub struct Row {
    pub key: &'static str,
    /// What it is, for its reader.
    pub summary: &'static str,
    pub kind: Kind,
    pub absent: Absent,
    /// Its name among the flat arrays; several rows may have a share in one. None of what has no say in
    /// the motion, and so does not count in the truth's key either.
    pub flat: Option<&'static str>,
    /// The value of the member of this index; None where there is none.
    pub get: fn(&Scene, usize) -> Option<Value<'_>>,
    /// Sets it, unjudged. A value of another kind or of a member that is not there changes nothing.
    pub set: fn(&mut Scene, usize, Value<'_>),
}

/// What stands under a key.
pub enum Kind {
    Number(Quantity),
    /// A list of so many numbers, at most three.
    Numbers(usize, Quantity),
    /// The id of a particle, or a list of two.
    Ids(usize),
    /// 0, 1 or 2 for x, y, z.
    Coordinate,
    /// `true` or `false`.
    Flag,
    /// One of these.
    Word(&'static [&'static str]),
    /// Text in which this finds no fault.
    Text(fn(&str, &Names) -> Result<(), Refusal>),
    /// A mapping or a list of them, with rows of its own.
    Part(&'static Part),
    /// What engines must do, by engine and key.
    Expect,
}

/// What a file means that leaves the key out.
pub enum Absent {
    /// Nothing: it is refused, with this advice.
    Required(&'static str),
    /// The default of the model.
    Default,
    /// What follows from the rest of the scene.
    Derived,
}

/// A value of any key, lent by whoever holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Value<'a> {
    /// One or several, in the row's unit.
    Numbers(&'a [f64]),
    /// Particles; a coordinate.
    Ids(&'a [usize]),
    Flag(bool),
    Text(&'a str),
}

/// A field of the model as a [`Value`]; nothing of what has rows of its own.
pub(super) trait Field {
    fn value(&self) -> Option<Value<'_>> {
        None
    }

    fn put(&mut self, _: Value<'_>) {}
}

macro_rules! fields {
    ($($type:ty: $field:ident => $value:expr, $($given:pat => $taken:expr),+;)*) => {
        $(impl Field for $type {
            fn value(&self) -> Option<Value<'_>> {
                let $field = self;
                Some($value)
            }

            fn put(&mut self, value: Value<'_>) {
                match value {
                    $($given => *self = $taken,)+
                    _ => {}
                }
            }
        })*
    };
}

fields! {
    f64: field => Value::Numbers(std::slice::from_ref(field)), Value::Numbers(&[x]) => x;
    [f64; 2]: field => Value::Numbers(field), Value::Numbers(&[x, y]) => [x, y];
    [f64; 3]: field => Value::Numbers(field), Value::Numbers(&[x, y, z]) => [x, y, z];
    usize: field => Value::Ids(std::slice::from_ref(field)), Value::Ids(&[id]) => id;
    [usize; 2]: field => Value::Ids(field), Value::Ids(&[a, b]) => [a, b];
    bool: field => Value::Flag(*field), Value::Flag(flag) => flag;
    String: field => Value::Text(field), Value::Text(text) => text.to_owned();
    Axis: field => Value::Text(["x", "y", "z"][field.index()]),
        Value::Text("x") => Axis::X, Value::Text("y") => Axis::Y, Value::Text("z") => Axis::Z;
    DampingModel: field => Value::Text(["axial", "isotropic"][*field as usize]),
        Value::Text("axial") => DampingModel::Axial,
        Value::Text("isotropic") => DampingModel::Isotropic;
}

impl<T: Field + Default> Field for Option<T> {
    fn value(&self) -> Option<Value<'_>> {
        self.as_ref()?.value()
    }

    fn put(&mut self, value: Value<'_>) {
        self.get_or_insert_default().put(value);
    }
}

impl<T> Field for Vec<T> {}

/// Where the members of a part are: the slice of them, or the place of one more.
macro_rules! members {
    (list, $scene:ident, $part:ident, $of:ident) => {
        $scene.$part.$of()
    };
    (maybe, $scene:ident, $part:ident, $of:ident) => {
        $scene.$part.$of()
    };
    (one, $scene:ident, $part:ident, as_slice) => {
        std::slice::from_ref(&$scene.$part)
    };
    (one, $scene:ident, $part:ident, as_mut_slice) => {
        std::slice::from_mut(&mut $scene.$part)
    };
    (the, $scene:ident, $part:ident, as_slice) => {
        std::slice::from_ref($scene)
    };
    (the, $scene:ident, $part:ident, as_mut_slice) => {
        std::slice::from_mut($scene)
    };
}
macro_rules! add {
    (list, $scene:ident, $part:ident) => {
        $scene.$part.push(Default::default())
    };
    (maybe, $scene:ident, $part:ident) => {
        $scene.$part = Some(Default::default())
    };
    ($one:ident, $scene:ident, $part:ident) => {
        _ = $scene
    };
}

/// Declares a type of the model: its fields with their defaults, and the row of each in the table. A field
/// in brackets has no key.
macro_rules! declare {
    (
        $(#[$about:meta])*
        $name:ident: $type:ident in $how:ident $place:ident, $expected:literal, later $later:expr;
        $([$(#[$note:meta])* $unlisted:ident: $kept:ty = $empty:expr])?
        $(
            $(#[doc = $summary:literal])*
            $field:ident: $of:ty = $default:expr, $key:literal => $kind:expr, $absent:expr, $flat:expr;
        )*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $type {
            $($(#[doc = $summary])* pub $field: $of,)*
            $($(#[$note])* pub $unlisted: $kept,)?
        }

        impl Default for $type {
            fn default() -> Self {
                Self { $($field: $default,)* $($unlisted: $empty,)? }
            }
        }

        impl Field for $type {}

        pub static $name: Part = Part {
            key: stringify!($place),
            list: matches!(stringify!($how).as_bytes(), b"list"),
            expected: $expected,
            later: &$later,
            rows: &[$(Row {
                key: $key,
                summary: concat!($($summary),*),
                kind: $kind,
                absent: $absent,
                flat: $flat,
                get: |scene, at| members!($how, scene, $place, as_slice).get(at)?.$field.value(),
                set: |scene, at, value| {
                    if let Some(member) = members!($how, scene, $place, as_mut_slice).get_mut(at) {
                        member.$field.put(value);
                    }
                },
            }),*],
            count: |scene| members!($how, scene, $place, as_slice).len(),
            add: |scene| add!($how, scene, $place),
        };
    };
}
pub(super) use {add, declare, members};
