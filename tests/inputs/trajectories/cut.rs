//! Files that end too early: what is cut for certain is refused, what may be cut is left out.

use super::{CHAIN, accepted, archive, doubles, read};
use std::fmt::Write;

const HALF: &str = "help: half a file? The program that wrote it may have stopped early";

/// Twelve instants of three particles. `print` writes a number.
fn text(print: &dyn Fn(f64) -> String) -> String {
    let mut text = "t,id,x,y,z\n".to_owned();
    for n in 0..12 {
        for id in 0..3 {
            let at = |axis: i32| f64::from(37 * n + 11 * id + axis).sin();
            let t = 0.25 * f64::from(n);
            let [x, y, z] = [0, 1, 2].map(at).map(print);
            writeln!(text, "{t},{id},{x},{y},{z}").expect("text");
        }
    }
    text
}

/// Cut at each of its last bytes a file is refused, or read as what is whole in it: a number that is
/// half there is nowhere.
#[test]
fn half_a_number_is_no_number() {
    let forms: [(&str, &dyn Fn(f64) -> String); 4] = [
        ("%.6f", &|x| format!("{x:.6}")),
        ("%.17g", &|x| format!("{x:.17}")),
        ("shortest", &|x| format!("{x:?}")),
        ("%.9e", &|x| format!("{x:.9e}")),
    ];
    for (title, print) in forms {
        let text = text(print);
        let whole = accepted(title, &text, CHAIN);
        let (mut refused, mut shorter) = (0, 0);
        for cut in 1..24 {
            match read(&text[..text.len() - cut], CHAIN) {
                Err(error) => {
                    let shown = error.to_string();
                    assert!(shown.ends_with(HALF), "{title}, {cut} bytes: {shown}");
                    refused += 1;
                }
                Ok(rows) => {
                    assert_eq!(rows.x[..], whole.x[..rows.x.len()], "{title}, {cut} bytes");
                    assert_eq!(rows.cut, rows.len() < whole.len(), "{title}, {cut} bytes");
                    shorter += usize::from(rows.cut);
                }
            }
        }
        // Fixed forms leave no doubt; without one there is some.
        assert!(
            refused > 3 && (shorter > 0) == (title == "shortest"),
            "{title}: {refused} {shorter}"
        );
    }
}

/// A missing line end at the end of a whole file costs nothing where the form of the numbers tells.
#[test]
fn a_last_line_end_may_be_missing() {
    let forms: [&dyn Fn(f64) -> String; 3] =
        [&|x| format!("{x:.6}"), &|x| format!("{x:?}"), &|x| {
            format!("{x:.9e}")
        }];
    for print in forms {
        let text = text(print);
        let rows = accepted("no line end", text.trim_end(), CHAIN);
        assert_eq!(rows, accepted("whole", &text, CHAIN));
    }
    let only = read("t,id,x,y,z\n0,1,0,0,1\n0,2,0,0,0.5", CHAIN).map(|rows| rows.cut);
    let shown = only.unwrap_err().to_string();
    assert!(shown.contains("the only row may be cut"), "{shown}");
}

#[test]
fn an_array_twice_is_refused() {
    let (t, x) = (
        doubles(&[3], &[0.0, 0.25, 0.5]),
        doubles(&[3, 3, 3], &[0.5; 27]),
    );
    let whole = archive(&[("t.npy", &t), ("x.npy", &x), ("y.npy", &x)]);
    // Python's zipfile writes a name twice with a warning; here y becomes a second x.
    let twice: Vec<u8> = String::from_utf8_lossy(b"y.npy").bytes().collect();
    let mut bytes = whole.clone();
    while let Some(at) = bytes.windows(5).position(|w| w == twice) {
        bytes[at] = b'x';
    }
    let shown = read(&bytes, CHAIN).unwrap_err().to_string();
    assert!(
        shown.starts_with("mine: the archive has an array twice\nhelp: "),
        "{shown}"
    );
}
