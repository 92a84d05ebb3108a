//! `springs.stiffness=1e2..1e8:24`: what a map varies, from where to where, in how many values.

use crate::scene::limits::{self, Quantity};
use crate::scene::{Scene, suggest};
use std::str::FromStr;

/// Values where the text does not say how many.
pub const COUNT: usize = 24;
/// More than this would be a picture nobody can read.
const MOST: usize = 200;

/// A quantity of particles or springs that a map can vary.
struct Key {
    /// As the command line writes it; of one member `list[index].field`.
    id: &'static str,
    quantity: Quantity,
    /// Members there are.
    count: fn(&Scene) -> usize,
    /// Whether it means anything of this member.
    free: fn(&Scene, usize) -> bool,
    set: fn(&mut Scene, usize, f64),
}

const SPRING: Key = Key {
    id: "",
    quantity: limits::STIFFNESS,
    count: |scene| scene.springs.len(),
    free: |_, _| true,
    set: |_, _, _| {},
};

const PARTICLE: Key = Key {
    quantity: limits::MASS,
    count: |scene| scene.particles.len(),
    free: |scene, at| scene.particles.get(at).is_some_and(|p| !p.fixed),
    ..SPRING
};

/// Sets a field of one member of a list.
macro_rules! set {
    ($list:ident, $field:ident) => {
        |scene, at, value| {
            if let Some(member) = scene.$list.get_mut(at) {
                member.$field = value;
            }
        }
    };
}

/// Everything that can be varied. A field of the scene becomes one more row.
static KEYS: &[Key] = &[
    Key {
        id: "springs.stiffness",
        set: set!(springs, stiffness),
        ..SPRING
    },
    Key {
        id: "springs.damping",
        quantity: limits::DAMPING,
        set: set!(springs, damping),
        ..SPRING
    },
    Key {
        id: "springs.rest_length",
        quantity: limits::REST_LENGTH,
        set: set!(springs, rest_length),
        ..SPRING
    },
    Key {
        id: "particles.mass",
        set: set!(particles, mass),
        ..PARTICLE
    },
    Key {
        id: "particles.drag",
        quantity: limits::DRAG,
        set: set!(particles, drag),
        ..PARTICLE
    },
];

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
    key: &'static Key,
    /// One member; None for all that are free.
    member: Option<usize>,
    /// Ascending.
    pub values: Vec<f64>,
}

impl std::fmt::Debug for Vary {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
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
        let (key, member) = find(id)?;
        let refuse = |message: String| {
            Err(VaryError::Member {
                key: id.to_owned(),
                message,
            })
        };
        let count = (key.count)(scene);
        match member {
            Some(at) if at >= count => {
                return refuse(format!("the scene has {count} of these, from 0"));
            }
            Some(at) if !(key.free)(scene, at) => {
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
        if let Some(&found) = [range.low, range.high]
            .iter()
            .find(|end| !(low..=high).contains(*end))
        {
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
            member,
            values: range.values(),
        })
    }

    /// As the command line writes it: `springs.stiffness`, `particles[1].mass`.
    pub fn id(&self) -> String {
        match (self.member, self.key.id.split_once('.')) {
            (Some(at), Some((list, field))) => format!("{list}[{at}].{field}"),
            _ => self.key.id.to_owned(),
        }
    }

    /// Of the values.
    pub fn unit(&self) -> &'static str {
        self.key.quantity.unit
    }

    /// The scene with this value, in the one member or in all that are free.
    pub fn apply(&self, scene: &Scene, value: f64) -> Scene {
        let mut varied = scene.clone();
        match self.member {
            Some(at) => (self.key.set)(&mut varied, at, value),
            None => {
                for at in (0..(self.key.count)(scene)).filter(|at| (self.key.free)(scene, *at)) {
                    (self.key.set)(&mut varied, at, value);
                }
            }
        }
        varied
    }
}

/// The key and the member `list[index].field` names.
fn find(id: &str) -> Result<(&'static Key, Option<usize>), VaryError> {
    let (plain, member) = match id
        .split_once('[')
        .map(|(list, rest)| (list, rest.split_once(']')))
    {
        Some((list, Some((index, field)))) => match index.parse() {
            Ok(index) => (format!("{list}{field}"), Some(index)),
            Err(_) => (id.to_owned(), None),
        },
        _ => (id.to_owned(), None),
    };
    let known: Vec<&str> = KEYS.iter().map(|key| key.id).collect();
    let key = KEYS.iter().find(|key| key.id == plain);
    key.map(|key| (key, member)).ok_or_else(|| {
        let near = suggest::nearest(&plain, &known);
        VaryError::Unknown {
            key: id.to_owned(),
            hint: near.map_or(String::new(), |near| format!(" (did you mean `{near}`?)")),
            known: known.join(", "),
            example: "springs[3].stiffness or particles[1].mass",
        }
    })
}
