//! What a method does to one part of a linearised scene, and to several together.

use super::coupled;
use super::definite::Definite;
use super::mode::{Mode, shown};
use super::spectrum::{Bound, Solved, Spectrum};
use super::{Effort, Limit};
use crate::integrators::{Amplification, DampingTreatment, Rational, Stable, Stage, bisect, map};
use nalgebra::Complex;

#[derive(Debug, Clone)]
pub(super) struct Verdict {
    pub limit: Limit,
    /// The largest of ln(modulus) / h at the timestep asked for, 1/s; None where nobody knows.
    pub growth: Option<f64>,
    /// Infinite where no mode ever changes its sign; None where one oscillates in truth, or nobody
    /// knows.
    pub smooth: Option<f64>,
    /// The mode that sets the limit.
    pub binding: Option<Mode>,
    /// How sure the limit is, where it is not.
    pub note: Option<String>,
}

impl Verdict {
    /// Of nothing that moves but freely.
    pub(super) fn at_rest() -> Self {
        Self {
            growth: Some(0.0),
            ..Self::only(Limit::Unconditional)
        }
    }

    pub(super) fn unknown(why: &str) -> Self {
        Self::only(Limit::Unknown(why.to_owned()))
    }

    pub(super) fn only(limit: Limit) -> Self {
        Self {
            limit,
            growth: None,
            smooth: None,
            binding: None,
            note: None,
        }
    }

    /// A mode's: a step that is stable does not grow, whatever rounding says.
    fn of(limit: Limit, growth: f64, smooth: Option<f64>, h: f64, mode: Mode) -> Self {
        Self {
            growth: Some(if limit.allows(h) {
                growth.min(0.0)
            } else {
                growth
            }),
            smooth,
            binding: Some(mode),
            ..Self::only(limit)
        }
    }

    /// Of both together: never beats unknown, unknown beats what is known.
    pub(super) fn and(self, other: Self) -> Self {
        let growth = match (self.growth, other.growth) {
            (Some(a), Some(b)) => Some(a.max(b)),
            // One that grows is enough to say so.
            (one, another) => one.or(another).filter(|growth| *growth > 0.0),
        };
        let smooth = self.smooth.zip(other.smooth).map(|(a, b)| a.min(b));
        let rank = |limit: &Limit| match limit {
            Limit::Never => 0,
            Limit::Unknown(_) => 1,
            Limit::At(_) | Limit::Between(..) => 2,
            Limit::Unconditional => 3,
        };
        let ours_binds = match (&self.limit, &other.limit) {
            (Limit::At(a), Limit::At(b)) => a <= b,
            // Of modes that are never stable, the fastest stands for all.
            (Limit::Never, Limit::Never) => {
                let rate = |v: &Self| v.binding.map_or(0.0, Mode::rate);
                rate(&self) >= rate(&other)
            }
            (a, b) => rank(a) <= rank(b),
        };
        let binding = if ours_binds { self } else { other };
        Self {
            growth,
            smooth,
            ..binding
        }
    }

    /// What binds, in words; `undamped` of `modes` that do not rest neither decay.
    pub(super) fn reason(&self, undamped: usize, modes: usize) -> Option<String> {
        let mode = self.binding.map(Mode::words);
        match &self.limit {
            Limit::Unknown(why) => Some(why.clone()),
            Limit::At(_) | Limit::Between(..) => {
                let words: Vec<String> = mode.into_iter().chain(self.note.clone()).collect();
                (!words.is_empty()).then(|| words.join("; "))
            }
            Limit::Unconditional => (self.smooth == Some(f64::INFINITY))
                .then(|| "smooth at every step: nothing oscillates".to_owned()),
            Limit::Never if undamped > 0 && undamped < modes => mode.map(|mode| {
                format!(
                    "{mode}; {undamped} of {modes} modes are undamped, and on those it is stable at \
                     no step"
                )
            }),
            Limit::Never => mode,
        }
    }
}

/// What a method does to a part at `h`, s; None where nothing of it could grow.
pub(super) fn part(
    amplification: Amplification,
    solved: &Solved,
    h: f64,
    effort: &Effort,
) -> Option<Verdict> {
    let alone = match amplification {
        Amplification::Rational(rational) => return by_region(&rational, &solved.spectrum, h),
        Amplification::Composition(stages, damping) => match &solved.spectrum {
            Spectrum::Modes(modes) => return by_maps(stages, damping, modes, h),
            Spectrum::Sampled(modes) => {
                return stiffest_binds(by_maps(stages, damping, modes, h)?, modes);
            }
            Spectrum::Roots(_) | Spectrum::Outermost { .. } => false,
        },
        Amplification::MaterialImplicit => {
            matches!(&solved.spectrum, Spectrum::Modes(modes) if modes.is_empty())
        }
    };
    (!alone).then(|| coupled::verdict(amplification, solved, h, effort))
}

/// By eigenvalues.
fn by_region(rational: &Rational, spectrum: &Spectrum, h: f64) -> Option<Verdict> {
    let by_roots =
        |roots: &[Complex<f64>]| by_roots(rational, roots.iter().map(|&r| (r, Mode::of(r))), h);
    match spectrum {
        Spectrum::Modes(modes) => by_modes(rational, modes, h),
        Spectrum::Roots(roots) => by_roots(roots),
        Spectrum::Sampled(modes) => stiffest_binds(by_modes(rational, modes, h)?, modes),
        Spectrum::Outermost { roots, bound } => Some(match bound {
            Some(bound) if roots.is_empty() => {
                of_bound(rational, bound, by_modes(rational, &[bound.stiffest], h))
            }
            _ => of_outermost(rational, roots, by_roots(roots)),
        }),
    }
}

fn by_modes(rational: &Rational, modes: &[Mode], h: f64) -> Option<Verdict> {
    let roots = modes
        .iter()
        .flat_map(|mode| mode.roots().into_iter().map(|root| (root, *mode)));
    by_roots(rational, roots, h)
}

fn by_roots(
    rational: &Rational,
    roots: impl Iterator<Item = (Complex<f64>, Mode)>,
    h: f64,
) -> Option<Verdict> {
    let sign_change = rational.sign_change();
    roots
        .map(|(root, mode)| {
            let (limit, bound) = match rational.reach(root) {
                Stable::Never => (Limit::Never, f64::INFINITY),
                Stable::Below(u) => (Limit::At(u / root.norm()), u / root.norm()),
                Stable::Always | Stable::AlwaysAlong { .. } => {
                    (Limit::Unconditional, f64::INFINITY)
                }
            };
            let smooth = (root.im == 0.0).then(|| bound.min(sign_change / root.norm()));
            Verdict::of(limit, rational.log_modulus(root, h) / h, smooth, h, mode)
        })
        .reduce(Verdict::and)
}

/// Between two samples there may be any mode: what they say holds where the stiffest, which is
/// known, is the one that binds, or where nothing does.
fn stiffest_binds(verdict: Verdict, modes: &[Mode]) -> Option<Verdict> {
    let binds = verdict.binding == modes.last().copied();
    if binds || !matches!(verdict.limit, Limit::At(_)) {
        return Some(verdict);
    }
    Some(Verdict::unknown(
        "too many coordinates for the full spectrum, and it is not the stiffest mode that binds",
    ))
}

/// Of outermost eigenvalues: the others lie within the least of them, and where the half disc of that
/// radius is stable too, nothing was missed.
fn of_outermost(rational: &Rational, roots: &[Complex<f64>], known: Option<Verdict>) -> Verdict {
    let radius = rational.half_disc();
    if radius == f64::INFINITY {
        // Others may decay more slowly.
        return Verdict {
            binding: known.and_then(|verdict| verdict.binding),
            ..Verdict::only(Limit::Unconditional)
        };
    }
    let Some(known) = known else {
        return Verdict::unknown(
            "damping couples too many modes to know them, and any may be the tightest",
        );
    };
    let inner = roots.last().map_or(0.0, |root| root.norm());
    let growth = known.growth.filter(|growth| *growth > 0.0);
    let note = match known.limit {
        Limit::Never => return known,
        Limit::At(limit) if limit * inner <= radius => known.note,
        Limit::At(_) if radius > 0.0 => Some(format!(
            "by the outermost modes of too many to know; others could lower it to {} s at most",
            shown(radius / inner)
        )),
        _ => {
            let why =
                "too many coordinates for the full spectrum, and any mode may be the tightest";
            return Verdict {
                growth,
                ..Verdict::unknown(why)
            };
        }
    };
    Verdict {
        growth,
        smooth: None,
        note,
        ..known
    }
}

/// Of the stiffest vector, and a radius no eigenvalue is beyond.
fn of_bound(rational: &Rational, bound: &Bound, known: Option<Verdict>) -> Verdict {
    let stable = rational.half_disc();
    let (Some(known), true) = (known, stable > 0.0 && stable.is_finite()) else {
        return of_outermost(rational, &[], None);
    };
    let Limit::At(limit) = known.limit else {
        return of_outermost(rational, &[], None);
    };
    let sure = stable / bound.radius;
    Verdict {
        growth: None,
        smooth: None,
        note: (sure < limit).then(|| {
            format!(
                "estimated by the stiffest motion, since damping couples too many modes to know them; \
                 certainly stable up to {} s",
                shown(sure)
            )
        }),
        ..known
    }
}

/// A modulus above 1 by no more than this is rounding of a composition of nine factors.
const ROUNDING: f64 = 1e-12;

/// The two eigenvalues of a composition's map of one mode; without stiffness, 0 instead of the 1 of the
/// place.
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
            // Flows of damping alone make one: their product overflows where kicks go backward.
            DampingTreatment::ExactFlow => ((-h * mode.damping).exp(), 0.0),
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

/// Of a composition on modes damped by themselves.
fn by_maps(
    stages: &'static [Stage],
    damping: DampingTreatment,
    modes: &[Mode],
    h: f64,
) -> Option<Verdict> {
    let definite = Definite::of(Amplification::Composition(stages, damping));
    let mut sorted = modes.to_vec();
    // The fastest first: it usually binds, and bounds how far the others are searched.
    sorted.sort_by(|a, b| b.rate().total_cmp(&a.rate()));
    let mut upto = f64::INFINITY;
    let verdicts = sorted.into_iter().map(|mode| {
        let at = |h: f64| Pair::at(stages, damping, mode, h);
        let found = match definite {
            Some(definite) => definite.limit_of(mode),
            None => first_failure(mode.rate(), upto, &|h| at(h).is_stable()),
        };
        upto = upto.min(found.unwrap_or(f64::INFINITY));
        let limit = found.map_or(Limit::Unconditional, Limit::At);
        let growth = at(h).modulus().clamp(f64::MIN_POSITIVE, f64::MAX).ln() / h;
        let smooth = (!mode.oscillates()).then(|| {
            let failure = first_failure(mode.rate(), upto, &|h| at(h).is_smooth());
            failure.unwrap_or(upto)
        });
        // What oscillates from the first cell on is not smooth up to anything worth saying.
        let smooth = smooth.filter(|smooth| *smooth > NEAR / mode.rate() * 0.5);
        Verdict::of(limit, growth, smooth, h, mode)
    });
    verdicts.reduce(Verdict::and)
}

/// Cells a scan takes, in units of the mode's rate; then in parts of how far it has come.
const CELL: f64 = 0.01;
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
        u += CELL * u.max(1.0);
    }
    None
}
