//! Arrays in NPY format, of real numbers; by NumPy's description of its format, versions 1 to 3.

use super::error::{HALF, Wrong};
use super::limits;
use crate::scene::words::shorten;
use std::io::{ErrorKind, Read};

/// The contents of an array's header.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Header {
    number: Number,
    fortran: bool,
    pub shape: Vec<usize>,
}

/// How one number is stored.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Number {
    kind: u8,
    bytes: usize,
    big_endian: bool,
}

const NO_ARRAY: &str = "write it with np.save or np.savez";

impl Header {
    /// Reads up to where the numbers begin. Nothing is allocated for sizes it only claims.
    pub fn read(from: &mut dyn Read) -> Result<Self, Wrong> {
        let mut start = [0; 8];
        exactly(from, &mut start)?;
        let length = match start {
            [b'\x93', b'N', b'U', b'M', b'P', b'Y', 1, _] => {
                let mut length = [0; 2];
                exactly(from, &mut length)?;
                usize::from(u16::from_le_bytes(length))
            }
            [b'\x93', b'N', b'U', b'M', b'P', b'Y', 2 | 3, _] => {
                let mut length = [0; 4];
                exactly(from, &mut length)?;
                u32::from_le_bytes(length) as usize
            }
            _ => return Err(Wrong::new("this is no NumPy array", NO_ARRAY)),
        };
        if length > limits::ARRAY_HEADER {
            return Err(Wrong::new(format!("a header of {length} bytes"), NO_ARRAY));
        }
        let mut text = vec![0; length];
        exactly(from, &mut text)?;
        Parser { rest: &text }.header().unwrap_or_else(|| {
            let text = shorten(String::from_utf8_lossy(&text).trim());
            Err(Wrong::new(
                format!("not a header of a NumPy array: {text}"),
                NO_ARRAY,
            ))
        })
    }

    /// Whether the numbers are in single precision.
    pub fn is_single(&self) -> bool {
        self.number.kind == b'f' && self.number.bytes == 4
    }

    /// Reads the numbers in C order; anything after them is an error.
    pub fn numbers(&self, from: &mut dyn Read) -> Result<Vec<f64>, Wrong> {
        let product = |sizes: &[usize]| {
            let mut sizes = sizes.iter();
            sizes.try_fold(1usize, |product, size| product.checked_mul(*size))
        };
        let count = product(&self.shape).filter(|count| *count <= limits::NUMBERS);
        let Some(count) = count else {
            let message = format!(
                "expected at most {} numbers, found the shape {}",
                limits::NUMBERS,
                tuple(&self.shape)
            );
            return Err(Wrong::new(message, "keep fewer instants"));
        };
        let wanted = count * self.number.bytes;
        // One more byte than wanted tells whether something follows. The header's claim alone
        // reserves at most a megabyte.
        let mut bytes = Vec::with_capacity(wanted.min(1 << 20));
        let read = from.take(wanted as u64 + 1).read_to_end(&mut bytes);
        if let Err(error) = read {
            return Err(damaged(&error));
        }
        if bytes.len() < wanted {
            let message = format!("expected {wanted} bytes of numbers, found {}", bytes.len());
            return Err(Wrong::new(message, HALF));
        }
        if bytes.len() > wanted {
            return Err(Wrong::new(
                format!("expected {wanted} bytes of numbers, found more"),
                "save one array, once",
            ));
        }
        let numbers = bytes.chunks_exact(self.number.bytes);
        let numbers: Vec<f64> = numbers.map(|bytes| self.number.decode(bytes)).collect();
        Ok(if self.fortran {
            self.to_c_order(&numbers)
        } else {
            numbers
        })
    }

    /// Reorders numbers whose first index varies fastest so that the last index does.
    fn to_c_order(&self, numbers: &[f64]) -> Vec<f64> {
        let stored = |mut at: usize| {
            // Neighbours along an axis lie as far apart as the product of all sizes before it.
            let (mut apart, mut stored) = (numbers.len(), 0);
            for size in self.shape.iter().rev() {
                apart /= size;
                stored += at % size * apart;
                at /= size;
            }
            numbers[stored]
        };
        (0..numbers.len()).map(stored).collect()
    }
}

/// A shape as Python writes it.
pub(super) fn tuple(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => {
            let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

fn exactly(from: &mut dyn Read, buffer: &mut [u8]) -> Result<(), Wrong> {
    from.read_exact(buffer).map_err(|error| match error.kind() {
        ErrorKind::UnexpectedEof => Wrong::new("the array ends within its header", HALF),
        _ => damaged(&error),
    })
}

/// The error of an archive whose contents are not what was put in.
fn damaged(error: &std::io::Error) -> Wrong {
    Wrong::new(format!("cannot be unpacked: {error}"), HALF)
}

impl Number {
    /// Reads NumPy's type string: `<f8`, `>f4`, `|i1`.
    fn new(described: &str) -> Result<Self, Wrong> {
        let refuse = |help: &str| {
            let message = format!("expected real numbers, found type '{}'", shorten(described));
            Err(Wrong::new(message, help))
        };
        let (&[order, kind, ..], Some(size)) = (described.as_bytes(), described.get(2..)) else {
            return refuse("");
        };
        let bytes = match (kind, size) {
            (b'f', "4" | "8") | (b'i' | b'u', "1" | "2" | "4" | "8") => {
                usize::from(size.as_bytes()[0] - b'0')
            }
            (b'f', "2") => return refuse("half precision keeps three digits: compute in double"),
            (b'f' | b'b' | b'i' | b'u', _) => return refuse("save x.astype(float)"),
            (b'O', _) => return refuse("objects are no numbers: save np.array(x, dtype=float)"),
            (b'c', _) => return refuse("save x.real"),
            _ => return refuse(""),
        };
        Ok(Self {
            kind,
            bytes,
            big_endian: order == b'>',
        })
    }

    /// One number from its bytes; whole numbers beyond 2^53 are rounded.
    fn decode(self, stored: &[u8]) -> f64 {
        // Sign and value in the highest bytes: shifting down extends the sign.
        let mut bytes = [0; 8];
        let size = self.bytes;
        bytes[8 - size..].copy_from_slice(stored);
        if self.big_endian {
            bytes[8 - size..].reverse();
        }
        let shift = 8 * (8 - size as u32);
        match self.kind {
            b'i' => (i64::from_le_bytes(bytes) >> shift) as f64,
            b'u' => (u64::from_le_bytes(bytes) >> shift) as f64,
            _ if size == 4 => f64::from(f32::from_bits((u64::from_le_bytes(bytes) >> 32) as u32)),
            _ => f64::from_le_bytes(bytes),
        }
    }
}

/// Reads the header's Python dictionary. It gives None for what NumPy never writes.
struct Parser<'a> {
    rest: &'a [u8],
}

impl<'a> Parser<'a> {
    fn header(&mut self) -> Option<Result<Header, Wrong>> {
        let (mut number, mut fortran, mut shape) = (None, None, None);
        self.take(b'{')?;
        while self.take(b'}').is_none() {
            let key = self.text()?;
            self.take(b':')?;
            match key {
                "descr" if self.next()? == b'[' => {
                    let help = "save plain arrays t, x and v instead of records";
                    return Some(Err(Wrong::new(
                        "expected real numbers, found records",
                        help,
                    )));
                }
                "descr" => number = Some(self.text()?),
                "fortran_order" => fortran = Some(self.truth()?),
                "shape" => shape = Some(self.sizes()?),
                _ => return None,
            }
            if self.take(b',').is_none() && self.next()? != b'}' {
                return None;
            }
        }
        let (fortran, shape) = (fortran?, shape?);
        let header = |number| Header {
            number,
            fortran,
            shape,
        };
        Some(Number::new(number?).map(header))
    }

    fn next(&mut self) -> Option<u8> {
        self.rest = self.rest.trim_ascii_start();
        self.rest.first().copied()
    }

    fn take(&mut self, byte: u8) -> Option<()> {
        (self.next()? == byte).then(|| self.rest = &self.rest[1..])
    }

    fn text(&mut self) -> Option<&'a str> {
        let quote = self.next().filter(|b| matches!(b, b'\'' | b'"'))?;
        let inside = &self.rest[1..];
        let end = inside.iter().position(|b| *b == quote)?;
        self.rest = &inside[end + 1..];
        std::str::from_utf8(&inside[..end]).ok()
    }

    fn truth(&mut self) -> Option<bool> {
        self.next()?;
        for (word, value) in [(&b"True"[..], true), (b"False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Some(value);
            }
        }
        None
    }

    fn sizes(&mut self) -> Option<Vec<usize>> {
        let mut sizes = Vec::new();
        self.take(b'(')?;
        while self.take(b')').is_none() {
            self.next()?;
            let end = self.rest.iter().position(|b| !b.is_ascii_digit())?;
            let digits = std::str::from_utf8(&self.rest[..end]).ok()?;
            self.rest = &self.rest[end..];
            // A size beyond any memory is as good as the largest; Python 2 writes 3L.
            sizes.push(match digits.parse() {
                Err(_) if digits.len() > 19 => usize::MAX,
                size => size.ok()?,
            });
            let _ = self.take(b'L');
            if self.take(b',').is_none() && self.next()? != b')' {
                return None;
            }
        }
        Some(sizes)
    }
}
