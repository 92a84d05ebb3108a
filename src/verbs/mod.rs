//! The verbs, one folder each: arguments, plan, result, text and figures. They share the [`Report`], which
//! holds everything one verb found about one scene and can be read back.
//!
//! Every number that could be missing is an `Option`; no field ever holds NaN or infinity.

pub mod check;
pub mod cli;
pub mod clock;
pub mod compare;
pub mod completions;
pub mod cost;
pub mod expand;
pub mod explain;
mod facts;
pub mod formats;
pub mod init;
pub mod list;
pub mod merge;
pub mod report;
pub mod rest;
pub mod run;
pub mod schema;
pub mod scheme;
pub mod series;
pub mod session;
pub mod shape;
pub mod show;
pub mod stability;

#[cfg(test)]
mod tests;

use crate::measure::identify::Fault;
use crate::report::Header;
use crate::scene::Names;
use cost::{Cost, CostPanels};
use rest::{AtRest, RestShape};
use run::{Outcome, RunSeries};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use stability::Stability;
use std::sync::LazyLock;

/// All names that a scene file may refer to: methods, engines, keys and checks. For
/// [`scene::parse`](crate::scene::parse) and [`scene::read`](crate::scene::read).
pub fn names() -> &'static Names {
    static NAMES: LazyLock<Names> = LazyLock::new(|| Names {
        checks: check::ids(),
        ..run::names().clone()
    });
    &NAMES
}

/// Everything one verb found about one scene. It is complete when it is made, and equal after it was written
/// as JSON and read again.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Report {
    #[serde(flatten)]
    pub header: Header,
    #[serde(flatten)]
    pub body: Body,
    /// The series that only figures need. The JSON says whether there are any; they lie in a file beside it.
    #[serde(default)]
    #[schemars(with = "bool")]
    pub series: SeriesState,
}

/// The result of one verb. The JSON's key `verb` says which it is.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "verb", rename_all = "snake_case")]
pub enum Body {
    Run {
        /// One for each engine and timestep.
        outcomes: Vec<Outcome>,
    },
    /// As `run`, without times.
    Check {
        /// One for each engine.
        outcomes: Vec<Outcome>,
    },
    Compare {
        /// One: that of the trajectory.
        outcomes: Vec<Outcome>,
        /// The first step that deviates from the scheme; null where none does.
        fault: Option<Fault>,
    },
    Stability {
        /// Always empty: some readers look for outcomes in every report.
        outcomes: [(); 0],
        /// How large a step may be.
        stability: Stability,
    },
    Cost {
        /// As in `Stability`.
        outcomes: [(); 0],
        /// What accuracy costs.
        cost: Cost,
    },
    Rest {
        /// As in `Stability`.
        outcomes: [(); 0],
        /// Where it comes to rest.
        rest: AtRest,
    },
}

impl Report {
    /// One outcome for each engine and timestep; none where the verb has a result of another kind.
    pub fn outcomes(&self) -> &[Outcome] {
        match &self.body {
            Body::Run { outcomes } | Body::Check { outcomes } | Body::Compare { outcomes, .. } => {
                outcomes
            }
            Body::Stability { .. } | Body::Cost { .. } | Body::Rest { .. } => &[],
        }
    }

    /// The result of `stability`; None for other verbs.
    pub fn stability(&self) -> Option<&Stability> {
        match &self.body {
            Body::Stability { stability, .. } => Some(stability),
            _ => None,
        }
    }

    /// The result of `rest`; None for other verbs.
    pub fn rest(&self) -> Option<&AtRest> {
        match &self.body {
            Body::Rest { rest, .. } => Some(rest),
            _ => None,
        }
    }

    /// The result of `cost`; None for other verbs.
    pub fn cost(&self) -> Option<&Cost> {
        match &self.body {
            Body::Cost { cost, .. } => Some(cost),
            _ => None,
        }
    }
}

/// Whether a report has series, and the series where they are loaded. The JSON holds true or false.
#[derive(Debug, Clone, Default)]
pub enum SeriesState {
    /// The report has no series, or its figures are not wanted.
    #[default]
    Nothing,
    /// The report has series, but the file that holds them was not found.
    Missing,
    Loaded(Series),
}

impl Serialize for SeriesState {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bool(!matches!(self, Self::Nothing))
    }
}

impl<'de> Deserialize<'de> for SeriesState {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let has_series = bool::deserialize(deserializer)?;
        Ok(if has_series {
            Self::Missing
        } else {
            Self::Nothing
        })
    }
}

/// The series of one report, from which figures are drawn.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// The series of `run` and `compare`.
    Curves(RunSeries),
    /// The series of `cost`, where the steps were named.
    Panels(CostPanels),
    /// The series of `rest`.
    Shape(RestShape),
}

impl Report {
    /// The same report without its series, for callers that draw nothing.
    #[must_use]
    pub fn without_series(self) -> Self {
        Self {
            series: SeriesState::Nothing,
            ..self
        }
    }

    /// The series; None where they are not loaded.
    pub fn series(&self) -> Option<&Series> {
        match &self.series {
            SeriesState::Loaded(series) => Some(series),
            SeriesState::Nothing | SeriesState::Missing => None,
        }
    }

    /// The series of `run` and `compare`; empty where they are not loaded.
    pub fn run_series(&self) -> &RunSeries {
        static EMPTY: RunSeries = RunSeries {
            curves: Vec::new(),
            truth: None,
            plot: None,
            plane: [0, 0],
            phase: None,
            fixed: Vec::new(),
            playback: None,
        };
        match self.series() {
            Some(Series::Curves(series)) => series,
            _ => &EMPTY,
        }
    }

    /// The series of `rest`; None where they are not loaded.
    pub fn shape(&self) -> Option<&RestShape> {
        match self.series()? {
            Series::Shape(shape) => Some(shape),
            _ => None,
        }
    }

    /// The series of `cost`, which draws a few steps side by side; None where they are not loaded.
    pub fn panels(&self) -> Option<&CostPanels> {
        match self.series()? {
            Series::Panels(panels) => Some(panels),
            _ => None,
        }
    }
}
