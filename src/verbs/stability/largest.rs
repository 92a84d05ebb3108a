//! The inverse question: how large a quantity of the scene may be at a given timestep.

use super::rows::predicted;
use super::vary::VariedKey;
use crate::measure::stability::{Effort, Limit, Linearised};
use crate::physics::{ParticleSystem, State};
use crate::scene::Scene;
use crate::scene::limits::Bounds;
use crate::solvers::Solver;
use crate::verbs::stability::{Largest, LargestFound, LargestRow};
use rayon::prelude::*;

/// Values tried first: this many decades around the scene's own, and so many a decade.
const DECADES: i32 = 6;
const PER_DECADE: i32 = 2;
/// Relative width to which a value is found.
const WIDTH: f64 = 1e-6;
/// A value is checked this much inside and outside, relative.
const BESIDE: f64 = 1e-4;
/// Keys of a penalty, which has no say where it presses nothing.
const PENALTY: &str = "contact.penalty";
/// A step at its limit counts as stable to rounding.
const ROUNDING: f64 = 1e-9;

/// The largest value of `key` for which each solver is stable at `timestep`, s, by the predicted limit of the
/// scene with that value: about its start, and about the state of a trajectory in which a penalty is `pressed`, if there is
/// one.
pub fn find(
    key: &VariedKey,
    scene: &Scene,
    solvers: &[Solver],
    timestep: f64,
    pressed: Option<&State>,
) -> Largest {
    let about = |value: f64| Some((value, linearised(&key.apply(scene, value).ok()?, pressed)));
    let found: Vec<_> = tried(key, scene)
        .into_par_iter()
        .filter_map(about)
        .collect();
    let (values, scenes): (Vec<f64>, Vec<Vec<Linearised>>) = found.into_iter().unzip();
    let search = Search {
        key,
        scene,
        timestep,
        values: &values,
        scenes: &scenes,
        pressed,
    };
    let row = |solver: &Solver| {
        let (found, value, reason) = match search.largest(solver) {
            Ok((found, value)) => (found, value, None),
            Err(why) => (LargestFound::NotKnown, None, Some(why)),
        };
        let engine = solver.id.to_string();
        LargestRow {
            engine,
            found,
            value,
            reason,
        }
    };
    Largest {
        vary: key.to_string(),
        unit: key.quantity().unit.to_owned(),
        timestep_s: timestep,
        tried: [values.first(), values.last()].map(|end| end.copied().unwrap_or_default()),
        rows: solvers.par_iter().map(row).collect(),
    }
}

/// Values evenly spaced in their logarithm, ascending, within what a scene may have; around 1 where the scene has
/// none.
fn tried(key: &VariedKey, scene: &Scene) -> Vec<f64> {
    let own = Some(key.largest(scene)).filter(|own| *own > 0.0);
    let own = own.unwrap_or(1.0);
    let places = -DECADES * PER_DECADE..=DECADES * PER_DECADE;
    let value = |place| own * 10_f64.powf(f64::from(place) / f64::from(PER_DECADE));
    let Bounds { low, high, .. } = key.quantity();
    let allowed = |value: &f64| (low..=high).contains(value);
    places.map(value).filter(allowed).collect()
}

fn linearised(scene: &Scene, pressed: Option<&State>) -> Vec<Linearised> {
    let system = ParticleSystem::new(scene);
    let start = ParticleSystem::initial_state(scene);
    let states = [&start].into_iter().chain(pressed);
    states
        .map(|state| Linearised::new(&system, state, Effort::FULL))
        .collect()
}

struct Search<'a> {
    key: &'a VariedKey,
    scene: &'a Scene,
    timestep: f64,
    /// The values tried first, ascending, and the scene with each.
    values: &'a [f64],
    scenes: &'a [Vec<Linearised>],
    pressed: Option<&'a State>,
}

impl Search<'_> {
    /// What is found and the value, or why nobody knows.
    fn largest(&self, solver: &Solver) -> Result<(LargestFound, Option<f64>), String> {
        if self.pressed.is_none() && self.key.to_string().starts_with(PENALTY) {
            return Err("nothing presses on a penalty along the trajectory".to_owned());
        }
        let mut above = None;
        // From above, so that the largest is found where small values are unstable too.
        for (value, about) in self.values.iter().zip(self.scenes).rev() {
            match (self.is_stable(solver, about)?, above) {
                (true, None) => return Ok((LargestFound::EveryValue, None)),
                (true, Some(above)) => {
                    let value = self.between(solver, *value, above)?;
                    return Ok((LargestFound::Value, Some(value)));
                }
                (false, _) => above = Some(*value),
            }
        }
        Ok((LargestFound::NoValue, None))
    }

    /// Whether the step is within the limit, or why nobody knows.
    fn is_stable(&self, solver: &Solver, about: &[Linearised]) -> Result<bool, String> {
        for about in about {
            match predicted(about, solver, self.timestep).map(|predicted| predicted.limit) {
                None => return Err("it follows no method with a predicted limit".to_owned()),
                Some(Limit::Unknown(why)) => return Err(why),
                Some(limit) if limit.allows(self.timestep * (1.0 - ROUNDING)) => (),
                Some(_) => return Ok(false),
            }
        }
        Ok(true)
    }

    /// The value between one that is stable and one that is not, checked just inside and outside.
    fn between(&self, solver: &Solver, mut low: f64, mut high: f64) -> Result<f64, String> {
        let stable = |value: f64| {
            let varied = self.key.apply(self.scene, value);
            let varied = varied.map_err(|error| error.to_string())?;
            self.is_stable(solver, &linearised(&varied, self.pressed))
        };
        while high - low > WIDTH * low {
            let middle = (low * high).sqrt();
            if stable(middle)? {
                low = middle;
            } else {
                high = middle;
            }
        }
        if stable(low * (1.0 - BESIDE))? && !stable(low * (1.0 + BESIDE))? {
            Ok(low)
        } else {
            Err("stable and unstable values alternate close to it".to_owned())
        }
    }
}
