//! The names of a text file's columns.

use super::super::error::{PLANE, SPACE, Wrong};
use super::super::expected::{AXES, Expected};
use super::bare;
use crate::scene::words::{nearest, shorten};
use std::collections::BTreeMap;

/// The fields of a record in which the numbers stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Columns {
    pub t: usize,
    /// None where each record is a whole instant.
    pub id: Option<usize>,
    /// The field of each position and its coordinate: of the record's particle where there is an `id`,
    /// else of the whole state.
    pub x: Vec<(usize, usize)>,
    /// The same of the velocities: as many as `x`, or none.
    pub v: Vec<(usize, usize)>,
    /// The particles a record gives where there is no `id`.
    pub particles: Vec<usize>,
    /// Number of fields in a record.
    pub count: usize,
}

const NAMES: [&str; 9] = ["t", "id", "x", "y", "z", "vx", "vy", "vz", "v"];
const EXAMPLE: &str = "write `t,id,x,y,z` or `t,id,x,y,z,vx,vy,vz` above the numbers";
const WIDE: &str =
    "write `t,x0,y0,z0,x1,...`, then `vx0,vy0,vz0,...` if wanted, or one particle a line";

/// A column of positions or velocities.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Column {
    /// Only in wide text, such as 12 in `x12`.
    particle: Option<usize>,
    velocity: bool,
    /// None for `v`, the velocity on the scene's free axis.
    axis: Option<usize>,
}

impl Column {
    /// `x`, `vy`, `v`, `z12` or `vz_12`.
    fn new(name: &str) -> Option<Self> {
        let plain = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let particle = match &name[plain.len()..] {
            "" => None,
            digits => Some(digits.parse().ok()?),
        };
        let plain = match particle {
            Some(_) => plain.strip_suffix('_').unwrap_or(plain),
            None => plain,
        };
        let letter = plain.strip_prefix('v');
        let axis = AXES
            .iter()
            .position(|axis| *axis == letter.unwrap_or(plain));
        let single = plain == "v" && particle.is_none();
        (axis.is_some() || single).then_some(Self {
            particle,
            velocity: letter.is_some(),
            axis,
        })
    }
}

/// The names in a header, each with its field.
pub(super) struct Header {
    t: Option<usize>,
    id: Option<usize>,
    columns: BTreeMap<Column, usize>,
    count: usize,
}

type Located<T> = Result<T, (usize, Wrong)>;

impl Header {
    /// Reads the fields of a header; an error comes with the field it is about.
    pub fn read<'a>(fields: impl Iterator<Item = &'a [u8]>) -> Located<Self> {
        let mut header = Self {
            t: None,
            id: None,
            columns: BTreeMap::new(),
            count: 0,
        };
        for (at, field) in fields.enumerate() {
            let name = String::from_utf8_lossy(bare(field)).to_lowercase();
            let before = match name.as_str() {
                "t" => header.t.replace(at),
                "id" => header.id.replace(at),
                // What `--columns` adds says nothing of the state.
                "rx" | "ry" | "rz" => {
                    header.count += 1;
                    continue;
                }
                _ => match Column::new(&name) {
                    Some(column) => header.columns.insert(column, at),
                    None => return Err((at, unknown(&name))),
                },
            };
            if before.is_some() {
                let message = format!("the column `{name}` a second time");
                return Err((at, Wrong::new(message, "leave one of them out")));
            }
            header.count += 1;
        }
        Ok(header)
    }

    /// The columns, if they say all that this scene needs and nothing else.
    pub fn columns(self, expected: &Expected) -> Located<Columns> {
        let whole = |wrong: Wrong| (0, wrong);
        let Some(t) = self.t else {
            return Err(whole(Wrong::new("the header lacks `t`", EXAMPLE)));
        };
        let wide = self.columns.keys().any(|column| column.particle.is_some());
        let (x, v, particles) = match wide {
            true => self.wide(expected)?,
            false => self.long(expected)?,
        };
        Ok(Columns {
            t,
            id: self.id,
            x,
            v,
            particles,
            count: self.count,
        })
    }

    /// One particle a record, or the only one that is free.
    fn long(&self, expected: &Expected) -> Located<Cells> {
        let whole = |wrong: Wrong| (0, wrong);
        let only = expected.only();
        let names = self.columns.keys();
        let positions: Vec<Option<usize>> = names.filter(|c| !c.velocity).map(|c| c.axis).collect();
        if positions == [Some(0)] {
            let Some(free) = expected.free_axis.filter(|_| self.id.is_none()) else {
                let message = "`x` alone is for a scene with one free particle that moves on one \
                               axis, without `id`";
                return Err(whole(Wrong::new(message, EXAMPLE)));
            };
            let known =
                |c: &&Column| matches!(c.axis, None | Some(0)) && !(c.velocity && c.axis.is_some());
            if let Some(other) = self.columns.keys().find(|c| !known(c)) {
                let wrong = Wrong::new("`x` alone goes with `v`", EXAMPLE);
                return Err((self.columns[other], wrong));
            }
            let field = |velocity: bool| {
                let found = self.columns.iter().find(|(c, _)| c.velocity == velocity);
                found.map(|(_, field)| (*field, free.coordinate()))
            };
            return Ok((
                field(false).into_iter().collect(),
                field(true).into_iter().collect(),
                vec![free.particle],
            ));
        }
        if self.id.is_none() && only.is_none() {
            let message = format!(
                "the header lacks `id`, and the scene has {} free particles",
                expected.free().len()
            );
            return Err(whole(Wrong::new(message, EXAMPLE)));
        }
        if let Some((_, at)) = self
            .columns
            .iter()
            .find(|(column, _)| column.axis.is_none())
        {
            let wrong = Wrong::new("`v` beside `x`, `y`, `z`", "name it vx, vy or vz");
            return Err((*at, wrong));
        }
        let first = match self.id {
            Some(_) => 0,
            None => 3 * only.unwrap_or_default(),
        };
        let (x, v) = self.particle(None, first, expected).map_err(whole)?;
        Ok((x, v, only.into_iter().collect()))
    }

    /// All particles in one record.
    fn wide(&self, expected: &Expected) -> Located<Cells> {
        if let Some(id) = self.id {
            let wrong = Wrong::new("`id` beside columns of single particles", WIDE);
            return Err((id, wrong));
        }
        let mut particles = Vec::new();
        for (column, field) in &self.columns {
            match column.particle {
                Some(particle) if particle < expected.particles() => particles.push(particle),
                Some(particle) => {
                    let last = expected.particles() - 1;
                    let message = format!("expected particles from 0 to {last}, found {particle}");
                    let help = "particles count from 0, as in the scene";
                    return Err((*field, Wrong::new(message, help)));
                }
                None => {
                    let message = "a column without a particle beside columns of single particles";
                    return Err((*field, Wrong::new(message, WIDE)));
                }
            }
        }
        particles.dedup();
        let all: Vec<usize> = (0..expected.particles()).collect();
        let free = expected.free();
        if particles != all && particles != free {
            let missing = free.iter().chain(&all).find(|id| !particles.contains(id));
            let missing = missing.copied().unwrap_or_default();
            let message = format!("the header lacks particle {missing}");
            return Err((0, Wrong::new(message, WIDE)));
        }
        let (mut x, mut v) = (Vec::new(), Vec::new());
        for &particle in &particles {
            let cells = self.particle(Some(particle), 3 * particle, expected);
            let (own_x, own_v) = cells.map_err(|wrong| (0, wrong))?;
            x.extend(own_x);
            v.extend(own_v);
        }
        if !v.is_empty() && v.len() != x.len() {
            let message = "the header has velocities of some particles only";
            return Err((0, Wrong::new(message, WIDE)));
        }
        Ok((x, v, particles))
    }

    /// The fields of one particle, whose coordinates begin at `first`.
    fn particle(
        &self,
        particle: Option<usize>,
        first: usize,
        expected: &Expected,
    ) -> Result<(Vec<Cell>, Vec<Cell>), Wrong> {
        let wanted = expected.axes();
        let example = match particle {
            Some(_) => WIDE,
            None => EXAMPLE,
        };
        let field = |velocity: bool, axis: usize| {
            self.columns.get(&Column {
                particle,
                velocity,
                axis: Some(axis),
            })
        };
        let given = |velocity: bool| -> Vec<usize> {
            (0..3)
                .filter(|axis| field(velocity, *axis).is_some())
                .collect()
        };
        // Data of a plane names its own two axes x and y, or as the scene does.
        let fits = |given: &[usize]| given == wanted || (wanted.len() == 2 && given == [0, 1]);
        let cells = |velocity: bool, names: &[usize]| -> Vec<Cell> {
            let fields = names.iter().filter_map(|axis| field(velocity, *axis));
            let coordinates = wanted.iter().map(|axis| first + axis);
            fields.copied().zip(coordinates).collect()
        };
        let lacks = |velocity: bool, found: usize| {
            let index = particle.map_or(String::new(), |particle| particle.to_string());
            let name = |axis: &usize| {
                let v = if velocity { "v" } else { "" };
                format!("`{v}{}{index}`", AXES[*axis])
            };
            let names: Vec<String> = wanted.iter().map(name).collect();
            let help = match (wanted.len(), found) {
                (3, 2) => PLANE,
                (2, 3) => SPACE,
                _ => example,
            };
            let message = match (wanted.len(), found) {
                (2, 3) => format!("expected {} alone", names.join(", ")),
                _ => format!("the header lacks one of {}", names.join(", ")),
            };
            Wrong::new(message, help)
        };
        let positions = given(false);
        if !fits(&positions) {
            return Err(lacks(false, positions.len()));
        }
        let velocities = given(true);
        if !velocities.is_empty() && velocities != positions {
            return Err(match velocities.len() > positions.len() {
                true => lacks(true, velocities.len()),
                false => Wrong::new(lacks(true, 0).message, example),
            });
        }
        Ok((cells(false, &positions), cells(true, &velocities)))
    }
}

/// A field, and the coordinate it gives.
type Cell = (usize, usize);
/// Positions, velocities, and the particles of a record without `id`.
type Cells = (Vec<Cell>, Vec<Cell>, Vec<usize>);

/// The error of a name that belongs to no column.
fn unknown(name: &str) -> Wrong {
    if name.parse::<f64>().is_ok() {
        return Wrong::new(
            format!("expected a header, found the number {}", shorten(name)),
            EXAMPLE,
        );
    }
    let message = format!("unknown column `{}`", shorten(name));
    let separator = [';', '\t', ' '].into_iter().find(|c| name.contains(*c));
    let help = match (separator, nearest(name, &NAMES)) {
        (Some(_), _) => "separate columns by commas".to_owned(),
        (None, Some(near)) => format!("did you mean `{near}`?"),
        (None, None) => format!("the columns are {}: remove others", NAMES[..8].join(", ")),
    };
    Wrong::new(message, help)
}
