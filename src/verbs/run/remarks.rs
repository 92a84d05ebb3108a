//! The remarks of an outcome: plain sentences for the rows that need them.

use super::identity::own_law;
use super::plan::{Case, Plan};
use crate::integrators::events::LARGE;
use crate::integrators::{Coefficients, EnergyLaw, Method, PerStep, Settings, Stable};
use crate::measure::stability::{Effort, Limit, Linearised, Prediction};
use crate::measure::{Behaviour, Energy, EnergyClass};
use crate::physics::constraints::contact::Obstacles;
use crate::physics::effects::BendingForce;
use crate::physics::{ForceKinds, ParticleSystem, System};
use crate::report::words;
use crate::scene::Scene;
use crate::solvers::Status;
use crate::verbs::run::Outcome;

/// The remarks of one outcome. `linearised` is the result of [`linearised`] for the scene.
pub fn remarks(
    plan: &Plan,
    case: &Case,
    outcome: &Outcome,
    linearised: Option<&Linearised>,
) -> Vec<String> {
    let energy = outcome.energy.as_ref();
    // What is steady needs no explanation.
    let steady = energy.and_then(Energy::behaviour) == Some(Behaviour::Steady);
    let class = energy.and_then(|energy| energy.class).filter(|_| !steady);
    let calm = outcome.status == Status::Completed && energy.is_some_and(is_calm);
    let method = case.solver.as_method();
    let prediction = linearised.zip(method);
    let prediction = prediction.map(|(scene, method)| scene.predict(method, case.label.timestep));
    let warning = prediction
        .as_ref()
        .and_then(|p| step_warning(p, case, calm));
    let mut remarks = Vec::new();
    match outcome.status {
        Status::Unsupported | Status::Failed => {
            remarks.extend(outcome.reason.clone());
        }
        Status::Diverged => {
            let cause = outcome.reason.as_deref().unwrap_or_default();
            let time = outcome.stopped_at_s.unwrap_or(0.0);
            // The limit on this scene says more than the method's general facts.
            let limit = prediction.as_ref().map(|p| (&p.limit, p.error));
            let why = match (&warning, method, limit) {
                (None, Some(_), Some((Limit::At(limit), error))) => format!(
                    "; the step is within the stability limit {} s of the scene at its start, \
                     which the motion leaves",
                    known(*limit, error)
                ),
                (None, Some(method), _) => why_unstable(plan, method),
                _ => String::new(),
            };
            let time = short(time);
            remarks.push(format!("diverged at t = {time} s, {cause}{why}"));
        }
        Status::Completed => {
            let lost = outcome.energy.as_ref().is_some_and(Energy::lost);
            remarks.extend(class.and_then(|class| explain(plan, case, class, lost)));
        }
    }
    remarks.extend(warning);
    let own = own_law(plan, case).filter(|_| outcome.status == Status::Completed);
    remarks.extend(own.map(str::to_owned));
    remarks.extend(strain(plan, case, outcome));
    remarks.extend(coarse_drive(plan.scene, case.label.timestep));
    remarks.extend(latent(plan.scene));
    remarks.extend(loosely_solved(plan, case));
    remarks
}

/// The remarks that a strain limit is not met, and that a program does not say what its own took.
fn strain(plan: &Plan, case: &Case, outcome: &Outcome) -> Vec<String> {
    let Some((strain, limit)) = outcome
        .strain
        .as_ref()
        .zip(plan.scene.strain_limit.as_ref())
    else {
        return Vec::new();
    };
    let mut remarks = Vec::new();
    if let Some(most) = strain.largest.filter(|_| !strain.met) {
        let why = match most {
            // Of no length at all.
            -1.0 => {
                "its ends are in one place, so there is no direction to part them in, and more `iterations` do not help"
            }
            ..0.0 => {
                "take more `iterations`, unless other particles hold its ends that close together"
            }
            _ => "take more `iterations`, unless other particles hold its ends that far apart",
        };
        remarks.push(format!(
            "the strain limit of {} is not met: spring {} is at {} at t = {} s, after {}; {why}",
            words::percent(strain.ratio),
            strain.spring,
            words::percent(most),
            short(strain.t_s),
            words::plural(limit.iterations as u64, "sweep")
        ));
    }
    if case.solver.as_program().is_some() && outcome.energy.is_some() {
        remarks.push(
            "it does not say what its strain limit takes out, which its balance of energy therefore lacks".to_owned(),
        );
    }
    remarks
}

/// Steps in a period of a drive below which they miss its motion.
const STEPS_A_PERIOD: f64 = 6.0;

/// The remark that steps are too coarse for the fastest drive by a sine.
fn coarse_drive(scene: &Scene, h: f64) -> Option<String> {
    let sines = scene
        .driven
        .iter()
        .filter_map(|driven| driven.sine.as_ref());
    let fastest = sines.map(|sine| sine.omega.abs()).reduce(f64::max)?;
    let period = std::f64::consts::TAU / fastest;
    (period < STEPS_A_PERIOD * h).then(|| {
        let advice = round_below(period / (4.0 * STEPS_A_PERIOD));
        format!(
            "the fastest drive has a period of {} s, of which h = {} s sees little: take {} s or less",
            words::quantity(period),
            short(h),
            advice.unwrap_or_default()
        )
    })
}

/// The remark that a hinge is in balance only because it cannot tell which way to turn.
fn latent(scene: &Scene) -> Option<String> {
    let hinge = BendingForce::latent(scene)?;
    Some(format!(
        "hinge {hinge} is in line and not at its rest angle: it cannot tell which way to turn, and acts only once \
         something turns it"
    ))
}

/// The remark that the scene's solver tolerance is looser than the default, for methods that iterate.
fn loosely_solved(plan: &Plan, case: &Case) -> Option<String> {
    let stated = plan.scene.solver.tolerance?;
    let method = case.solver.as_method()?;
    let iterates = matches!(method.evaluations, PerStep::PerIteration { .. });
    (iterates && stated > Settings::default().tolerance).then(|| {
        format!(
            "its steps are solved to a relative residual of {stated:e} only (`solver.tolerance`): a \
             loose tolerance breaks invariants and step-by-step replay"
        )
    })
}

/// The cause of a divergence, from the method's facts.
fn why_unstable(plan: &Plan, method: &Method) -> String {
    let kinds = plan.system.kinds();
    if kinds.damps() && method.oscillator.stable != Stable::Always {
        let springs = has_springs(plan);
        return if springs {
            "; stiff springs and strong damping each limit the step: take a smaller one"
        } else {
            "; strong damping limits the step: take a smaller one"
        }
        .to_owned();
    }
    // Its facts are those on springs.
    let other = kinds.has(ForceKinds::GYROSCOPIC | ForceKinds::CONSTRAINED);
    if other && !has_springs(plan) {
        return String::new();
    }
    match method.oscillator.stable {
        Stable::Never => {
            "; it is stable on no undamped spring, whatever the step: a smaller one only delays it"
                .to_owned()
        }
        Stable::Below(limit) => {
            format!("; stable while h ω < {limit:.4} for the stiffest mode: take a smaller step")
        }
        Stable::AlwaysAlong { across } => format!(
            "; it leaves out the stiffness of turning springs: motion across them is stable while \
             h ω < {across}"
        ),
        Stable::Always => "; it is always stable on linear springs, but this scene is not linear \
                           at this step"
            .to_owned(),
    }
}

/// Explains the energy class of a completed run, where it is not bounded; `lost` if the energy is below its
/// initial value.
fn explain(plan: &Plan, case: &Case, class: EnergyClass, lost: bool) -> Option<String> {
    if class == EnergyClass::Bounded {
        return None;
    }
    let effects = plan.system.effects();
    let kinds = plan.system.kinds();
    match case.solver.as_method() {
        Some(method) if kinds.has(ForceKinds::CONSTRAINED) => {
            // Symplectic, where nothing takes or gives energy.
            let keeps = matches!(method.coefficients, Coefficients::Rattle(_))
                && !kinds.depends_on_velocity()
                && !kinds.has(ForceKinds::DRIVEN)
                && plan.system.strain_limiter().is_none();
            Some(on_rods(method, class, keeps))
        }
        Some(method) if effects.iter().all(|(row, _)| row.constant) => {
            under_constant_force(method, class)
        }
        Some(method) => {
            let damped = kinds.depends_on_velocity();
            // The work of what drives a scene is no part of an oscillator's law.
            let driven = kinds.has(ForceKinds::DRIVEN);
            let limited = plan.system.strain_limiter().is_some();
            let free = has_springs(plan) && !driven && !limited;
            let law = by_law(method, class, damped).filter(|_| free);
            law.or_else(|| {
                (damped || driven || limited)
                    .then(|| by_balance(closes_to(method, plan), class, lost, limited))
            })
        }
        None if has_springs(plan) => case.solver.by_design(class == EnergyClass::Growing),
        None => None,
    }
}

fn has_springs(plan: &Plan) -> bool {
    plan.system.effects().iter().any(|(row, _)| row.elastic)
}

fn energy_change(class: EnergyClass) -> &'static str {
    match class {
        EnergyClass::Growing => "energy grows",
        EnergyClass::Dissipating => "energy falls",
        EnergyClass::Drifting | EnergyClass::Bounded => "energy drifts",
    }
}

/// Without an oscillator no law of one applies: under a constant acceleration the error is that of the position
/// update.
fn under_constant_force(method: &Method, class: EnergyClass) -> Option<String> {
    (method.order == 1).then(|| {
        format!(
            "{}: under a constant acceleration a its position is off by a h t/2, which grows for \
             as long as the fall lasts",
            energy_change(class)
        )
    })
}

/// Rods are neither an oscillator nor a constant acceleration: what is left is the order, and whether energy is kept for
/// good.
fn on_rods(method: &Method, class: EnergyClass, keeps: bool) -> String {
    let change = energy_change(class);
    if keeps {
        return format!(
            "{change}: on rods it is bounded for good well below its stability limit; {TREND_LIKE}"
        );
    }
    format!(
        "{change}: on rods its error is of order {}, and a smaller step lessens it",
        method.order
    )
}

/// What is no trend of a symplectic method and looks like one.
const TREND_LIKE: &str = "a step at that limit, a force that jumps, or less than a period of its swing all look like a trend";

/// The explanation by the method's energy law on an oscillator, where that is the cause.
fn by_law(method: &Method, class: EnergyClass, damped: bool) -> Option<String> {
    let change = energy_change(class);
    match (method.oscillator.energy, method.oscillator.stable) {
        (EnergyLaw::Factor { factor, formula }, _) => {
            // A small step: there the leading term decides the formula's sign.
            let law = factor(0.1) - 1.0;
            let agrees = match class {
                EnergyClass::Growing => law > 0.0,
                EnergyClass::Dissipating => law < 0.0,
                EnergyClass::Drifting | EnergyClass::Bounded => law != 0.0,
            };
            let undamped = if damped { "undamped " } else { "" };
            agrees.then(|| {
                format!(
                    "{change} as its law says: by {formula} a step, z = hω, on an \
                     {undamped}oscillator"
                )
            })
        }
        (_, Stable::Below(limit)) if !damped => Some(format!(
            "{change}: on an oscillator it is bounded for good while h ω < {limit:.4}; {TREND_LIKE}"
        )),
        _ => None,
    }
}

/// The explanation by a balance that does not close. It may grow while the energy falls: the work counted for
/// dampers exceeds what they took.
fn by_balance(order: u32, class: EnergyClass, lost: bool, limited: bool) -> String {
    let does = match class {
        EnergyClass::Growing if lost => "grows, though E itself falls",
        EnergyClass::Growing => "grows",
        EnergyClass::Dissipating => "falls",
        EnergyClass::Drifting | EnergyClass::Bounded => "drifts",
    };
    let more = if limited { " + limited" } else { "" };
    format!(
        "the balance E + dissipated - injected{more} {does}: it closes to order {order} only, take a smaller \
         step"
    )
}

/// The order to which a balance closes: many impacts in one step are of second order.
fn closes_to(method: &Method, plan: &Plan) -> u32 {
    let many = |obstacles: &Obstacles| obstacles.particles().count() > LARGE;
    let order = method.order_damped;
    if plan.system.obstacles().is_some_and(many) {
        order.min(2)
    } else {
        order
    }
}

/// What linearising takes a particle, in its steps under explicit forces, and what each prediction takes where
/// damping couples modes: one and a few Krylov spaces.
const LINEARISED: u64 = 1_700;
const COUPLED: u64 = 3_000;
/// Its matrices and vectors take some 25 kB a particle: with more than so many, more than a gigabyte.
const MOST_LINEARISED: u64 = 40_000;

/// What predicting the limits of a plan's methods takes, in steps of one particle; None where there is none to
/// predict, or no memory for it.
pub fn effort(plan: &Plan) -> Option<u64> {
    let methods = plan
        .cases
        .iter()
        .filter(|case| case.solver.as_method().is_some());
    let methods = methods.count() as u64;
    let coupled = if plan.system.kinds().depends_on_velocity() {
        COUPLED.saturating_mul(methods)
    } else {
        0
    };
    let particles = plan.scene.particles.len() as u64;
    let any = methods > 0 && particles <= MOST_LINEARISED;
    any.then(|| (LINEARISED + coupled).saturating_mul(particles))
}

/// The scene linearised about its start, if the plan has a method: only methods have a predicted limit. None, and
/// true, where that takes more than the budget.
pub fn linearised(plan: &Plan, budget: u64) -> (Option<Linearised>, bool) {
    if effort(plan).is_none_or(|effort| effort > budget) {
        let method = |case: &Case| case.solver.as_method().is_some();
        return (None, plan.cases.iter().any(method));
    }
    let start = ParticleSystem::initial_state(plan.scene);
    (
        Some(Linearised::new(&plan.system, &start, Effort::BRIEF)),
        false,
    )
}

/// A relative growth of amplitudes over a whole run below this is invisible in a plot.
const VISIBLE: f64 = 0.01;

/// The largest error of the energy, in units of S, of a run that is called stable.
const CALM: f64 = 1.0;

/// Whether a run shows itself stable: its energy neither rises nor is far off.
fn is_calm(energy: &Energy) -> bool {
    let keeps = matches!(
        energy.behaviour(),
        Some(
            Behaviour::Steady | Behaviour::Bounded | Behaviour::FewSamples | Behaviour::Dissipating
        )
    );
    keeps && energy.relative_error_max.is_some_and(|error| error <= CALM)
}

/// The warning that a timestep exceeds the stability limit of its method on this scene; None where it is stable
/// or the limit is unknown. Of a `calm` run, which stays stable, it only says where the linearised scene's limit
/// is.
fn step_warning(prediction: &Prediction, case: &Case, calm: bool) -> Option<String> {
    let h = case.label.timestep;
    match prediction.limit {
        // Exactly at the limit nothing grows, and a timestep rounded to a few digits may be meant to lie there.
        Limit::At(limit) if h > limit * (1.0 + 1e-9) && calm => Some(format!(
            "this run stays stable, though its step is beyond the limit of the scene linearised about its start, \
             {} s{}",
            known(limit, prediction.error),
            reason_in_brackets(prediction)
        )),
        Limit::At(limit) if h > limit * (1.0 + 1e-9) => Some(beyond_limit(h, limit, prediction)),
        Limit::Never | Limit::Unknown(_) if calm => None,
        Limit::Never => never_stable(h, case.label.end(), prediction),
        // The scene is too large to know all its modes, but one that grows is enough.
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

fn beyond_limit(h: f64, limit: f64, prediction: &Prediction) -> String {
    let mode = reason_in_brackets(prediction);
    // What is surely stable.
    let sure = limit * (1.0 - prediction.error);
    let advice = round_below(sure).map_or_else(String::new, |step| format!(": take {step} s"));
    format!(
        "h = {} s is beyond its stability limit {} s here{mode}{advice}",
        short(h),
        known(limit, prediction.error)
    )
}

fn never_stable(h: f64, duration: f64, prediction: &Prediction) -> Option<String> {
    let growth = prediction.growth_per_s?;
    (growth * duration > VISIBLE).then(|| {
        format!(
            "no step is stable here{}: at h = {} s motion grows by {} 1/s, and a smaller step only \
             slows that",
            reason_in_brackets(prediction),
            short(h),
            short(growth)
        )
    })
}

fn reason_in_brackets(prediction: &Prediction) -> String {
    let reason = prediction.reason.as_ref();
    reason.map_or_else(String::new, |reason| format!(" ({reason})"))
}

/// A number with four digits, without trailing zeros.
fn short(value: f64) -> String {
    known(value, 0.0)
}

/// A number with as many digits as its relative error leaves, two to four, without trailing zeros.
fn known(value: f64, error: f64) -> String {
    let digits = (-error.max(1e-4).log10()).floor().clamp(2.0, 4.0) as usize;
    let rounded: f64 = format!("{value:.*e}", digits - 1).parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-4..1e5).contains(&rounded.abs()) {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// The largest number with a round leading digit (halves below 3) that is at most 95 % of a limit: a little
/// beyond the limit is already unstable.
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
        for (error, digits) in [(0.0, "0.02828"), (5e-4, "0.0283"), (0.2, "0.028")] {
            assert_eq!(known(0.028_284_27, error), digits, "{error}");
        }
    }
}
