//! The twin proof: before a run compares anything with rapier, a few steps of its own scene show
//! that both sides compute the same scene.
//!
//! Two programs that agree to rounding on a scene agree on its masses, springs, dampers, gravity
//! and units. What is compared is rapier with the method of ours that it *is*, not with the truth.

mod contact;
mod lockstep;
mod start;

use crate::measure::identify::solve_effort;
use crate::measure::{Check, CheckStatus};
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use crate::solvers::rapier::{RapierSettings, stand_ins};
use crate::solvers::{Solver, Unsupported, find};
use lockstep::{ForcesHeld, Path, distance};
use start::{condition, disturbed, set_in_motion};

/// World steps of the proof against symplectic Euler.
const FORCE_STEPS: u32 = 16;
/// World steps of the proofs of rapier's own joints and gravity, each of several substeps.
const JOINT_STEPS: u32 = 4;
/// Most sweeps of a proof.
const MAX_SWEEPS: u32 = 1024;
/// Most visits to joints in one try: about two seconds.
const MAX_ROWS: u64 = 20_000_000;
/// Paths of ours in a proof that measures how much rounding grows.
const PATHS: u64 = 3;
/// What a visit to a joint takes, in steps of one particle under explicit forces.
const ROW: u64 = 3;
/// A proof that could not tell a relative error of this size is none.
const BLUNT: f64 = 1e-6;

/// All proofs a scene calls for, at a timestep in seconds: `twin-forces`, `twin-joints`, without springs `twin-fall`, and
/// with obstacles `twin-contact`. The others leave obstacles out.
///
/// `measured` is the largest distance over the steps taken: of positions in units of the largest
/// coordinate, of velocities in units of the largest speed, whichever is larger. The `bound` is what
/// rounding can explain, in the same units; 0 means bit for bit. A proof that fails says that the two sides
/// do not compute the same scene: nothing compared with rapier means anything. It is inconclusive where
/// neither is shown, and skipped where rapier does not take the scene.
///
/// The scene is started with small pseudo-random velocities added, the same in every run: many
/// scenes begin at rest with no spring stretched, where a few steps would exercise only gravity.
pub fn prove(scene: &Scene, timestep: f64) -> Vec<Check> {
    prove_pair(scene, scene, timestep)
}

/// The same, as far as `effort` allows, in steps of one particle under explicit forces: a proof that takes more is
/// skipped, and sweeps are not doubled beyond it.
pub fn prove_within(scene: &Scene, timestep: f64, effort: u64) -> Vec<Check> {
    let mut pair = Pair::new(scene, scene, timestep);
    pair.effort = effort;
    pair.proofs()
}

/// The same with a scene of its own for rapier: a different one must fail. For tests of the proof.
pub fn prove_pair(ours: &Scene, theirs: &Scene, timestep: f64) -> Vec<Check> {
    Pair::new(ours, theirs, timestep).proofs()
}

impl Pair {
    fn proofs(&self) -> Vec<Check> {
        let pair = self;
        let mut proofs = vec![
            pair.prove(FORCES, Pair::forces),
            pair.prove(JOINTS, Pair::joints),
        ];
        let system = ParticleSystem::new(&pair.ours);
        if system.effects().iter().all(|(row, _)| row.constant) {
            proofs.push(pair.prove(FALL, Pair::fall));
        }
        if pair
            .touching
            .iter()
            .any(|scene| !scene.colliders.is_empty())
        {
            proofs.push(pair.prove(CONTACT, Pair::contact));
        }
        proofs
    }
}

/// The proof `twin-user-forces`, for runs that have this engine: rapier's bodies at its defaults hold the forces
/// of each step's start. `theirs` is rapier's scene, which is the same but in tests of the proof.
pub fn prove_user_forces(ours: &Scene, theirs: &Scene, timestep: f64) -> Check {
    Pair::new(ours, theirs, timestep).prove(USER_FORCES, Pair::user_forces)
}

/// The claim that a proof is to show.
struct Claim {
    id: &'static str,
    subject: &'static str,
    /// The integrator of ours that the subject must be.
    method: &'static str,
}

/// rapier-forces is symplectic Euler.
const FORCES: Claim = Claim {
    id: "twin-forces",
    subject: "rapier-forces",
    method: "symplectic_euler",
};
/// rapier-user-forces is symplectic Euler at dt / n under held forces.
const USER_FORCES: Claim = Claim {
    id: "twin-user-forces",
    subject: "rapier-user-forces",
    method: "forces_held(symplectic_euler)",
};
/// rapier-converged is linearly implicit Euler without geometric stiffness, at dt / 4.
const JOINTS: Claim = Claim {
    id: "twin-joints",
    subject: "rapier-converged",
    method: "linearized_implicit_material",
};
/// rapier's fall is symplectic Euler at dt / n.
const FALL: Claim = Claim {
    id: "twin-fall",
    subject: "rapier",
    method: "symplectic_euler",
};

/// rapier's contact, swept until it converges, is the step written here.
const CONTACT: Claim = Claim {
    id: "twin-contact",
    subject: "rapier-converged",
    method: "rapier_contact",
};

impl Claim {
    fn judge(&self, ours: &Path, theirs: &Path, bound: f64, derivation: String) -> Check {
        let (subject, method) = (self.subject, self.method);
        let measured = distance(ours, theirs);
        let (status, message) = if let Some(reason) = ours.ended() {
            (
                CheckStatus::Inconclusive,
                format!("{method} could not take these steps: {reason}"),
            )
        } else if bound.is_nan() || bound > BLUNT {
            (
                CheckStatus::Inconclusive,
                format!(
                    "rounding alone may move this scene by {bound:.0e} in a few steps: it proves nothing"
                ),
            )
        } else {
            match measured {
                Some(0.0) => (
                    CheckStatus::Pass,
                    format!("{subject} is {method}, bit for bit"),
                ),
                Some(d) if d <= bound => (
                    CheckStatus::Pass,
                    format!("{subject} is {method} to {d:.0e}, rounding ({bound:.0e})"),
                ),
                Some(d) => (
                    CheckStatus::Fail,
                    format!(
                        "{subject} is {d:.0e} away from {method}; rounding explains {bound:.0e}"
                    ),
                ),
                None => (
                    CheckStatus::Fail,
                    format!("{subject} left the finite numbers, {method} did not"),
                ),
            }
        };
        self.check(status, measured, bound, derivation, message)
    }

    fn check(
        &self,
        status: CheckStatus,
        measured: Option<f64>,
        bound: f64,
        derivation: String,
        message: String,
    ) -> Check {
        Check {
            id: self.id.to_owned(),
            subject: self.subject.to_owned(),
            status,
            measured: measured.filter(|measured| measured.is_finite()),
            bound: Some(bound).filter(|bound| bound.is_finite()),
            derivation,
            message,
            ..Check::default()
        }
    }
}

struct Pair {
    ours: Scene,
    theirs: Scene,
    /// Both with their obstacles, as their files have them.
    touching: [Scene; 2],
    timestep: f64,
    /// The most that a proof may take, in steps of one particle under explicit forces.
    effort: u64,
}

impl Pair {
    /// Both sides, set in motion.
    fn new(ours: &Scene, theirs: &Scene, timestep: f64) -> Self {
        // In rapier's world stiff springs stand for rods, so that is what it has to be.
        let mut stiff = ours.clone();
        // Contact has a proof of its own, from where the scene starts.
        stiff.colliders.clear();
        stiff.contact = None;
        stiff.springs.extend(stand_ins(ours));
        stiff.rods.clear();
        let mut start = set_in_motion(&stiff, timestep * f64::from(JOINT_STEPS));
        // Whatever residual the scene puts up with, the proof solves to the default one.
        start.solver.tolerance = None;
        // Their side differs in what the caller made different, never in how it is set in motion.
        let mut other = theirs.clone();
        other.colliders.clear();
        other.contact = None;
        for (theirs, moving) in other.particles.iter_mut().zip(&start.particles) {
            theirs.velocity = moving.velocity;
        }
        Self {
            ours: start,
            theirs: other,
            touching: [ours.clone(), theirs.clone()],
            timestep,
            effort: u64::MAX,
        }
    }

    /// rapier's path over `steps` world steps.
    fn theirs(&self, solver: Option<Solver>, steps: u32) -> Result<Path, Unsupported> {
        let solver = solver.ok_or_else(|| Unsupported {
            reason: "there is no such engine".to_owned(),
        })?;
        Path::of(&solver, &self.theirs, self.timestep, 1, steps)
    }

    /// Proves a claim; a proof that rapier does not support is skipped.
    fn prove(&self, claim: Claim, by: fn(&Self, &Claim) -> Result<Check, Unsupported>) -> Check {
        by(self, &claim).unwrap_or_else(|Unsupported { reason }| {
            claim.check(CheckStatus::Skip, None, 0.0, String::new(), reason)
        })
    }

    fn forces(&self, claim: &Claim) -> Result<Check, Unsupported> {
        let theirs = self.theirs(find(claim.subject), FORCE_STEPS)?;
        let ours = Path::ours(&self.ours, claim.method, self.timestep, 1, FORCE_STEPS)?;
        // v += h (f / m), x += h v: the forces are the same code, and both sides round the same
        // four operations in the same order. There is no difference to be amplified.
        let derivation = "both sides round the same operations in the same order: bit for bit";
        Ok(claim.judge(&ours, &theirs, 0.0, derivation.to_owned()))
    }

    fn user_forces(&self, claim: &Claim) -> Result<Check, Unsupported> {
        let substeps = RapierSettings::DEFAULT.iterations;
        let held = Solver::own(claim.method, move || Box::new(ForcesHeld::new(substeps)));
        let theirs = self.theirs(find(claim.subject), FORCE_STEPS)?;
        let ours = Path::of(&held, &self.ours, self.timestep, 1, FORCE_STEPS)?;
        // v += h/n (f / m), x += h/n v: the same code and the same operations, as in `forces`.
        let derivation = "both sides round the same operations in the same order: bit for bit";
        Ok(claim.judge(&ours, &theirs, 0.0, derivation.to_owned()))
    }

    fn joints(&self, claim: &Claim) -> Result<Check, Unsupported> {
        let mut settings = RapierSettings::CONVERGED;
        let solves = PATHS * u64::from(JOINT_STEPS * settings.iterations);
        let particles = self.ours.particles.len() as u64;
        if (solves * particles).saturating_mul(solve_effort(particles)) > self.effort {
            return Err(Unsupported {
                reason: format!(
                    "left out: its {solves} linear solves would take longer than the runs"
                ),
            });
        }
        let most = MAX_ROWS.min(self.effort / ROW);
        let run =
            |settings: &RapierSettings| self.theirs(Some(Solver::rapier(*settings)), JOINT_STEPS);
        let mut coarse = run(&settings)?;
        let (path, bound, derivation) = self.reference(claim.method, settings.iterations)?;
        let joints = self.ours.springs.len() as u64 * u64::from(JOINT_STEPS * settings.iterations);
        while settings.pgs < MAX_SWEEPS && joints * u64::from(2 * settings.pgs) <= most {
            settings.pgs *= 2;
            let Ok(fine) = run(&settings) else { break };
            let moved = distance(&coarse, &fine);
            if let Some(moved) = moved.filter(|moved| *moved <= 0.1 * bound) {
                let derivation = format!("{derivation}; {} sweeps", settings.pgs);
                let judged = claim.judge(&path, &fine, bound, derivation);
                // A sweep takes off at least one part in `condition` of the error, so half of the
                // sweeps having moved it this far leave at most this much. A difference refutes
                // only if it is not that.
                let part = 1.0 / condition(&self.ours, settings.substep(self.timestep));
                let kept = (1.0 - part).powf(f64::from(settings.pgs) / 2.0);
                let left = moved.max(f64::EPSILON) * kept / (1.0 - kept);
                if judged.status != CheckStatus::Fail || left <= 0.1 * bound {
                    return Ok(judged);
                }
            }
            coarse = fine;
        }
        let message = format!(
            "rapier's sweeps did not converge within {}, more are not spent on a proof",
            settings.pgs
        );
        let measured = distance(&path, &coarse);
        let status = CheckStatus::Inconclusive;
        Ok(claim.check(status, measured, bound, derivation, message))
    }

    fn fall(&self, claim: &Claim) -> Result<Check, Unsupported> {
        let settings = RapierSettings::DEFAULT;
        let theirs = self.theirs(Some(Solver::rapier(settings)), JOINT_STEPS)?;
        let (path, bound, derivation) = self.reference(claim.method, settings.iterations)?;
        Ok(claim.judge(&path, &theirs, bound, derivation))
    }

    /// Our path at dt / n, the distance that rounding can move it, and the derivation of that.
    ///
    /// The amplification is measured, not estimated: the same path is taken again from starts one
    /// unit in the last place of the largest coordinate away, and ends `grown` away. Every
    /// substep rounds that much on both sides, and its solve loses up to its condition number. So
    /// the bound holds on stiff, unstable and chaotic scenes too. It is usually 30 to 200 times
    /// what is measured, since signs are random, and within a factor of 3 on the worst of thousands
    /// of random nets; it is looser on scenes small beside their distance from the origin, where
    /// both sides mostly round positions alike, but need not.
    fn reference(
        &self,
        method: &'static str,
        substeps: u32,
    ) -> Result<(Path, f64, String), Unsupported> {
        let h = self.timestep / f64::from(substeps);
        let ours = |scene: &Scene| Path::ours(scene, method, h, substeps, JOINT_STEPS);
        let path = ours(&self.ours)?;
        // The larger of two random directions: one alone may miss what grows.
        let mut grown = 0.0_f64;
        for seed in [2, 3] {
            let disturbed = ours(&disturbed(&self.ours, seed))?;
            grown = grown.max(distance(&path, &disturbed).unwrap_or(f64::INFINITY));
        }
        let condition = condition(&self.ours, h);
        let roundings = 2 * JOINT_STEPS * substeps;
        let bound = f64::from(roundings) * (grown + f64::EPSILON * condition);
        let derivation = format!(
            "{roundings} roundings, each growing to {grown:.1e} in these steps and losing \
             {condition:.1} ulp in the solve"
        );
        Ok((path, bound, derivation))
    }
}
