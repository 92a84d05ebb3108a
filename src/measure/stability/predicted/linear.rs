//! The scene linearised about a state, its spectrum, and what a method does to it.

use super::assembly;
use super::predict;
use super::spectrum::{self, Solved, Spectrum};
use super::verdict::Verdict;
use super::{Effort, Limit};
use crate::integrators::Method;
use crate::scene::{DampingModel, Scene};
use crate::system::System;

/// x'' = -K x - C v about a state, mass-normalised, as its parts that do not couple.
#[derive(Debug, Clone)]
pub struct Linearised {
    /// Those with a spectrum.
    parts: Vec<Solved>,
    excluded: Vec<Excluded>,
    omega_max: Option<f64>,
    /// Why nothing, or not everything, can be said.
    failed: Option<&'static str>,
    effort: Effort,
}

/// Modes the prediction leaves out.
#[derive(Debug, Clone, PartialEq)]
pub struct Excluded {
    /// Such as `2 modes that grow in truth (compressed springs, attraction)`.
    pub what: String,
    pub count: usize,
}

/// What one method does to a linearised scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    pub limit: Limit,
    /// ln(spectral radius) / h of the amplitude at the timestep asked for, 1/s; at most 0 where it
    /// is stable, 0 where nothing moves but freely. None where it would take the full spectrum of too
    /// many coordinates.
    pub growth_per_s: Option<f64>,
    /// Where nothing oscillates (drag alone, overdamped modes): the largest step, s, up to which every
    /// mode decays without changing sign from step to step; None where something oscillates in truth,
    /// where no step is too large (`reason` says so), and for splittings where damping couples modes.
    pub smooth_below_s: Option<f64>,
    /// What there is to say in words: which mode binds, or why there is no limit.
    pub reason: Option<String>,
}

impl Linearised {
    /// About the state (t, x, v) of all particles, fixed ones included (3n coordinates).
    ///
    /// Not cheap: the full spectrum of up to 600 coordinates that couple.
    pub fn at<S: System + ?Sized>(system: &S, t: f64, x: &[f64], v: &[f64]) -> Self {
        Self::with(Effort::FULL, system, t, x, v)
    }

    /// With less care for large scenes: what a run can afford to be warned.
    pub fn brief<S: System + ?Sized>(system: &S, t: f64, x: &[f64], v: &[f64]) -> Self {
        Self::with(Effort::BRIEF, system, t, x, v)
    }

    /// With limits on the work of one's own.
    pub fn with<S: System + ?Sized>(
        effort: Effort,
        system: &S,
        t: f64,
        x: &[f64],
        v: &[f64],
    ) -> Self {
        let mut linearised = Self {
            parts: Vec::new(),
            excluded: Vec::new(),
            omega_max: None,
            failed: None,
            effort,
        };
        let Some(parts) = assembly::parts(system, t, x, v) else {
            linearised.failed = Some("a derivative of the forces is not finite here");
            return linearised;
        };
        let (mut at_rest, mut unstable, mut uncounted) = (0, 0, 0);
        for part in parts {
            let copies = part.copies;
            let n = part.component.n();
            let Some(solved) = spectrum::solve(part, &effort) else {
                linearised.failed = Some("the eigenvalues of the linearised scene do not converge");
                continue;
            };
            at_rest += copies * solved.at_rest.unwrap_or(0);
            unstable += copies * solved.unstable.unwrap_or(0);
            if solved.unstable.is_none() {
                uncounted += copies * n;
            }
            linearised.omega_max = linearised
                .omega_max
                .into_iter()
                .chain(solved.omega_max)
                .max_by(f64::total_cmp);
            linearised.parts.push(solved);
        }
        linearised.excluded = [
            (
                at_rest,
                "without restoring force (rigid motion, free particles)",
            ),
            (
                unstable,
                "that grow in truth (compressed springs, attraction)",
            ),
        ]
        .into_iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, what)| Excluded {
            what: format!("{count} mode{} {what}", if count == 1 { "" } else { "s" }),
            count,
        })
        .collect();
        if uncounted > 0 {
            linearised.excluded.push(Excluded {
                what: format!(
                    "modes that rest or grow in truth among {uncounted} coordinates, too many to count"
                ),
                count: 0,
            });
        }
        linearised
    }

    /// The largest angular frequency, rad/s; None where nothing oscillates, or nobody knows
    /// ([`Self::is_unsure`]).
    pub fn omega_max(&self) -> Option<f64> {
        self.omega_max
    }

    /// Whether [`Self::omega_max`] is None because nobody knows.
    pub fn is_unsure(&self) -> bool {
        self.omega_max.is_none()
            && (self.failed.is_some() || self.parts.iter().any(|solved| solved.unsure))
    }

    /// A bound on the rates of damping, 1/s: by row sums, no less than the largest.
    pub fn damping_max(&self) -> f64 {
        let parts = self.parts.iter().map(|s| s.part.component.damping.norm());
        parts.fold(0.0, f64::max)
    }

    /// What the prediction leaves out, in words and numbers.
    pub fn excluded(&self) -> &[Excluded] {
        &self.excluded
    }

    /// What `method` does to it: its limit, and its growth at `timestep`, s.
    pub fn predict(&self, method: &Method, timestep: f64) -> Prediction {
        let verdict = self.verdict(method, timestep);
        let (undamped, modes) = self.undamped();
        Prediction {
            reason: predict::reason(&verdict, undamped, modes),
            limit: verdict.limit,
            growth_per_s: verdict.growth.filter(|growth| growth.is_finite()),
            smooth_below_s: verdict.smooth.filter(|smooth| smooth.is_finite()),
        }
    }

    pub(super) fn verdict(&self, method: &Method, timestep: f64) -> Verdict {
        let failed = self.failed.map(Verdict::unknown);
        let parts = self.parts.iter();
        parts
            .filter_map(|solved| {
                predict::part(method.amplification, solved, timestep, &self.effort)
            })
            .chain(failed)
            .reduce(Verdict::and)
            .unwrap_or(Verdict {
                limit: Limit::Unconditional,
                growth: Some(0.0),
                smooth: None,
                binding: None,
                note: None,
            })
    }

    /// Modes that neither decay nor rest, and all that do not rest; zeros where nobody counted.
    fn undamped(&self) -> (usize, usize) {
        let mut counts = (0, 0);
        for solved in &self.parts {
            let (undamped, all) = match &solved.spectrum {
                Spectrum::Modes(modes) => {
                    let undamped = modes.iter().filter(|mode| mode.damping == 0.0);
                    (undamped.count(), modes.len())
                }
                Spectrum::Roots(roots) => {
                    let undamped = roots.iter().filter(|root| root.re == 0.0);
                    (undamped.count(), roots.len())
                }
                Spectrum::Sampled(_) | Spectrum::Outermost(_) | Spectrum::Bounded { .. } => {
                    return (0, 0);
                }
            };
            counts.0 += solved.part.copies * undamped;
            counts.1 += solved.part.copies * all;
        }
        counts
    }
}

/// Whether every force is linear in position and velocity, or constant: then a limit does not
/// depend on the state.
pub fn is_linear(scene: &Scene) -> bool {
    let moves = |ends: &[usize; 2]| {
        let fixed = |&end: &usize| scene.particles.get(end).is_some_and(|p| p.fixed);
        !ends.iter().all(fixed)
    };
    let isotropic = scene.damping_model == DampingModel::Isotropic;
    let springs = scene.springs.iter().filter(|spring| moves(&spring.ends));
    let attractions = scene.gravitational.iter().filter(|pair| moves(&pair.ends));
    springs.into_iter().all(|s| {
        let pulls_linearly = s.rest_length == 0.0 || s.stiffness == 0.0;
        pulls_linearly && s.cubic == 0.0 && (s.damping == 0.0 || isotropic)
    }) && attractions.into_iter().all(|pair| pair.g == 0.0)
}
