//! Which times are steps.

use super::{HANGING, archive, doubles, npy, scene};
use springcheck::trajectory::{self, Expected, ReadError};

fn steps(t: Vec<u8>, count: usize, timestep: f64) -> Result<Vec<u64>, ReadError> {
    let x = doubles(&[count], &vec![1.0; count]);
    let bytes = archive(&[("t.npy", &t), ("x.npy", &x)]);
    let expected = Expected::new(&scene(HANGING), timestep);
    trajectory::read(&bytes, "mine.npz", None, &expected).map(|rows| rows.steps)
}

fn of_doubles(t: &[f64], timestep: f64) -> Result<Vec<u64>, ReadError> {
    steps(doubles(&[t.len()], t), t.len(), timestep)
}

fn of_singles(t: &[f32], timestep: f64) -> Result<Vec<u64>, ReadError> {
    let bytes: Vec<u8> = t.iter().flat_map(|t| t.to_le_bytes()).collect();
    steps(npy("<f4", false, &[t.len()], &bytes), t.len(), timestep)
}

fn of_text(t: &[String], timestep: f64) -> Result<Vec<u64>, ReadError> {
    let rows: String = t.iter().map(|t| format!("{t},1\n")).collect();
    let expected = Expected::new(&scene(HANGING), timestep);
    trajectory::read(
        format!("t,x\n{rows}").as_bytes(),
        "mine.csv",
        None,
        &expected,
    )
    .map(|rows| rows.steps)
}

#[test]
fn times_match_within_a_millionth_of_a_step() {
    let at = |off: f64| vec![0.0, 0.3, (7.0 + off) * 0.1];
    // Doubles of 17 digits carry no rounding worth a millionth.
    for off in [0.0, 0.9e-6, -0.9e-6] {
        assert_eq!(of_doubles(&at(off), 0.1).unwrap(), [0, 3, 7], "{off}");
    }
    for off in [1.1e-6, -1.1e-6, 0.3, -0.5] {
        let error = of_doubles(&at(off), 0.1).unwrap_err();
        assert!(error.to_string().starts_with("mine.npz: t[2]: "), "{error}");
    }
}

#[test]
fn rows_may_be_unevenly_spaced_and_start_late() {
    // A viewer's 60 Hz over steps of 0.5 ms: 33 or 34 steps from frame to frame.
    let frames: Vec<u64> = (3..200)
        .map(|frame| (frame as f64 / 60.0 / 5e-4) as u64)
        .collect();
    let times: Vec<f64> = frames.iter().map(|n| *n as f64 * 5e-4).collect();
    assert_eq!(of_doubles(&times, 5e-4).unwrap(), frames);
    let gaps: Vec<u64> = frames.windows(2).map(|pair| pair[1] - pair[0]).collect();
    assert!(gaps.contains(&33) && gaps.contains(&34));
    let text: Vec<String> = times.iter().map(|t| format!("{t:.4}")).collect();
    assert_eq!(of_text(&text, 5e-4).unwrap(), frames);
}

#[test]
fn running_sums_stay_at_their_step() {
    let h = 0.01f64;
    let mut sum = 0.0f64;
    let mut times = vec![];
    for n in 0..1_000_001 {
        if n % 1000 == 0 {
            times.push(sum);
        }
        sum += h;
    }
    // The last of these is more than a millionth of a step off.
    assert!((times[1000] / h - 1e6).abs() > 1e-6);
    let wanted: Vec<u64> = (0..=1000).map(|k| 1000 * k).collect();
    assert_eq!(of_doubles(&times, h).unwrap(), wanted);

    let mut sum = 0.0f32;
    let mut times = vec![];
    for _ in 0..1500 {
        times.push(sum);
        sum += h as f32;
    }
    assert!((f64::from(times[1499]) / h - 1499.0).abs() > 1e-3);
    assert_eq!(
        of_singles(&times, h).unwrap(),
        (0..1500).collect::<Vec<u64>>()
    );
    // Mutant: doubles with such errors are no running sum.
    let doubles: Vec<f64> = (0..1500).map(|n| n as f64 * h * (1.0 + 1e-7)).collect();
    assert!(of_doubles(&doubles, h).is_err());
}

#[test]
fn rounded_times_fit_where_rounding_leaves_no_doubt() {
    let h = 1.0 / 240.0;
    let count = 5000u64;
    let all: Vec<u64> = (0..count).collect();
    let text = |form: &dyn Fn(f64) -> String| -> Vec<String> {
        all.iter().map(|n| form(*n as f64 * h)).collect()
    };
    for decimals in [4, 6, 9] {
        assert_eq!(
            of_text(&text(&|t| format!("{t:.decimals$}")), h).unwrap(),
            all,
            "{decimals}"
        );
    }
    for digits in [5, 9] {
        assert_eq!(
            of_text(&text(&|t| format!("{t:.digits$e}")), h).unwrap(),
            all,
            "{digits}"
        );
    }
    let short = text(&|t| format!("{:?}", (t * 1e5).round() / 1e5));
    assert_eq!(of_text(&short, h).unwrap(), all);
    let singles: Vec<f32> = all.iter().map(|n| (*n as f64 * h) as f32).collect();
    assert_eq!(of_singles(&singles, h).unwrap(), all);
    let printed: Vec<String> = singles.iter().map(f32::to_string).collect();
    assert_eq!(of_text(&printed, h).unwrap(), all);
    // Two decimals are more than a step: which one is meant cannot be told.
    assert!(of_text(&text(&|t| format!("{t:.2}")), h).is_err());
}

#[test]
fn a_step_that_fits_is_suggested() {
    let suggestion = |times: &[f64], h: f64| of_doubles(times, h).unwrap_err().help;
    let multiples = |h: f64, of: &[u32]| of.iter().map(|n| f64::from(*n) * h).collect::<Vec<f64>>();
    for h in [0.01, 5e-4, 0.15, 0.0123, 3.0, 1.0 / 240.0] {
        for of in [
            &[0, 1, 2, 3, 4, 5][..],
            &[2, 5, 8, 15, 100],
            &[7, 9, 11, 300, 303],
        ] {
            let expected = format!("times are multiples of {h:?}: --timestep {h:?}");
            assert_eq!(suggestion(&multiples(h, of), 0.7 * h), expected);
        }
    }
    let random = [0.0, 0.123_456_789_1, 0.314_159_265_3, 0.271_828_182_8, 0.9];
    let mut sums = random;
    for k in 1..sums.len() {
        sums[k] += sums[k - 1];
    }
    let none = "--timestep tells the step the rows were computed with";
    assert_eq!(suggestion(&sums, 0.01), none);
    let nearly = "write t as n * timestep, not as a running sum";
    assert_eq!(suggestion(&[0.0, 1.0, 2.000_1], 1.0), nearly);
}
