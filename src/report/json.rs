//! The machine-readable reports: the contract's keys, indented, floats that round-trip, and the way back.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt::Debug;

/// Version of the JSON layout.
pub const SCHEMA_VERSION: u64 = 2;

/// The program that made some reports.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tool {
    pub name: String,
    pub version: String,
    /// System and processor, such as `linux-x86_64`.
    pub platform: String,
}

impl Tool {
    /// This very program.
    pub fn this() -> Self {
        Self {
            name: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            platform: format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

#[derive(Serialize)]
struct Envelope<'a, R> {
    schema_version: u64,
    tool: &'a Tool,
    reports: &'a [R],
}

/// Any number of reports as one object.
pub fn render<R: Serialize + Debug>(tool: &Tool, reports: &[R]) -> String {
    debug_assert!(
        reports.iter().all(is_finite),
        "a report holds NaN or infinity, which JSON would turn into null without a reason"
    );
    let envelope = Envelope {
        schema_version: SCHEMA_VERSION,
        tool,
        reports,
    };
    // Fails only for a `Serialize` that refuses or a map with keys that are no strings: not here.
    let mut text = serde_json::to_string_pretty(&envelope).unwrap_or_default();
    text.push('\n');
    text
}

/// Why a text holds no reports.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    #[error("expected the JSON of a report, found text that ends too early: {0}")]
    Truncated(serde_json::Error),
    #[error("expected the JSON of a report: {0}")]
    NoJson(serde_json::Error),
    #[error(
        "expected an object with the keys `schema_version`, `tool` and `reports`, as --format json prints it"
    )]
    NoReport,
    #[error("made by an older version of springcheck (schema 1): run it again")]
    Older,
    #[error(
        "schema {0}, made by a later version of springcheck; this one reads schema {SCHEMA_VERSION}"
    )]
    Later(Value),
    #[error("{place}: {why}")]
    Wrong {
        /// Such as `reports[0]`.
        place: String,
        why: serde_json::Error,
    },
}

/// What [`render`] wrote. Of reports with series, those are [`SeriesState::Missing`](crate::verbs::SeriesState):
/// [`series::unpack`](crate::verbs::series::unpack) brings both together.
///
/// # Errors
/// [`ReadError`], whatever the text.
pub fn read<R: DeserializeOwned>(text: &[u8]) -> Result<(Tool, Vec<R>), ReadError> {
    let value: Value = serde_json::from_slice(text).map_err(|why| match why.classify() {
        serde_json::error::Category::Eof => ReadError::Truncated(why),
        _ => ReadError::NoJson(why),
    })?;
    let older = |value: &Value| value["schema_version"] == 1;
    match &value["schema_version"] {
        version if *version == SCHEMA_VERSION => {}
        Value::Number(version) if version.as_f64() > Some(SCHEMA_VERSION as f64) => {
            return Err(ReadError::Later(Value::Number(version.clone())));
        }
        _ if older(&value) || older(&value[0]) => return Err(ReadError::Older),
        _ => return Err(ReadError::NoReport),
    }
    let Value::Object(mut keys) = value else {
        return Err(ReadError::NoReport);
    };
    let (Some(tool), Some(Value::Array(reports))) = (keys.remove("tool"), keys.remove("reports"))
    else {
        return Err(ReadError::NoReport);
    };
    let wrong = |place: String| move |why| ReadError::Wrong { place, why };
    let tool = serde_json::from_value(tool).map_err(wrong("tool".to_owned()))?;
    let report =
        |(at, report)| serde_json::from_value(report).map_err(wrong(format!("reports[{at}]")));
    let reports = reports.into_iter().enumerate().map(report);
    Ok((tool, reports.collect::<Result<_, _>>()?))
}

/// No NaN and no infinity in anything the JSON carries. `Debug` reaches every field, also those a
/// later version adds, and prints such numbers as bare words.
fn is_finite(report: &impl Debug) -> bool {
    let text = format!("{report:?}")
        .replace(r"\\", "")
        .replace(r#"\""#, "");
    // Every second part stands between quotation marks.
    let bare = text.split('"').step_by(2);
    let separates = |c: char| !c.is_alphanumeric() && c != '_';
    let mut words = bare.flat_map(|part| part.split(separates));
    !words.any(|word| word == "NaN" || word == "inf")
}
