//! Trajectories as NumPy arrays: `t`, `x` and `v` in an archive, or the positions alone.

use super::array::{Header, tuple};
use super::error::{ErrorPlace, HALF, PLANE, ReadError, SPACE, Wrong};
use super::expected::{AXES, Expected};
use super::times::Times;
use super::{Numbers, Precision, Table};
use crate::scene::words::{nearest, shorten};
use std::io::{Cursor, Read};
use zip::{ZipArchive, result::ZipError};

/// The arrays an archive may hold.
const NAMES: [&str; 3] = ["t", "x", "v"];
/// Arrays that `--columns` adds, which say nothing of the state.
const BESIDE: [&str; 2] = ["reaction", "tension"];
const EXAMPLE: &str = "np.savez('mine.npz', t=t, x=x, v=v) writes what is read here";

/// Reads an archive as `np.savez` and `np.savez_compressed` write it.
pub(super) fn read(bytes: &[u8], expected: &Expected) -> Result<Table, ReadError> {
    let whole = |wrong: Wrong| wrong.at(ErrorPlace::File);
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(|error| {
        whole(if bytes.starts_with(b"PK") {
            Wrong::new(format!("the archive cannot be read: {error}"), HALF)
        } else {
            Wrong::new("this is no NPZ archive", EXAMPLE)
        })
    })?;
    // Of two entries of one name the archive shows one.
    if entries(bytes).is_some_and(|entries| entries > archive.len()) {
        let message = "the archive has an array twice";
        return Err(whole(Wrong::new(message, EXAMPLE)));
    }
    let known = |name: &str| {
        name.strip_suffix(".npy")
            .is_some_and(|name| NAMES.contains(&name) || BESIDE.contains(&name))
    };
    if let Some(name) = archive.file_names().find(|name| !known(name)) {
        return Err(whole(unknown(name)));
    }
    let mut find = |name| match archive.by_name(&format!("{name}.npy")) {
        Ok(entry) => Array::read(name, entry, expected).map(Some),
        Err(ZipError::FileNotFound) => Ok(None),
        Err(error) => {
            let message = format!("cannot be unpacked: {error}");
            Err(Wrong::new(message, EXAMPLE).at(of(name)))
        }
    };
    let (Some(t), Some(x)) = (find("t")?, find("x")?) else {
        let message = "expected arrays `t` and `x`, and `v` if wanted";
        return Err(whole(Wrong::new(message, EXAMPLE)));
    };
    let v = find("v")?;
    let instants = t.numbers.values.len();
    for array in [Some(&x), v.as_ref()].into_iter().flatten() {
        if array.sizes[0] != instants {
            let found = array.sizes[0];
            let message = format!("expected the {instants} instants of t, found {found}");
            let help = "give one row of each array for each instant";
            return Err(Wrong::new(message, help).at(of(array.name)));
        }
        if array.coordinates != x.coordinates {
            let message = format!(
                "expected x's shape {}, found {}",
                tuple(&x.sizes),
                tuple(&array.sizes)
            );
            let help = "give the velocities of those particles whose positions are given";
            return Err(Wrong::new(message, help).at(of(array.name)));
        }
    }
    Ok(Table {
        times: Times {
            numbers: t.numbers,
            fields: None,
        },
        left_out: expected.left_out(|id| x.coordinates.contains(&(3 * id))),
        x: x.states(&expected.start),
        v: v.map(|v| v.states(&vec![0.0; 3 * expected.particles()])),
        cut: false,
    })
}

/// The number of entries an archive's last record states; None where it has none.
fn entries(bytes: &[u8]) -> Option<usize> {
    let end = bytes.windows(4).rposition(|w| w == b"PK\x05\x06")?;
    let count = bytes.get(end + 10..end + 12)?;
    Some(usize::from(u16::from_le_bytes(count.try_into().ok()?)))
}

/// Reads an array of positions; its times are n timesteps.
pub(super) fn positions(bytes: &[u8], expected: &Expected) -> Result<Table, ReadError> {
    let x = Array::read("x", bytes, expected)?;
    let instants = 0..x.sizes[0];
    Ok(Table {
        times: Times {
            numbers: Numbers {
                values: instants.map(|n| n as f64 * expected.timestep).collect(),
                written: Precision::Double,
            },
            fields: None,
        },
        left_out: expected.left_out(|id| x.coordinates.contains(&(3 * id))),
        x: x.states(&expected.start),
        v: None,
        cut: false,
    })
}

/// One array of a file.
struct Array {
    name: &'static str,
    /// The shape: instants first, at least one.
    sizes: Vec<usize>,
    /// What one instant of positions or velocities gives, in order: all coordinates, those of free
    /// particles, or the one on the free axis.
    coordinates: Vec<usize>,
    numbers: Numbers,
}

impl Array {
    fn read(
        name: &'static str,
        mut from: impl Read,
        expected: &Expected,
    ) -> Result<Self, ReadError> {
        let fail = |wrong: Wrong| wrong.at(of(name));
        let header = Header::read(&mut from).map_err(fail)?;
        // The shape is read first: it says how much there is to read.
        let coordinates = coordinates(name, &header.shape, expected).map_err(fail)?;
        if header.shape[0] == 0 {
            let wrong = Wrong::new("expected at least one instant, found none", HALF);
            return Err(fail(wrong));
        }
        let values = header.numbers(&mut from).map_err(fail)?;
        if let Some(at) = values.iter().position(|value| !value.is_finite()) {
            let place = ErrorPlace::Array {
                name: name.to_owned(),
                index: index(at, &header.shape),
            };
            let message = format!("expected a finite number, found {}", values[at]);
            let help = "end the arrays before the first number that is none";
            return Err(Wrong::new(message, help).at(place));
        }
        let written = match header.is_single() {
            true => Precision::Single,
            false => Precision::Double,
        };
        Ok(Self {
            name,
            sizes: header.shape,
            coordinates,
            numbers: Numbers { values, written },
        })
    }

    /// Whole states; what is not given is taken from `missing`.
    fn states(self, missing: &[f64]) -> Numbers {
        let Numbers { values, written } = self.numbers;
        if self.coordinates.len() == missing.len() {
            return Numbers { values, written };
        }
        let mut whole = missing.repeat(self.sizes[0]);
        let given = values.chunks_exact(self.coordinates.len());
        for (state, given) in whole.chunks_exact_mut(missing.len()).zip(given) {
            for (at, value) in self.coordinates.iter().zip(given) {
                state[*at] = *value;
            }
        }
        Numbers {
            values: whole,
            written,
        }
    }
}

/// The coordinates that an array of this name and shape gives at one instant, empty for times. An
/// array that cannot be of this scene is an error.
fn coordinates(name: &str, shape: &[usize], expected: &Expected) -> Result<Vec<usize>, Wrong> {
    if name == "t" {
        let help = "t.ravel() makes it so";
        let wrong = || {
            Wrong::new(
                format!("expected the shape (T,), found {}", tuple(shape)),
                help,
            )
        };
        return (shape.len() == 1).then(Vec::new).ok_or_else(wrong);
    }
    let (n, free, axes) = (expected.particles(), expected.free(), expected.axes());
    let of = |particles: &[usize]| -> Vec<usize> {
        let each = particles.iter();
        each.flat_map(|id| axes.iter().map(move |axis| 3 * id + axis))
            .collect()
    };
    let all: Vec<usize> = (0..n).collect();
    match (shape, &free[..], expected.free_axis) {
        (&[_, k, d], ..) if k == n && d == axes.len() => Ok(of(&all)),
        (&[_, k, d], ..) if k == free.len() && d == axes.len() => Ok(of(&free)),
        (&[_, d], [_], _) if d == axes.len() => Ok(of(&free)),
        (&[_], _, Some(free)) => Ok(vec![free.coordinate()]),
        _ => Err(Wrong::new(
            format!(
                "expected the shape (T, {n}, {}), found {}",
                axes.len(),
                tuple(shape)
            ),
            remedy(name, shape, expected),
        )),
    }
}

/// A guess at what the array is, in NumPy's words.
fn remedy(x: &str, shape: &[usize], expected: &Expected) -> String {
    let (n, free) = (expected.particles(), expected.free().len());
    let d = expected.axes().len();
    // The shape as it would be with this many coordinates.
    let has = |d: usize| match *shape {
        [_, k, last] => (k == n || k == free) && last == d,
        [_, last] => free == 1 && last == d,
        _ => false,
    };
    match *shape {
        _ if d == 3 && has(2) => PLANE.to_owned(),
        _ if d == 2 && has(3) => SPACE.to_owned(),
        [_, k] if k == d * n => format!("{x}.reshape(-1, {n}, {d}) makes it so"),
        [a, c, _] if a == n && c == d => format!("{x}.transpose(2, 0, 1) makes it so"),
        [c, b, _] if b == n && c == d => format!("{x}.transpose(2, 1, 0) makes it so"),
        [a, _, c] if a == n && c == d => format!("{x}.transpose(1, 0, 2) makes it so"),
        [_, c, b] if b == n && c == d => format!("{x}.transpose(0, 2, 1) makes it so"),
        _ => {
            let axes = expected.axes().into_iter().map(|axis| AXES[axis]);
            let axes = axes.collect::<Vec<_>>().join(", ");
            format!("instants, then the scene's {n} particles, then {axes}")
        }
    }
}

/// The place of the array as a whole.
fn of(name: &str) -> ErrorPlace {
    ErrorPlace::Array {
        name: name.to_owned(),
        index: Vec::new(),
    }
}

/// The index of the number at this place in C order.
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
