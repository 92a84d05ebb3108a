//! The other values a file is made of: truth values, text, lists.

use super::number::Number;
use super::refusal::refuse;
use super::shown::shorten;
use serde::de::{Deserialize, Deserializer, Error, IgnoredAny, SeqAccess, Visitor};
use std::fmt;
use std::marker::PhantomData;

/// `true` or `false`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Truth(pub(super) bool);

/// Text, quoted or not.
#[derive(Debug)]
pub(super) struct Text(pub(super) String);

/// A list of exactly `N` numbers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers<const N: usize>(pub(super) [Number; N]);

/// A list of any length.
#[derive(Debug)]
pub(super) struct Items<T>(pub(super) Vec<T>);

struct Reader<T>(PhantomData<T>);

impl<'de> Deserialize<'de> for Truth {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl Visitor<'_> for Reader<Truth> {
    type Value = Truth;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("true or false")
    }

    fn visit_bool<E: Error>(self, truth: bool) -> Result<Truth, E> {
        Ok(Truth(truth))
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Truth, E> {
        let message = format!("expected true or false, found the text `{}`", shorten(text));
        Err(refuse("", &message, "write true or false, without quotes"))
    }
}

impl<'de> Deserialize<'de> for Text {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl Visitor<'_> for Reader<Text> {
    type Value = Text;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("text (in quotes if it looks like something else)")
    }

    fn visit_str<E: Error>(self, text: &str) -> Result<Text, E> {
        Ok(Text(text.to_owned()))
    }
}

impl<'de, const N: usize> Deserialize<'de> for Numbers<N> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl<'de, const N: usize> Visitor<'de> for Reader<Numbers<N>> {
    type Value = Numbers<N>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "a list of {N} numbers")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Numbers<N>, A::Error> {
        let mut numbers = [Number::Whole(0); N];
        let mut count = 0;
        while count < N
            && let Some(number) = list.next_element()?
        {
            numbers[count] = number;
            count += 1;
        }
        while list.next_element::<IgnoredAny>()?.is_some() {
            count += 1;
        }
        if count != N {
            let message = format!("expected a list of {N} numbers, found {count}");
            return Err(refuse("", &message, ""));
        }
        Ok(Numbers(numbers))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Items<T> {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        from.deserialize_any(Reader::<Self>(PhantomData))
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for Reader<Items<T>> {
    type Value = Items<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a list")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Items<T>, A::Error> {
        let mut items = Vec::new();
        while let Some(item) = list.next_element()? {
            items.push(item);
        }
        Ok(Items(items))
    }
}
