//! What was written reads back, and whatever else is read does no harm.

use super::all;
use crate::report::json::{self, ReportReadError, Tool};
use crate::report::{terminal, verdict::verdict};
use crate::verbs::formats::FORMATS;
use crate::verbs::series;
use crate::verbs::{Report, SeriesState};
use serde_json::{Value, json};

fn written(reports: &[Report]) -> String {
    json::render(&Tool::this(), reports)
}

/// Through the JSON and the file of series beside it.
fn back(report: &Report) -> Report {
    let reports = std::slice::from_ref(report);
    let (_, read) = json::read::<Report>(written(reports).as_bytes()).unwrap();
    let read = match series::pack(reports) {
        Some(bytes) => series::unpack(read, &bytes),
        None => read,
    };
    read.into_iter().next().unwrap()
}

#[test]
fn a_report_that_is_read_back_shows_the_same() {
    for report in all() {
        let read = [back(&report)];
        let report = [report];
        for format in FORMATS {
            let render = |reports| (format.render)(&Tool::this(), reports);
            assert_eq!(render(&read), render(&report), "{}", format.id);
        }
        assert_eq!(read[0].svg(), report[0].svg());
        assert_eq!(series::pack(&read), series::pack(&report));
    }
}

#[test]
fn without_its_series_a_report_says_the_same() {
    for report in all() {
        let text = written(std::slice::from_ref(&report));
        let (_, read) = json::read::<Report>(text.as_bytes()).unwrap();
        assert_eq!(written(&read), text);
        let had = matches!(report.series, SeriesState::Loaded(_));
        assert_eq!(matches!(read[0].series, SeriesState::Missing), had);
        let [one, other] = [&read[0], &report].map(|report| terminal::render(report.view()));
        assert_eq!(one, other);
        let drawn = read[0].svg().len();
        assert!(drawn == report.svg().len() || had);
    }
}

/// An earlier run's, of which the JSON was written over; of something else altogether; cut short.
#[test]
fn series_of_other_reports_are_not_taken() {
    let [one, other] = [4, 5].map(|at| all().remove(at));
    let (_, read) = json::read::<Report>(written(std::slice::from_ref(&one)).as_bytes()).unwrap();
    let missing = |file: &[u8]| {
        let whole = series::unpack(read.clone(), file);
        matches!(whole[0].series, SeriesState::Missing)
    };
    let own = series::pack(std::slice::from_ref(&one)).unwrap();
    assert!(!missing(&own));
    assert!(missing(&series::pack(&[other]).unwrap()));
    assert!(missing(b"") && missing(b"{}") && missing(&own[..own.len() / 2]));
}

#[test]
fn what_is_no_report_is_refused() {
    let good = written(&all()[4..5]);
    for cut in (0..good.len() - 2).step_by(97) {
        let found = json::read::<Report>(&good.as_bytes()[..cut]);
        assert!(matches!(found, Err(ReportReadError::Truncated(_))), "{cut}");
    }
    let read = |value: &Value| json::read::<Report>(value.to_string().as_bytes());
    let whole: Value = serde_json::from_str(&good).unwrap();
    let with = |key: &str, value: Value| {
        let mut changed = whole.clone();
        changed[key] = value;
        read(&changed)
    };
    let older = json!({"schema_version": 1, "scene": {}});
    for older in [json!([older.clone(), older.clone()]), older] {
        assert!(matches!(read(&older), Err(ReportReadError::Older)));
    }
    for later in [json!(3), json!(u64::MAX), json!(1e300)] {
        let found = with("schema_version", later);
        assert!(matches!(found, Err(ReportReadError::Later(_))));
    }
    for odd in [json!(0), json!(-1), json!("2"), json!(null), json!([2])] {
        let found = with("schema_version", odd);
        assert!(matches!(found, Err(ReportReadError::NoReport)));
    }
    for other in [json!(null), json!([]), json!({}), json!(7), json!("report")] {
        assert!(matches!(read(&other), Err(ReportReadError::NoReport)));
    }
    for odd in [json!(null), json!({}), json!("")] {
        assert!(matches!(
            with("reports", odd),
            Err(ReportReadError::NoReport)
        ));
    }
    for odd in [json!([1]), json!([{}]), json!([{"verb": "dance"}])] {
        let found = with("reports", odd).unwrap_err().to_string();
        assert!(found.starts_with("reports[0]: "), "{found}");
    }
    assert!(with("reports", json!([])).is_ok());
    assert!(matches!(
        json::read::<Report>(b"\xff"),
        Err(ReportReadError::NoJson(_))
    ));
    let deep = "[".repeat(100_000);
    assert!(json::read::<Report>(deep.as_bytes()).is_err());
}

/// Pseudo-random numbers, the same in every run (Knuth's MMIX generator).
struct Dice(u64);

impl Dice {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count.max(1)
    }
}

/// Every place of a value, as JSON pointers.
fn places(at: &str, value: &Value, found: &mut Vec<String>) {
    found.push(at.to_owned());
    match value {
        Value::Object(keys) => {
            for (key, value) in keys {
                places(&format!("{at}/{key}"), value, found);
            }
        }
        Value::Array(values) => {
            for (i, value) in values.iter().enumerate().take(4) {
                places(&format!("{at}/{i}"), value, found);
            }
        }
        _ => {}
    }
}

/// Reports with anything anywhere are refused or shown, and never panic.
#[test]
fn no_report_is_too_odd() {
    let odd = [
        json!(null),
        json!(true),
        json!(0),
        json!(-1),
        json!(1),
        json!(9_999),
        json!(u64::MAX),
        json!(1e-320),
        json!(-1e308),
        json!(1.7e308),
        json!(0.1),
        json!("NaN"),
        json!(""),
        json!("\u{1b}[31m\u{202e}a|b"),
        json!([]),
        json!([1e308, -1e308]),
        json!([[0.0, 1e308], []]),
        json!({}),
    ];
    let mut dice = Dice(2);
    let mut shown = 0;
    for report in all() {
        let reports = [report];
        let text: Value = serde_json::from_str(&written(&reports)).unwrap();
        let drawn = serde_json::to_value(reports[0].series()).unwrap();
        let [mut keys, mut points] = [Vec::new(), Vec::new()];
        places("", &text["reports"][0], &mut keys);
        places("", &drawn, &mut points);
        for _ in 0..30 {
            let mut text = text.clone();
            for _ in 0..=dice.below(2) {
                let place = format!("/reports/0{}", keys[dice.below(keys.len())]);
                if let Some(value) = text.pointer_mut(&place) {
                    *value = odd[dice.below(odd.len())].clone();
                }
            }
            let mut drawn = drawn.clone();
            if let Some(value) = drawn.pointer_mut(&points[dice.below(points.len())]) {
                *value = odd[dice.below(odd.len())].clone();
            }
            let Ok((_, read)) = json::read::<Report>(text.to_string().as_bytes()) else {
                continue;
            };
            let Some(mut read) = read.into_iter().next() else {
                continue;
            };
            if let Ok(Some(series)) = serde_json::from_value(drawn) {
                read.series = SeriesState::Loaded(series);
            }
            terminal::render(read.view());
            read.markdown();
            read.svg();
            verdict(&read.view());
            shown += 1;
        }
    }
    // A fifth of the changes leave a report that can be shown.
    assert!(shown > 60, "{shown}");
}
