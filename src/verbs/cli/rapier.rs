//! `--rapier dt=0.001,iterations=8,pgs=4`: one more rapier row.

use crate::solvers::Solver;
use crate::solvers::rapier::Settings;
use std::str::FromStr;

/// rapier's settings as the flag states them; what it leaves out keeps rapier's default.
#[derive(Debug, Clone)]
pub struct Custom {
    /// Seconds; None takes everybody's.
    pub timestep: Option<f64>,
    settings: Settings,
}

/// More iterations or sweeps than this are a typing error.
const MOST: u32 = 1_000_000;

impl FromStr for Custom {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut custom = Self {
            timestep: None,
            settings: Settings::DEFAULT,
        };
        for pair in text.split(',') {
            let (key, value) = pair
                .split_once('=')
                .ok_or_else(|| format!("expected key=value, found `{pair}`"))?;
            let count = |least: u32| match value.parse::<u32>() {
                Ok(count) if (least..=MOST).contains(&count) => Ok(count),
                _ => Err(format!(
                    "{key}: expected a whole number from {least} to {MOST}, found `{value}`"
                )),
            };
            let positive = |unit: &str| {
                let number = value.parse::<f64>().ok();
                let number = number.filter(|x| x.is_finite() && *x > 0.0);
                number.ok_or_else(|| format!("{key}: expected positive {unit}, found `{value}`"))
            };
            match key {
                "dt" => custom.timestep = Some(positive("seconds")?),
                "speed" => custom.settings.speed = Some(positive("metres per second")?),
                "iterations" => custom.settings.iterations = count(1)?,
                "pgs" => custom.settings.pgs = count(1)?,
                "stabilization" => custom.settings.stabilization = count(0)?,
                _ => {
                    return Err(format!(
                        "unknown key `{key}`; known: dt, iterations, pgs, stabilization, \
                         speed"
                    ));
                }
            }
        }
        Ok(custom)
    }
}

impl Custom {
    /// The engine, named after its settings. Others are not compared with it.
    pub fn solver(&self) -> Solver {
        let mut solver = Solver::rapier(self.settings);
        solver.reference = false;
        solver.timestep = self.timestep;
        if let Some(dt) = self.timestep {
            let changes = self.settings.changes();
            solver.id = format!("rapier(dt={dt},{changes})").into();
        }
        solver
    }
}
