//! Energy: the undamped oscillator's energy follows the claimed law.

use super::stability::W;
use super::subject::{Broken, Subject, advance};
use super::systems::Oscillator;
use super::{Finding, Law, SOLVED_TO};
use crate::integrators::{EnergyLaw, Integrator, PerStep, Stable};
use crate::physics::State;

pub(super) const LAW: Law = Law {
    id: "energy",
    summary: "the oscillator's energy grows, falls or stays within bounds as claimed",
    derivation: "a factor or a band is met to the rounding of a step, or to what its solver leaves; \
                 a band is also filled to its edges within 1 %",
    judge: |subject| {
        let Some(oscillator) = subject.claims.oscillator else {
            return Ok(Finding::skip("the oscillator"));
        };
        let mut findings = Vec::new();
        for z in STEPS {
            // Beyond the stability limit the energy is not bounded; a factor holds at any step.
            let inside = match oscillator.stable {
                Stable::Below(limit) => z < limit,
                _ => true,
            };
            findings.push(match oscillator.energy {
                EnergyLaw::Factor { factor, .. } => by_factor(subject, z, factor(z))?,
                EnergyLaw::Band { band, .. } if inside => within(subject, z, band(z))?,
                EnergyLaw::Bounded if inside => bounded(subject, z)?,
                _ => continue,
            });
        }
        let worst = Finding::worst(findings, |off| off);
        Ok(worst.unwrap_or_else(|| Finding::skip("steps of these sizes")))
    },
};

/// z = h w. These lie below all explicit limits but the smallest, and give no simple fraction of a turn
/// except at z = 1, where symplectic Euler turns by exactly a sixth.
const STEPS: [f64; 5] = [0.01, 0.1, 0.5, 1.0, 1.5];

/// Steps over which a bound has to hold.
const LONG: usize = 20_000;

const SYSTEM: Oscillator = Oscillator { w: W, zeta: 0.0 };

/// The start, at rest.
fn start() -> State {
    State::new(vec![0.5], vec![0.0])
}

/// Compares each step's factor with the claimed one. The one-step maps are normal matrices, so the factor
/// does not depend on the phase.
fn by_factor(subject: &Subject, z: f64, factor: f64) -> Result<Finding, Broken> {
    let (mut integrator, mut state) = (subject.fresh(), start());
    let (mut off, mut seen) = (0.0_f64, factor);
    for _ in 0..50 {
        let before = SYSTEM.energy(&state);
        advance(integrator.as_mut(), &SYSTEM, z / W, 1, &mut state)?;
        let found = SYSTEM.energy(&state) / before;
        let defect = (found - factor).abs() / factor.max(1.0);
        if defect.is_nan() {
            // The energy is 0, so it has no factor.
            let message = format!("at z = {z} all energy is gone");
            return Ok(Finding::of(false, None, SOLVED_TO, message));
        }
        if defect > off {
            (off, seen) = (defect, found);
        }
    }
    let what =
        format!("at z = {z} one step multiplies the energy by {seen:.6}, claimed {factor:.6}");
    Ok(Finding::at_most(off, SOLVED_TO, &what))
}

/// The least and largest energy over the next many steps, in units of the initial energy.
fn range(integrator: &mut dyn Integrator, z: f64, state: &mut State) -> Result<(f64, f64), Broken> {
    let initial = SYSTEM.energy(&start());
    let now = SYSTEM.energy(state) / initial;
    let (mut least, mut most) = (now, now);
    for _ in 0..LONG {
        advance(integrator, &SYSTEM, z / W, 1, state)?;
        let found = SYSTEM.energy(state) / initial;
        (least, most) = (least.min(found), most.max(found));
    }
    Ok((least, most))
}

fn within(subject: &Subject, z: f64, (low, high): (f64, f64)) -> Result<Finding, Broken> {
    if low.is_nan() || high.is_nan() {
        let message = format!("at z = {z} the claimed band is no number");
        return Ok(Finding::of(false, None, SOLVED_TO, message));
    }
    let (least, most) = range(subject.fresh().as_mut(), z, &mut start())?;
    // Rounding moves the state along its orbit, hardly off it, so this bound holds over all steps.
    let beyond = (low - least).max(most - high).max(0.0);
    let what =
        format!("at z = {z} energies in [{least:.9}, {most:.9}], claimed [{low:.9}, {high:.9}]");
    if beyond > SOLVED_TO {
        return Ok(Finding::at_most(beyond, SOLVED_TO, &what));
    }
    // The orbit fills the band up to each edge, so a band 1 % too wide is wrong. But at z = 1 symplectic
    // Euler has only three energies, and leaves a quarter of its band empty, a third of what it fills.
    let (unseen, bound) = if z == 1.0 {
        ((high - low) / (most - least), 1.4)
    } else {
        // An edge at the initial energy is reached at the start.
        let edge = |edge: f64, met: f64| {
            if edge == 0.0 { 1.0 } else { edge / met }
        };
        (
            edge(1.0 - low, 1.0 - least).max(edge(high - 1.0, most - 1.0)),
            1.01,
        )
    };
    if unseen > bound {
        let message = format!("{what}: the band is {unseen:.3} times as wide as the motion");
        return Ok(Finding::of(false, unseen, bound, message));
    }
    Ok(Finding::of(true, beyond, SOLVED_TO, what))
}

/// Checks that the second half of a long run spans the same energies as the first.
fn bounded(subject: &Subject, z: f64) -> Result<Finding, Broken> {
    let (mut integrator, mut state) = (subject.fresh(), start());
    let (low, high) = range(integrator.as_mut(), z, &mut state)?;
    let (later_low, later_high) = range(integrator.as_mut(), z, &mut state)?;
    // 20,000 phases come within 1e-4 of the extreme ones, so energies come within (1e-4)² / 2 of the span.
    // Rounding is a random last bit in each of 40,000 steps; a solver may err the same way every time. Drift
    // would shift the second half by a whole span.
    let solver = match subject.claims.evaluations {
        Some(PerStep::Exactly(_)) => 0.0,
        _ => LONG as f64 * SOLVED_TO,
    };
    let bound = 5e-8 * (high - low) + 200.0 * f64::EPSILON + solver;
    let off = (later_low - low).abs().max((later_high - high).abs());
    let what = format!(
        "at z = {z} energies in [{low:.9}, {high:.9}], later in [{later_low:.9}, {later_high:.9}]"
    );
    Ok(Finding::at_most(off, bound, &what))
}
