//! `springs.stiffness=1e2..1e8:24`: the quantity that varies, its range, and the number of values.

use crate::scene::limits::Bounds;
use crate::scene::model::{PARTICLES, PARTS, Part, Row, ValueKind};
use crate::scene::words::aside;
use crate::scene::{Scene, Value};
use std::fmt;
use std::str::FromStr;

/// The number of values where the text does not give one.
pub const COUNT: usize = 24;
/// The most values: a picture of more cannot be read.
const MAX_COUNT: usize = 200;

/// Why a text is not a range of one quantity of the scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct VaryError(String);

/// `A..B` or `A..B:N`, A below B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The first value.
    pub low: f64,
    /// The last value.
    pub high: f64,
    /// The number of values, with both ends.
    pub count: usize,
}

impl FromStr for Range {
    type Err = VaryError;

    fn from_str(text: &str) -> Result<Self, VaryError> {
        let form = || VaryError(format!("expected A..B or A..B:N, found `{text}`"));
        let (low, rest) = text.split_once("..").ok_or_else(form)?;
        let (high, count) = match rest.split_once(':') {
            Some((high, count)) => (high, Some(count)),
            None => (rest, None),
        };
        let number = |text: &str| {
            let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
            number.ok_or_else(|| VaryError(format!("expected a finite number, found `{text}`")))
        };
        let (low, high) = (number(low)?, number(high)?);
        if low >= high {
            let message = format!("expected a range that rises, found {low} to {high}");
            return Err(VaryError(message));
        }
        let count = count.map_or(Ok(COUNT), |count| {
            let parsed = count
                .trim()
                .parse()
                .ok()
                .filter(|n| (2..=MAX_COUNT).contains(n));
            parsed.ok_or_else(|| {
                VaryError(format!("expected 2 to {MAX_COUNT} values, found `{count}`"))
            })
        })?;
        Ok(Self { low, high, count })
    }
}

impl Range {
    /// Values evenly spaced in their logarithm where both ends are positive, else evenly. The ends are exact.
    pub fn values(&self) -> Vec<f64> {
        let last = self.count.saturating_sub(1).max(1);
        let at = |i: usize| {
            let part = i as f64 / last as f64;
            match i {
                0 => self.low,
                i if i == last => self.high,
                _ if self.low > 0.0 => {
                    (self.low.ln() + part * (self.high.ln() - self.low.ln())).exp()
                }
                _ => self.low + part * (self.high - self.low),
            }
        };
        (0..self.count).map(at).collect()
    }
}

/// A number of the scene that acts on the motion, in one member of its part or in all that are free.
#[derive(Debug, Clone, Copy)]
pub struct VariedKey {
    part: &'static Part,
    row: &'static Row,
    /// The values a scene file may give it, and their unit.
    pub quantity: Bounds,
    member: Option<usize>,
}

/// Every key, for all members at once.
fn keys() -> impl Iterator<Item = VariedKey> {
    let of = |part: &'static Part| part.rows.iter().map(move |row| (part, row));
    let number = |(part, row): (_, &'static Row)| match row.kind {
        ValueKind::Number(quantity) if row.flat.is_some() => Some(VariedKey {
            part,
            row,
            quantity,
            member: None,
        }),
        _ => None,
    };
    PARTS.into_iter().flat_map(of).filter_map(number)
}

impl VariedKey {
    /// Reads `springs.stiffness`, or `springs[3].stiffness` for one member where there is a list.
    ///
    /// # Errors
    /// [`VaryError`] when the key is unknown, or acts on nothing in this scene.
    pub fn parse(id: &str, scene: &Scene) -> Result<Self, VaryError> {
        let key = Self::find(id)?;
        let refused = |why: String| Err(VaryError(format!("{id}: {why}")));
        let count = (key.part.count)(scene);
        match key.member {
            Some(at) if at >= count => refused(format!("the scene has {count} of these, from 0")),
            Some(at) if !key.free(scene, at) => {
                refused(format!("particle {at} is fixed: it changes nothing"))
            }
            None if count == 0 => refused("the scene has none".into()),
            _ if key.is_vector(scene) => {
                refused("the scene gives vectors here: only a number can be varied".into())
            }
            _ => Ok(key),
        }
    }

    fn find(id: &str) -> Result<Self, VaryError> {
        let (list, rest) = id.split_once('[').unwrap_or((id, ""));
        let (index, field) = rest.split_once(']').unwrap_or(("", rest));
        let plain = format!("{list}{field}");
        let member = index.parse().ok();
        let found = keys().find(|key| {
            key.to_string() == plain && (plain == id || key.part.list && member.is_some())
        });
        found.map(|key| VariedKey { member, ..key }).ok_or_else(|| {
            let known: Vec<String> = keys().map(|key| key.to_string()).collect();
            let words: Vec<&str> = known.iter().map(String::as_str).collect();
            VaryError(format!(
                "unknown key `{id}`{}; known: {}, and of one member such as springs[3].stiffness \
                 or particles[1].mass",
                aside(&plain, &words),
                known.join(", ")
            ))
        })
    }

    /// Whether the scene has vectors in the place of the number.
    fn is_vector(&self, scene: &Scene) -> bool {
        let other = |row: &&Row| row.key == self.row.key && !std::ptr::eq(*row, self.row);
        let mut others = self.part.rows.iter().filter(other);
        others.any(|row| (row.get)(scene, 0, 0).is_some())
    }

    /// The scene with this value, in the one member or in all that are free.
    pub fn apply(&self, scene: &Scene, value: f64) -> Scene {
        let mut varied = scene.clone();
        for at in self.members(scene) {
            (self.row.set)(&mut varied, at, 0, Value::Number(value));
        }
        varied
    }

    /// The largest magnitude among the values the scene has.
    pub fn largest(&self, scene: &Scene) -> f64 {
        let magnitude = |at| match (self.row.get)(scene, at, 0) {
            Some(Value::Number(value)) => value.abs(),
            _ => 0.0,
        };
        self.members(scene).map(magnitude).fold(0.0, f64::max)
    }

    fn members<'s>(&'s self, scene: &'s Scene) -> impl Iterator<Item = usize> + 's {
        let count = (self.part.count)(scene);
        let members = self.member.map_or(0..count, |at| at..at + 1);
        members.filter(|at| self.free(scene, *at))
    }

    /// Whether the key acts on this member: a fixed particle has neither inertia nor drag.
    fn free(&self, scene: &Scene, at: usize) -> bool {
        self.part.key != PARTICLES.key || scene.particles.get(at).is_some_and(|p| !p.fixed)
    }
}

impl fmt::Display for VariedKey {
    /// The key as the command line writes it: `springs.stiffness`, `particles[1].mass`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.part.path(self.member, self.row.key))
    }
}

/// One quantity of a scene and its values.
#[derive(Debug, Clone)]
pub struct Vary {
    key: VariedKey,
    /// Ascending.
    pub values: Vec<f64>,
}

impl Vary {
    /// Reads `KEY=A..B[:N]` for this scene.
    ///
    /// # Errors
    /// [`VaryError`] when the key is unknown, the scene has no such member, or the values leave the bounds
    /// of a scene file.
    pub fn parse(text: &str, scene: &Scene) -> Result<Self, VaryError> {
        let (id, range) = text
            .split_once('=')
            .ok_or_else(|| VaryError(format!("expected KEY=A..B or KEY=A..B:N, found `{text}`")))?;
        let refused = |why: String| VaryError(format!("{id}: {why}"));
        let key = VariedKey::parse(id, scene)?;
        let range: Range = range.parse().map_err(|VaryError(why)| refused(why))?;
        let Bounds { low, high, unit } = key.quantity;
        let outside = |end: &f64| !(low..=high).contains(end);
        if let Some(found) = [range.low, range.high].into_iter().find(outside) {
            return Err(refused(format!(
                "expected values from {low:e} to {high:e} ({unit}), found {found}"
            )));
        }
        let values = range.values();
        Ok(Self { key, values })
    }

    /// The key as the command line writes it: `springs.stiffness`, `particles[1].mass`.
    pub fn id(&self) -> String {
        self.key.to_string()
    }

    /// The unit of the values.
    pub fn unit(&self) -> &'static str {
        self.key.quantity.unit
    }

    /// The scene with this value.
    pub fn apply(&self, scene: &Scene, value: f64) -> Scene {
        self.key.apply(scene, value)
    }
}
