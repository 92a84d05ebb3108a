//! Arrays in every form NumPy gives them.

use super::{CHAIN, HANGING, accepted, archive, doubles, npy};
use springcheck::trajectory::Rows;

/// As `samples/make.py` computes them.
fn x() -> Vec<f64> {
    (0..30).map(|n| f64::from(n) / 8.0 - 1.0).collect()
}

fn v() -> Vec<f64> {
    let x = x();
    x.chunks(6).rev().flatten().map(|x| -x).collect()
}

macro_rules! samples {
    ($($file:literal),*) => { [$(($file, &include_bytes!(concat!("samples/", $file))[..])),*] };
}

fn sample(file: &str) -> Rows {
    let samples = samples![
        "savez.npz",
        "compressed.npz",
        "single_fortran.npz",
        "big_endian.npz",
        "whole.npz",
        "free_only.npz",
        "positions.npy",
        "one_particle.npy",
        "savetxt.csv",
        "print.csv"
    ];
    let (_, bytes) = samples
        .iter()
        .find(|(name, _)| *name == file)
        .expect("a sample");
    accepted(file, bytes, HANGING)
}

/// The fixed particle as the scene has it.
fn filled(mut states: Vec<f64>, fixed: [f64; 3]) -> Vec<f64> {
    for state in states.chunks_mut(6) {
        state[..3].copy_from_slice(&fixed);
    }
    states
}

#[test]
fn what_numpy_writes_is_read() {
    for file in [
        "savez.npz",
        "compressed.npz",
        "big_endian.npz",
        "savetxt.csv",
        "print.csv",
    ] {
        let rows = sample(file);
        assert_eq!((&rows.x, &rows.v), (&x(), &Some(v())), "{file}");
        assert_eq!(rows.steps, [0, 1, 2, 3, 4], "{file}");
    }
    for file in ["single_fortran.npz", "positions.npy"] {
        let rows = sample(file);
        assert_eq!((&rows.x, &rows.v), (&x(), &None), "{file}");
        assert_eq!(rows.steps, [0, 1, 2, 3, 4], "{file}");
    }
    let whole = sample("whole.npz");
    assert_eq!(whole.steps, [0, 4, 8, 12, 16]);
    assert_eq!(whole.x, x().iter().map(|x| 8.0 * x).collect::<Vec<_>>());
    assert_eq!(
        whole.v.unwrap(),
        x().iter().map(|x| 8.0 * x + 8.0).collect::<Vec<_>>()
    );
}

#[test]
fn fixed_particles_may_be_left_out() {
    let rows = sample("free_only.npz");
    assert_eq!(rows.x, filled(x(), [0.0, 0.0, 2.0]));
    assert_eq!(rows.v, Some(filled(v(), [0.0; 3])));
    assert_eq!(sample("one_particle.npy").x, filled(x(), [0.0, 0.0, 2.0]));
}

#[test]
fn one_coordinate_is_enough_where_only_one_moves() {
    let t = doubles(&[3], &[0.0, 0.5, 1.0]);
    let x = doubles(&[3], &[1.0, 0.9, 0.8]);
    let files: [(&str, &[u8]); 3] = [("v.npy", &x), ("x.npy", &x), ("t.npy", &t)];
    let rows = accepted("t, x, v", archive(&files), HANGING);
    let heights = [1.0, 0.9, 0.8];
    assert_eq!(
        rows.x,
        heights.map(|z| [0.0, 0.0, 2.0, 0.0, 0.0, z]).concat()
    );
    assert_eq!(
        rows.v,
        Some(heights.map(|z| [0.0, 0.0, 0.0, 0.0, 0.0, z]).concat())
    );
    assert_eq!(rows.steps, [0, 2, 4]);
    let alone = accepted("x", &x, HANGING);
    assert_eq!((alone.x, alone.steps), (rows.x, vec![0, 1, 2]));
}

/// The bytes of a small whole number.
type Stored<'a> = &'a dyn Fn(u8) -> Vec<u8>;

#[test]
fn every_stored_number_is_read() {
    // One instant of three particles: whole numbers that every type can hold, 1 to 9.
    let numbers = |bytes: Stored| (1..=9).flat_map(bytes).collect::<Vec<u8>>();
    let types: [(&str, Stored); 16] = [
        ("<f8", &|n| f64::from(n).to_le_bytes().into()),
        (">f8", &|n| f64::from(n).to_be_bytes().into()),
        ("=f8", &|n| f64::from(n).to_le_bytes().into()),
        ("<f4", &|n| f32::from(n).to_le_bytes().into()),
        (">f4", &|n| f32::from(n).to_be_bytes().into()),
        ("|i1", &|n| (n as i8).to_le_bytes().into()),
        ("|u1", &|n| vec![n]),
        ("<i2", &|n| i16::from(n).to_le_bytes().into()),
        (">i2", &|n| i16::from(n).to_be_bytes().into()),
        ("<u2", &|n| u16::from(n).to_le_bytes().into()),
        (">i4", &|n| i32::from(n).to_be_bytes().into()),
        ("<i4", &|n| i32::from(n).to_le_bytes().into()),
        ("<u4", &|n| u32::from(n).to_le_bytes().into()),
        (">i8", &|n| i64::from(n).to_be_bytes().into()),
        ("<i8", &|n| i64::from(n).to_le_bytes().into()),
        (">u8", &|n| u64::from(n).to_be_bytes().into()),
    ];
    let wanted: Vec<f64> = (1..=9).map(f64::from).collect();
    for (descr, bytes) in types {
        let file = npy(descr, false, &[1, 3, 3], &numbers(bytes));
        assert_eq!(accepted(descr, file, CHAIN).x, wanted, "{descr}");
    }
}

#[test]
fn signs_survive_every_type() {
    let types: [(&str, Vec<u8>, f64); 6] = [
        ("|i1", vec![0xff; 9], -1.0),
        ("<i2", (-300i16).to_le_bytes().repeat(9), -300.0),
        (">i4", (-70_000i32).to_be_bytes().repeat(9), -70_000.0),
        (
            "<i8",
            i64::MIN.to_le_bytes().repeat(9),
            -9_223_372_036_854_775_808.0,
        ),
        (
            ">u8",
            u64::MAX.to_be_bytes().repeat(9),
            18_446_744_073_709_551_616.0,
        ),
        (">f4", (-0.1f32).to_be_bytes().repeat(9), f64::from(-0.1f32)),
    ];
    for (descr, bytes, value) in types {
        let rows = accepted(descr, npy(descr, false, &[1, 3, 3], &bytes), CHAIN);
        assert_eq!(rows.x, [value; 9], "{descr}");
    }
}

#[test]
fn fortran_order_runs_over_instants_first() {
    // x[t, i, a] = 100 t + 10 i + a, its first index fastest.
    let mut stored = Vec::new();
    for a in 0..3 {
        for i in 0..3 {
            for t in 0..2 {
                stored.extend(f64::from(100 * t + 10 * i + a).to_le_bytes());
            }
        }
    }
    let rows = accepted("fortran", npy("<f8", true, &[2, 3, 3], &stored), CHAIN);
    let wanted = [
        0, 1, 2, 10, 11, 12, 20, 21, 22, 100, 101, 102, 110, 111, 112, 120, 121, 122,
    ];
    assert_eq!(rows.x, wanted.map(f64::from));
    // Mutant: the same bytes in C order are another trajectory.
    let wrong = accepted("C", npy("<f8", false, &[2, 3, 3], &stored), CHAIN);
    assert_ne!(wrong.x, rows.x);
}

#[test]
fn headers_of_every_version_are_read() {
    let numbers: Vec<u8> = (1..=9).flat_map(|n| f64::from(n).to_le_bytes()).collect();
    let headers = [
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3, 3), }          \n",
        "{\"shape\":(1,3,3),\"descr\":\"<f8\",\"fortran_order\":False}",
        "{'descr': '<f8', 'fortran_order': False, 'shape': (1L, 3L, 3L)}\n",
    ];
    for header in headers {
        for version in [1u8, 2, 3] {
            let length = header.len() as u32;
            let length = match version {
                1 => (length as u16).to_le_bytes().to_vec(),
                _ => length.to_le_bytes().to_vec(),
            };
            let start = [&b"\x93NUMPY"[..], &[version, 0], &length].concat();
            let file = [&start, header.as_bytes(), &numbers].concat();
            assert_eq!(accepted(header, file, CHAIN).x[8], 9.0);
        }
    }
}
