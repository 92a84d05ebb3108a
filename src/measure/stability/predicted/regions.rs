//! Limits of Runge-Kutta methods: by the eigenvalues of a part and the region where |R| <= 1.

use super::Limit;
use super::prediction::Prediction;
use super::spectrum::{Bound, Coverage, Mode, Spectrum, shown};
use crate::integrators::{Rational, Stable};
use nalgebra::Complex;

/// The prediction for a part at `h`, s; None where nothing of it could grow.
pub(super) fn predict(rational: &Rational, spectrum: &Spectrum, h: f64) -> Option<Prediction> {
    let of = |eigenvalues: &[(Complex<f64>, Mode)]| of_eigenvalues(rational, eigenvalues, h);
    let outermost = &spectrum.eigenvalues;
    match spectrum.coverage {
        Coverage::All => of(outermost),
        Coverage::Sampled(error) => stiffest_binds(of(outermost)?.within(error), &spectrum.modes),
        Coverage::Outermost(Some(bound)) if outermost.is_empty() => {
            Some(of_bound(rational, bound, of(&bound.stiffest.eigenvalues())))
        }
        Coverage::Outermost(_) => Some(of_outermost(rational, outermost, of(outermost))),
    }
}

fn of_eigenvalues(
    rational: &Rational,
    eigenvalues: &[(Complex<f64>, Mode)],
    h: f64,
) -> Option<Prediction> {
    let sign_change = rational.sign_change();
    let each = eigenvalues.iter().map(|&(value, mode)| {
        let rate = value.norm();
        let (limit, bound) = match rational.reach(value) {
            Stable::Never => (Limit::Never, f64::INFINITY),
            Stable::Below(u) => (Limit::At(u / rate), u / rate),
            Stable::Always | Stable::AlwaysAlong { .. } => (Limit::Unconditional, f64::INFINITY),
        };
        let smooth = (value.im == 0.0).then(|| bound.min(sign_change / rate));
        let growth = rational.log_modulus(value, h) / h;
        Prediction::of(mode, limit, growth, smooth, h)
    });
    each.reduce(Prediction::and)
}

/// Between two samples there may be any mode. So a limit holds only where the stiffest mode, which is known,
/// sets it, or where there is none.
pub(super) fn stiffest_binds(found: Prediction, modes: &[Mode]) -> Option<Prediction> {
    let binds = found.binding == modes.last().copied();
    if binds || !matches!(found.limit, Limit::At(_)) {
        return Some(found);
    }
    Some(Prediction::unknown(
        "too many coordinates for the full spectrum, and it is not the stiffest mode that binds",
    ))
}

/// The prediction from outermost eigenvalues. The others are no larger than the least of them, so nothing
/// was missed where the half disc of that radius is stable.
fn of_outermost(
    rational: &Rational,
    outermost: &[(Complex<f64>, Mode)],
    known: Option<Prediction>,
) -> Prediction {
    let radius = rational.half_disc();
    if radius == f64::INFINITY {
        // Others may decay more slowly.
        return Prediction {
            binding: known.and_then(|known| known.binding),
            ..Prediction::only(Limit::Unconditional)
        };
    }
    let Some(known) = known else {
        return Prediction::unknown(
            "damping couples too many modes to know them, and any may be the tightest",
        );
    };
    let inner = outermost.last().map_or(0.0, |(value, _)| value.norm());
    let growth_per_s = known.growth_per_s.filter(|growth| *growth > 0.0);
    let (reason, error) = match known.limit {
        Limit::Never => return known,
        Limit::At(limit) if limit * inner <= radius => (known.reason.clone(), 0.0),
        Limit::At(limit) if radius > 0.0 => {
            let why = format!(
                "by the outermost modes of too many to know; others could lower it to {} s at most",
                shown(radius / inner)
            );
            (Some(why), 1.0 - radius / inner / limit)
        }
        _ => {
            let why =
                "too many coordinates for the full spectrum, and any mode may be the tightest";
            return Prediction {
                growth_per_s,
                ..Prediction::unknown(why)
            };
        }
    };
    Prediction {
        growth_per_s,
        smooth_below_s: None,
        reason,
        ..known.within(error)
    }
}

/// The prediction from the stiffest vector and a radius that no eigenvalue exceeds.
fn of_bound(rational: &Rational, bound: Bound, known: Option<Prediction>) -> Prediction {
    let stable = rational.half_disc();
    let sure = stable / bound.radius;
    match known {
        Some(Prediction {
            limit: Limit::At(limit),
            binding,
            ..
        }) if stable > 0.0 && stable.is_finite() => Prediction {
            binding,
            reason: (sure < limit).then(|| {
                format!(
                    "estimated by the stiffest motion, since damping couples too many modes to know \
                     them; certainly stable up to {} s",
                    shown(sure)
                )
            }),
            ..Prediction::only(Limit::At(limit)).within(1.0 - sure / limit)
        },
        _ => of_outermost(rational, &[], None),
    }
}
