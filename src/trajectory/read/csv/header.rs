//! The names of a text file's columns.

use super::super::error::Wrong;
use super::super::expected::Expected;
use super::bare;
use crate::scene::words::{nearest, shorten};

/// The fields of a record in which the numbers stand.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Columns {
    pub t: usize,
    pub id: Option<usize>,
    /// Fields of the positions: three, or the one on the scene's free axis.
    pub x: Vec<usize>,
    /// Fields of the velocities: as many as `x`, or none.
    pub v: Vec<usize>,
    /// Number of fields in a record.
    pub count: usize,
}

const NAMES: [&str; 9] = ["t", "id", "x", "y", "z", "vx", "vy", "vz", "v"];
const EXAMPLE: &str = "write `t,id,x,y,z` or `t,id,x,y,z,vx,vy,vz` above the numbers";

impl Columns {
    /// Reads the fields of the header; an error comes with the field it is about.
    pub fn new<'a>(
        fields: impl Iterator<Item = &'a [u8]>,
        expected: &Expected,
    ) -> Result<Self, (usize, Wrong)> {
        let mut places = [None; NAMES.len()];
        let mut count = 0;
        for (at, field) in fields.enumerate() {
            let name = String::from_utf8_lossy(bare(field)).to_lowercase();
            let Some(known) = NAMES.iter().position(|known| *known == name) else {
                return Err((at, unknown(&name)));
            };
            if places[known].replace(at).is_some() {
                return Err((
                    at,
                    Wrong::new(format!("the column `{name}` a second time"), ""),
                ));
            }
            count += 1;
        }
        let [t, id, x, y, z, vx, vy, vz, v] = places;
        let missing = |names: &str| {
            let message = format!("the header lacks {names}");
            Err((0, Wrong::new(message, EXAMPLE)))
        };
        let Some(t) = t else { return missing("`t`") };
        let (x, v) = match ([x, y, z], [vx, vy, vz], v) {
            ([Some(x), None, None], [None, None, None], v) => (vec![x], v.into_iter().collect()),
            ([Some(x), Some(y), Some(z)], v, None) => match v {
                [None, None, None] => (vec![x, y, z], vec![]),
                [Some(vx), Some(vy), Some(vz)] => (vec![x, y, z], vec![vx, vy, vz]),
                _ => return missing("one of `vx`, `vy`, `vz`"),
            },
            ([Some(_), Some(_), Some(_)], _, Some(at)) => {
                let wrong = Wrong::new("`v` beside `x`, `y`, `z`", "name it vx, vy or vz");
                return Err((at, wrong));
            }
            _ => return missing("one of `x`, `y`, `z`"),
        };
        let columns = Self { t, id, x, v, count };
        columns.check(expected).map_err(|wrong| (0, wrong))?;
        Ok(columns)
    }

    /// Whether these columns say all that this scene needs.
    fn check(&self, expected: &Expected) -> Result<(), Wrong> {
        if self.x.len() == 1 {
            if self.id.is_some() || expected.free_axis.is_none() {
                let message = "`x` alone is for a scene with one free particle that moves on one \
                               axis, without `id`";
                return Err(Wrong::new(message, EXAMPLE));
            }
        } else if self.id.is_none() && expected.only().is_none() {
            let message = format!(
                "the header lacks `id`, and the scene has {} free particles",
                expected.free().len()
            );
            return Err(Wrong::new(message, EXAMPLE));
        }
        Ok(())
    }
}

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
