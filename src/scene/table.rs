//! Building blocks of the table of parameters: the [`Value`]s it gets and sets, and `declare!`, which
//! declares a type of the [model](super::model) together with its rows, so that every field has one.

use serde::Serialize;

/// The value of a key, or one component of it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Value<'a> {
    /// A number in the row's unit.
    Number(f64),
    /// The id of a particle, or the index of a coordinate.
    Id(usize),
    Flag(bool),
    /// Text borrowed from the scene, or from the file that is read.
    Text(&'a str),
}

/// A field of the model, accessed by the values of its components. A part has none; any value put into it
/// adds a member.
pub(super) trait Field {
    fn value(&self, _component: usize) -> Option<Value<'_>> {
        None
    }

    fn put(&mut self, _component: usize, _value: Value<'_>) {}
}

macro_rules! scalars {
    ($($type:ty: $kind:ident, $lend:expr;)*) => {
        $(impl Field for $type {
            fn value(&self, component: usize) -> Option<Value<'_>> {
                (component == 0).then(|| Value::$kind($lend(self)))
            }

            fn put(&mut self, _: usize, value: Value<'_>) {
                if let Value::$kind(value) = value {
                    *self = value.to_owned();
                }
            }
        })*
    };
}
scalars! {
    f64: Number, Clone::clone;
    usize: Id, Clone::clone;
    bool: Flag, Clone::clone;
    String: Text, String::as_str;
}

impl<T: Field, const N: usize> Field for [T; N] {
    fn value(&self, component: usize) -> Option<Value<'_>> {
        self.get(component)?.value(0)
    }

    fn put(&mut self, component: usize, value: Value<'_>) {
        if let Some(field) = self.get_mut(component) {
            field.put(0, value);
        }
    }
}

impl<T: Field + Default> Field for Option<T> {
    fn value(&self, component: usize) -> Option<Value<'_>> {
        self.as_ref()?.value(component)
    }

    fn put(&mut self, component: usize, value: Value<'_>) {
        self.get_or_insert_default().put(component, value);
    }
}

impl<T: Field + Default> Field for Vec<T> {
    fn value(&self, component: usize) -> Option<Value<'_>> {
        self.get(component)?.value(0)
    }

    fn put(&mut self, _: usize, value: Value<'_>) {
        let mut member = T::default();
        member.put(0, value);
        self.push(member);
    }
}

/// Vectors that one key holds, of no fixed number; components follow one another.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Vectors(pub Vec<[f64; 3]>);

impl Field for Vectors {
    fn value(&self, component: usize) -> Option<Value<'_>> {
        self.0.get(component / 3)?.value(component % 3)
    }

    /// Vectors up to this component that are not there yet are 0.
    fn put(&mut self, component: usize, value: Value<'_>) {
        let vectors = self.0.len().max(component / 3 + 1);
        self.0.resize(vectors, [0.0; 3]);
        self.0[component / 3].put(component % 3, value);
    }
}

/// Gives an enum its words in a file, in the order in which messages list them.
macro_rules! words {
    ($type:ident: $($word:literal => $variant:ident),+) => {
        impl $type {
            const WORDS: &'static [&'static str] = &[$($word),+];
        }

        impl Field for $type {
            fn value(&self, component: usize) -> Option<Value<'_>> {
                let word = match self {
                    $(Self::$variant => $word,)+
                };
                (component == 0).then_some(Value::Text(word))
            }

            fn put(&mut self, _: usize, value: Value<'_>) {
                match value {
                    $(Value::Text($word) => *self = Self::$variant,)+
                    _ => {}
                }
            }
        }
    };
}

/// The members of a part as a slice: the scene `itself`, `one` member, `maybe` one or a `list`.
macro_rules! members {
    (itself $scene:ident . $file:ident, as_slice) => {
        std::slice::from_ref($scene)
    };
    (itself $scene:ident . $file:ident, as_mut_slice) => {
        std::slice::from_mut($scene)
    };
    (one $scene:ident . $part:ident, as_slice) => {
        std::slice::from_ref(&$scene.$part)
    };
    (one $scene:ident . $part:ident, as_mut_slice) => {
        std::slice::from_mut(&mut $scene.$part)
    };
    ($how:ident $scene:ident . $part:ident, $as_slice:ident) => {
        $scene.$part.$as_slice()
    };
}

/// Declares a type of the model: its fields with their defaults, and the row of each. A field in
/// brackets has no key.
macro_rules! declare {
    (
        $(#[$about:meta])*
        $name:ident: $type:ident, $how:ident $place:ident, $expected:literal, reserved $reserved:expr;
        $([$(#[$note:meta])* $unlisted:ident: $kept:ty = $empty:expr])*
        $(
            $(#[doc = $summary:literal])*
            $field:ident: $of:ty = $default:expr, $key:literal => $kind:expr, $absent:expr, $flat:expr;
        )*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, PartialEq)]
        pub struct $type {
            $($(#[doc = $summary])* pub $field: $of,)*
            $($(#[$note])* pub $unlisted: $kept,)*
        }

        impl Default for $type {
            fn default() -> Self {
                Self { $($field: $default,)* $($unlisted: $empty,)* }
            }
        }

        impl Field for $type {}

        pub static $name: Part = Part {
            key: stringify!($place),
            list: matches!(stringify!($how).as_bytes(), b"list"),
            expected: $expected,
            reserved: &$reserved,
            rows: &[$(Row {
                key: $key,
                summary: concat!($($summary),*),
                kind: $kind,
                absent: $absent,
                flat: $flat,
                get: |scene, at, component| {
                    members!($how scene.$place, as_slice).get(at)?.$field.value(component)
                },
                set: |scene, at, component, value| {
                    if let Some(member) = members!($how scene.$place, as_mut_slice).get_mut(at) {
                        member.$field.put(component, value);
                    }
                },
            }),*],
            count: |scene| members!($how scene.$place, as_slice).len(),
        };
    };
}
pub(super) use {declare, members, words};
