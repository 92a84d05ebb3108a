//! A key that takes a number, [x, y, z] or a list of such vectors; and directions.

use super::error::{Refusal, refuse};
use super::place::Problem;
use super::values::{Any, Number, Numbers, number};
use serde::de::{Error, SeqAccess, Visitor};
use std::fmt;

/// What reads either a number or a list.
pub(super) trait Either {
    fn number(&mut self, number: Number) -> Result<(), Refusal>;

    fn list<'de, A: SeqAccess<'de>>(self, list: A) -> Result<bool, A::Error>;
}

/// Reads a number or a list; false for a number. `list` says of its list what it likes.
pub(super) struct NumberOrList<E>(pub(super) E);

impl<E: Either> NumberOrList<E> {
    fn number(&mut self) -> impl Visitor<'_, Value = bool> {
        number(|n| self.0.number(n).map(|()| false))
    }
}

impl<'de, E: Either> Visitor<'de> for NumberOrList<E> {
    type Value = bool;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, [x, y, z] or a list of vectors")
    }

    fn visit_bool<R: Error>(mut self, flag: bool) -> Result<bool, R> {
        self.number().visit_bool(flag)
    }

    fn visit_i64<R: Error>(mut self, n: i64) -> Result<bool, R> {
        self.number().visit_i64(n)
    }

    fn visit_u64<R: Error>(mut self, n: u64) -> Result<bool, R> {
        self.number().visit_u64(n)
    }

    fn visit_i128<R: Error>(mut self, n: i128) -> Result<bool, R> {
        self.number().visit_i128(n)
    }

    fn visit_u128<R: Error>(mut self, n: u128) -> Result<bool, R> {
        self.number().visit_u128(n)
    }

    fn visit_f64<R: Error>(mut self, x: f64) -> Result<bool, R> {
        self.number().visit_f64(x)
    }

    fn visit_str<R: Error>(mut self, text: &str) -> Result<bool, R> {
        self.number().visit_str(text)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, list: A) -> Result<bool, A::Error> {
        self.0.list(list)
    }
}

/// Reads [x, y, z] or a list of such vectors. The function also gets the index among all numbers.
pub(super) fn vectors<'de, A: SeqAccess<'de>>(
    mut list: A,
    mut judge: impl FnMut(usize, Number) -> Result<(), Refusal>,
) -> Result<(), A::Error> {
    let (mut numbers, mut vectors) = (0, 0);
    loop {
        let element = Element(numbers + vectors, &mut judge);
        match list.next_element_seed(Any(NumberOrList(element)))? {
            Some(true) => vectors += 1,
            Some(false) => numbers += 1,
            None => break,
        }
    }
    let found = match (numbers, vectors) {
        (3, 0) | (0, 1..) => return Ok(()),
        (0, 0) => "an empty list".to_owned(),
        (numbers, 0) => format!("{numbers} numbers"),
        _ => "numbers beside vectors".to_owned(),
    };
    let message = format!("expected [x, y, z] or a list of such vectors, found {found}");
    Err(refuse(Refusal::new(message, "")))
}

/// A component of a vector, or one of several vectors.
struct Element<'j, F>(usize, &'j mut F);

impl<F: FnMut(usize, Number) -> Result<(), Refusal>> Either for Element<'_, F> {
    fn number(&mut self, number: Number) -> Result<(), Refusal> {
        (self.1)(self.0, number)
    }

    fn list<'de, A: SeqAccess<'de>>(self, list: A) -> Result<bool, A::Error> {
        let Element(at, judge) = self;
        let vector = Numbers(3, |axis, number| judge(3 * at + axis, number));
        vector.visit_seq(list).map(|()| true)
    }
}

/// Makes a direction a unit vector.
pub(super) fn normalise(direction: &mut [f64; 3], path: &str) -> Result<(), Problem> {
    // The vector is scaled first, so that the squares of tiny components do not vanish.
    let largest = direction.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    if largest == 0.0 {
        let message = "expected a direction, found a vector of length 0";
        return Problem::because(path, message, "");
    }
    let scaled = direction.map(|d| d / largest);
    let length = scaled.iter().map(|d| d * d).sum::<f64>().sqrt();
    // A unit vector, to the few roundings that made it one, stays as it is: once more would round it once more.
    if (length * largest - 1.0).abs() > 8.0 * f64::EPSILON {
        *direction = scaled.map(|d| d / length);
    }
    Ok(())
}
