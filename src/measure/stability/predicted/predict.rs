//! A method's limit on each part, and on all.

use super::assembly::Part;
use super::composition;
use super::coupled::{Coupled, Scheme};
use super::mode::{Mode, shown};
use super::one_kick::{self, OneKick};
use super::region::{Reach, Region};
use super::spectrum::{Solved, Spectrum};
use super::verdict::Verdict;
use super::{Effort, Limit};
use crate::integrators::Amplification;
use nalgebra::Complex;

/// What a method does to a part.
pub(super) fn part(
    amplification: Amplification,
    solved: &Solved,
    h: f64,
    effort: &Effort,
) -> Option<Verdict> {
    match amplification {
        Amplification::Rational {
            numerator,
            denominator,
        } => {
            let region = Region {
                numerator,
                denominator,
            };
            by_region(&region, &solved.spectrum, h)
        }
        Amplification::Composition(stages, damping) => {
            let kind = OneKick::of(stages, damping);
            let formula = kind.map(|kind| move |mode: Mode| kind.limit(mode));
            let closed = formula.as_ref().map(|f| f as &dyn Fn(Mode) -> Option<f64>);
            let judge = |modes: &[Mode]| composition::judge(stages, damping, modes, h, closed);
            let scheme = Scheme::Composition(stages, damping);
            match &solved.spectrum {
                Spectrum::Modes(modes) => judge(modes),
                Spectrum::Sampled(modes) => stiffest_binds(judge(modes)?, modes),
                Spectrum::Roots(_) | Spectrum::Outermost(_) | Spectrum::Bounded { .. } => {
                    Some(coupled(scheme, kind, solved, h, effort))
                }
            }
        }
        Amplification::MaterialImplicit => {
            let alone = matches!(&solved.spectrum, Spectrum::Modes(modes) if modes.is_empty());
            let kind = Some(OneKick::Material);
            (!alone).then(|| coupled(Scheme::MaterialImplicit, kind, solved, h, effort))
        }
    }
}

/// By eigenvalues.
fn by_region(region: &Region, spectrum: &Spectrum, h: f64) -> Option<Verdict> {
    match spectrum {
        Spectrum::Modes(modes) => by_modes(region, modes, h),
        Spectrum::Roots(roots) => by_roots(region, roots.iter().map(|&r| (r, Mode::of(r))), h),
        Spectrum::Sampled(modes) => stiffest_binds(by_modes(region, modes, h)?, modes),
        Spectrum::Outermost(roots) => {
            let known = by_roots(region, roots.iter().map(|&r| (r, Mode::of(r))), h);
            Some(of_outermost(region, roots, known))
        }
        Spectrum::Bounded { stiffest, radius } => {
            let known = by_modes(region, &[*stiffest], h);
            Some(of_bounded(region, *radius, known))
        }
    }
}

fn by_modes(region: &Region, modes: &[Mode], h: f64) -> Option<Verdict> {
    let roots = modes
        .iter()
        .flat_map(|mode| mode.roots().into_iter().map(|root| (root, *mode)));
    by_roots(region, roots, h)
}

fn by_roots(
    region: &Region,
    roots: impl Iterator<Item = (Complex<f64>, Mode)>,
    h: f64,
) -> Option<Verdict> {
    let sign_change = region.sign_change();
    roots
        .map(|(root, mode)| {
            let limit = match region.reach(root) {
                Reach::Nowhere => Limit::Never,
                Reach::To(u) => Limit::At(u / root.norm()),
                Reach::Everywhere => Limit::Unconditional,
            };
            let bound = if let Limit::At(limit) = limit {
                limit
            } else {
                f64::INFINITY
            };
            let smooth = (root.im == 0.0).then(|| bound.min(sign_change / root.norm()));
            Verdict::of(limit, region.log_modulus(root, h) / h, smooth, h, mode)
        })
        .reduce(Verdict::and)
}

/// Between two samples there may be any mode: what they say holds where the stiffest, which is
/// known, is the one that binds, or where nothing does.
fn stiffest_binds(verdict: Verdict, modes: &[Mode]) -> Option<Verdict> {
    let binds = verdict.binding == modes.last().copied();
    let sure = match verdict.limit {
        Limit::At(_) => binds,
        _ => true,
    };
    if sure {
        return Some(verdict);
    }
    Some(Verdict::unknown(
        "too many coordinates for the full spectrum, and it is not the stiffest mode that binds",
    ))
}

/// Of outermost eigenvalues: the others lie within the least of them, and where the half disc of that
/// radius is stable too, nothing was missed.
fn of_outermost(region: &Region, roots: &[Complex<f64>], known: Option<Verdict>) -> Verdict {
    let radius = region.half_disc();
    if radius == f64::INFINITY {
        return Verdict {
            limit: Limit::Unconditional,
            // Others may decay more slowly.
            growth: None,
            smooth: None,
            note: None,
            binding: known.and_then(|verdict| verdict.binding),
        };
    }
    let Some(known) = known else {
        return Verdict::unknown(
            "damping couples too many modes to know them, and any may be the tightest",
        );
    };
    let inner = roots.last().map_or(0.0, |root| root.norm());
    let growth = known.growth.filter(|growth| *growth > 0.0);
    match known.limit {
        Limit::Never => known,
        Limit::At(limit) if limit * inner <= radius => Verdict {
            growth,
            smooth: None,
            ..known
        },
        Limit::At(_) if radius > 0.0 => Verdict {
            growth,
            smooth: None,
            note: Some(format!(
                "by the outermost modes of too many to know; others could lower it to {} s at most",
                shown(radius / inner)
            )),
            ..known
        },
        _ => Verdict {
            growth,
            ..Verdict::unknown(
                "too many coordinates for the full spectrum, and any mode may be the tightest",
            )
        },
    }
}

/// Of the stiffest vector, and a radius no eigenvalue is beyond.
fn of_bounded(region: &Region, radius: f64, known: Option<Verdict>) -> Verdict {
    let stable = region.half_disc();
    let Some(known) = known.filter(|_| stable > 0.0 && stable.is_finite()) else {
        return of_outermost(region, &[], None);
    };
    let Limit::At(limit) = known.limit else {
        return of_outermost(region, &[], None);
    };
    let sure = stable / radius;
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

/// Where modes are coupled by damping, or by stiffness a method leaves out.
fn coupled(
    scheme: Scheme,
    kind: Option<OneKick>,
    solved: &Solved,
    h: f64,
    effort: &Effort,
) -> Verdict {
    let Part {
        component,
        symmetric,
        ..
    } = &solved.part;
    let n = component.n();
    let by_theory = kind.and_then(|kind| one_kick::limit(kind, component, effort));
    let map = (n <= effort.map)
        .then(|| {
            let at_rest = solved.at_rest != Some(0);
            let unstable = solved.unstable != Some(0);
            Coupled::new(component, at_rest, unstable)
        })
        .flatten();
    let binding = by_theory.as_ref().and_then(|found| found.binding);
    let limit = match (&by_theory, &map) {
        // For stiffnesses that are not symmetric the theory is about their symmetric part only.
        (Some(found), None) => found.limit.map_or(Limit::Unconditional, Limit::At),
        (Some(found), Some(_)) if *symmetric => found.limit.map_or(Limit::Unconditional, Limit::At),
        (_, Some(map)) => {
            let rate = component
                .stiffness
                .norm()
                .sqrt()
                .max(component.damping.norm());
            let guess = by_theory.as_ref().and_then(|found| found.limit);
            let guess = guess.unwrap_or(2.0 / rate);
            map.limit(scheme, guess)
                .map_or(Limit::Unconditional, Limit::At)
        }
        (None, None) => Limit::Unknown(format!(
            "damping couples {n} coordinates: too many for this method's one-step map"
        )),
    };
    let growth = map.and_then(|map| map.growth(scheme, h));
    let stable = match limit {
        Limit::At(limit) | Limit::Between(limit, _) => h <= limit,
        Limit::Unconditional => true,
        Limit::Never | Limit::Unknown(_) => false,
    };
    Verdict {
        limit,
        growth: growth.map(|growth| if stable { growth.min(0.0) } else { growth }),
        smooth: None,
        binding,
        note: by_theory
            .filter(|found| found.at_most)
            .map(|_| "at most: damping couples too many modes to look at all".to_owned()),
    }
}

/// What binds, in words.
pub(super) fn reason(verdict: &Verdict, undamped: usize, modes: usize) -> Option<String> {
    let mode = verdict.binding.map(Mode::words);
    match &verdict.limit {
        Limit::Unknown(why) => Some(why.clone()),
        Limit::At(_) | Limit::Between(..) => {
            let words: Vec<String> = mode.into_iter().chain(verdict.note.clone()).collect();
            (!words.is_empty()).then(|| words.join("; "))
        }
        Limit::Unconditional => match verdict.smooth {
            Some(smooth) if smooth == f64::INFINITY => {
                Some("smooth at every step: nothing oscillates".to_owned())
            }
            _ => None,
        },
        Limit::Never => {
            let mode = mode?;
            if undamped > 0 && undamped < modes {
                return Some(format!(
                    "{mode}; {undamped} of {modes} modes are undamped, and on those it is stable at \
                     no step"
                ));
            }
            Some(mode)
        }
    }
}
