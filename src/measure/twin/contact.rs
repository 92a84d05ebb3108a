//! The proof of contact: each step that rapier takes from the scene's start is the step of ours from the same state.

use super::start::condition;
use super::{BLUNT, Claim, Pair, ROW};
use crate::measure::identify::solve_effort;
use crate::measure::{Check, CheckStatus};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::Scene;
use crate::solvers::rapier::RapierSettings;
use crate::solvers::{Engine, Setting, Solver, Unsupported, advance, find};

/// The most steps of a proof, and the steps with contact after which it is enough.
const STEPS: u64 = 4096;
const ENOUGH: u32 = 64;

/// rapier's balls are of this radius or so, m, and its gaps as precise.
const USUAL: f64 = 0.1;

/// What the steps of a proof have shown.
#[derive(Default)]
struct Shown {
    steps: u32,
    /// With contact, and among them those where rounding decides.
    pressing: u32,
    ties: u32,
    /// The largest distance, as in the other proofs, beyond what rounding decides.
    apart: f64,
    /// The largest coordinate, m, and speed, m/s.
    size: f64,
    speed: f64,
}

impl Pair {
    /// Each step begins with rapier's state and the impulses of ours, so that what one step rounds grows in no other.
    pub(super) fn contact(&self, claim: &Claim) -> Result<Check, Unsupported> {
        let [ours, theirs] = &self.touching;
        let mut settings = RapierSettings::CONVERGED;
        settings.stabilization = 1;
        let h = self.timestep;
        let system = ParticleSystem::new(ours).driven_as(|drive| drive.straight(h));
        // The row says what it does not take.
        find(claim.method)
            .ok_or_else(|| Unsupported {
                reason: "there is no such engine".to_owned(),
            })?
            .engine(ours, &system, &Setting::step(h))?;
        let steps = self.steps(ours, &settings)?;
        let mut world = Solver::rapier(settings).engine(
            theirs,
            &ParticleSystem::new(theirs),
            &Setting::step(h),
        )?;
        let radii = ours.particles.iter().map(|particle| particle.radius);
        let size = radii.fold(USUAL, f64::max);
        let shown = match Shown::of(size, &mut *world, &system, &settings, h, steps) {
            Ok(shown) => shown,
            Err(reason) => {
                let (status, none) = (CheckStatus::Inconclusive, String::new());
                return Ok(claim.check(status, None, 0.0, none, reason));
            }
        };
        // Gaps are rounded coordinates, and velocities close them in a substep; each of those rounds again.
        let substeps = f64::from(settings.iterations);
        let substep = settings.substep(h);
        let roundings = 8.0 * substeps * condition(&self.ours, substep);
        let far = shown.size / (substep * shown.speed.max(f64::MIN_POSITIVE));
        let bound = roundings * f64::EPSILON * (1.0 + far);
        let derivation = format!(
            "{roundings:.0} roundings of a step, of velocities and of gaps over a substep ({far:.0e} as large)"
        );
        let (status, message) = shown.judge(claim, bound, ours);
        Ok(claim.check(status, Some(shown.apart), bound, derivation, message))
    }

    /// How many steps the proof may take.
    fn steps(&self, scene: &Scene, settings: &RapierSettings) -> Result<u64, Unsupported> {
        let particles = scene.particles.len() as u64;
        let rows = scene.springs.len() as u64 + particles * scene.colliders.len() as u64;
        let sweeps = u64::from(settings.pgs);
        let each = particles * solve_effort(particles) + rows * sweeps * ROW;
        let within = self.effort / (u64::from(settings.iterations) * each).max(1);
        if within < u64::from(ENOUGH) {
            return Err(Unsupported {
                reason: "left out: its linear solves would take longer than the runs".to_owned(),
            });
        }
        Ok(within.min(STEPS).min(scene.steps(self.timestep)))
    }
}

impl Shown {
    /// # Errors
    /// Says why a step of ours could not be taken.
    fn of(
        size: f64,
        world: &mut dyn Engine,
        system: &ParticleSystem,
        settings: &RapierSettings,
        h: f64,
        steps: u64,
    ) -> Result<Self, String> {
        let mut contact = settings.contact();
        let mut shown = Self {
            size,
            ..Self::default()
        };
        for step in 0..steps {
            let mut own = world.state().clone();
            contact.resume(&own);
            let end = (step + 1) as f64 * h;
            advance(&mut contact, system, h, end, &mut own)
                .map_err(|error| format!("rapier_contact could not take these steps: {error}"))?;
            world.step().map_err(|error| error.to_string())?;
            let ties = contact.ties();
            shown.steps += 1;
            shown.pressing += u32::from(!contact.kept().is_empty());
            shown.ties += u32::from(ties != Default::default());
            // A spring pulls otherwise where its end is elsewhere.
            let pulled = ties.position / settings.substep(h);
            shown.compare(
                system,
                &own,
                world.state(),
                [ties.position, ties.velocity + pulled * shown.pull(system)],
            );
            if shown.pressing >= ENOUGH || !shown.apart.is_finite() {
                break;
            }
        }
        Ok(shown)
    }

    /// Whether forces other than constant ones act.
    fn pull(&self, system: &ParticleSystem) -> f64 {
        let constant = system.effects().iter().all(|(row, _)| row.constant);
        if constant { 0.0 } else { 1.0 }
    }

    fn compare(
        &mut self,
        system: &ParticleSystem,
        ours: &State,
        theirs: &State,
        allowed: [f64; 2],
    ) {
        for i in (0..ours.x.len()).filter(|i| system.inverse_mass()[*i] > 0.0) {
            self.size = self.size.max(theirs.x[i].abs());
            self.speed = self.speed.max(theirs.v[i].abs());
        }
        let units = [self.size, self.speed];
        let parts = [(&ours.x, &theirs.x), (&ours.v, &theirs.v)];
        for ((ours, theirs), (unit, allowed)) in
            parts.into_iter().zip(units.into_iter().zip(allowed))
        {
            for i in (0..ours.len()).filter(|i| system.inverse_mass()[*i] > 0.0) {
                let beyond = (ours[i] - theirs[i]).abs() - allowed;
                if beyond.is_nan() {
                    self.apart = f64::INFINITY;
                } else if beyond > 0.0 {
                    self.apart = self.apart.max(beyond / unit);
                }
            }
        }
    }

    fn judge(&self, claim: &Claim, bound: f64, scene: &Scene) -> (CheckStatus, String) {
        let (subject, method) = (claim.subject, claim.method);
        let Self {
            steps, pressing, ..
        } = self;
        let apart = self.apart;
        if *pressing == 0 && apart <= bound {
            let message =
                format!("nothing touches in {steps} steps: they prove nothing of contact");
            return (CheckStatus::Inconclusive, message);
        }
        if bound.is_nan() || bound > BLUNT {
            let message = format!(
                "rounding alone may move a step of this scene by {bound:.0e}: it proves nothing"
            );
            return (CheckStatus::Inconclusive, message);
        }
        let decided = match self.ties {
            0 => String::new(),
            1 => "; in one of them rounding decides whether a gap is closed".to_owned(),
            many => format!("; in {many} of them rounding decides whether a gap is closed"),
        };
        if apart <= bound {
            let message = format!(
                "{subject} is {method} to {apart:.0e}, rounding ({bound:.0e}), in {steps} steps, {pressing} with \
                 contact{decided}"
            );
            return (CheckStatus::Pass, message);
        }
        let away =
            format!("{subject} is {apart:.0e} away from {method}; rounding explains {bound:.0e}");
        match excuse(scene) {
            Some(why) => (CheckStatus::Inconclusive, format!("{away}: {why}")),
            None => (CheckStatus::Fail, away),
        }
    }
}

/// Why a difference need not be a fault.
fn excuse(scene: &Scene) -> Option<String> {
    let mut springs = vec![0; scene.particles.len()];
    for spring in &scene.springs {
        for end in spring.ends {
            springs[end] += 1;
        }
    }
    let free = |end: &usize| !scene.particles[*end].fixed;
    let joined = |ends: [usize; 2]| ends.iter().all(free);
    let net = scene.springs.iter().any(|spring| joined(spring.ends));
    let several = (0..springs.len()).any(|at| free(&at) && springs[at] > 1);
    if net || several {
        return Some(format!(
            "its sweeps need not have converged within {}",
            RapierSettings::CONVERGED.pgs
        ));
    }
    let flat = scene.colliders.iter().all(|one| one.plane.is_some());
    if !flat
        && scene
            .particles
            .iter()
            .any(|one| !one.fixed && one.radius == 0.0)
    {
        return Some(
            "rapier has no normal for a particle without extent that is exactly on a surface"
                .to_owned(),
        );
    }
    if !flat {
        return Some("rapier stops what is fast at obstacles that are not planes".to_owned());
    }
    (scene.colliders.len() > 1)
        .then(|| "rapier sweeps the contacts of one particle in an order of its own".to_owned())
}
