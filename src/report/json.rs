//! The reports as JSON, written and read: the contract's keys, indented, with floats that round-trip.

use crate::scene::words::acts;
use schemars::generate::SchemaSettings;
use schemars::{JsonSchema, Schema};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::fmt::Debug;

/// Version of the JSON layout.
pub const SCHEMA_VERSION: u64 = 2;

/// The program that made some reports.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct Tool {
    /// `springcheck`.
    pub name: String,
    /// Its version.
    pub version: String,
    /// System and processor, such as `linux-x86_64`.
    pub platform: String,
}

impl Tool {
    /// This program itself.
    pub fn this() -> Self {
        Self {
            name: env!("CARGO_PKG_NAME").to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            platform: format!("{}-{}", std::env::consts::OS, std::env::consts::ARCH),
        }
    }
}

#[derive(Serialize, JsonSchema)]
struct Envelope<'a, R> {
    /// The version of this layout.
    #[schemars(extend("const" = SCHEMA_VERSION))]
    schema_version: u64,
    /// The program that made the reports.
    tool: &'a Tool,
    /// One for each scene.
    reports: &'a [R],
}

/// Renders any number of reports as one object.
pub fn render<R: Serialize + Debug>(tool: &Tool, reports: &[R]) -> String {
    rendered(tool, reports, serde_json::to_string_pretty)
}

/// The same object on one line.
pub fn line<R: Serialize + Debug>(tool: &Tool, reports: &[R]) -> String {
    rendered(tool, reports, serde_json::to_string)
}

fn rendered<'a, R: Serialize + Debug>(
    tool: &'a Tool,
    reports: &'a [R],
    to_text: fn(&Envelope<'a, R>) -> serde_json::Result<String>,
) -> String {
    debug_assert!(
        reports.iter().all(is_finite),
        "a report holds NaN or infinity, which JSON would turn into null without a reason"
    );
    let envelope = Envelope {
        schema_version: SCHEMA_VERSION,
        tool,
        reports,
    };
    // Serialization fails only for a `Serialize` that refuses, or a map whose keys are no strings: not here.
    escaped(&to_text(&envelope).unwrap_or_default()) + "\n"
}

/// The same JSON, with characters escaped on which a terminal would act. They only occur inside of strings.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        if c == '\n' || !acts(c) {
            escaped.push(c);
        } else {
            for unit in c.encode_utf16(&mut [0; 2]) {
                escaped += &format!("\\u{unit:04x}");
            }
        }
    }
    escaped
}

/// The JSON Schema of what [`render`] writes: JSON Schema, draft 7, as editors know it. Keys that it does not know are
/// allowed: later versions add some.
pub fn schema<R: JsonSchema>() -> Schema {
    let settings = SchemaSettings::draft07().for_serialize();
    settings
        .into_generator()
        .into_root_schema_for::<Envelope<R>>()
}

/// Why a text is not the JSON of reports. Not to be confused with a trajectory's
/// [`ReadError`](crate::trajectory::ReadError).
#[derive(Debug, thiserror::Error)]
pub enum ReportReadError {
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

/// Reads what [`render`] wrote. Series of a report are not in it, so they are
/// [`SeriesState::Missing`](crate::verbs::SeriesState): [`series::unpack`](crate::verbs::series::unpack) adds them.
///
/// # Errors
/// [`ReportReadError`] for every text that is not such JSON.
pub fn read<R: DeserializeOwned>(text: &[u8]) -> Result<(Tool, Vec<R>), ReportReadError> {
    let value: Value = serde_json::from_slice(text).map_err(|why| match why.classify() {
        serde_json::error::Category::Eof => ReportReadError::Truncated(why),
        _ => ReportReadError::NoJson(why),
    })?;
    let older = |value: &Value| value["schema_version"] == 1;
    match &value["schema_version"] {
        version if *version == SCHEMA_VERSION => {}
        Value::Number(version) if version.as_f64() > Some(SCHEMA_VERSION as f64) => {
            return Err(ReportReadError::Later(Value::Number(version.clone())));
        }
        _ if older(&value) || older(&value[0]) => return Err(ReportReadError::Older),
        _ => return Err(ReportReadError::NoReport),
    }
    let Value::Object(mut keys) = value else {
        return Err(ReportReadError::NoReport);
    };
    let (Some(tool), Some(Value::Array(reports))) = (keys.remove("tool"), keys.remove("reports"))
    else {
        return Err(ReportReadError::NoReport);
    };
    let wrong = |place: String| move |why| ReportReadError::Wrong { place, why };
    let tool = serde_json::from_value(tool).map_err(wrong("tool".to_owned()))?;
    let report =
        |(at, report)| serde_json::from_value(report).map_err(wrong(format!("reports[{at}]")));
    let reports = reports.into_iter().enumerate().map(report);
    Ok((tool, reports.collect::<Result<_, _>>()?))
}

/// Whether a report holds no NaN and no infinity. `Debug` reaches every field, also those a later version
/// adds, and prints such numbers as bare words.
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
