//! Whatever the bytes, the answer is a sound trajectory or a located error, never a panic.

use super::{CHAIN, HANGING, archive, doubles, expected, npy};
use proptest::prelude::*;
use springcheck::trajectory::{self, ErrorPlace, Layout, Plane};

fn answers(bytes: &[u8]) {
    let in_plane = expected(HANGING)
        .in_plane(Plane::Yz)
        .expect("it moves on z");
    for expected in [expected(HANGING), expected(CHAIN), in_plane] {
        for layout in [
            None,
            Some(Layout::Csv),
            Some(Layout::Npz),
            Some(Layout::Npy),
        ] {
            match trajectory::read(bytes, "x", layout, &expected) {
                Ok(rows) => {
                    assert!(!rows.is_empty());
                    assert!(rows.steps.is_sorted_by(|a, b| a < b));
                    assert_eq!(rows.x.len(), rows.len() * rows.dim);
                    assert!(
                        rows.x
                            .iter()
                            .chain(rows.v.iter().flatten())
                            .all(|x| x.is_finite())
                    );
                    assert!(rows.v.is_none_or(|v| v.len() == rows.x.len()));
                }
                Err(error) => {
                    assert!(error.to_string().starts_with("x:"), "{error}");
                    assert!(error.to_string().len() < 600, "{error}");
                    if let ErrorPlace::Text { line, column } = error.place {
                        assert!(line > 0 && column > 0);
                    }
                }
            }
        }
    }
}

const TEXT: &str = "# by hand\nt,id,x,y,z,vx,vy,vz\n0,0,0,0,2,0,0,0\n0,1,0,0,1,0,0,0\n\
    0.25,0,0,0,2,0,0,0\n0.25,1,0.001,1e-3,.99,-1.5,+2,3.\r\n";

fn seeds() -> Vec<Vec<u8>> {
    let t = doubles(&[2], &[0.0, 0.25]);
    let x = doubles(&[2, 2, 3], &[0.5; 12]);
    let v = npy(">f4", true, &[2, 2, 3], &0.5f32.to_be_bytes().repeat(12));
    vec![
        TEXT.as_bytes().to_vec(),
        b"t,x,v\n0,1,0\n0.25,0.9,-0.1\n".to_vec(),
        b"t,x1,y1,z1,vx1,vy1,vz1\n0,0,0,1,0,0,0\n0.25,0,0,0.9,0,0,-0.1".to_vec(),
        x.clone(),
        v.clone(),
        archive(&[("t.npy", &t), ("x.npy", &x), ("v.npy", &v)]),
        include_bytes!("samples/savez.npz").to_vec(),
    ]
}

#[test]
fn what_is_changed_was_sound() {
    for seed in seeds() {
        trajectory::read(&seed, "x", None, &expected(HANGING)).unwrap_or_else(|e| panic!("{e}"));
    }
}

/// Pieces that mean something in one of the formats.
const PIECES: &[&[u8]] = &[
    b",",
    b"\n",
    b"\r",
    b"\"",
    b"'",
    b"#",
    b"t",
    b"id",
    b"x",
    b"vx",
    b"-",
    b"0",
    b"1",
    b"0.25",
    b"1e999",
    b"nan",
    b"-inf",
    b"1e-400",
    b"99999999999999999999",
    b"\xef\xbb\xbf",
    b"\xff\xfe",
    b"\0",
    b"PK\x03\x04",
    b"PK\x01\x02",
    b"PK\x05\x06",
    b"\x93NUMPY",
    b"\x93NUMPY\x02\x00\xff\xff\xff\xff",
    b"{'descr': '",
    b"<f8",
    b">i2",
    b"|O",
    b"'fortran_order': True, ",
    b"'shape': (",
    b")",
    b"(",
    b"}",
    b"18446744073709551615",
    b"\xff\xff\xff\xff",
];

#[derive(Debug, Clone)]
enum Change {
    Insert(&'static [u8]),
    Overwrite(u8),
    Remove(usize),
    Repeat(usize),
    Cut,
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        4 => proptest::sample::select(PIECES).prop_map(Change::Insert),
        4 => any::<u8>().prop_map(Change::Overwrite),
        3 => (1_usize..12).prop_map(Change::Remove),
        2 => (1_usize..60).prop_map(Change::Repeat),
        1 => Just(Change::Cut),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 3000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn changed_files_are_answered(
        seed in proptest::sample::select(seeds()),
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), change()), 1..6),
    ) {
        let mut bytes = seed;
        for (place, change) in changes {
            let at = place.index(bytes.len() + 1);
            let end = |length: usize| (at + length).min(bytes.len());
            match change {
                Change::Insert(piece) => drop(bytes.splice(at..at, piece.iter().copied())),
                Change::Overwrite(byte) => drop(bytes.splice(at..end(1), [byte])),
                Change::Remove(length) => drop(bytes.drain(at..end(length))),
                Change::Repeat(length) => {
                    let piece = bytes[at..end(length)].to_vec();
                    drop(bytes.splice(at..at, piece));
                }
                Change::Cut => bytes.truncate(at),
            }
        }
        answers(&bytes);
    }

    /// Checksums hide an archive's arrays from changed bytes: here arrays change inside it.
    #[test]
    fn changed_arrays_are_answered(
        which in 0..3usize,
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let mut arrays = [
            doubles(&[2], &[0.0, 0.25]),
            doubles(&[2, 2, 3], &[0.5; 12]),
            npy("<f4", false, &[2, 2, 3], &0.5f32.to_le_bytes().repeat(12)),
        ];
        for (place, byte) in changes {
            let length = arrays[which].len();
            arrays[which][place.index(length)] = byte;
        }
        let [t, x, v] = &arrays;
        answers(&archive(&[("t.npy", t), ("x.npy", x), ("v.npy", v)]));
    }

    #[test]
    fn any_pieces_are_answered(
        pieces in proptest::collection::vec(proptest::sample::select(PIECES), 0..60),
    ) {
        answers(&pieces.concat());
    }

    #[test]
    fn any_bytes_are_answered(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        answers(&bytes);
    }
}
