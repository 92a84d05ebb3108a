//! Bad files, each with the whole message. In text `»` marks the place and is taken out before
//! reading; in arrays the place is written down.

use super::{CHAIN, HANGING, archive, doubles, expected, npy, read};
use springcheck::trajectory::{self, ErrorPlace, Layout};

const SORT: &str = "help: rows of one time stand together, one a particle: sort them by time";
const HALF: &str = "help: half a file? The program that wrote it may have stopped early";
const HEADER: &str = "help: write `t,id,x,y,z` or `t,id,x,y,z,vx,vy,vz` above the numbers";
const COLUMNS: &str = "help: the columns are t, id, x, y, z, vx, vy, vz: remove others";
const PLANE: &str =
    "help: data of a plane? `--axes xy` (or xz, yz) says which axes of the scene it has";
const WIDE: &str =
    "help: write `t,x0,y0,z0,x1,...`, then `vx0,vy0,vz0,...` if wanted, or one particle a line";
const ONCE: &str = "help: leave one of them out";
const FIELDS: &str = "help: give every record a field for each column of the header";
const COLUMN: &str =
    "help: name every column in the header; numbers have a decimal point, no comma";
const NUMBER: &str = "help: numbers are as 0.25 or 2.5e-1";
const EACH: &str = "help: give each particle once at each time";
const CUT: &str = "help: end the file before the first number that is none";
const COUNT: &str = "help: particles count from 0, as in the scene";
const STEP: &str = "help: --timestep tells the step the rows were computed with";

/// Title, text, message and, where there is some, help. Three particles, the first fixed, and 0.25 s
/// a step.
#[rustfmt::skip]
const TEXTS: &[(&str, &str, &[&str])] = &[
    // The header.
    ("empty", "»", &["expected a header, found nothing", "help: is the file empty, or not yet written?"]),
    ("only comments", "# a\n# »b\n", &["expected a header, found nothing", "help: is the file empty, or not yet written?"]),
    ("only a header", "t,id,x,y,»z\n", &["expected rows below the header, found none", HALF]),
    ("no header", "»0,0,0,0,2\n", &["expected a header, found the number 0", HEADER]),
    ("a comment that is no header", "# by t\n»0,0,0,0\n", &["expected a header, found the number 0", HEADER]),
    ("a plane in a comment", "»# t,id,x,y\n0,0,0,0\n", &["the header lacks one of `x`, `y`, `z`", PLANE]),
    ("no t", "»id,x,y,z\n", &["the header lacks `t`", HEADER]),
    ("no id", "»t,x,y,z\n", &["the header lacks `id`, and the scene has 2 free particles", HEADER]),
    ("no z", "»t,id,x,y\n", &["the header lacks one of `x`, `y`, `z`", PLANE]),
    ("no y, no z", "»t,id,y\n", &["the header lacks one of `x`, `y`, `z`", HEADER]),
    ("no vz", "»t,id,x,y,z,vx,vy\n", &["the header lacks one of `vx`, `vy`, `vz`", HEADER]),
    ("v for vx, vy, vz", "t,id,x,y,z,»v\n", &["`v` beside `x`, `y`, `z`", "help: name it vx, vy or vz"]),
    ("x alone", "»t,x\n0,0\n", &["`x` alone is for a scene with one free particle that moves on one axis, without `id`", HEADER]),
    ("a column twice", "t,id,x,y,z, »x\n", &["the column `x` a second time", ONCE]),
    ("misspelt", "t,id,x,y,z,vx,vy,»v_z\n", &["unknown column `v_z`", "help: did you mean `vz`?"]),
    ("more than is read", "t,id,x,y,z,»energy\n", &["unknown column `energy`", COLUMNS]),
    ("semicolons", "»t;id;x;y;z\n", &["unknown column `t;id;x;y;z`", "help: separate columns by commas"]),
    ("blanks", "»t id x y z\n", &["unknown column `t id x y z`", "help: separate columns by commas"]),
    ("control characters", "»t\u{1b}[2J,id,x,y,z\n", &["unknown column `t\u{fffd}[2j`", COLUMNS]),
    // Wide headers.
    ("id in wide text", "t,»id,x1,y1,z1,x2,y2,z2\n", &["`id` beside columns of single particles", WIDE]),
    ("x beside x1", "t,»x,x1,y1,z1,x2,y2,z2\n", &["a column without a particle beside columns of single particles", WIDE]),
    ("a free particle missing", "»t,x0,y0,z0,x1,y1,z1\n", &["the header lacks particle 2", WIDE]),
    ("too many particles", "t,x1,y1,z1,x2,y2,z2,»x3,y3,z3\n", &["expected particles from 0 to 2, found 3", COUNT]),
    ("no z2", "»t,x1,y1,z1,x2,y2\n", &["the header lacks one of `x2`, `y2`, `z2`", PLANE]),
    ("velocities of one", "»t,x1,y1,z1,x2,y2,z2,vx1,vy1,vz1\n", &["the header has velocities of some particles only", WIDE]),
    // Fields.
    ("too few", "t,id,x,y,z\n0,0,0,»0\n0,1,0,0,0\n", &["expected 5 fields, found 4", FIELDS]),
    ("too few at the end", "t,id,x,y,z\n0,0,0,»0", &["expected 5 fields, found 4", HALF]),
    ("too many", "t,id,x,y,z\n0,0,0,0,»0,0\n", &["expected 5 fields, found 6", COLUMN]),
    ("text", "t,id,x,y,z\n0,0,0, »up,0\n", &["expected a number, found `up`", NUMBER]),
    ("half a number", "t,id,x,y,z\n0,0,0,0,»1.5e-", &["expected a number, found `1.5e-`", HALF]),
    ("empty field", "t,id,x,y,z\n0,0,0,»,0\n", &["expected a number, found nothing", NUMBER]),
    ("a Fortran exponent", "t,id,x,y,z\n0,0,»1.0D+00,0,0\n", &["expected a number, found `1.0D+00`", NUMBER]),
    ("NaN", "t,id,x,y,z\n0,0,0,0,»nan\n", &["expected a finite number, found `nan`", CUT]),
    ("infinite", "t,id,x,y,z,vx,vy,vz\n0,0,0,0,0,0,0,»-inf\n", &["expected a finite number, found `-inf`", CUT]),
    ("beyond doubles", "t,id,x,y,z\n0,0,»1e999,0,0\n", &["expected a finite number, found `1e999`", CUT]),
    ("after an umlaut", "t,id,x,y,z\n0,0,»ä,0,0\n", &["expected a number, found `ä`", NUMBER]),
    ("after a byte order mark", "\u{feff}t,id,»w,y,z\n", &["unknown column `w`", COLUMNS]),
    ("CRLF and blank lines", "t,id,x,y,z\r\n\r\n \r\n0,0,»x,0,0\r\n", &["expected a number, found `x`", NUMBER]),
    ("CR", "t,id,x,y,z\r0,0,»x,0,0\r", &["expected a number, found `x`", NUMBER]),
    // Particles.
    ("unknown", "t,id,x,y,z\n0,»3,0,0,0\n", &["expected a particle from 0 to 2, found `3`", COUNT]),
    ("negative", "t,id,x,y,z\n0,»-1,0,0,0\n", &["expected a particle from 0 to 2, found `-1`", COUNT]),
    ("between two", "t,id,x,y,z\n0,»0.5,0,0,0\n", &["expected a particle from 0 to 2, found `0.5`", COUNT]),
    ("NaN as a particle", "t,id,x,y,z\n0,»nan,0,0,0\n", &["expected a particle from 0 to 2, found `nan`", COUNT]),
    ("twice", "t,id,x,y,z\n0,0,0,0,0\n0,»0,0,0,0\n", &["particle 0 a second time at t = 0.0", EACH]),
    ("missing", "t,id,x,y,z\n0,0,0,0,0\n0,1,0,0,0\n»0.25,0,0,0,0\n", &["particle 2 missing at t = 0.0 before the next time begins", SORT]),
    ("sorted by particle", "t,id,x,y,z\n0,0,0,0,0\n»0.25,0,0,0,0\n", &["particle 1 and 1 more missing at t = 0.0 before the next time begins", SORT]),
    ("a fixed one and a free one missing", "t,id,x,y,z\n0,1,0,0,0\n»0.25,1,0,0,0\n", &["particle 2 missing at t = 0.0 before the next time begins", SORT]),
    ("missing at the end", "t,id,x,y,z\n0,0,0,0,0\n0,1,0,0,»0\n", &["particle 2 missing at t = 0.0 before the file ends", HALF]),
    // Times.
    ("NaN as a time", "t,id,x,y,z\n»nan,1,0,0,0\n", &["expected a finite number, found `nan`", CUT]),
    ("an infinite time", "t,id,x,y,z\n»inf,1,0,0,0\n", &["expected a finite number, found `inf`", CUT]),
    ("a negative time", "t,id,x,y,z\n»-0.25,1,0,0,0\n", &["expected a time of at least 0 s, found -0.25", "help: the scene starts at t = 0"]),
    ("back in time", "id,t,x,y,z\n1,0.5,0,0,0\n2,0.5,0,0,0\n1,»0.25,0,0,0\n", &["expected a time after 0.5, found 0.25", "help: sort the rows by time"]),
    ("between steps", "id,t,x,y,z\n1,0,0,0,0\n2,0,0,0,0\n1,»0.3,0,0,0\n2,0.3,0,0,0\n", &["expected a whole number of steps of 0.25 s, found 1.2 at t = 0.3", "help: times are multiples of 0.3: --timestep 0.3"]),
    ("a step that fits all", "t,id,x,y,z\n0,1,0,0,0\n0,2,0,0,0\n»0.1,1,0,0,0\n0.1,2,0,0,0\n0.25,1,0,0,0\n0.25,2,0,0,0\n", &["expected a whole number of steps of 0.25 s, found 0.4 at t = 0.1", "help: times are multiples of 0.05: --timestep 0.05"]),
    ("far too late", "t,id,x,y,z\n»1e12,1,0,0,0\n1e12,2,0,0,0\n", &["expected at most 1e9 steps of 0.25 s, found t = 1000000000000.0", STEP]),
    ("two times of one step", "t,id,x,y,z\n0.25,1,0,0,0\n0.25,2,0,0,0\n»0.2500000001,1,0,0,0\n0.2500000001,2,0,0,0\n", &["expected another step than the time before, found 1 for both at t = 0.2500000001", STEP]),
];

#[test]
fn bad_text_is_refused_at_its_place() {
    for (title, marked, lines) in TEXTS {
        let at = marked.find('»').expect("a mark");
        let before = marked[..at]
            .trim_start_matches('\u{feff}')
            .replace("\r\n", "\n")
            .replace('\r', "\n");
        let line = before.matches('\n').count() + 1;
        let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
        match read(marked.replace('»', ""), CHAIN) {
            Ok(rows) => panic!("{title}: accepted: {rows:?}"),
            Err(error) => {
                let wanted = format!("mine:{line}:{column}: {}", lines.join("\n"));
                assert_eq!(error.to_string(), wanted, "{title}");
            }
        }
    }
}

/// An archive of three instants with one array replaced.
fn with(name: &str, array: &[u8]) -> Vec<u8> {
    let t = doubles(&[3], &[0.0, 0.25, 0.5]);
    let x = doubles(&[3, 3, 3], &[0.5; 27]);
    let pick = |own: &str, array_of: Vec<u8>| {
        if own == name {
            array.to_vec()
        } else {
            array_of
        }
    };
    let (t, x, v) = (pick("t", t), pick("x", x.clone()), pick("v", x));
    archive(&[("t.npy", &t), ("x.npy", &x), ("v.npy", &v)])
}

fn header(text: &str) -> Vec<u8> {
    let length = (text.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\x00", &length[..], text.as_bytes()].concat()
}

fn halves(shape: &[usize]) -> Vec<u8> {
    doubles(shape, &vec![0.5; shape.iter().product()])
}

/// Halves, and one other number.
fn but(shape: &[usize], at: usize, value: f64) -> Vec<u8> {
    let mut numbers = vec![0.5; shape.iter().product()];
    numbers[at] = value;
    doubles(shape, &numbers)
}

/// Title, file, message and help.
type Rows = Vec<(&'static str, Vec<u8>, &'static str, &'static str)>;

fn judge(rows: Rows) {
    for (title, bytes, message, help) in rows {
        let wanted = match help {
            "" => format!("mine: {message}"),
            help => format!("mine: {message}\n{help}"),
        };
        match read(&bytes, CHAIN) {
            Ok(rows) => panic!("{title}: accepted: {rows:?}"),
            Err(error) => assert_eq!(error.to_string(), wanted, "{title}"),
        }
    }
}

const SAVE: &str = "help: write it with np.save or np.savez";
const SAVEZ: &str = "help: np.savez('mine.npz', t=t, x=x, v=v) writes what is read here";
const NAMES: &str =
    "help: the arrays are t, x and v: np.savez('mine.npz', t=t, x=x, v=v) writes what is read here";
const FLOAT: &str = "help: save x.astype(float)";
const ORDER: &str = "help: instants, then the scene's 3 particles, then x, y, z";
const END: &str = "help: end the arrays before the first number that is none";
const ROWS: &str = "help: give one row of each array for each instant";
const SAME: &str = "help: give the velocities of those particles whose positions are given";
const FEWER: &str = "help: keep fewer instants";

#[test]
fn bad_archives_are_refused() {
    let (t, x) = (halves(&[3]), halves(&[3, 3, 3]));
    let whole = archive(&[("t.npy", &t), ("x.npy", &x)]);
    let half = whole[..whole.len() - 40].to_vec();
    let mut flipped = with("", &[]);
    // x's checksum in the archive's directory, 30 bytes before the name.
    let name = flipped.windows(5).rposition(|w| w == b"x.npy").expect("x");
    flipped[name - 30] ^= 1;
    let missing = "expected arrays `t` and `x`, and `v` if wanted";
    #[rustfmt::skip]
    judge(vec![
        ("half an archive", half, "the archive cannot be read: invalid Zip archive: Could not find EOCD", HALF),
        ("no x", archive(&[("t.npy", &t)]), missing, SAVEZ),
        ("no t", archive(&[("x.npy", &x)]), missing, SAVEZ),
        ("nothing", archive(&[]), missing, SAVEZ),
        ("no names", archive(&[("arr_0.npy", &t)]), "unknown array `arr_0`", NAMES),
        ("a name in capitals", archive(&[("t.npy", &t), ("X.npy", &x)]), "unknown array `X`", "help: did you mean `x`?"),
        ("no arrays", archive(&[("t", b"0 1 2")]), "`t` in the archive is no NumPy array", SAVEZ),
        ("damaged", flipped, "x: cannot be unpacked: Invalid checksum", HALF),
    ]);
}

#[test]
fn bad_headers_are_refused() {
    let t = halves(&[3]);
    let unsized_t = "{'descr': '<f8', 'fortran_order': False}";
    let negative = "{'descr': '<f8', 'fortran_order': False, 'shape': (-3,)}";
    let records = "{'descr': [('a', '<f8')], 'fortran_order': False, 'shape': (3,), }";
    let of_type = |descr| npy(descr, false, &[3, 3, 3], b"");
    #[rustfmt::skip]
    judge(vec![
        ("another file", with("x", b"0,1,2,3,4,5"), "x: this is no NumPy array", SAVE),
        ("a cut header", with("t", &t[..30]), "t: the array ends within its header", HALF),
        ("no header", with("t", b"\x93NUM"), "t: the array ends within its header", HALF),
        ("version 9", with("t", b"\x93NUMPY\x09\x00\x00\x00"), "t: this is no NumPy array", SAVE),
        ("a huge header", with("t", b"\x93NUMPY\x02\x00\xff\xff\xff\xff"), "t: a header of 4294967295 bytes", SAVE),
        ("not a dictionary", with("t", &header("((((((((((")), "t: not a header of a NumPy array: ((((((((((", SAVE),
        ("a header without shape", with("t", &header(unsized_t)), "t: not a header of a NumPy array: {'descr': '<f8', 'fortran_order': False}", SAVE),
        ("a negative size", with("t", &header(negative)), "t: not a header of a NumPy array: {'descr': '<f8', 'fortran_order': False, 'shape': (-3,)}", SAVE),
        ("records", header(records), "x: expected real numbers, found records", "help: save plain arrays t, x and v instead of records"),
        ("objects", of_type("|O"), "x: expected real numbers, found type '|O'", "help: objects are no numbers: save np.array(x, dtype=float)"),
        ("complex numbers", of_type("<c16"), "x: expected real numbers, found type '<c16'", "help: save x.real"),
        ("half precision", of_type("<f2"), "x: expected real numbers, found type '<f2'", "help: half precision keeps three digits: compute in double"),
        ("long doubles", of_type("<f16"), "x: expected real numbers, found type '<f16'", FLOAT),
        ("truth values", of_type("|b1"), "x: expected real numbers, found type '|b1'", FLOAT),
        ("text", of_type("<U4"), "x: expected real numbers, found type '<U4'", ""),
        ("no type", of_type(""), "x: expected real numbers, found type ''", ""),
    ]);
}

#[test]
fn bad_shapes_are_refused() {
    #[rustfmt::skip]
    judge(vec![
        ("four particles", halves(&[4, 4, 3]), "x: expected the shape (T, 3, 3), found (4, 4, 3)", ORDER),
        ("in a plane", halves(&[4, 3, 2]), "x: expected the shape (T, 3, 3), found (4, 3, 2)", PLANE),
        ("one particle of three", halves(&[4, 3]), "x: expected the shape (T, 3, 3), found (4, 3)", ORDER),
        ("one number an instant", halves(&[4]), "x: expected the shape (T, 3, 3), found (4,)", ORDER),
        ("a single number", halves(&[]), "x: expected the shape (T, 3, 3), found ()", ORDER),
        ("flat", halves(&[4, 9]), "x: expected the shape (T, 3, 3), found (4, 9)", "help: x.reshape(-1, 3, 3) makes it so"),
        ("particles first", halves(&[3, 7, 3]), "x: expected the shape (T, 3, 3), found (3, 7, 3)", "help: x.transpose(1, 0, 2) makes it so"),
        ("instants last", with("v", &halves(&[3, 3, 7])), "v: expected the shape (T, 3, 3), found (3, 3, 7)", "help: v.transpose(2, 0, 1) makes it so"),
        ("no instant", halves(&[0, 3, 3]), "x: expected at least one instant, found none", HALF),
        ("no time", with("t", &halves(&[0])), "t: expected at least one instant, found none", HALF),
        ("times in a column", with("t", &halves(&[3, 1])), "t: expected the shape (T,), found (3, 1)", "help: t.ravel() makes it so"),
        ("a position too few", with("x", &halves(&[2, 3, 3])), "x: expected the 3 instants of t, found 2", ROWS),
        ("a velocity too many", with("v", &halves(&[4, 3, 3])), "v: expected the 3 instants of t, found 4", ROWS),
        ("velocities of the free ones", with("v", &halves(&[3, 2, 3])), "v: expected x's shape (3, 3, 3), found (3, 2, 3)", SAME),
    ]);
}

/// Headers claim more, or less, than there is.
#[test]
fn bad_sizes_are_refused() {
    let x = halves(&[3, 3, 3]);
    let (half, shorter) = (x[..x.len() - 8].to_vec(), &x[..x.len() - 100]);
    let bomb = [&x[..], &vec![0; 1 << 24]].concat();
    let claim = |descr, instants| npy(descr, false, &[instants, 3, 3], b"");
    #[rustfmt::skip]
    judge(vec![
        ("half an array", half, "x: expected 216 bytes of numbers, found 208", HALF),
        ("half an array, packed", with("v", shorter), "v: expected 216 bytes of numbers, found 116", HALF),
        ("two arrays in one", [&x[..], &x].concat(), "x: expected 216 bytes of numbers, found more", "help: save one array, once"),
        ("an array that unpacks to more", with("x", &bomb), "x: expected 216 bytes of numbers, found more", "help: save one array, once"),
        ("an array of nothing", claim("<f8", 1 << 24), "x: expected 1207959552 bytes of numbers, found 0", HALF),
        ("a huge array", claim("<f8", 1 << 40), "x: expected at most 268435456 numbers, found the shape (1099511627776, 3, 3)", FEWER),
        ("a huge array of bytes", claim("|i1", 1 << 40), "x: expected at most 268435456 numbers, found the shape (1099511627776, 3, 3)", FEWER),
        ("beyond any memory", claim("<f8", usize::MAX), "x: expected at most 268435456 numbers, found the shape (18446744073709551615, 3, 3)", FEWER),
    ]);
}

#[test]
fn bad_numbers_are_refused_at_their_index() {
    let times = |t: &[f64; 3]| with("t", &doubles(&[3], t));
    #[rustfmt::skip]
    judge(vec![
        ("NaN", but(&[3, 3, 3], 23, f64::NAN), "x[2, 1, 2]: expected a finite number, found NaN", END),
        ("infinite", with("v", &but(&[3, 3, 3], 9, f64::NEG_INFINITY)), "v[1, 0, 0]: expected a finite number, found -inf", END),
        ("NaN as a time", times(&[0.0, f64::NAN, 0.5]), "t[1]: expected a finite number, found NaN", END),
        ("a negative time", times(&[-0.25, 0.0, 0.25]), "t[0]: expected a time of at least 0 s, found -0.25", "help: the scene starts at t = 0"),
        ("a time twice", times(&[0.0, 0.25, 0.25]), "t[2]: the time 0.25 a second time", ""),
        ("back in time", times(&[0.0, 0.5, 0.25]), "t[2]: expected a time after 0.5, found 0.25", "help: sort the rows by time"),
        ("between steps", times(&[0.0, 0.2, 0.4]), "t[1]: expected a whole number of steps of 0.25 s, found 0.8 at t = 0.2", "help: times are multiples of 0.2: --timestep 0.2"),
    ]);
}

#[test]
fn a_layout_asked_for_is_the_one_read() {
    let refused = |bytes: &[u8], layout| {
        let expected = expected(HANGING);
        trajectory::read(bytes, "mine\u{1b}[2J", Some(layout), &expected)
            .unwrap_err()
            .to_string()
    };
    let text = b"t,x\n0,1\n";
    assert_eq!(
        refused(text, Layout::Npz),
        format!("mine\u{fffd}[2J: this is no NPZ archive\n{SAVEZ}")
    );
    assert_eq!(
        refused(text, Layout::Npy),
        format!(
            "mine\u{fffd}[2J: x: this is no NumPy array\nhelp: write it with np.save or np.savez"
        )
    );
    let utf16: Vec<u8> = "\u{feff}t,x\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    assert_eq!(
        refused(&utf16, Layout::Csv),
        "mine\u{fffd}[2J:1:1: this text is UTF-16\nhelp: save it as UTF-8"
    );
}

#[test]
fn ids_go_with_whole_positions() {
    let error = read("t,id,x\n0,1,1\n", HANGING).unwrap_err();
    assert_eq!(error.place, ErrorPlace::Text { line: 1, column: 1 });
    // And the only free particle needs none, but only once an instant.
    let error = read("t,x\n0,1\n0,1\n", HANGING).unwrap_err();
    assert_eq!(
        error.to_string(),
        "mine:3:1: particle 1 a second time at t = 0.0\nhelp: give each particle once at each time"
    );
}
