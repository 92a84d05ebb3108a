//! How exactly numbers are given, told from the numbers.

use super::{CHAIN, archive, doubles, npy, read};
use proptest::prelude::*;
use springcheck::trajectory::{Precision, Rows};

/// A dozen instants or more of three particles: the fixed one exact, the others anywhere between a
/// hundredth and a hundred, on either side, from exact starts. Seeded: shrunk numbers are short
/// ones, which say nothing of rounding.
fn positions() -> impl Strategy<Value = Vec<f64>> {
    (any::<u64>(), 12usize..40).prop_map(|(mut seed, instants)| {
        // SplitMix64.
        let mut random = || {
            seed = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let z = (seed ^ (seed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            z ^ (z >> 31)
        };
        let mut x = vec![0.0, 0.0, 2.0, 0.5, 0.0, 1.0, 1.0, 0.0, 1.0];
        for _ in 1..instants {
            x.extend([0.0, 0.0, 2.0]);
            for _ in 0..6 {
                let exponent = (random() >> 11) as f64 / (1u64 << 53) as f64 * 4.0 - 2.0;
                let sign = if random() % 2 == 0 { 1.0 } else { -1.0 };
                x.push(sign * 10f64.powf(exponent));
            }
        }
        x
    })
}

fn npz(x: &[u8], v: &[u8], instants: usize) -> Rows {
    let t: Vec<f64> = (0..instants).map(|k| k as f64 * 0.25).collect();
    let t = doubles(&[instants], &t);
    read(archive(&[("t.npy", &t), ("x.npy", x), ("v.npy", v)]), CHAIN).expect("a trajectory")
}

fn array(x: &[f64]) -> Vec<u8> {
    doubles(&[x.len() / 9, 3, 3], x)
}

fn singles(x: &[f64]) -> Vec<u8> {
    let bytes: Vec<u8> = x.iter().flat_map(|x| (*x as f32).to_le_bytes()).collect();
    npy("<f4", false, &[x.len() / 9, 3, 3], &bytes)
}

fn text(x: &[f64], form: &dyn Fn(f64) -> String) -> Rows {
    let mut text = "t,id,x,y,z\n".to_owned();
    for (k, x) in x.chunks_exact(3).enumerate() {
        let t = (k / 3) as f64 * 0.25;
        text += &format!(
            "{t},{},{},{},{}\n",
            k % 3,
            form(x[0]),
            form(x[1]),
            form(x[2])
        );
    }
    read(text, CHAIN).expect("a trajectory")
}

/// As numpy.round does it.
fn rounded(x: &[f64], decimals: usize) -> Vec<f64> {
    let scale = 10f64.powi(decimals as i32);
    x.iter()
        .map(|x| (x * scale).round_ties_even() / scale)
        .collect()
}

/// printf's %g without its switch to exponents: so many digits, zeros at the end left out.
fn general(x: f64, digits: usize) -> String {
    let rounded: f64 = format!("{x:.*e}", digits - 1).parse().expect("a number");
    format!("{rounded}")
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 100,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn decimals_are_counted(x in positions(), decimals in 3usize..=12) {
        let wanted = Precision::Decimals(decimals as u32);
        let short = rounded(&x, decimals);
        let rows = npz(&array(&short), &array(&x), x.len() / 9);
        prop_assert_eq!(rows.precision, wanted);
        prop_assert_eq!(rows.precision_v, Precision::Double);
        prop_assert_eq!(text(&x, &|x| format!("{x:.decimals$}")).precision, wanted);
        prop_assert_eq!(text(&short, &|x| format!("{x:?}")).precision, wanted);
    }

    #[test]
    fn digits_are_counted(x in positions(), digits in 4usize..=16) {
        let wanted = Precision::Digits(digits as u32);
        prop_assert_eq!(text(&x, &|x| general(x, digits)).precision, wanted);
        prop_assert_eq!(text(&x, &|x| format!("{x:.*e}", digits - 1)).precision, wanted);
        let short: Vec<f64> = x.iter().map(|x| general(*x, digits).parse().unwrap()).collect();
        prop_assert_eq!(npz(&array(&short), &array(&x), x.len() / 9).precision, wanted);
    }

    #[test]
    fn floats_in_full_are_told_apart(x in positions()) {
        let held: Vec<f64> = x.iter().map(|x| f64::from(*x as f32)).collect();
        let rows = npz(&singles(&x), &array(&held), x.len() / 9);
        prop_assert_eq!((rows.precision, rows.precision_v), (Precision::Single, Precision::Single));
        prop_assert_eq!(text(&x, &|x| (x as f32).to_string()).precision, Precision::Single);
        prop_assert_eq!(text(&held, &|x| x.to_string()).precision, Precision::Single);
        // As C prints floats: %.9g, %.8e, %.12e, %.10f.
        prop_assert_eq!(text(&held, &|x| general(x, 9)).precision, Precision::Single);
        prop_assert_eq!(text(&held, &|x| format!("{x:.8e}")).precision, Precision::Single);
        prop_assert_eq!(text(&held, &|x| format!("{x:.12e}")).precision, Precision::Single);
        prop_assert_eq!(text(&held, &|x| format!("{x:.10}")).precision, Precision::SingleDecimals(10));
        // And they are back as they were.
        prop_assert_eq!(&text(&held, &|x| general(x, 9)).x, &held);
        prop_assert_eq!(text(&x, &|x| x.to_string()).precision, Precision::Double);
        prop_assert_eq!(text(&x, &|x| format!("{x:.18e}")).precision, Precision::Double);
    }

    /// Whatever is found, no number is farther from its original than half a unit.
    #[test]
    fn rounding_stays_within_half_a_unit(x in positions(), decimals in 1usize..=16, digits in 1usize..=17) {
        let forms: [&dyn Fn(f64) -> String; 6] = [
            &|x| format!("{x:.decimals$}"),
            &|x| general(x, digits),
            &|x| format!("{x:.*e}", digits - 1),
            &|x| (x as f32).to_string(),
            &|x| general(f64::from(x as f32), digits),
            &|x| format!("{:.decimals$}", x as f32),
        ];
        for (at, form) in forms.iter().enumerate() {
            let rows = text(&x, form);
            for (given, x) in rows.x.iter().zip(&x) {
                // Reading text rounds once more, and the unit is itself a rounded number.
                let unit = rows.precision.half_unit(*x).max(rows.precision.half_unit(*given));
                // The last two are rounded twice.
                let twice = if at < 4 { 0.0 } else { Precision::Single.half_unit(*x) };
                let slack = 1e-12 * unit + 0.5 * f64::EPSILON * x.abs() + twice;
                prop_assert!(
                    (given - x).abs() <= unit + slack,
                    "form {}, {:?}: {} given as {}", at, rows.precision, x, given
                );
            }
        }
    }
}

#[test]
fn exact_numbers_are_no_rounded_ones() {
    // Free fall in binary fractions: short decimals, but nothing was rounded.
    let x: Vec<f64> = (0..20)
        .flat_map(|n| {
            [
                0.0,
                0.0,
                2.0,
                0.5,
                0.0,
                1.0 - f64::from(n * n) / 256.0,
                1.0,
                0.0,
                1.0,
            ]
        })
        .collect();
    assert_eq!(npz(&array(&x), &array(&x), 20).precision, Precision::Double);
    assert_eq!(text(&x, &|x| x.to_string()).precision, Precision::Double);
    assert_eq!(
        npz(&singles(&x), &array(&x), 20).precision,
        Precision::Single
    );
    // The start is in doubles, as the scene has it, and the rest in singles.
    let mut mixed: Vec<f64> = (0..180)
        .map(|n| f64::from(f64::from(n).sin() as f32))
        .collect();
    mixed[..9].copy_from_slice(&[0.0, 0.1, 2.3, 0.7, 0.0, 1.1, 1.0, 0.0, 1.0]);
    assert_eq!(
        npz(&array(&mixed), &array(&x), 20).precision,
        Precision::Single
    );
    // Nothing moves.
    let x = x[..9].repeat(4);
    assert_eq!(npz(&array(&x), &array(&x), 4).precision, Precision::Double);
    assert_eq!(
        text(&x, &|x| format!("{x:.1}")).precision,
        Precision::Double
    );
}

/// -19.0390625 lies between two shortest texts: NumPy prints the first, Rust the second.
#[test]
fn singles_are_known_whichever_way_they_are_printed() {
    let x = [
        [0.5f32; 9],
        [
            0.1,
            1.0 / 3.0,
            -19.0 - 5.0 / 128.0,
            0.7,
            12.345_678,
            2e-3,
            77.7,
            0.123_456_79,
            9.87,
        ],
    ];
    for tie in ["-19.039062", "-19.039063"] {
        let print = |x: f64| {
            if x == -19.0 - 5.0 / 128.0 {
                tie.to_owned()
            } else {
                (x as f32).to_string()
            }
        };
        let rows = text(
            &x.concat().into_iter().map(f64::from).collect::<Vec<_>>(),
            &print,
        );
        assert_eq!(rows.precision, Precision::Single, "{tie}");
        assert_eq!(rows.x[9..], x[1].map(f64::from), "{tie}");
    }
}

#[test]
fn few_rows_are_enough_for_decimals() {
    let rows = text(
        &[
            0.0, 0.0, 2.0, 0.5, 0.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.5, 0.0, 0.9951, 1.0, 0.0,
            0.9951,
        ],
        &|x| x.to_string(),
    );
    assert_eq!(rows.precision, Precision::Decimals(4));
}
