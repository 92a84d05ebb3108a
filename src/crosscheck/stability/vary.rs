//! `springs.stiffness=1e2..1e8:24`: what a map varies, from where to where, in how many values.

use crate::scene::Scene;
use crate::scene::limits::Quantity;
use crate::scene::parameters::{Kind, PARTICLES, PARTS, Part, Row, Value};
use crate::scene::words::nearest;
use std::fmt;
use std::str::FromStr;

/// Values where the text does not say how many.
pub const COUNT: usize = 24;
/// More than this would be a picture nobody can read.
const MOST: usize = 200;

/// A number of the scene that has a say in the motion, of one member of its part or of all.
#[derive(Clone, Copy)]
struct Key {
    part: &'static Part,
    row: &'static Row,
    quantity: Quantity,
    member: Option<usize>,
}

/// Every key there is, of all members.
fn keys() -> impl Iterator<Item = Key> {
    let of = |part: &'static Part| part.rows.iter().map(move |row| (part, row));
    PARTS
        .into_iter()
        .flat_map(of)
        .filter_map(|(part, row)| match row.kind {
            Kind::Number(quantity) if row.flat.is_some() => Some(Key {
                part,
                row,
                quantity,
                member: None,
            }),
            _ => None,
        })
}

impl Key {
    /// The key `list[index].field` names; of one member only where there is a list.
    fn find(id: &str) -> Result<Key, VaryError> {
        let of_all = keys().find(|key| key.to_string() == id);
        let of_one = || {
            let (list, rest) = id.split_once('[')?;
            let (index, field) = rest.split_once(']')?;
            let field = field.strip_prefix('.')?;
            let member = Some(index.parse().ok()?);
            let mut lists = keys().filter(|key| key.part.list);
            let key = lists.find(|key| key.part.key == list && key.row.key == field)?;
            Some(Key { member, ..key })
        };
        of_all.or_else(of_one).ok_or_else(|| {
            let known: Vec<String> = keys().map(|key| key.to_string()).collect();
            let words: Vec<&str> = known.iter().map(String::as_str).collect();
            let plain = match id.split_once('[').zip(id.split_once(']')) {
                Some(((list, _), (_, field))) => format!("{list}{field}"),
                None => id.to_owned(),
            };
            let hint = nearest(&plain, &words).map(|near| format!(" (did you mean `{near}`?)"));
            VaryError::Unknown {
                key: id.to_owned(),
                hint: hint.unwrap_or_default(),
                known: known.join(", "),
                example: "springs[3].stiffness or particles[1].mass",
            }
        })
    }

    /// Members there are.
    fn count(&self, scene: &Scene) -> usize {
        (self.part.count)(scene)
    }

    /// Whether it means anything of this member: what is fixed neither has inertia nor drags.
    fn free(&self, scene: &Scene, at: usize) -> bool {
        self.part.key != PARTICLES.key || scene.particles.get(at).is_some_and(|p| !p.fixed)
    }
}

impl fmt::Display for Key {
    /// As the command line writes it: `springs.stiffness`, `particles[1].mass`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.part.key)?;
        if let Some(at) = self.member {
            write!(f, "[{at}]")?;
        }
        write!(f, ".{}", self.row.key)
    }
}

/// Why a text varies nothing.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum VaryError {
    #[error("expected KEY=A..B or KEY=A..B:N, found `{0}`")]
    NoRange(String),
    #[error("unknown key `{key}`{hint}; known: {known}, and of one member such as {example}")]
    Unknown {
        key: String,
        /// Empty, or ` (did you mean ...?)`.
        hint: String,
        known: String,
        example: &'static str,
    },
    #[error("{key}: {message}")]
    Member { key: String, message: String },
    #[error("{key}: {why}")]
    Range { key: String, why: RangeError },
    #[error("{key}: expected values from {low:e} to {high:e} ({unit}), found {found}")]
    Bounds {
        key: String,
        low: f64,
        high: f64,
        unit: &'static str,
        found: f64,
    },
}

/// Why a text is no range.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RangeError {
    #[error("expected A..B or A..B:N, found `{0}`")]
    Form(String),
    #[error("expected a finite number, found `{0}`")]
    Number(String),
    #[error("expected a range that rises, found {0} to {1}")]
    Order(f64, f64),
    #[error("expected 2 to {MOST} values, found `{0}`")]
    Count(String),
}

/// `A..B` or `A..B:N`, A below B.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// The first value.
    pub low: f64,
    /// The last.
    pub high: f64,
    /// Values from end to end.
    pub count: usize,
}

impl FromStr for Range {
    type Err = RangeError;

    fn from_str(text: &str) -> Result<Self, RangeError> {
        let form = || RangeError::Form(text.to_owned());
        let (low, rest) = text.split_once("..").ok_or_else(form)?;
        let (high, count) = match rest.split_once(':') {
            Some((high, count)) => (high, Some(count)),
            None => (rest, None),
        };
        let number = |text: &str| {
            let number = text.trim().parse::<f64>().ok().filter(|n| n.is_finite());
            number.ok_or_else(|| RangeError::Number(text.to_owned()))
        };
        let (low, high) = (number(low)?, number(high)?);
        if low >= high {
            return Err(RangeError::Order(low, high));
        }
        let count = count.map_or(Ok(COUNT), |count| {
            let parsed = count.trim().parse::<usize>().ok();
            parsed
                .filter(|n| (2..=MOST).contains(n))
                .ok_or_else(|| RangeError::Count(count.to_owned()))
        })?;
        Ok(Self { low, high, count })
    }
}

impl Range {
    /// Evenly spaced in their logarithm where both ends are positive, else evenly; the ends exactly.
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

/// One quantity of a scene and the values it takes.
#[derive(Clone)]
pub struct Vary {
    key: Key,
    /// Ascending.
    pub values: Vec<f64>,
}

impl fmt::Debug for Vary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Vary").field("id", &self.id()).finish()
    }
}

impl Vary {
    /// Reads `KEY=A..B[:N]` for this scene.
    ///
    /// # Errors
    /// [`VaryError`] when the key is unknown, the scene has no such member, or the values leave what
    /// a scene file may say.
    pub fn parse(text: &str, scene: &Scene) -> Result<Self, VaryError> {
        let (id, range) = text
            .split_once('=')
            .ok_or_else(|| VaryError::NoRange(text.to_owned()))?;
        let key = Key::find(id)?;
        let refuse = |message: String| {
            Err(VaryError::Member {
                key: id.to_owned(),
                message,
            })
        };
        let count = key.count(scene);
        match key.member {
            Some(at) if at >= count => {
                return refuse(format!("the scene has {count} of these, from 0"));
            }
            Some(at) if !key.free(scene, at) => {
                return refuse(format!("particle {at} is fixed: it changes nothing"));
            }
            None if count == 0 => return refuse("the scene has none".to_owned()),
            _ => {}
        }
        let range: Range = range.parse().map_err(|why| VaryError::Range {
            key: id.to_owned(),
            why,
        })?;
        let Quantity { low, high, unit } = key.quantity;
        let outside = |end: &f64| !(low..=high).contains(end);
        if let Some(found) = [range.low, range.high].into_iter().find(outside) {
            return Err(VaryError::Bounds {
                key: id.to_owned(),
                low,
                high,
                unit,
                found,
            });
        }
        Ok(Self {
            key,
            values: range.values(),
        })
    }

    /// As the command line writes it: `springs.stiffness`, `particles[1].mass`.
    pub fn id(&self) -> String {
        self.key.to_string()
    }

    /// Of the values.
    pub fn unit(&self) -> &'static str {
        self.key.quantity.unit
    }

    /// The scene with this value, in the one member or in all that are free.
    pub fn apply(&self, scene: &Scene, value: f64) -> Scene {
        let mut varied = scene.clone();
        let members = self
            .key
            .member
            .map_or(0..self.key.count(scene), |at| at..at + 1);
        for at in members.filter(|at| self.key.free(scene, *at)) {
            (self.key.row.set)(&mut varied, at, Value::Numbers(&[value]));
        }
        varied
    }
}
