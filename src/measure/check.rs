//! A finding held against its bound.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A finding held against its bound. The default is a check that was not made.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Check {
    /// The id of the check.
    pub id: String,
    /// The engine, the effect or the part of the scene that it is about.
    pub subject: String,
    /// Whether the bound holds.
    pub status: CheckStatus,
    /// The number that was found, in the unit of the bound; null where there is none.
    pub measured: Option<f64>,
    /// The number that it is held against; null where there is none.
    pub bound: Option<f64>,
    /// Where the bound comes from.
    pub derivation: String,
    /// The result in one sentence.
    pub message: String,
    /// The first moment that breaks the bound, s; absent where it is not known or nothing does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_s: Option<f64>,
    /// What likely makes it fail; absent where nobody knows.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// The key of the scene's file that it is about, as `expect.rk4.status`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CheckStatus {
    Pass,
    Fail,
    #[default]
    Skip,
    Inconclusive,
}
