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

/// The `key` of a part, and its members: one by its index (`get`, `get_mut`) and their number (`len`). A part is the scene `itself`, `one`
/// member, `maybe` one, a `list`, or what is `inside` each member of one.
macro_rules! member {
    // `box` is a word of the language.
    (key ($list:ident block)) => {
        concat!(stringify!($list), ".box")
    };
    (key ($list:ident $part:ident $($inner:ident)?)) => {
        concat!(stringify!($list), ".", stringify!($part) $(, ".", stringify!($inner))?)
    };
    (key $part:ident) => {
        stringify!($part)
    };
    (len inside $scene:ident ($list:ident $($part:ident)+)) => {
        $scene.$list.as_slice().len()
    };
    (get inside $scene:ident ($list:ident $($part:ident)+), $at:ident) => {
        $scene.$list.as_slice().get($at)$(.and_then(|member| member.$part.as_ref()))+
    };
    (get_mut inside $scene:ident ($list:ident $($part:ident)+), $at:ident) => {
        $scene.$list.as_mut_slice().get_mut($at)$(.and_then(|member| member.$part.as_mut()))+
    };
    (len $how:ident $scene:ident $part:ident) => {
        member!(slice $how $scene $part).len()
    };
    (get $how:ident $scene:ident $part:ident, $at:ident) => {
        member!(slice $how $scene $part).get($at)
    };
    (get_mut $how:ident $scene:ident $part:ident, $at:ident) => {
        member!(slice_mut $how $scene $part).get_mut($at)
    };
    (slice itself $scene:ident $file:ident) => {
        std::slice::from_ref($scene)
    };
    (slice_mut itself $scene:ident $file:ident) => {
        std::slice::from_mut($scene)
    };
    (slice one $scene:ident $part:ident) => {
        std::slice::from_ref(&$scene.$part)
    };
    (slice_mut one $scene:ident $part:ident) => {
        std::slice::from_mut(&mut $scene.$part)
    };
    (slice $how:ident $scene:ident $part:ident) => {
        $scene.$part.as_slice()
    };
    (slice_mut $how:ident $scene:ident $part:ident) => {
        $scene.$part.as_mut_slice()
    };
}

/// Declares a type of the model: its fields with their defaults, and the row of each. A field in
/// brackets has no key. A type that stands inside two parts has the rows of each.
macro_rules! declare {
    (
        $(#[$about:meta])*
        $name:ident $place:tt and $other:ident $beside:tt: $type:ident, inside, $expected:literal, reserved $reserved:expr;
        $($rows:tt)*
    ) => {
        declare! { $(#[$about])* $name: $type, inside $place, $expected, reserved $reserved; $($rows)* }
        part! { $other, inside $beside, $expected, reserved $reserved; $($rows)* }
    };
    (
        $(#[$about:meta])*
        $name:ident: $type:ident, $how:ident $place:tt, $expected:literal, reserved $reserved:expr;
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

        part! {
            $name, $how $place, $expected, reserved $reserved;
            $($(#[doc = $summary])* $field: $of = $default, $key => $kind, $absent, $flat;)*
        }
    };
}

/// Declares the rows of a type in one place of the file.
macro_rules! part {
    (
        $name:ident, $how:ident $place:tt, $expected:literal, reserved $reserved:expr;
        $(
            $(#[doc = $summary:literal])*
            $field:ident: $of:ty = $default:expr, $key:literal => $kind:expr, $absent:expr, $flat:expr;
        )*
    ) => {
        pub static $name: Part = Part {
            key: member!(key $place),
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
                    member!(get $how scene $place, at)?.$field.value(component)
                },
                set: |scene, at, component, value| {
                    if let Some(member) = member!(get_mut $how scene $place, at) {
                        member.$field.put(component, value);
                    }
                },
            }),*],
            count: |scene| member!(len $how scene $place),
        };
    };
}
pub(super) use {declare, member, part, words};
