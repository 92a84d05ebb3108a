//! What rods do in a run, at every recorded instant: how far it is off them in length and in velocity, how that grows,
//! and how much they pull.

use crate::physics::constraints::Rods;
use crate::physics::{ParticleSystem, System};
use crate::trajectory::Trajectory;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What a run leaves of its rods, over its recorded instants. What the start is off counts too, but not in the growth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Constrained {
    /// The largest error of a rod's length, m.
    pub length_error_max_m: f64,
    /// The rod that has it, by its place in the scene's list.
    pub rod: usize,
    /// When, s.
    pub t_s: f64,
    /// How the error of the length grows; null where it was not finite, or there are too few instants.
    pub length_growth: Option<Growth>,
    /// The largest velocity along a rod, m/s; null where velocities are not known.
    pub velocity_along_max_m_s: Option<f64>,
    /// How that grows.
    pub velocity_growth: Option<Growth>,
    /// The largest pull of a rod; null where velocities are not known, on which it depends.
    pub tension_max: Option<RodTension>,
    /// The smallest: below 0 N where a rod pushes.
    pub tension_min: Option<RodTension>,
}

/// The tension of a rod at an instant: the multiplier that its state asks for.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RodTension {
    /// N.
    pub tension_n: f64,
    /// Its place in the scene's list of rods.
    pub rod: usize,
    /// s.
    pub t_s: f64,
}

/// The law by which an error of rods grows.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", tag = "law")]
pub enum Growth {
    /// It is no more than rounding.
    Rounding,
    /// It comes and goes, and its largest values do not grow.
    Bounded,
    /// Its largest values so far grow as a power of time.
    Power {
        /// That power, fitted over the last nine tenths of the run.
        exponent: f64,
    },
}

/// The errors of all rods over time.
#[derive(Debug, Clone)]
struct Series {
    /// Seconds.
    t: Vec<f64>,
    /// The largest error of a length at each instant, m.
    length: Vec<f64>,
    /// Its rod.
    rods: Vec<usize>,
    /// The largest velocity along a rod, m/s; empty where velocities are not known.
    velocity: Vec<f64>,
    /// Errors of lengths and velocities that rounding explains, m and m/s.
    floors: [f64; 2],
}

/// Roundings of a coordinate, or of a speed, that an error may have and still count as rounding.
const ROUNDINGS: f64 = 16.0;
/// Instants that a law of growth takes, at least.
const FEWEST: usize = 13;
/// A smaller power of time is no growth: the largest of many values that come and go rises as slowly.
const GROWS: f64 = 0.25;

/// What rods do in a run; None without rods or instants. Instants that are not finite are left out.
pub fn constrained(system: &ParticleSystem, run: &Trajectory) -> Option<Constrained> {
    let series = Series::new(system.rods()?, run)?;
    let mut summary = series.summary();
    for k in 0..run.len() {
        if !run.has_velocities() {
            break;
        }
        let t_s = run.time(k);
        // Not determined, or not finite: no tension.
        let tensions = system
            .rod_tensions(t_s, run.x(k), run.v(k))
            .unwrap_or_default();
        for (rod, tension_n) in tensions.into_iter().enumerate() {
            let now = RodTension {
                tension_n,
                rod,
                t_s,
            };
            let more = |than: &RodTension| tension_n > than.tension_n;
            let less = |than: &RodTension| tension_n < than.tension_n;
            if tension_n.is_finite() && summary.tension_max.as_ref().is_none_or(more) {
                summary.tension_max = Some(now);
            }
            if tension_n.is_finite() && summary.tension_min.as_ref().is_none_or(less) {
                summary.tension_min = Some(now);
            }
        }
    }
    Some(summary)
}

impl Series {
    fn new(rods: &Rods, run: &Trajectory) -> Option<Self> {
        let mut series = Self {
            t: Vec::new(),
            length: Vec::new(),
            rods: Vec::new(),
            velocity: Vec::new(),
            floors: [0.0; 2],
        };
        for k in 0..run.len() {
            let (x, v) = (run.x(k), run.v(k));
            let off = rods.residual(x, v);
            if !(off.position.is_finite() && off.velocity.is_finite()) {
                continue;
            }
            for (floor, values) in series.floors.iter_mut().zip([x, v]) {
                let largest = values.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
                *floor = floor.max(ROUNDINGS * f64::EPSILON * largest);
            }
            series.t.push(run.time(k));
            series.length.push(off.position);
            series.rods.push(off.longest);
            if run.has_velocities() {
                series.velocity.push(off.velocity);
            }
        }
        (!series.t.is_empty()).then_some(series)
    }

    /// The largest errors and how they grow.
    fn summary(&self) -> Constrained {
        let mut worst = 0;
        for (k, off) in self.length.iter().enumerate() {
            if *off > self.length[worst] {
                worst = k;
            }
        }
        let fastest = self.velocity.iter().copied().reduce(f64::max);
        Constrained {
            length_error_max_m: self.length[worst],
            rod: self.rods[worst],
            t_s: self.t[worst],
            length_growth: growth(&self.t, &self.length, self.floors[0]),
            velocity_along_max_m_s: fastest,
            velocity_growth: growth(&self.t, &self.velocity, self.floors[1]),
            tension_max: None,
            tension_min: None,
        }
    }
}

/// The law of the largest values so far, from their slope over time on logarithmic scales.
fn growth(t: &[f64], off: &[f64], floor: f64) -> Option<Growth> {
    let last = *t.last()?;
    let most = off.iter().copied().reduce(f64::max)?;
    if most <= floor {
        return Some(Growth::Rounding);
    }
    if off.len() < FEWEST {
        return None;
    }
    let mut largest = 0.0_f64;
    let mut points = Vec::new();
    for (t, off) in t.iter().zip(off).skip(1) {
        largest = largest.max(*off);
        if *t >= 0.1 * last && largest > 0.0 {
            points.push([t.ln(), largest.ln()]);
        }
    }
    let count = points.len() as f64;
    let mean = |axis: usize| points.iter().map(|p| p[axis]).sum::<f64>() / count;
    let means = [mean(0), mean(1)];
    let product = |a: usize, b: usize| -> f64 {
        let each = points.iter().map(|p| (p[a] - means[a]) * (p[b] - means[b]));
        each.sum()
    };
    let exponent = product(0, 1) / product(0, 0);
    if !exponent.is_finite() {
        return None;
    }
    Some(if exponent < GROWS {
        Growth::Bounded
    } else {
        Growth::Power { exponent }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(law: impl Fn(f64) -> f64) -> Option<Growth> {
        let t: Vec<f64> = (0..=1000).map(|n| f64::from(n) * 0.01).collect();
        let off: Vec<f64> = t.iter().map(|t| law(*t)).collect();
        growth(&t, &off, 1e-15)
    }

    #[test]
    fn the_law_is_found() {
        assert_eq!(of(|_| 1e-16), Some(Growth::Rounding));
        assert_eq!(of(|t| 1e-6 * (7.0 * t).sin().abs()), Some(Growth::Bounded));
        for power in [1.0, 2.0, 4.0] {
            let Some(Growth::Power { exponent }) = of(|t| 1e-9 * t.powf(power)) else {
                panic!("{power}");
            };
            // A power is a straight line on these scales.
            assert!((exponent - power).abs() < 1e-9, "{exponent}");
        }
        assert_eq!(growth(&[0.0, 1.0], &[0.0, 1.0], 0.0), None);
    }
}
