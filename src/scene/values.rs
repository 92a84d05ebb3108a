//! The values of a file, checked while they are read, when the parser still knows their place.

use super::error::{Refusal, refuse};
use super::words::{about_key, shorten};
use serde::de::{DeserializeSeed, Deserializer, Error, IgnoredAny, SeqAccess, Unexpected, Visitor};
use std::fmt;

/// A number as the file writes it: `20`, `20.`, `2e1`, `0x14`; never quoted. Ids must be whole, all
/// other numbers may be either.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    Whole(i64),
    /// Possibly infinite or NaN: YAML has `.inf` and `.nan`.
    Real(f64),
}

impl Number {
    pub(super) fn value(self) -> f64 {
        match self {
            Number::Whole(n) => n as f64,
            Number::Real(x) => x,
        }
    }

    /// The number as an id: whole and not negative.
    pub(super) fn whole(self) -> Option<usize> {
        match self {
            Number::Whole(n) => usize::try_from(n).ok(),
            Number::Real(_) => None,
        }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Number::Whole(n) => write!(f, "{n}"),
            Number::Real(x) => write!(f, "{x:?}"),
        }
    }
}

/// A value that is neither a list nor a mapping.
pub(super) enum Scalar<'a> {
    Number(Number),
    Flag(bool),
    Text(&'a str),
}

/// Reads a value of any type that the visitor accepts.
pub(super) struct Any<V>(pub(super) V);

impl<'de, V: Visitor<'de>> DeserializeSeed<'de> for Any<V> {
    type Value = V::Value;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<V::Value, D::Error> {
        from.deserialize_any(self.0)
    }
}

/// Reads a key. If the function refuses it, the error has the key's exact place.
pub(super) struct Key<F>(pub(super) F);

impl<'de, T, F: FnMut(&str) -> Result<T, Refusal>> DeserializeSeed<'de> for Key<F> {
    type Value = T;

    fn deserialize<D: Deserializer<'de>>(mut self, from: D) -> Result<T, D::Error> {
        let key = |scalar: Scalar| match scalar {
            Scalar::Text(text) => Some((self.0)(text)),
            _ => None,
        };
        from.deserialize_str(One("a key", key))
    }
}

/// The refusal of a repeated key.
pub(super) fn repeated(key: &str) -> Refusal {
    Refusal::new("this key is given twice", "keep one of them").of(key)
}

/// The index of the key among those of a mapping. Bit i of `seen` says that key i occurred before; a
/// repeated key is refused.
pub(super) fn index_of<'k>(
    key: &str,
    keys: impl Iterator<Item = &'k str> + Clone,
    seen: &mut u32,
) -> Result<usize, Refusal> {
    let Some(index) = keys.clone().position(|known| known == key) else {
        no_merge(key)?;
        return Err(unknown(key, &keys.collect::<Vec<_>>()));
    };
    let before = *seen;
    *seen |= 1 << index;
    if *seen == before {
        return Err(repeated(key));
    }
    Ok(index)
}

/// The refusal of an unknown key.
pub(super) fn unknown(key: &str, known: &[&str]) -> Refusal {
    let message = format!("unknown key `{}`", shorten(key));
    Refusal::new(message, about_key(key, known))
}

/// Refuses the merge key, by which YAML 1.1 merges a mapping into the one around it.
pub(super) fn no_merge(key: &str) -> Result<(), Refusal> {
    let help = "write the keys out, or alias a whole value";
    match key {
        "<<" => Refusal::because("merge keys (`<<`) are not applied", help),
        _ => Ok(()),
    }
}

/// Reads a scalar. The function converts it, or gives None where the scalar is not of the kind that the
/// words name.
struct One<F>(&'static str, F);

pub(super) fn number<'de, T>(
    mut judge: impl FnMut(Number) -> Result<T, Refusal>,
) -> impl Visitor<'de, Value = T> {
    let number = move |scalar: Scalar| match scalar {
        Scalar::Number(number) => Some(judge(number).map_err(Refusal::judged)),
        Scalar::Text(text) => {
            let message = format!("expected a number, found the text `{}`", shorten(text));
            Some(Refusal::because(message, remedy(text)))
        }
        Scalar::Flag(_) => None,
    };
    One("a number", number)
}

/// A particle, by its id or by its name.
pub(super) enum Id<'a> {
    Number(Number),
    Name(&'a str),
}

pub(super) fn id<'de, T>(
    mut judge: impl FnMut(Id<'_>) -> Result<T, Refusal>,
) -> impl Visitor<'de, Value = T> {
    One("a particle: its id, or its name", move |scalar: Scalar| {
        let id = match scalar {
            Scalar::Number(number) => Id::Number(number),
            Scalar::Text(name) => Id::Name(name),
            Scalar::Flag(_) => return None,
        };
        Some(judge(id).map_err(Refusal::judged))
    })
}

/// Reads `true` or `false`.
pub(super) fn flag<'de>() -> impl Visitor<'de, Value = bool> {
    One("true or false", |scalar: Scalar| match scalar {
        Scalar::Flag(flag) => Some(Ok(flag)),
        Scalar::Text(text) => {
            let message = format!("expected true or false, found the text `{}`", shorten(text));
            Some(Refusal::because(
                message,
                "write true or false, without quotes",
            ))
        }
        Scalar::Number(_) => None,
    })
}

/// Reads text, quoted or not.
pub(super) fn text<'de, T>(
    mut judge: impl FnMut(&str) -> Result<T, Refusal>,
) -> impl Visitor<'de, Value = T> {
    let expected = "text (in quotes if it looks like something else)";
    One(expected, move |scalar: Scalar| match scalar {
        Scalar::Text(text) => Some(judge(text).map_err(Refusal::judged)),
        _ => None,
    })
}

impl<T, F: FnMut(Scalar) -> Option<Result<T, Refusal>>> One<F> {
    fn take<E: Error>(mut self, scalar: Scalar, found: Unexpected) -> Result<T, E> {
        match (self.1)(scalar) {
            Some(taken) => taken.map_err(refuse),
            None => Err(E::invalid_type(found, &self.0)),
        }
    }
}

impl<T, F: FnMut(Scalar) -> Option<Result<T, Refusal>>> Visitor<'_> for One<F> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.0)
    }

    fn visit_bool<E: Error>(self, flag: bool) -> Result<T, E> {
        self.take(Scalar::Flag(flag), Unexpected::Bool(flag))
    }

    fn visit_i64<E: Error>(self, n: i64) -> Result<T, E> {
        self.take(Scalar::Number(Number::Whole(n)), Unexpected::Signed(n))
    }

    fn visit_u64<E: Error>(self, n: u64) -> Result<T, E> {
        let number = i64::try_from(n).map_or(Number::Real(n as f64), Number::Whole);
        self.take(Scalar::Number(number), Unexpected::Unsigned(n))
    }

    fn visit_i128<E: Error>(self, n: i128) -> Result<T, E> {
        self.visit_f64(n as f64)
    }

    fn visit_u128<E: Error>(self, n: u128) -> Result<T, E> {
        self.visit_f64(n as f64)
    }

    fn visit_f64<E: Error>(self, x: f64) -> Result<T, E> {
        self.take(Scalar::Number(Number::Real(x)), Unexpected::Float(x))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<T, E> {
        self.take(Scalar::Text(text), Unexpected::Str(text))
    }
}

/// Advice on a text that stands where a number is expected.
fn remedy(text: &str) -> String {
    let digits = text.trim_start_matches(['-', '+']);
    let all_digits = !digits.is_empty() && digits.bytes().all(|b| b.is_ascii_digit());
    if all_digits && digits.len() > 1 && digits.starts_with('0') && digits.len() <= 40 {
        let plain = match digits.trim_start_matches('0') {
            "" => "0",
            plain => plain,
        };
        return format!("a leading zero can mean octal: write {plain}, or 0o{plain} for octal");
    }
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => "a quoted number is text: remove the quotes".into(),
        Ok(_) if all_digits || text.contains(['e', 'E']) => "too large for a double".into(),
        _ if text.len() <= 40 && text.replacen(',', ".", 1).parse::<f64>().is_ok() => {
            "decimals take a point, not a comma".into()
        }
        _ => "write a number such as 2, 2.5 or 1e-3".into(),
    }
}

/// Reads a list of this many numbers. The function also gets the index in the list.
pub(super) struct Numbers<F>(pub(super) usize, pub(super) F);

impl<'de, F: FnMut(usize, Number) -> Result<(), Refusal>> Visitor<'de> for Numbers<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a list of {} numbers", self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Numbers(wanted, mut judge) = self;
        counted(wanted, &mut list, |list, at| {
            list.next_element_seed(Any(number(|n| judge(at, n))))
        })
    }
}

/// Reads a list of this many particles, by id or name. The function also gets the index in the list.
pub(super) struct Ids<F>(pub(super) usize, pub(super) F);

impl<'de, F: FnMut(usize, Id<'_>) -> Result<(), Refusal>> Visitor<'de> for Ids<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a list of {} numbers", self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Ids(wanted, mut judge) = self;
        counted(wanted, &mut list, |list, at| {
            list.next_element_seed(Any(id(|found| judge(at, found))))
        })
    }
}

/// Reads the elements of a list that has to have so many.
fn counted<'de, A: SeqAccess<'de>>(
    wanted: usize,
    list: &mut A,
    mut next: impl FnMut(&mut A, usize) -> Result<Option<()>, A::Error>,
) -> Result<(), A::Error> {
    let mut count = 0;
    while count < wanted && next(list, count)?.is_some() {
        count += 1;
    }
    while list.next_element::<IgnoredAny>()?.is_some() {
        count += 1;
    }
    if count != wanted {
        let message = format!("expected a list of {wanted} numbers, found {count}");
        return Err(refuse(Refusal::new(message, "")));
    }
    Ok(())
}

/// Reads a list of lists of this many numbers each, at least so many of them. The function also gets the index among all
/// numbers.
pub(super) struct Table<F>(pub(super) usize, pub(super) usize, pub(super) F);

impl<'de, F: FnMut(usize, Number) -> Result<(), Refusal>> Visitor<'de> for Table<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a list of rows of {} numbers", self.0)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<(), A::Error> {
        let Table(width, least, mut judge) = self;
        let mut before = 0;
        while let Some(()) =
            list.next_element_seed(Any(Numbers(width, |i, n| judge(before + i, n))))?
        {
            before += width;
        }
        if before < least * width {
            let wanted = match least {
                1 => "a row",
                2 => "two rows",
                _ => "three rows",
            };
            let message = format!("expected {wanted} or more, found {}", before / width);
            let help = format!("a row is a list of {width} numbers");
            return Err(refuse(Refusal::new(message, help)));
        }
        Ok(())
    }
}

/// Reads a list of texts.
pub(super) struct Texts<F>(pub(super) F);

impl<'de, F: FnMut(&str) -> Result<(), Refusal>> Visitor<'de> for Texts<F> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list of names")
    }

    fn visit_seq<A: SeqAccess<'de>>(mut self, mut list: A) -> Result<(), A::Error> {
        while list.next_element_seed(Any(text(&mut self.0)))?.is_some() {}
        Ok(())
    }
}

/// A value that may be left empty: a key without a value counts as absent.
pub(super) struct Maybe<S>(pub(super) S);

impl<'de, S: DeserializeSeed<'de>> DeserializeSeed<'de> for Maybe<S> {
    type Value = Option<S::Value>;

    fn deserialize<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        from.deserialize_option(self)
    }
}

impl<'de, S: DeserializeSeed<'de>> Visitor<'de> for Maybe<S> {
    type Value = Option<S::Value>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a value or nothing")
    }

    fn visit_none<E: Error>(self) -> Result<Self::Value, E> {
        Ok(None)
    }

    fn visit_some<D: Deserializer<'de>>(self, from: D) -> Result<Self::Value, D::Error> {
        self.0.deserialize(from).map(Some)
    }
}
