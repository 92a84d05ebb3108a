//! Limits from theory: the scene linearised about a state, its modes, and what a step of a method does to
//! each.

mod coupled;
mod definite;
mod krylov;
mod mode;
mod parts;
mod spectrum;
mod verdict;

use super::Limit;
use crate::integrators::Method;
use crate::physics::{State, System};
use crate::scene::{DampingModel, Scene};
use spectrum::{Solved, Spectrum};
use verdict::Verdict;

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
        let Some(parts) = parts::parts(system, t, x, v) else {
            linearised.failed = Some("a derivative of the forces is not finite here");
            return linearised;
        };
        let (mut at_rest, mut unstable, mut uncounted) = (0, 0, 0);
        for part in parts {
            let Some(solved) = spectrum::solve(part, &effort) else {
                linearised.failed = Some("the eigenvalues of the linearised scene do not converge");
                continue;
            };
            match solved.left_out {
                Some(left_out) => {
                    at_rest += solved.part.copies * left_out.at_rest;
                    unstable += solved.part.copies * left_out.unstable;
                }
                None => uncounted += solved.part.copies * solved.part.n(),
            }
            linearised.parts.push(solved);
        }
        let omegas = linearised.parts.iter();
        let omegas = omegas.filter_map(|solved| solved.spectrum.omega_max());
        linearised.omega_max = omegas.max_by(f64::total_cmp);
        let mut exclude = |count: usize, what: &str| {
            if count > 0 {
                linearised.excluded.push(Excluded {
                    what: format!("{count} mode{} {what}", if count == 1 { "" } else { "s" }),
                    count,
                });
            }
        };
        exclude(
            at_rest,
            "without restoring force (rigid motion, free particles)",
        );
        exclude(
            unstable,
            "that grow in truth (compressed springs, attraction)",
        );
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
        let unknown = |solved: &Solved| matches!(solved.spectrum, Spectrum::Outermost { .. });
        self.omega_max.is_none() && (self.failed.is_some() || self.parts.iter().any(unknown))
    }

    /// A bound on the rates of damping, 1/s: by row sums, no less than the largest.
    pub fn damping_max(&self) -> f64 {
        let parts = self.parts.iter().map(|s| s.part.damping.norm());
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
            reason: verdict.reason(undamped, modes),
            limit: verdict.limit,
            growth_per_s: verdict.growth.filter(|growth| growth.is_finite()),
            smooth_below_s: verdict.smooth.filter(|smooth| smooth.is_finite()),
        }
    }

    fn verdict(&self, method: &Method, timestep: f64) -> Verdict {
        let parts = self.parts.iter().filter_map(|solved| {
            verdict::part(method.amplification, solved, timestep, &self.effort)
        });
        let all = parts.chain(self.failed.map(Verdict::unknown));
        all.reduce(Verdict::and).unwrap_or_else(Verdict::at_rest)
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
                Spectrum::Sampled(_) | Spectrum::Outermost { .. } => return (0, 0),
            };
            counts.0 += solved.part.copies * undamped;
            counts.1 += solved.part.copies * all;
        }
        counts
    }
}

/// Sizes, in coordinates that couple, up to which things are done, and how far Krylov spaces go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// All modes of a symmetric stiffness, damped by themselves.
    pub symmetric: usize,
    /// All eigenvalues where damping couples them, of a matrix twice that size.
    pub unsymmetric: usize,
    /// One-step maps as matrices, whose limit is searched.
    pub map: usize,
    /// Coordinates up to which Verlet's limit with coupled damping is found to the end; beyond, the
    /// stiffest vector alone bounds it from above.
    pub flow: usize,
    /// Coordinates up to which outermost eigenvalues are looked for where damping couples; beyond
    /// they lie too close together for one Krylov space.
    pub outermost: usize,
    /// Vectors in a Krylov space.
    pub space: usize,
    /// How often such a space is begun anew from its best vector.
    pub restarts: usize,
    /// Residual, relative to the spectrum's size, at which a vector counts as found; an eigenvalue is
    /// then good to its square.
    pub found: f64,
}

impl Effort {
    /// Some seconds for a method on a scene of several hundred coupled coordinates.
    pub const FULL: Self = Self {
        symmetric: 600,
        unsymmetric: 300,
        map: 60,
        flow: 600,
        outermost: 1_800,
        space: 320,
        restarts: 8,
        found: 1e-10,
    };
    /// Some tens of milliseconds on such a scene.
    pub const BRIEF: Self = Self {
        symmetric: 120,
        unsymmetric: 40,
        map: 12,
        flow: 12,
        outermost: 270,
        space: 60,
        restarts: 2,
        found: 1e-3,
    };
}

/// Where along a trajectory a limit is tightest.
#[derive(Debug, Clone, PartialEq)]
pub struct Tightest {
    /// Seconds.
    pub limit_s: f64,
    /// When, s.
    pub t_s: f64,
}

/// A trajectory linearised at some of its states; made once for all methods.
#[derive(Debug, Clone)]
pub struct Along {
    states: Vec<(f64, Linearised)>,
}

/// States looked at, where a part couples few coordinates; of larger scenes fewer.
const STATES: usize = 64;
/// Coordinates times states.
const WORK: usize = 8_000;
/// States at least.
const FEWEST: usize = 8;

impl Along {
    /// Of states in order of time, evenly thinned, both ends included, to at most 64.
    pub fn new<'a, S: System + ?Sized>(
        system: &S,
        states: impl IntoIterator<Item = &'a State>,
    ) -> Self {
        let states: Vec<_> = states.into_iter().collect();
        let kept = (WORK / system.dim().max(1)).clamp(FEWEST, STATES);
        let last = states.len().saturating_sub(1);
        let mut places: Vec<usize> = (0..kept).map(|i| i * last / (kept - 1)).collect();
        places.dedup();
        let states = places
            .into_iter()
            .filter_map(|at| states.get(at))
            .map(|state| {
                let State { t, x, v, .. } = state;
                (*t, Linearised::with(Effort::BRIEF, system, *t, x, v))
            })
            .collect();
        Self { states }
    }

    /// The least limit, and when. None where no state has one that is known: it is stable at every
    /// step, or at none.
    pub fn tightest(&self, method: &Method) -> Option<Tightest> {
        let limits = self.states.iter().filter_map(|(t_s, linearised)| {
            // Any timestep: growth is not asked for.
            match linearised.verdict(method, 1.0).limit {
                Limit::At(limit_s) => Some(Tightest { limit_s, t_s: *t_s }),
                _ => None,
            }
        });
        // The first of equal ones.
        limits.min_by(|a, b| a.limit_s.total_cmp(&b.limit_s))
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
