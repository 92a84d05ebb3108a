//! What figures are drawn from beside the report itself: too large for the JSON, so it lies in a file
//! beside it ([`report::series`](crate::report::series)).

use super::{Report, Status};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

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

/// What the figures are drawn from.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Figures {
    /// One per outcome that recorded anything, in the outcomes' order.
    pub curves: Vec<Curves>,
    /// What really happens, up to the truth's horizon.
    pub truth: Option<TruthCurves>,
    /// The curve the scene asks for: its axis label and range.
    pub plot: Option<PlotAxis>,
    /// The two coordinates (0, 1, 2) trajectories are projected on: the widest, `up` vertical.
    pub plane: [usize; 2],
    /// Fixed particles on that plane, drawn as squares.
    pub fixed: Vec<[f64; 2]>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct PlotAxis {
    /// Such as `particle 1, z (m)`.
    pub label: String,
    pub y_range: Option<[f64; 2]>,
}

/// Series over the recorded instants of one outcome; all finite, equally long where not empty.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct Curves {
    /// Index into the report's outcomes.
    pub outcome: usize,
    /// Seconds.
    pub t: Vec<f64>,
    /// (B - B(0)) / S, or joules where the scene has no scale; empty where no velocities are known.
    pub energy: Vec<f64>,
    /// The coordinate `plot` names; empty without one.
    pub plot: Vec<f64>,
    /// A few particles' paths projected on `Figures::plane`: one polyline each.
    pub paths: Vec<Vec<[f64; 2]>>,
}

/// The truth over some instants; all finite, equally long.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct TruthCurves {
    /// Seconds.
    pub t: Vec<f64>,
    /// As in [`Curves`].
    pub plot: Vec<f64>,
    /// As in [`Curves`].
    pub paths: Vec<Vec<[f64; 2]>>,
}

/// The classic picture: each integrator at a few steps, the truth, and the difference.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CostPanels {
    /// The coordinate shown, such as `particle 1, z (m)`.
    pub label: String,
    /// The truth's curve: seconds and metres; empty without truth.
    pub truth: Vec<[f64; 2]>,
    /// One an engine, in the order of the curves.
    pub panels: Vec<CostPanel>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CostPanel {
    pub engine: String,
    /// Coarse to fine.
    pub lines: Vec<CostLine>,
}

/// One run in a panel; all numbers finite.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CostLine {
    /// Seconds.
    pub timestep: f64,
    pub status: Status,
    /// Seconds and metres.
    pub curve: Vec<[f64; 2]>,
    /// Seconds, and metres above the truth; empty without truth.
    pub difference: Vec<[f64; 2]>,
}
