//! Trajectories as NumPy arrays: `t`, `x` and `v` in an archive, or the positions alone.

use super::array::Header;
use super::digits::Written;
use super::error::{HALF, Place, ReadError, Wrong};
use super::expected::Expected;
use super::shape::{Shape, tuple};
use super::times::{Source, Times};
use super::{Numbers, Table};
use crate::scene::words::{nearest, shorten};
use std::io::{Cursor, Read};
use zip::{ZipArchive, result::ZipError};

/// The arrays an archive may hold.
const NAMES: [&str; 3] = ["t", "x", "v"];
const EXAMPLE: &str = "np.savez('mine.npz', t=t, x=x, v=v) writes what is read here";

/// Reads an archive as `np.savez` and `np.savez_compressed` write it.
pub(super) fn read(bytes: &[u8], file: &str, expected: &Expected) -> Result<Table, ReadError> {
    let whole = |wrong: Wrong| wrong.at(file, Place::File);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| {
        whole(if bytes.starts_with(b"PK") {
            Wrong::new(format!("the archive cannot be read: {error}"), HALF)
        } else {
            Wrong::new("this is no NPZ archive", EXAMPLE)
        })
    })?;
    let known = |name: &str| {
        name.strip_suffix(".npy")
            .is_some_and(|name| NAMES.contains(&name))
    };
    if let Some(name) = archive.file_names().find(|name| !known(name)) {
        return Err(whole(unknown(name)));
    }
    let mut find = |name| match archive.by_name(&format!("{name}.npy")) {
        Ok(entry) => Array::read(name, entry, file, expected).map(Some),
        Err(ZipError::FileNotFound) => Ok(None),
        Err(error) => {
            let message = format!("cannot be unpacked: {error}");
            Err(Wrong::new(message, EXAMPLE).at(file, of(name)))
        }
    };
    let (Some(t), Some(x)) = (find("t")?, find("x")?) else {
        let message = "expected arrays `t` and `x`, and `v` if wanted";
        return Err(whole(Wrong::new(message, EXAMPLE)));
    };
    let v = find("v")?;
    let instants = t.numbers.values.len();
    for array in [Some(&x), v.as_ref()].into_iter().flatten() {
        let (found, positions) = (&array.shape, &x.shape);
        if found.instants() != instants {
            let message = format!(
                "expected the {instants} instants of t, found {}",
                found.instants()
            );
            return Err(Wrong::new(message, "").at(file, of(array.name)));
        }
        if found != positions {
            let message = format!(
                "expected x's shape {}, found {}",
                tuple(&x.sizes),
                tuple(&array.sizes)
            );
            return Err(Wrong::new(message, "").at(file, of(array.name)));
        }
    }
    Ok(Table {
        times: Times {
            values: t.numbers.values,
            written: t.numbers.written,
            source: Source::Array,
        },
        x: x.states(expected.start()),
        v: v.map(|v| v.states(&vec![0.0; 3 * expected.particles()])),
    })
}

/// Reads an array of positions; its times are n timesteps.
pub(super) fn positions(bytes: &[u8], file: &str, expected: &Expected) -> Result<Table, ReadError> {
    let x = Array::read("x", bytes, file, expected)?;
    let instants = 0..x.shape.instants();
    Ok(Table {
        times: Times {
            values: instants.map(|n| n as f64 * expected.timestep()).collect(),
            written: Written::Any,
            source: Source::Array,
        },
        x: x.states(expected.start()),
        v: None,
    })
}

/// One array of a file.
struct Array {
    name: &'static str,
    sizes: Vec<usize>,
    shape: Shape,
    numbers: Numbers,
}

impl Array {
    fn read(
        name: &'static str,
        mut from: impl Read,
        file: &str,
        expected: &Expected,
    ) -> Result<Self, ReadError> {
        let fail = |wrong: Wrong| wrong.at(file, of(name));
        let header = Header::read(&mut from).map_err(fail)?;
        // The shape first: it says how much there is to read.
        let shape = match name {
            "t" => Shape::of_times(&header.shape),
            _ => Shape::new(name, &header.shape, expected),
        };
        let shape = shape.map_err(fail)?;
        let values = header.numbers(&mut from).map_err(fail)?;
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            let place = Place::Array {
                name: name.to_owned(),
                index: index(at, &header.shape),
            };
            let message = format!("expected a finite number, found {}", values[at]);
            let help = "end the arrays before the first number that is none";
            return Err(Wrong::new(message, help).at(file, place));
        }
        let written = match header.is_single() {
            true => Written::Single,
            false => Written::Any,
        };
        Ok(Self {
            name,
            sizes: header.shape,
            shape,
            numbers: Numbers { values, written },
        })
    }

    fn states(self, missing: &[f64]) -> Numbers {
        Numbers {
            values: self.shape.fill(self.numbers.values, missing),
            written: self.numbers.written,
        }
    }
}

/// The array as a whole.
fn of(name: &str) -> Place {
    Place::Array {
        name: name.to_owned(),
        index: Vec::new(),
    }
}

/// Of the number at this place in C order.
fn index(mut at: usize, shape: &[usize]) -> Vec<usize> {
    let mut index = vec![0; shape.len()];
    for (i, size) in index.iter_mut().zip(shape).rev() {
        *i = at % (*size).max(1);
        at /= (*size).max(1);
    }
    index
}

fn unknown(entry: &str) -> Wrong {
    let Some(name) = entry.strip_suffix(".npy") else {
        let message = format!("`{}` in the archive is no NumPy array", shorten(entry));
        return Wrong::new(message, EXAMPLE);
    };
    let help = match nearest(name, &NAMES) {
        Some(near) => format!("did you mean `{near}`?"),
        None => format!("the arrays are t, x and v: {EXAMPLE}"),
    };
    Wrong::new(format!("unknown array `{}`", shorten(name)), help)
}
