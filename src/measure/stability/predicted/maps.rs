//! Limits of splittings: by the one-step map of each mode, of a whole part where modes are coupled, or by
//! a definite matrix.

use super::definite::Definite;
use super::part::{Matrix, Part};
use super::prediction::Prediction;
use super::regions::stiffest_binds;
use super::spectrum::{Coverage, Mode, Spectrum};
use super::stepmap::StepMap;
use super::{Effort, Limit};
use crate::integrators::{Amplification, DampingTreatment, Method, Stage, bisect, map};

/// The prediction for a part at `h`, s; None where nothing of it could grow.
pub(super) fn predict(
    amplification: Amplification,
    spectrum: &Spectrum,
    h: f64,
    effort: &Effort,
) -> Option<Prediction> {
    match amplification {
        Amplification::Composition(stages, damping) if spectrum.proportional => {
            let found = by_modes(stages, damping, &spectrum.modes, h)?;
            match spectrum.coverage {
                Coverage::Sampled(error) => stiffest_binds(found.within(error), &spectrum.modes),
                _ => Some(found),
            }
        }
        _ if spectrum.proportional && spectrum.modes.is_empty() => None,
        _ => Some(coupled(amplification, spectrum, h, effort)),
    }
}

/// ln |eigenvalue| / h, 1/s.
fn growth(modulus: f64, h: f64) -> f64 {
    modulus.clamp(f64::MIN_POSITIVE, f64::MAX).ln() / h
}

/// The prediction for modes that are damped by themselves.
fn by_modes(
    stages: &'static [Stage],
    damping: DampingTreatment,
    modes: &[Mode],
    h: f64,
) -> Option<Prediction> {
    let definite = Definite::of(Amplification::Composition(stages, damping));
    let mut sorted = modes.to_vec();
    // The fastest first: it usually binds, and bounds how far the others are searched.
    sorted.sort_by(|a, b| b.rate().total_cmp(&a.rate()));
    let mut upto = f64::INFINITY;
    let each = sorted.into_iter().map(|mode| {
        let at = |h: f64| Pair::at(stages, damping, mode, h);
        let found = match definite {
            Some(definite) => definite.limit_of(mode),
            None => first_failure(mode.rate(), upto, &|h| at(h).is_stable()),
        };
        upto = upto.min(found.unwrap_or(f64::INFINITY));
        let limit = found.map_or(Limit::Unconditional, Limit::At);
        let smooth = (!mode.oscillates()).then(|| {
            let failure = first_failure(mode.rate(), upto, &|h| at(h).is_smooth());
            failure.unwrap_or(upto)
        });
        // A mode that oscillates from the first cell on has no smooth step worth reporting.
        let smooth = smooth.filter(|smooth| *smooth > NEAR / mode.rate() * 0.5);
        Prediction::of(mode, limit, growth(at(h).modulus(), h), smooth, h)
    });
    each.reduce(Prediction::and)
}

/// Length of a scan's cells, in units of 1 over the mode's rate; beyond 1, relative to how far it has come.
const FINE: f64 = 0.01;
/// Nothing of what a method promises begins below; far above, limits are those of drag's flow.
const NEAR: f64 = 0.02;
const FAR: f64 = 1e12;

/// The first h, at most `upto`, at which `holds` no longer does, by a scan and bisection.
fn first_failure(rate: f64, upto: f64, holds: &dyn Fn(f64) -> bool) -> Option<f64> {
    let mut before = 0.0;
    let mut u = NEAR;
    while u < FAR {
        let h = (u / rate).min(upto);
        if !holds(h) {
            return Some(bisect(before, h, 1e-14, holds));
        }
        if h >= upto {
            return None;
        }
        before = h;
        u += FINE * u.max(1.0);
    }
    None
}

/// A modulus above 1 by no more than this is rounding of a composition of nine factors.
const ROUNDING: f64 = 1e-12;

/// The two eigenvalues of a composition's map of one mode. Without stiffness the position keeps its value:
/// this eigenvalue 1 is left out, and 0 stands for it.
struct Pair {
    half_trace: f64,
    determinant: f64,
}

impl Pair {
    fn at(stages: &[Stage], damping: DampingTreatment, mode: Mode, h: f64) -> Self {
        let [a, b, c, d] = map(stages, damping, [mode.stiffness, mode.damping], h);
        let (trace, determinant) = match damping {
            _ if mode.stiffness != 0.0 => (a + d, a * d - b * c),
            DampingTreatment::Explicit => (d, 0.0),
            DampingTreatment::Boris => (d, 0.0),
            // Flows of damping alone merge into one: their product overflows where kicks go backward.
            _ => ((-h * mode.damping).exp(), 0.0),
        };
        Self {
            half_trace: 0.5 * trace,
            determinant,
        }
    }

    /// Jury's conditions: both within the unit circle.
    fn is_stable(&self) -> bool {
        let room = 1.0 + self.determinant - 2.0 * self.half_trace.abs();
        self.determinant <= 1.0 + ROUNDING && room >= -ROUNDING
    }

    /// A quarter of the squared distance between them.
    fn apart(&self) -> f64 {
        self.half_trace * self.half_trace - self.determinant
    }

    /// Both real and not negative, or so close to a double real one that only rounding parts them.
    fn is_smooth(&self) -> bool {
        let half = self.half_trace;
        self.determinant >= 0.0 && half >= 0.0 && self.apart() >= -ROUNDING * half * half
    }

    fn modulus(&self) -> f64 {
        if self.apart() < 0.0 {
            self.determinant.abs().sqrt()
        } else {
            self.half_trace.abs() + self.apart().sqrt()
        }
    }
}

/// The prediction where modes are coupled, by damping or by stiffness a method leaves out.
fn coupled(
    amplification: Amplification,
    spectrum: &Spectrum,
    h: f64,
    effort: &Effort,
) -> Prediction {
    let part = &spectrum.part;
    let n = part.n();
    if let Some(limit) = turning(amplification, part) {
        return Prediction::only(limit);
    }
    // Of matrices that are not symmetric this takes the symmetric parts: a guess.
    let definite = Definite::of(amplification).and_then(|kind| kind.limit(part, effort));
    let map = (n <= effort.map).then(|| StepMap::new(spectrum)).flatten();
    let found = match (definite, &map) {
        (Some(found), None) if part.symmetric => found,
        (Some(found), Some(map)) if part.symmetric && map.confirms(amplification, &found.limit) => {
            found
        }
        (found, Some(map)) => {
            let fastest = spectrum.eigenvalues.iter().map(|(value, _)| value.norm());
            let fastest = fastest.fold(0.0, f64::max);
            let limit = if fastest > 0.0 {
                map.limit(amplification, 2.0 / fastest)
            } else {
                Limit::Unconditional
            };
            let found = found.unwrap_or(Prediction::only(Limit::Unconditional));
            Prediction { limit, ..found }
        }
        (_, None) => {
            return Prediction::unknown(format!(
                "damping couples {n} coordinates: too many for this method's one-step map"
            ));
        }
    };
    found.growing(map.and_then(|map| map.growth(amplification, h)), h)
}

/// The limit of a composition on a part with a magnetic field, where one look is enough.
///
/// The map of textbook kicks has the determinant of their 1 - b h C, which is above 1 for a skew C: they gain energy
/// at every step. Flows and Boris' turns only turn velocities, and do no more without other forces.
fn turning(amplification: Amplification, part: &Part) -> Option<Limit> {
    let Amplification::Composition(_, damping) = amplification else {
        return None;
    };
    let turns = part.damping.skewness() > 0.0 && part.damping.symmetric_part().norm() == 0.0;
    match damping {
        _ if !turns => None,
        DampingTreatment::Explicit => Some(Limit::Never),
        _ => (part.stiffness.norm() == 0.0).then_some(Limit::Unconditional),
    }
}

/// Whether a composition sweeps over dampers in a way of which [`swept`] does not know the limit: in more than one
/// kick, or in `any` number.
pub(super) fn is_swept(method: &Method, any: bool) -> bool {
    let sweeps = matches!(
        method.amplification,
        Amplification::Composition(_, DampingTreatment::Sweeps | DampingTreatment::Boris)
    );
    sweeps && (any || Definite::of(method.amplification).is_none())
}

/// The prediction where a composition sweeps over dampers that share particles.
///
/// Verlet's step is S* V S, with V the undamped step over the forces and S a sweep, which shrinks v in the metric of
/// the masses. Below V's limit it conserves v² + xᵀ (K - h² K²/4) x, a definite form in which only v is shrunk. An
/// eigenvalue -1 needs S* S v = -v, so v = 0 and h² K x = 4 x: dampers never move the limit.
pub(super) fn swept(amplification: Amplification, of: &Spectrum, effort: &Effort) -> Prediction {
    let part = &of.part;
    let undamped = Part {
        damping: Matrix::new(part.n(), []),
        ..part.clone()
    };
    let kind = Definite::of(amplification).filter(|_| part.symmetric);
    kind.and_then(|kind| kind.limit(&undamped, effort))
        .unwrap_or_else(|| {
            Prediction::unknown(
                "dampers that share particles act one after the other, and this method's map of them is not \
                 worked out",
            )
        })
}
