//! Forces against their own energies: minus the gradient of the potential, and the power that is booked.

use super::{Ran, Row};
use crate::measure::Check;
use crate::physics::effects::Effect;
use crate::physics::{ForceKinds, ParticleSystem};

pub(super) const LAW: Row = Row {
    id: "forces",
    requires: "every effect's force does the work that its potential loses and its power states; one that only turns \
               velocities is what it says it is",
    derivation: "a central difference of the potential along the motion, extrapolated, against the force; the \
                 difference of two step widths and the rounding of the potential bound its error",
    remedy: "the named effect's force, potential and power do not belong together: check its sign and its factors",
    judge: Some(|ran| {
        let effects = ran.system().effects().iter();
        let judge =
            |(row, effect): &(&'static crate::physics::effects::EffectRow, Box<dyn Effect>)| {
                let instants = states(ran)
                    .into_iter()
                    .map(|(t, x, v)| instant(effect.as_ref(), t, &x, &v));
                let check = LAW.over_time(row.id, "work and energy differ by (W)", instants)?;
                let cause = (check.status == crate::measure::CheckStatus::Fail)
                    .then(|| format!("{} pushes otherwise than its energy says", row.id));
                Some(Check { cause, ..check })
            };
        effects.filter_map(judge).collect()
    }),
};

/// The start, and a few instants of the first run: times, positions, velocities that are not at rest.
fn states(ran: &Ran) -> Vec<(f64, Vec<f64>, Vec<f64>)> {
    let start = ParticleSystem::initial_state(ran.scene());
    let mut states = vec![(0.0, start.x, start.v)];
    if let Some((_, run, _)) = ran.whole().next() {
        let last = run.len() - 1;
        let at = [last / 7, last / 3, last * 2 / 3, last];
        states.extend(at.map(|k| (run.time(k), run.x(k).to_vec(), run.v(k).to_vec())));
    }
    let size = ran.scene().size().max(1.0);
    let speed = size / ran.scene().duration;
    for (_, _, v) in &mut states {
        // Something has to move for a power to show.
        for (i, v) in v.iter_mut().enumerate() {
            let sign = if (i * 7 + i / 3) % 2 == 0 { 1.0 } else { -1.0 };
            *v += 0.1 * speed * sign;
        }
    }
    states
}

/// The power of the force along the motion, against what potential and booked powers say, W.
fn instant(effect: &dyn Effect, t: f64, x: &[f64], v: &[f64]) -> super::Instant {
    let mut f = vec![0.0; x.len()];
    let booked = effect.add_force(t, x, v, &mut f);
    let power: f64 = f.iter().zip(v).map(|(f, v)| f * v).sum();
    let moved = |dt: f64| {
        let x: Vec<f64> = x.iter().zip(v).map(|(x, v)| x + dt * v).collect();
        effect.potential(t + dt, &x)
    };
    let largest = x.iter().fold(1e-3, |most: f64, x| most.max(x.abs()));
    let fastest = v.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
    let dt = 1e-5 * largest / fastest.max(f64::MIN_POSITIVE);
    let slope = |dt: f64| (moved(dt) - moved(-dt)) / (2.0 * dt);
    let (coarse, fine) = (slope(dt), slope(0.5 * dt));
    let rate = fine + (fine - coarse) / 3.0;
    let said = booked.injected - booked.dissipated - rate;
    let terms: f64 = f.iter().zip(v).map(|(f, v)| (f * v).abs()).sum();
    let mut off = vec![0.0; x.len()];
    effect.add_rounding(t, x, v, &mut off);
    let off: f64 = off.iter().zip(v).map(|(off, v)| (off * v).abs()).sum();
    // Coordinates are moved by a rounding, which the force turns into energy.
    let push = f.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    let rounding = f64::EPSILON * (moved(0.0).abs() + push * largest * x.len() as f64) / dt;
    let bound = 4.0 * (fine - coarse).abs() + 16.0 * (rounding + off) + 1e-9 * terms;
    super::Instant {
        t,
        found: (power - said).abs().max(turning(effect, t, x, v, &f)),
        bound,
    }
}

/// Of a force that turns velocities and so has no power: how far what `f` has of the velocity is from what the effect
/// says of it elsewhere, W. 0 of any other.
fn turning(effect: &dyn Effect, t: f64, x: &[f64], v: &[f64], f: &[f64]) -> f64 {
    if !effect.kinds().has(ForceKinds::GYROSCOPIC) {
        return 0.0;
    }
    let mut rest = vec![0.0; x.len()];
    effect.add_force(t, x, &vec![0.0; x.len()], &mut rest);
    effect.add_damping(x, v, &mut rest);
    let pairs = f.iter().zip(&rest).zip(v);
    pairs.map(|((f, rest), v)| ((f - rest) * v).abs()).sum()
}
