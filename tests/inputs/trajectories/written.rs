//! What `run --save` writes comes back to the last bit.

use super::{CHAIN, expected, scene};
use springcheck::physics::State;
use springcheck::trajectory::{self, CsvWriter, NpzWriter, Observer, Precision, Rows};
use std::io::Cursor;

const STEPS: u64 = 50;
const STEP: f64 = 0.1;

/// Numbers of every size, none of them short; no step's time is exact either.
fn state(step: u64) -> State {
    let number = |at: u64| {
        let angle = (step * 31 + at * 7) as f64;
        angle.sin() * 10f64.powi(at as i32 % 7 - 3)
    };
    State::new((0..9).map(number).collect(), (9..18).map(number).collect())
}

fn drive(writer: &mut dyn Observer) -> Vec<u64> {
    let mut seen = Vec::new();
    let mut due = writer.next(0);
    for step in 0..=STEPS {
        if due == Some(step) {
            writer.observe(step, &state(step));
            seen.push(step);
            due = writer.next(step + 1);
        }
    }
    seen
}

/// Both files of a run of every so many steps, and the steps they hold.
fn files(every: u64) -> ([Vec<u8>; 2], Vec<u64>) {
    let mut csv = CsvWriter::new(Vec::new(), STEPS, every, STEP);
    let steps = drive(&mut csv);
    let scratch = [Cursor::new(Vec::new()), Cursor::new(Vec::new())];
    let mut npz = NpzWriter::new(scratch, 3, STEPS, every, STEP);
    assert_eq!(drive(&mut npz), steps);
    let npz = npz.finish(Cursor::new(Vec::new())).expect("an archive");
    ([csv.finish().expect("text"), npz.into_inner()], steps)
}

fn read(bytes: &[u8]) -> Result<Rows, trajectory::ReadError> {
    let scene = scene(CHAIN);
    let expected = trajectory::Expected::new(&scene, STEP);
    trajectory::read(bytes, "saved", None, &expected)
}

fn bits(numbers: &[f64]) -> Vec<u64> {
    numbers.iter().map(|n| n.to_bits()).collect()
}

#[test]
fn saved_runs_come_back_to_the_last_bit() {
    for every in [1, 7, 50, 60] {
        let (files, steps) = files(every);
        for bytes in files {
            let rows = read(&bytes).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(rows.steps, steps);
            let written: Vec<State> = steps.iter().map(|step| state(*step)).collect();
            let of = |part: fn(&State) -> &Vec<f64>| -> Vec<u64> {
                written.iter().flat_map(|s| bits(part(s))).collect()
            };
            assert_eq!(bits(&rows.x), of(|s| &s.x), "{every}");
            assert_eq!(bits(rows.v.as_deref().unwrap()), of(|s| &s.v), "{every}");
            assert_eq!(
                (rows.precision, rows.precision_v),
                (Precision::Double, Precision::Double)
            );
        }
    }
}

#[test]
fn no_changed_bit_goes_unnoticed() {
    let ([_, whole], _) = files(25);
    let rows = read(&whole).expect("whole");
    // Checksums guard the numbers. Of the rest some bits say nothing, such as the version of the
    // program that packed it; one counts the arrays, and takes the last one away.
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut changed = whole.clone();
            changed[at] ^= 1 << bit;
            if let Ok(read) = read(&changed) {
                let same = (&read.steps, &read.x) == (&rows.steps, &rows.x);
                assert!(same, "byte {at}, bit {bit}");
                assert!(read.v.is_none() || read.v == rows.v, "byte {at}, bit {bit}");
            }
        }
    }
    for end in 0..whole.len() {
        assert!(
            read(&whole[..end]).is_err(),
            "{end} bytes of {}",
            whole.len()
        );
    }
}

#[test]
fn a_run_of_another_step_is_refused() {
    let ([csv, _], _) = files(1);
    // 0.25 s a step: of n / 10 s only every fifth is a whole number of steps.
    let error = trajectory::read(&csv, "saved", None, &expected(CHAIN)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "saved:5:1: expected a whole number of steps of 0.25 s, found 0.4 at t = 0.1\n\
         help: times are multiples of 0.1: --timestep 0.1"
    );
}

/// Counts the calls that reach a file.
#[derive(Default)]
struct Calls(u64, u64);

impl std::io::Write for Calls {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0 += 1;
        self.1 += bytes.len() as u64;
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

#[test]
fn rows_reach_the_file_in_blocks() {
    let mut csv = CsvWriter::new(Calls::default(), STEPS, 1, STEP);
    drive(&mut csv);
    let Calls(calls, bytes) = csv.finish().expect("text");
    // Blocks of 8 KiB, but for a row that does not fit in and the end.
    assert!(calls <= bytes / 4096 + 1, "{calls} calls for {bytes} bytes");
}
