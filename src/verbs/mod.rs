//! The verbs, one folder each: arguments, plan, result, text and figures. Here is what they share: the
//! [`Report`], which holds everything one verb found of one scene and reads back.
//!
//! Every number that could be missing is an `Option`; no field ever holds NaN or infinity.

pub mod cli;
pub mod clock;
pub mod compare;
pub mod cost;
mod facts;
pub mod formats;
pub mod list;
pub mod run;
pub mod series;
pub mod session;
pub mod show;
pub mod stability;

#[cfg(test)]
mod tests;

pub use run::names;

use crate::measure::identify::Fault;
use crate::report::Header;
use cost::{Cost, CostPanels};
use run::{Figures, Outcome};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use stability::Stability;

/// Everything one verb found of one scene: complete when it is made, and equal after it was written
/// as JSON and read again.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Report {
    #[serde(flatten)]
    pub header: Header,
    #[serde(flatten)]
    pub body: Body,
    /// What only figures need. The JSON says whether there is any; it lies in a file beside it.
    #[serde(rename = "series", default)]
    pub beside: Beside,
}

/// What one verb found. The JSON's key `verb` says which it is.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(tag = "verb", rename_all = "snake_case")]
pub enum Body {
    Run {
        outcomes: Vec<Outcome>,
    },
    Compare {
        outcomes: Vec<Outcome>,
        /// The first step that leaves the scheme; null where none does.
        fault: Option<Fault>,
    },
    Stability {
        /// There for readers that look for outcomes in every report.
        outcomes: [(); 0],
        stability: Stability,
    },
    Cost {
        /// As in `Stability`.
        outcomes: [(); 0],
        cost: Cost,
    },
}

impl Report {
    /// One for each engine and timestep; none where the verb has other answers.
    pub fn outcomes(&self) -> &[Outcome] {
        match &self.body {
            Body::Run { outcomes } | Body::Compare { outcomes, .. } => outcomes,
            Body::Stability { .. } | Body::Cost { .. } => &[],
        }
    }

    /// Of `stability` alone.
    pub fn stability(&self) -> Option<&Stability> {
        match &self.body {
            Body::Stability { stability, .. } => Some(stability),
            _ => None,
        }
    }

    /// Of `cost` alone.
    pub fn cost(&self) -> Option<&Cost> {
        match &self.body {
            Body::Cost { cost, .. } => Some(cost),
            _ => None,
        }
    }
}

/// Whether a report has series, and whether they are at hand. In the JSON true or false.
#[derive(Debug, Clone, Default)]
pub enum Beside {
    /// It has none, or nobody wants its figures.
    #[default]
    Nothing,
    /// It has some, and the file that holds them was not found.
    Missing,
    Here(Series),
}

impl Serialize for Beside {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_bool(!matches!(self, Self::Nothing))
    }
}

impl<'de> Deserialize<'de> for Beside {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let there = bool::deserialize(deserializer)?;
        Ok(if there { Self::Missing } else { Self::Nothing })
    }
}

/// The series of one report.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Series {
    /// Of `run` and `compare`.
    Curves(Figures),
    /// Of `cost`, where steps were asked for by name.
    Panels(CostPanels),
}

impl Report {
    /// The same report for those who draw nothing.
    #[must_use]
    pub fn without_series(self) -> Self {
        Self {
            beside: Beside::Nothing,
            ..self
        }
    }

    /// The series, where they are at hand.
    pub fn series(&self) -> Option<&Series> {
        match &self.beside {
            Beside::Here(series) => Some(series),
            Beside::Nothing | Beside::Missing => None,
        }
    }

    /// What the figures of `run` and `compare` are drawn from; empty where nothing is at hand.
    pub fn figures(&self) -> &Figures {
        static EMPTY: Figures = Figures {
            curves: Vec::new(),
            truth: None,
            plot: None,
            plane: [0, 0],
            fixed: Vec::new(),
        };
        match self.series() {
            Some(Series::Curves(figures)) => figures,
            _ => &EMPTY,
        }
    }

    /// The picture of a few steps side by side that `cost` draws.
    pub fn panels(&self) -> Option<&CostPanels> {
        match self.series()? {
            Series::Panels(panels) => Some(panels),
            Series::Curves(_) => None,
        }
    }
}
