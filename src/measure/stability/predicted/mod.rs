//! Limits from theory: the scene linearised about a state, its modes, and what a step of a method does to
//! each.

mod definite;
mod forced;
mod krylov;
mod maps;
mod part;
mod parts;
mod prediction;
mod regions;
mod rods;
mod spectrum;
mod stepmap;
mod swept;

use super::Limit;
use crate::integrators::{Amplification, Coefficients, DampingTreatment, Method, fixed};
use crate::physics::constraints::Rods;
use crate::physics::{Dampers, ForceKinds, Refused, State, System};
use crate::scene::{DampingModel, Scene, Stabilisation};
pub(super) use parts::shortest;
pub use prediction::Prediction;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use spectrum::{Coverage, Spectrum};

/// The point of the trajectory where the predicted limit is smallest.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
pub struct TightestLimit {
    /// The smallest limit, s.
    pub limit_s: f64,
    /// The time at which it holds, s.
    pub t_s: f64,
}

/// Free coordinates up to which steps of a method that sweeps over dampers are taken one by one.
const SWEPT: usize = 24;

/// x'' = -K x - C v about a state, mass-normalised, as its parts that do not couple.
#[derive(Debug, Clone)]
pub struct Linearised {
    /// The parts with a spectrum.
    parts: Vec<Spectrum>,
    /// What the scene's forces are: a method that does not take them has no limit.
    kinds: ForceKinds,
    excluded: Vec<String>,
    /// The number of modes that grow in truth, of those that were counted.
    growing: usize,
    /// The reason why nothing, or not everything, is known.
    failed: Option<&'static str>,
    /// Whether some particle has two dampers, so that a sweep over them is not their exact flow.
    shared: bool,
    /// Whether damping multiplies all velocities alike.
    uniform: bool,
    /// Limits of methods that sweep over such dampers, by the methods' ids, where they were searched.
    swept: Vec<(&'static str, Limit)>,
    effort: Effort,
}

impl Linearised {
    /// Linearises about the state of all particles, fixed ones included (3n coordinates). Rods leave the motions along
    /// them, of stiffnesses that the tensions of this place at rest add to.
    ///
    /// This is not cheap: full effort computes the whole spectrum of up to 600 coordinates that couple.
    pub fn new<S: System + ?Sized>(system: &S, state: &State, effort: Effort) -> Self {
        let mut linearised = Self {
            parts: Vec::new(),
            kinds: system.kinds(),
            excluded: Vec::new(),
            growing: 0,
            failed: None,
            shared: system.dampers() == Dampers::Shared,
            uniform: true,
            swept: Vec::new(),
            effort,
        };
        let Some(parts) = parts::parts(system, state, effort.symmetric) else {
            linearised.failed = Some("a derivative of the forces is not finite here");
            return linearised;
        };
        linearised.uniform = parts.uniform;
        if parts.left_out {
            linearised.failed =
                Some("rods couple too many coordinates to find the motions they allow");
        }
        let (mut at_rest, mut unstable, mut uncounted) = (0, 0, 0);
        for part in parts.all {
            let Some(spectrum) = spectrum::solve(part, &effort) else {
                linearised.failed = Some("the eigenvalues of the linearised scene do not converge");
                continue;
            };
            let copies = spectrum.part.copies;
            match spectrum.left_out {
                Some(left_out) => {
                    at_rest += copies * left_out.at_rest;
                    unstable += copies * left_out.unstable;
                }
                None => uncounted += copies * spectrum.part.n(),
            }
            linearised.parts.push(spectrum);
        }
        linearised.growing = unstable;
        for (count, what) in [
            (
                at_rest,
                ["without restoring force (rigid motion, free particles)"; 2],
            ),
            (
                unstable,
                [
                    "that grows in truth (compressed springs, attraction)",
                    "that grow in truth (compressed springs, attraction)",
                ],
            ),
        ] {
            let one = count == 1;
            let [s, what] = if one { ["", what[0]] } else { ["s", what[1]] };
            let some = (count > 0).then(|| format!("{count} mode{s} {what}"));
            linearised.excluded.extend(some);
        }
        if let Some(rods) = system.rods() {
            linearised.excluded.extend(of_rods(rods, state));
        }
        if uncounted > 0 {
            linearised.excluded.push(format!(
                "modes that rest or grow in truth among {uncounted} coordinates, too many to count"
            ));
        }
        let free = system.inverse_mass().iter().filter(|w| **w > 0.0).count();
        let rods = linearised.kinds.has(ForceKinds::CONSTRAINED);
        if linearised.shared && !rods && unstable == 0 && free <= effort.map.min(SWEPT) {
            // What is known of one sweep a step holds for dampers, and not for what turns velocities.
            let turns = linearised.kinds.has(ForceKinds::GYROSCOPIC);
            let sweeps = fixed()
                .iter()
                .filter(|method| maps::is_swept(method, turns));
            let omega = linearised.omega_max();
            linearised.swept = sweeps
                .filter_map(|m| Some((m.id, swept::limit(system, state, m, omega?))))
                .collect();
        }
        linearised
    }

    /// The largest angular frequency, rad/s; None where nothing oscillates, or that is unknown
    /// ([`Self::is_unsure`]).
    pub fn omega_max(&self) -> Option<f64> {
        let omegas = self.parts.iter().filter_map(Spectrum::omega_max);
        omegas.max_by(f64::total_cmp)
    }

    /// Whether [`Self::omega_max`] is None because it is unknown.
    pub fn is_unsure(&self) -> bool {
        let unknown = |part: &Spectrum| matches!(part.coverage, Coverage::Outermost(_));
        self.omega_max().is_none() && (self.failed.is_some() || self.parts.iter().any(unknown))
    }

    /// The number of modes that grow in truth, of those that were counted: a method that follows them is right.
    pub fn growing(&self) -> usize {
        self.growing
    }

    /// A bound on the rates of damping, 1/s: by row sums, no less than the largest.
    pub fn damping_max(&self) -> f64 {
        let norms = self.parts.iter().map(|of| of.part.damping.norm());
        norms.fold(0.0, f64::max)
    }

    /// The modes the prediction leaves out, in words and numbers, such as `2 modes that grow in truth
    /// (compressed springs, attraction)`.
    pub fn excluded(&self) -> &[String] {
        &self.excluded
    }

    /// The prediction for `method`: its limit, and its growth at `timestep`, s. The limit of a method that does
    /// not take the scene's forces is unknown.
    pub fn predict(&self, method: &Method, timestep: f64) -> Prediction {
        let kinds = self.kinds.without(method.takes());
        if kinds != ForceKinds::NONE {
            let (method, effects) = (method.id.to_owned(), Vec::new());
            let refused = Refused {
                method,
                kinds,
                effects,
            };
            return Prediction::unknown(refused.reason());
        }
        let on_rods = self.kinds.has(ForceKinds::CONSTRAINED);
        if on_rods && matches!(method.coefficients, Coefficients::Rattle(_)) && !self.uniform {
            return Prediction::unknown(
                "how dampers and the impulses of rods act together in this method is not worked out",
            );
        }
        if self.growing > 0 && self.parts.iter().all(|part| part.modes.is_empty()) {
            return Prediction::unknown(
                "all that moves here grows in truth, and a method that follows it is right",
            );
        }
        let method = &method.under(self.kinds);
        let parts = self
            .parts
            .iter()
            .filter_map(|part| match method.amplification {
                Amplification::Rational(rational) => regions::predict(&rational, part, timestep),
                Amplification::Composition(
                    _,
                    DampingTreatment::Sweeps | DampingTreatment::Boris,
                ) if self.shared && part.part.damping.norm() > 0.0 => {
                    Some(maps::swept(method.amplification, part, &self.effort))
                }
                other => maps::predict(other, part, timestep, &self.effort),
            });
        if let Some((_, limit)) = self.swept.iter().find(|(id, _)| *id == method.id) {
            return Prediction::only(limit.clone());
        }
        let all = parts.chain(self.failed.map(Prediction::unknown));
        // All motion is free: nothing grows.
        let whole = all
            .reduce(Prediction::and)
            .unwrap_or_else(|| Prediction::only(Limit::Unconditional).growing(Some(0.0), timestep));
        let (undamped, modes) = self.undamped();
        whole.explained(undamped, modes)
    }

    /// The numbers of modes that neither decay nor rest, and of all that do not rest; zeros where
    /// they were not counted.
    fn undamped(&self) -> (usize, usize) {
        let mut counts = (0, 0);
        for Spectrum {
            part,
            modes,
            coverage,
            ..
        } in &self.parts
        {
            if !matches!(coverage, Coverage::All) {
                return (0, 0);
            }
            let undamped = modes.iter().filter(|mode| mode.damping == 0.0).count();
            counts.0 += part.copies * undamped;
            counts.1 += part.copies * modes.len();
        }
        counts
    }
}

/// What a prediction on rods leaves out. Baumgarte's forces make modes of what rods hold.
fn of_rods(rods: &Rods, state: &State) -> Vec<String> {
    let s = if rods.len() == 1 { "" } else { "s" };
    let held = format!("{} motion{s} that rods hold", rods.len());
    let moves = state.v.iter().any(|v| *v != 0.0);
    let turning = "what the velocities here do to the tensions of rods".to_owned();
    let held = (rods.stabilisation() != Stabilisation::Baumgarte).then_some(held);
    held.into_iter().chain(moves.then_some(turning)).collect()
}

/// Sizes, in coordinates that couple, up to which each method is used, and how far Krylov spaces go.
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

/// A trajectory linearised at some of its states; made once for all methods.
#[derive(Debug, Clone)]
pub struct LinearisedTrajectory {
    states: Vec<(f64, Linearised)>,
}

/// Most states looked at; larger scenes have fewer.
const STATES: usize = 64;
/// Most coordinates times states.
const WORK: usize = 8_000;
/// Fewest states looked at.
const FEWEST: usize = 8;

impl LinearisedTrajectory {
    /// Linearises at these states, in order of time, evenly thinned to at most 64 with both ends included.
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
            .map(|state| (state.t, Linearised::new(system, state, Effort::BRIEF)))
            .collect();
        Self { states }
    }

    /// The least limit, and when. None where no state has one that is known: it is stable at every
    /// step, or at none.
    pub fn tightest(&self, method: &Method) -> Option<TightestLimit> {
        let limits = self.states.iter().filter_map(|(t_s, linearised)| {
            // Any timestep will do: growth is not used.
            match linearised.predict(method, 1.0).limit {
                Limit::At(limit_s) => Some(TightestLimit { limit_s, t_s: *t_s }),
                _ => None,
            }
        });
        // Of equal limits this takes the first.
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
    let hinges = scene.bending.iter().filter(|hinge| {
        let fixed = |&p: &usize| scene.particles.get(p).is_some_and(|p| p.fixed);
        !hinge.particles.iter().all(fixed)
    });
    let bends = hinges
        .into_iter()
        .any(|hinge| hinge.stiffness != 0.0 || hinge.damping != 0.0);
    let presses = scene.contact.as_ref().is_some_and(|c| c.penalty.is_some());
    !bends
        && !presses
        && scene.rods.is_empty()
        && springs.into_iter().all(|s| {
            let pulls_linearly = s.rest_length == 0.0 || s.stiffness == 0.0;
            pulls_linearly && s.cubic == 0.0 && (s.damping == 0.0 || isotropic)
        })
        && attractions.into_iter().all(|pair| pair.g == 0.0)
        && (scene.particles.iter()).all(|p| p.fixed || p.quadratic_drag == 0.0)
        && scene
            .triangles
            .iter()
            .all(|triangle| triangle.air_drag == 0.0)
}
