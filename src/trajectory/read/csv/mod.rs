//! Trajectories as text: `t,id,x,y,z[,vx,vy,vz]`, wide as `t,x0,y0,z0,x1,...`, or `t,x[,v]` on a free
//! axis.

mod header;
mod tail;

use super::digits::Form;
use super::error::{HALF, ReadError, Wrong, of_end, of_field, without_mark};
use super::expected::Expected;
use super::times::{self, Times};
use super::{ErrorPlace, Numbers, Table, limits};
use crate::scene::words::shorten;
use ::csv::{ByteRecord, ReaderBuilder};
use header::{Columns, Header};
use tail::{Tail, Verdict};

/// Reads the text of a file. Quotes around single fields are taken off, but nothing inside quotes
/// is protected: a number needs none.
pub(super) fn read(bytes: &[u8], expected: &Expected) -> Result<Table, ReadError> {
    if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        let wrong = Wrong::new("this text is UTF-16", "save it as UTF-8");
        return Err(wrong.at(ErrorPlace::Text { line: 1, column: 1 }));
    }
    let text = without_mark(bytes);
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .quoting(false)
        .from_reader(text);
    let mut record = ByteRecord::new();
    let mut commented = None;
    let mut rows: Option<Rows> = None;
    // What no line end, blank or quote follows may be cut there.
    let closes = |b: &u8| b.is_ascii_whitespace() || matches!(b, b'"' | b'\'');
    let open = text.last().is_some_and(|b| !closes(b));
    // Reading from memory, into bytes and with any number of fields, cannot fail.
    while reader.read_byte_record(&mut record).unwrap_or(false) {
        let start = record.position().map_or(0, ::csv::Position::byte);
        let end = match reader.position().byte() >= text.len() as u64 {
            false => End::Line,
            true if open => End::Number,
            true => End::File,
        };
        let first = record.get(0).unwrap_or_default().trim_ascii_start();
        let fail = |(field, wrong): (usize, Wrong)| wrong.at(of_field(bytes, start, field));
        if let Some(comment) = first.strip_prefix(b"#") {
            let fields = std::iter::once(comment).chain(record.iter().skip(1));
            commented = commented.or_else(|| Some((Header::read(fields).ok()?, start)));
            continue;
        }
        if record.len() == 1 && first.is_empty() {
            continue;
        }
        if let Some(rows) = &mut rows {
            rows.add(&record, start, end).map_err(fail)?;
            continue;
        }
        // The numbers follow right below a comment that names the columns.
        if let Some((header, start)) = commented.take().filter(|_| number(first).is_some()) {
            let columns = header.columns(expected);
            let columns = columns.map_err(|(field, wrong)| wrong.at(of_field(bytes, start, field)));
            let rows = rows.insert(Rows::new(columns?, expected));
            rows.add(&record, start, end).map_err(fail)?;
        } else {
            let header = Header::read(record.iter()).map_err(fail)?;
            let columns = header.columns(expected).map_err(fail)?;
            rows = Some(Rows::new(columns, expected));
        }
    }
    let nothing = || {
        let help = "is the file empty, or not yet written?";
        Wrong::new("expected a header, found nothing", help)
    };
    rows.ok_or_else(nothing)
        .and_then(Rows::finish)
        .map_err(|wrong| wrong.at(of_end(bytes)))
}

/// What ends with a record.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    Line,
    /// Nothing follows.
    File,
    /// Nothing follows, not even a line end: the file may end inside a number.
    Number,
}

/// The states read so far; the last may still lack particles.
struct Rows<'a> {
    columns: Columns,
    expected: &'a Expected,
    times: Vec<f64>,
    /// Byte offsets of each state's first record.
    starts: Vec<u64>,
    x: Vec<f64>,
    v: Vec<f64>,
    /// How times, positions and velocities are written.
    forms: [Form; 3],
    /// For each particle, the number of states there were when it was last given.
    given_in: Vec<usize>,
    /// Number of particles given so far in the last state.
    given: usize,
    /// How the last field of each record is written.
    tail: Tail,
    /// The last state may be cut.
    cut: bool,
}

type Located<T> = Result<T, (usize, Wrong)>;

impl<'a> Rows<'a> {
    fn new(columns: Columns, expected: &'a Expected) -> Self {
        Self {
            columns,
            expected,
            times: Vec::new(),
            starts: Vec::new(),
            x: Vec::new(),
            v: Vec::new(),
            forms: [Form::default(); 3],
            given_in: vec![0; expected.particles()],
            given: 0,
            tail: Tail::default(),
            cut: false,
        }
    }

    /// Adds the record that starts at this byte; errors name the field.
    fn add(&mut self, record: &ByteRecord, start: u64, end: End) -> Located<()> {
        if record.len() != self.columns.count {
            let (count, found) = (self.columns.count, record.len());
            let message = format!("expected {count} fields, found {found}");
            let help = match found < count {
                true if end != End::Line => HALF,
                true => "give every record a field for each column of the header",
                false => "name every column in the header; numbers have a decimal point, no comma",
            };
            return Err((
                found.min(count).saturating_sub(1),
                Wrong::new(message, help),
            ));
        }
        let t = self.number(record, self.columns.t, 0)?;
        if self.times.last() != Some(&t) {
            self.begin(t, start)
                .map_err(|wrong| (self.columns.t, wrong))?;
        }
        let first = self.particles(record)?;
        self.store(record, first, end)
            .and_then(|()| self.check_end(record, first, end))
    }

    /// Whether the last number of a file without a last line end is whole.
    fn check_end(&mut self, record: &ByteRecord, first: usize, end: End) -> Located<()> {
        let field = self.columns.count - 1;
        let text = bare(record.get(field).unwrap_or_default());
        if end != End::Number {
            self.tail.see(text);
            return Ok(());
        }
        match self.tail.judge(text) {
            Verdict::Whole => {}
            Verdict::Cut => {
                let message = format!("{} has fewer digits than the numbers above it", shown(text));
                return Err((field, Wrong::new(message, HALF)));
            }
            // A number that is as it was before, or as its time demands, is whole, too.
            Verdict::Undecided => self.cut = !self.as_before(field, first),
        }
        Ok(())
    }

    /// Whether the last number read, in this field, is what stood there in the state before, or is the
    /// time of other records.
    fn as_before(&self, field: usize, first: usize) -> bool {
        let dim = 3 * self.given_in.len();
        let same = |values: &[f64], cells: &[(usize, usize)]| {
            let cell = cells.iter().find(|(own, _)| *own == field);
            cell.is_some_and(|(_, coordinate)| {
                let at = values.len() - dim + first + coordinate;
                at.checked_sub(dim)
                    .is_some_and(|before| values[at] == values[before])
            })
        };
        same(&self.x, &self.columns.x)
            || same(&self.v, &self.columns.v)
            || (field == self.columns.t && self.given > self.columns.particles.len().max(1))
    }

    /// Begins a state at another time than the last one's.
    fn begin(&mut self, t: f64, start: u64) -> Result<(), Wrong> {
        times::follows(self.times.last().copied(), t)?;
        self.complete("before the next time begins")?;
        let numbers = self.x.len() + self.v.len() + 6 * self.expected.particles();
        if numbers > limits::NUMBERS {
            let message = format!("more than {} numbers", limits::NUMBERS);
            return Err(Wrong::new(message, "keep fewer instants"));
        }
        self.times.push(t);
        self.starts.push(start);
        self.given = 0;
        self.x.extend_from_slice(&self.expected.start);
        if !self.columns.v.is_empty() {
            self.v.resize(self.x.len(), 0.0);
        }
        Ok(())
    }

    /// Whether the last state has all particles, or all but the fixed ones.
    fn complete(&self, when: &str) -> Result<(), Wrong> {
        let Some(t) = self.times.last() else {
            return Ok(());
        };
        if self.given == self.given_in.len() {
            return Ok(());
        }
        let missing = |id: &usize| self.given_in[*id] != self.times.len();
        let fixed = &self.expected.fixed;
        let ids = 0..fixed.len();
        let some_fixed_given = ids.clone().any(|id| fixed[id] && !missing(&id));
        let wanted = |id: &usize| missing(id) && (some_fixed_given || !fixed[*id]);
        let mut lacking = ids.filter(wanted);
        let Some(first) = lacking.next() else {
            return Ok(());
        };
        let more = match lacking.count() {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let message = format!("particle {first}{more} missing at t = {t:?} {when}");
        Err(Wrong::new(
            message,
            "rows of one time stand together, one a particle: sort them by time",
        ))
    }

    /// Notes the particles a record gives. The result is where its coordinates begin in a state.
    fn particles(&mut self, record: &ByteRecord) -> Located<usize> {
        let count = self.given_in.len();
        let Some(field) = self.columns.id else {
            for at in 0..self.columns.particles.len() {
                self.give(self.columns.particles[at], self.columns.t)?;
            }
            return Ok(0);
        };
        let text = record.get(field).unwrap_or_default();
        // Ids may be whole numbers in any form: `np.savetxt` writes 1.000000e+00.
        let whole = number(text).filter(|id| *id >= 0.0 && id.fract() == 0.0);
        let Some(id) = whole.map(|id| id as usize).filter(|id| *id < count) else {
            let found = shown(text);
            let message = format!("expected a particle from 0 to {}, found {found}", count - 1);
            return Err((
                field,
                Wrong::new(message, "particles count from 0, as in the scene"),
            ));
        };
        self.give(id, field)?;
        Ok(3 * id)
    }

    /// Notes that the last state has this particle, which it may have once.
    fn give(&mut self, particle: usize, field: usize) -> Located<()> {
        let stamp = self.times.len();
        let t = self.times.last().copied().unwrap_or_default();
        match self.given_in.get_mut(particle) {
            Some(at) if *at != stamp => *at = stamp,
            _ => {
                let message = format!("particle {particle} a second time at t = {t:?}");
                let help = "give each particle once at each time";
                return Err((field, Wrong::new(message, help)));
            }
        }
        self.given += 1;
        Ok(())
    }

    /// Writes a record's coordinates into the last state, from its coordinate `first` on.
    fn store(&mut self, record: &ByteRecord, first: usize, end: End) -> Located<()> {
        let state = (self.times.len() - 1) * 3 * self.given_in.len() + first;
        let last = self.columns.count - 1;
        let cut = end == End::Number && record.get(last).and_then(number).is_none();
        let half = |(field, wrong): (usize, Wrong)| match cut && field == last {
            true => (field, Wrong::new(wrong.message, HALF)),
            false => (field, wrong),
        };
        for at in 0..self.columns.x.len() {
            let (field, coordinate) = self.columns.x[at];
            self.x[state + coordinate] = self.number(record, field, 1).map_err(half)?;
        }
        for at in 0..self.columns.v.len() {
            let (field, coordinate) = self.columns.v[at];
            self.v[state + coordinate] = self.number(record, field, 2).map_err(half)?;
        }
        Ok(())
    }

    /// Reads a field as a finite number: a time (0), position (1) or velocity (2).
    fn number(&mut self, record: &ByteRecord, field: usize, kind: usize) -> Located<f64> {
        let text = record.get(field).unwrap_or_default();
        match number(text) {
            Some(value) if value.is_finite() => {
                self.forms[kind].see(bare(text));
                Ok(value)
            }
            Some(_) => {
                let message = format!("expected a finite number, found {}", shown(text));
                let help = "end the file before the first number that is none";
                Err((field, Wrong::new(message, help)))
            }
            None => {
                let message = format!("expected a number, found {}", shown(text));
                let help = "numbers are as 0.25 or 2.5e-1";
                Err((field, Wrong::new(message, help)))
            }
        }
    }

    fn finish(mut self) -> Result<Table, Wrong> {
        if self.times.is_empty() {
            return Err(Wrong::new(
                "expected rows below the header, found none",
                HALF,
            ));
        }
        self.complete("before the file ends")
            .map_err(|wrong| Wrong::new(wrong.message, HALF))?;
        if self.cut {
            self.drop_last()?;
        }
        let v = !self.columns.v.is_empty();
        let [t_form, x_form, v_form] = self.forms;
        Ok(Table {
            times: Times {
                numbers: Numbers {
                    values: self.times,
                    written: t_form.written(),
                },
                fields: Some((self.starts, self.columns.t)),
            },
            x: Numbers {
                values: self.x,
                written: x_form.written(),
            },
            v: v.then_some(Numbers {
                values: self.v,
                written: v_form.written(),
            }),
            left_out: self.expected.left_out(|id| self.given_in[id] > 0),
            cut: self.cut,
        })
    }

    /// Leaves the last state out.
    fn drop_last(&mut self) -> Result<(), Wrong> {
        if self.times.len() == 1 {
            let message = "the only row may be cut: no line end follows its last number";
            return Err(Wrong::new(message, "end the last line as the others"));
        }
        let dim = 3 * self.given_in.len();
        self.times.pop();
        self.starts.pop();
        self.x.truncate(self.x.len() - dim);
        self.v.truncate(self.v.len().saturating_sub(dim));
        Ok(())
    }
}

/// A field without blanks and quotes around it.
fn bare(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    let inside = |quote: &[u8]| field.strip_prefix(quote)?.strip_suffix(quote);
    inside(b"\"")
        .or_else(|| inside(b"'"))
        .map_or(field, <[u8]>::trim_ascii)
}

/// The number in a field, possibly infinite or NaN; None where there is none.
fn number(field: &[u8]) -> Option<f64> {
    std::str::from_utf8(bare(field)).ok()?.parse().ok()
}

fn shown(field: &[u8]) -> String {
    match bare(field) {
        b"" => "nothing".to_owned(),
        text => format!("`{}`", shorten(&String::from_utf8_lossy(text))),
    }
}
