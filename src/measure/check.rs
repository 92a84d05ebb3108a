//! A finding held against its bound.

use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Check {
    pub id: String,
    pub subject: String,
    pub status: CheckStatus,
    pub measured: Option<f64>,
    pub bound: Option<f64>,
    pub derivation: String,
    pub message: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CheckStatus {
    Pass,
    Fail,
    Skip,
    Inconclusive,
}
