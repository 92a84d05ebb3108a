//! Is a timestep beyond what its method is stable at, here?

use super::plan::{Case, Plan};
use crate::measure::stability::{Effort, Limit, Linearised, Prediction};
use crate::physics::ParticleSystem;

/// The scene linearised about its start, if anybody here has a limit.
pub struct StepLimits(Option<Linearised>);

/// Amplitudes that grow by less than this part over a whole run are seen in no plot.
const VISIBLE: f64 = 0.01;

impl StepLimits {
    pub fn new(plan: &Plan) -> Self {
        let wanted = plan
            .cases
            .iter()
            .any(|case| case.solver.as_method().is_some());
        Self(wanted.then(|| {
            let start = ParticleSystem::initial_state(plan.scene);
            Linearised::new(&plan.system, &start, Effort::BRIEF)
        }))
    }

    /// What there is to say of a case's timestep; None where it is stable or nobody knows.
    pub fn warning(&self, case: &Case) -> Option<String> {
        let (linearised, method) = (self.0.as_ref()?, case.solver.as_method()?);
        let h = case.label.timestep;
        let prediction = linearised.predict(method, h);
        match prediction.limit {
            // Exactly at the limit nothing grows; a timestep stated in a few digits may be meant to be.
            Limit::At(limit) if h > limit * (1.0 + 1e-9) => Some(beyond(h, limit, &prediction)),
            Limit::Never => never(h, case.label.end(), &prediction),
            // One growing mode of a scene too large to know all of.
            Limit::Unknown(_) => {
                let growth = prediction.growth_per_s.filter(|rate| *rate > 0.0)?;
                Some(format!(
                    "h = {} s is not stable here: motion grows by {} 1/s",
                    short(h),
                    short(growth)
                ))
            }
            Limit::At(_) | Limit::Between(..) | Limit::Unconditional => None,
        }
    }
}

fn beyond(h: f64, limit: f64, prediction: &Prediction) -> String {
    let mode = bracketed(prediction);
    let advice = round_below(limit).map_or_else(String::new, |step| format!(": take {step} s"));
    format!(
        "h = {} s is beyond its stability limit {} s here{mode}{advice}",
        short(h),
        short(limit)
    )
}

fn never(h: f64, duration: f64, prediction: &Prediction) -> Option<String> {
    let growth = prediction.growth_per_s?;
    (growth * duration > VISIBLE).then(|| {
        format!(
            "no step is stable here{}: at h = {} s motion grows by {} 1/s, and a smaller step only \
             slows that",
            bracketed(prediction),
            short(h),
            short(growth)
        )
    })
}

fn bracketed(prediction: &Prediction) -> String {
    let reason = prediction.reason.as_ref();
    reason.map_or_else(String::new, |reason| format!(" ({reason})"))
}

/// Four digits, as short as they go.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e5).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// The largest round number, in steps of a half or more of its leading digit, that is not above 95 %
/// of a limit: past it by a little is past it.
fn round_below(limit: f64) -> Option<String> {
    let safe = 0.95 * limit;
    let power = safe.log10().floor();
    let digits = ["9", "8", "7", "6", "5", "4", "3", "2.5", "2", "1.5", "1"];
    digits.iter().find_map(|digits| {
        let step: f64 = format!("{digits}e{power}").parse().ok()?;
        (step > 0.0 && step <= safe).then(|| short(step))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_to_take_are_round_and_stable() {
        for (limit, step) in [
            (0.0283, "0.025"),
            (0.02, "0.015"),
            (0.022, "0.02"),
            (7.0, "6"),
            (1.0, "0.9"),
            (3e-7, "2.5e-7"),
        ] {
            assert_eq!(round_below(limit).as_deref(), Some(step), "{limit}");
        }
        assert_eq!(short(0.05), "0.05");
        assert_eq!(short(0.028_284_27), "0.02828");
        assert_eq!(short(1.234_6e6), "1.235e6");
    }
}
