//! Stability: the z = h w up to which the oscillator's amplitude stays bounded, for motion along a spring
//! and for motion across it, whose stiffness a method's Jacobian may leave out.

use super::subject::{Broken, Build, advance};
use super::systems::{Across, Oscillator};
use super::{Finding, Law};
use crate::integrators::Stable;
use crate::physics::{State, System};

pub(super) const ALONG: Law = Law {
    id: "stability",
    summary: "the undamped oscillator is stable exactly as far as claimed",
    derivation: "bisection of the one-step matrix's spectral radius to 1e-9; limits are published \
                 to six decimals",
    judge: |subject| {
        let Some(oscillator) = subject.claims.oscillator else {
            return Ok(Finding::skip("the oscillator"));
        };
        let stable = oscillator.stable;
        let upto = match stable {
            Stable::Below(limit) => f64::max(FAR, 1.25 * limit),
            _ => FAR,
        };
        let found = measured_limit(subject.build, 0.0, upto)?;
        let seen = found.map_or_else(
            || format!("stable up to {upto}"),
            |z| format!("stable below z = {z:.6}"),
        );
        let (holds, bound, claim) = match stable {
            Stable::Below(limit) => (
                found.is_some_and(|z| (z - limit).abs() < PUBLISHED),
                Some(limit),
                format!("stable below {limit:.6}"),
            ),
            // Growth at any rate is visible at a tenth of a radian a step.
            Stable::Never => (
                found.is_some_and(|z| z < SMALL),
                Some(SMALL),
                "never stable".to_owned(),
            ),
            Stable::Always | Stable::AlwaysAlong { .. } => {
                (found.is_none(), None, "always stable".to_owned())
            }
        };
        let message = format!("claims to be {claim}, is {seen}");
        Ok(Finding::of(holds, found, bound, message))
    },
};

pub(super) const ACROSS: Law = Law {
    id: "stability-across",
    summary: "motion across a spring is as stable as claimed: as motion along it, unless its \
              stiffness is left out",
    derivation: "the one-step matrix 1e-6 inside and outside the limit: six decimals are published",
    judge: |subject| {
        let Some(oscillator) = subject.claims.oscillator else {
            return Ok(Finding::skip("the oscillator"));
        };
        let at = |z: f64| unstable(subject.build, &Across { w: W }, z);
        let (limit, holds) = match oscillator.stable {
            Stable::AlwaysAlong { across: limit } | Stable::Below(limit) => {
                let holds = !at(limit - PUBLISHED)? && at(limit + PUBLISHED)?;
                (Some(limit), holds)
            }
            Stable::Always => {
                let mut holds = true;
                for z in [0.1, 1.0, 2.1, 10.0] {
                    holds &= !at(z)?;
                }
                (None, holds)
            }
            Stable::Never => (None, at(0.1)?),
        };
        let (verb, stable) = (if holds { "is" } else { "is not" }, oscillator.stable);
        let message = format!("{verb} stable across a spring as claimed: {stable:?}");
        Ok(Finding::of(holds, None, limit, message))
    },
};

/// The z up to which a method without a limit is tested.
const FAR: f64 = 10.0;
const SMALL: f64 = 0.1;
/// The tolerance of limits, which are published to six decimals.
const PUBLISHED: f64 = 1e-6;

/// rad/s.
pub(super) const W: f64 = 7.0;

/// The number of cells of the scan, for any range.
const CELLS: u32 = 4_000;

/// The largest z = h w up to which no oscillator of damping ratio `zeta` is unstable, to 1e-9: a
/// scan of 4,000 cells up to `upto`, then bisection. None where none of them is unstable.
///
/// # Errors
/// [`Broken`] when a step cannot be taken.
pub fn measured_limit(build: Build, zeta: f64, upto: f64) -> Result<Option<f64>, Broken> {
    let system = Oscillator { w: W, zeta };
    let cell = upto / f64::from(CELLS);
    let mut cells = 1..=CELLS;
    let mut high = loop {
        let Some(i) = cells.next() else {
            return Ok(None);
        };
        if unstable(build, &system, cell * f64::from(i))? {
            break cell * f64::from(i);
        }
    };
    let mut low = high - cell;
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if middle <= low || middle >= high {
            // The ends are neighbouring doubles: a limit beyond a million has no ninth decimal.
            break;
        }
        if unstable(build, &system, middle)? {
            high = middle;
        } else {
            low = middle;
        }
    }
    Ok(Some(low))
}

/// Whether a step of z / W is unstable: its spectral radius exceeds 1 by more than rounding. Beyond the
/// limit the excess grows like the square root of the distance to it, or linearly.
fn unstable(build: Build, system: &dyn System, z: f64) -> Result<bool, Broken> {
    Ok(spectral_radius(one_step_matrix(build, system, z)?) > 1.0 + 1e-12)
}

/// The one-step map of a linear one-coordinate system as a 2 x 2 matrix over (x, v/W), row-major.
fn one_step_matrix(build: Build, system: &dyn System, z: f64) -> Result<[f64; 4], Broken> {
    let column = |x: f64, v: f64| -> Result<[f64; 2], Broken> {
        let mut state = State::new(vec![x], vec![W * v]);
        advance(build().as_mut(), system, z / W, 1, &mut state)?;
        let first = |values: &[f64]| values.first().copied().unwrap_or(0.0);
        Ok([first(&state.x), first(&state.v) / W])
    };
    let ([a, c], [b, d]) = (column(1.0, 0.0)?, column(0.0, 1.0)?);
    Ok([a, b, c, d])
}

/// Largest modulus of the eigenvalues of a 2 x 2 matrix.
fn spectral_radius([a, b, c, d]: [f64; 4]) -> f64 {
    let (half, det) = ((a + d) / 2.0, a * d - b * c);
    let disc = half * half - det;
    if disc < 0.0 {
        det.sqrt()
    } else {
        half.abs() + disc.sqrt()
    }
}
