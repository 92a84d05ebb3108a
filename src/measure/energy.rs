//! The energy balance of a run, and the verdict on it.

use super::trend::{EnergyClass, FEWEST, trend};
use crate::physics::constraints::kinetic_on_rods;
use crate::physics::effects::Effect;
use crate::physics::{ParticleSystem, System, Work};
use crate::trajectory::Trajectory;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The energy balance B = E + dissipated - injected + limited. On rods E has the kinetic energy of the motion that they allow,
/// without that of velocities along them.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct Energy {
    /// Kinetic and all potential energies at the start, J.
    pub initial_j: Option<f64>,
    /// The same at the last finite instant, J.
    pub final_j: Option<f64>,
    /// max |B - B(0)| / S.
    pub relative_error_max: Option<f64>,
    /// Fitted trend of B, in units of S per second.
    pub drift_per_s: Option<f64>,
    /// 99.9 % interval of the trend, autocorrelation accounted for.
    pub drift_per_s_ci: Option<[f64; 2]>,
    /// Half the peak-to-peak of the residual about the trend, in units of S.
    pub fluctuation: Option<f64>,
    /// What the balance does.
    pub class: Option<EnergyClass>,
    /// The number of instants the class was taken from.
    #[serde(default)]
    pub samples: Option<usize>,
    /// Kinetic energy at the end, on rods without that of velocities along them.
    pub kinetic_final_j: Option<f64>,
    /// Potential energy at the end, by the id of the effect that holds it.
    pub potential_final_j: BTreeMap<String, f64>,
    /// Energy that effects took out over the run, J; 0 where nothing takes any.
    pub dissipated_j: Option<f64>,
    /// Energy that effects put in over the run, J.
    pub injected_j: Option<f64>,
    /// Energy that moving states onto rods put in over the run, J, which the balance counts as an error; null without
    /// rods.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub projected_j: Option<f64>,
    /// Energy that the strain limit took out over the run, J, negative where it put some in; the balance leaves it out.
    /// Null without a limit, and where nobody says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limited_j: Option<f64>,
    /// Energy lost in impacts on obstacles over the run, J; null without obstacles, and where nobody says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub impacts_j: Option<f64>,
    /// Energy lost in sliding along obstacles over the run, J; null without obstacles, and where nobody says it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friction_j: Option<f64>,
}

/// What a run's energy does, for a reader: its class, unless its error is too small or too large for
/// the trend to be what counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Behaviour {
    /// Never off by as much as a practical part of S, whatever its trend.
    Steady,
    Bounded,
    /// Off by more than S, and no trend says which way.
    Unsteady,
    /// Too few instants to show a trend.
    FewSamples,
    Drifting,
    Dissipating,
    Growing,
}

impl Behaviour {
    pub const ALL: [Self; 7] = [
        Self::Steady,
        Self::Bounded,
        Self::Unsteady,
        Self::FewSamples,
        Self::Drifting,
        Self::Dissipating,
        Self::Growing,
    ];

    /// What the word means, in a sentence.
    pub fn says(self) -> &'static str {
        match self {
            Self::Steady => {
                "E + dissipated - injected is never off by a millionth of the scene's energy S"
            }
            Self::Bounded => "its error comes and goes, with no trend that outweighs that",
            Self::Unsteady => {
                "it is off by more than the scene's energy S, and no trend says which way"
            }
            Self::FewSamples => "too few instants were seen to tell a trend",
            Self::Drifting => {
                "its error has a trend that outweighs its coming and going, up in part and down in part"
            }
            Self::Dissipating => {
                "E + dissipated - injected falls: the method takes out energy that no damper took"
            }
            Self::Growing => {
                "E + dissipated - injected rises: the method puts in energy that no force put in"
            }
        }
    }

    pub fn word(self) -> &'static str {
        match self {
            Self::Steady => "steady",
            Self::Bounded => "bounded",
            Self::Unsteady => "unsteady",
            Self::FewSamples => "few samples",
            Self::Drifting => "drifting",
            Self::Dissipating => "dissipating",
            Self::Growing => "growing",
        }
    }
}

/// Energy errors below this part of S are of no practical size.
pub const PRACTICAL: f64 = 1e-6;

impl Energy {
    /// What the energy does; None where there is no class. Without S nothing is small or large.
    pub fn behaviour(&self) -> Option<Behaviour> {
        let error = self.relative_error_max;
        let few = self.samples.is_some_and(|samples| samples < FEWEST);
        Some(match self.class? {
            _ if error.is_some_and(|error| error < PRACTICAL) => Behaviour::Steady,
            EnergyClass::Growing => Behaviour::Growing,
            EnergyClass::Dissipating => Behaviour::Dissipating,
            _ if error.is_some_and(|error| error > 1.0) => Behaviour::Unsteady,
            EnergyClass::Drifting => Behaviour::Drifting,
            EnergyClass::Bounded if few => Behaviour::FewSamples,
            EnergyClass::Bounded => Behaviour::Bounded,
        })
    }

    /// Whether less energy is left at the end than there was, both known. Not to be confused with the
    /// class, which judges the balance: where dampers are booked more than they took, that grows.
    pub fn lost(&self) -> bool {
        matches!((self.initial_j, self.final_j), (Some(initial), Some(last)) if last < initial)
    }
}

/// The energies of one state, J.
pub(crate) struct Sum {
    /// Kinetic and potential.
    pub energy: f64,
    /// E + dissipated - injected + limited + impacts + friction.
    pub balance: f64,
    /// The largest term of these sums, which rounding is relative to.
    pub largest: f64,
}

impl Sum {
    pub(crate) fn new(system: &ParticleSystem, t: f64, x: &[f64], v: &[f64], work: Work) -> Self {
        let mut energy = kinetic_on_rods(system, x, v);
        let mut largest = energy.max(work.dissipated.abs()).max(work.injected.abs());
        for taken in [work.limited, work.impacts, work.friction] {
            largest = largest.max(taken.abs());
        }
        for (_, effect) in system.effects() {
            let u = effect.potential(t, x);
            energy += u;
            largest = largest.max(u.abs());
        }
        let balance = work.balance(energy);
        Self {
            energy,
            balance,
            largest,
        }
    }
}

/// Energies at the recorded instants of one run, joules; all finite.
#[derive(Debug, Clone)]
pub struct EnergySeries {
    /// Seconds.
    pub t: Vec<f64>,
    /// The instant of the trajectory that each sample is from.
    pub instants: Vec<usize>,
    /// B = E + dissipated - injected + limited; constant in the truth.
    pub balance: Vec<f64>,
    /// Energies at the start and the end; nothing is judged yet.
    ends: Energy,
    /// What rounding alone may do to the balance: half a last bit of the largest term each way a
    /// step. Mostly it is a random walk, but a constant such as 1/6 rounds the same way every time.
    floor: f64,
}

impl EnergySeries {
    /// The energies of a run. None when nothing was recorded or no velocities are known: a kinetic
    /// energy from differences of positions has errors that are no fault of the run. Instants whose
    /// energy is not finite are left out.
    pub fn new(system: &ParticleSystem, run: &Trajectory) -> Option<Self> {
        if !run.has_velocities() {
            return None;
        }
        let sample = |k: usize| {
            let sum = Sum::new(system, run.time(k), run.x(k), run.v(k), run.work(k));
            let Sum {
                energy,
                balance,
                largest,
            } = sum;
            let finite = balance.is_finite() && energy.is_finite() && largest.is_finite();
            finite.then_some((k, energy, balance, largest))
        };
        let samples: Vec<_> = (0..run.len()).filter_map(sample).collect();
        let (&(_, initial, ..), &(end, last, ..)) = samples.first().zip(samples.last())?;
        let largest = samples.iter().fold(0.0, |most, (.., term)| term.max(most));
        let potential = |effect: &dyn Effect| effect.potential(run.time(end), run.x(end));
        let effects = system.effects().iter();
        let Work {
            dissipated,
            injected,
            projected,
            limited,
            impacts,
            friction,
        } = run.work(end);
        let obstacles = system.obstacles();
        Some(Self {
            t: samples.iter().map(|(k, ..)| run.time(*k)).collect(),
            instants: samples.iter().map(|(k, ..)| *k).collect(),
            balance: samples.iter().map(|(_, _, balance, _)| *balance).collect(),
            ends: Energy {
                initial_j: Some(initial),
                final_j: Some(last),
                relative_error_max: None,
                drift_per_s: None,
                drift_per_s_ci: None,
                fluctuation: None,
                class: None,
                samples: None,
                kinetic_final_j: Some(kinetic_on_rods(system, run.x(end), run.v(end))),
                potential_final_j: effects
                    .map(|(row, effect)| (row.id.to_owned(), potential(effect.as_ref())))
                    .collect(),
                dissipated_j: Some(dissipated),
                injected_j: Some(injected),
                projected_j: system.rods().map(|_| projected),
                limited_j: system.strain_limiter().map(|_| limited),
                impacts_j: obstacles.map(|_| impacts),
                friction_j: obstacles.map(|_| friction),
            },
            floor: f64::EPSILON * largest * run.step(end).max(8) as f64,
        })
    }

    /// Balance minus its initial value at every instant, in units of `scale` (1 for joules).
    pub fn error(&self, scale: f64) -> Vec<f64> {
        let start = self.balance[0];
        self.balance.iter().map(|b| (b - start) / scale).collect()
    }
}

/// The verdict on a run's balance; `scale` is S, without which errors have no relative size.
/// A run that `diverged` is growing by definition, however few instants it left.
pub fn judge(series: &EnergySeries, scale: Option<f64>, diverged: bool) -> Energy {
    let trend = trend(&series.t, &series.balance, series.floor);
    // One instant has no history: 0 would look like a perfect run.
    let scale = scale.filter(|_| series.t.len() > 1);
    let in_scale = |joules: f64| scale.map(|s| joules / s).filter(|r| r.is_finite());
    let worst = series
        .error(1.0)
        .into_iter()
        .fold(0.0, |m: f64, e| m.max(e.abs()));
    // Too few instants show no trend, but they show an explosion: a balance that ends at its highest,
    // more than S above its start.
    let rise = series.balance[series.balance.len() - 1] - series.balance[0];
    let few = series.t.len() < FEWEST;
    let exploded = few && rise == worst && scale.is_some_and(|scale| rise > scale);
    let interval = [in_scale(trend.interval[0]), in_scale(trend.interval[1])];
    Energy {
        relative_error_max: in_scale(worst),
        drift_per_s: in_scale(trend.slope),
        drift_per_s_ci: interval[0].zip(interval[1]).map(|(lo, hi)| [lo, hi]),
        fluctuation: in_scale(trend.fluctuation),
        class: Some(if diverged || exploded {
            EnergyClass::Growing
        } else {
            trend.class
        }),
        samples: Some(series.t.len()),
        ..series.ends.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A balance that is `balance(n)` joules at instant n.
    fn judged(instants: usize, balance: impl Fn(f64) -> f64) -> Energy {
        let n = || (0..instants).map(|n| n as f64);
        let series = EnergySeries {
            t: n().collect(),
            instants: (0..instants).collect(),
            balance: n().map(balance).collect(),
            ends: Energy {
                initial_j: None,
                final_j: None,
                relative_error_max: None,
                drift_per_s: None,
                drift_per_s_ci: None,
                fluctuation: None,
                class: None,
                samples: None,
                kinetic_final_j: None,
                potential_final_j: BTreeMap::new(),
                dissipated_j: None,
                injected_j: None,
                projected_j: None,
                limited_j: None,
                impacts_j: None,
                friction_j: None,
            },
            floor: 1e-13,
        };
        judge(&series, Some(1.0), false)
    }

    /// Explicit Euler multiplies an oscillator's energy by 1 + z² in every step.
    fn explicit_euler(z: f64) -> impl Fn(f64) -> f64 {
        move |n| (1.0 + z * z).powf(n)
    }

    #[test]
    fn few_instants_of_an_explosion_are_enough() {
        let class = |instants, z| judged(instants, explicit_euler(z)).class;
        assert_eq!(class(6, 105.0), Some(EnergyClass::Growing));
        // 1.01^5 is no explosion, and six instants are no trend; two thousand are.
        assert_eq!(class(6, 0.1), Some(EnergyClass::Bounded));
        assert_eq!(class(2000, 0.1), Some(EnergyClass::Growing));
        // A fall, or a rise that comes back, is none either.
        let fall = judged(6, |n| 1.0 - 2.0 * n);
        let back = judged(6, |n| 1.0 + 9.0 * (n * (5.0 - n)));
        for energy in [fall, back] {
            assert_eq!(energy.class, Some(EnergyClass::Bounded));
        }
    }

    #[test]
    fn words_agree_with_numbers() {
        let behaviour = |instants, z| judged(instants, explicit_euler(z)).behaviour();
        assert_eq!(behaviour(6, 105.0), Some(Behaviour::Growing));
        assert_eq!(behaviour(6, 0.1), Some(Behaviour::FewSamples));
        assert_eq!(behaviour(2000, 0.1), Some(Behaviour::Growing));
        // A trend that is real, 2000 z² = 2e-7 in all, and of no size.
        let small = judged(2000, explicit_euler(1e-5));
        assert_eq!(small.class, Some(EnergyClass::Growing));
        assert_eq!(small.behaviour(), Some(Behaviour::Steady));
        // A swing of three times S.
        let swing = judged(2000, |n| 1.0 + 3.0 * (0.7 * n).sin());
        assert_eq!(swing.class, Some(EnergyClass::Bounded));
        assert_eq!(swing.behaviour(), Some(Behaviour::Unsteady));
        let swing = judged(2000, |n| 1.0 + 0.3 * (0.7 * n).sin());
        assert_eq!(swing.behaviour(), Some(Behaviour::Bounded));
    }
}
