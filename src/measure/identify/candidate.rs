//! A scheme that a trajectory may follow: a step under certain forces, whole or in substeps, or applied in another
//! way than to all particles at once.

mod replayer;

pub use replayer::Replayer;

use super::altered::Around;
use super::bounce::{Bounce, Way, pressed};
use super::keeping::Keeping;
use super::step::Step;
use crate::integrators::{Coefficients, Method, PerStep, Remembered, Velocities, fixed};
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Scene, Stabilisation};
use std::borrow::Cow;
use std::sync::Arc;

/// The schemes that the soft step is where nothing touches: the second under constant forces alone.
pub(super) const SOFT_SCHEMES: [&str; 2] = ["linearized_implicit_material", "symplectic_euler"];
/// Forces that candidates share.
pub type Forces = Arc<dyn System + Send + Sync>;

/// A scheme to replay: known method, composed scheme, known mistake, or a guess at what went wrong.
#[derive(Clone)]
pub struct Candidate {
    /// As reports name it: `rk4`, `in_place(midpoint)`, `gravity_forgotten(rk4)`.
    pub id: String,
    /// Steps it takes inside one timestep.
    pub substeps: u32,
    /// Registry id of the method it is, or was meant to be.
    pub meant: &'static str,
    /// What it does, for people, where its name does not say it all.
    pub says: Option<Cow<'static, str>>,
    /// Whether it is a known mistake.
    pub mistake: bool,
    /// Length of the step it takes, in timesteps: 1, unless h itself is wrong.
    stretch: f64,
    /// The forces it really computes: the scene's, or altered ones.
    forces: Forces,
    step: Box<Step>,
    /// How the step is applied, where not to all particles at once.
    around: Option<Around>,
    /// Whether it steps each particle alone, which takes an evaluation of all forces for each.
    alone: bool,
    /// The step it begins with, where that is another.
    first: Option<Box<Step>>,
    scaling: Option<Box<Scaling>>,
    /// How it keeps rods, where not as the scene says.
    keeping: Option<Keeping>,
    /// What it does about obstacles, where that is beside its step.
    bounce: Option<Box<Bounce>>,
    /// Of steps that keep impulses of contact: what they keep at each row of a trajectory.
    remembered: Arc<Vec<Vec<Remembered>>>,
}

/// A factor on velocities, from a rate in 1/s and the length of a step in s.
pub type Factor = fn(f64, f64) -> f64;

/// A multiplication of velocities beside the step proper.
#[derive(Clone)]
pub struct Scaling {
    /// The factor, from the coordinate's `rate` and the length of the step in s.
    pub factor: Factor,
    /// A number of each coordinate: a rate in 1/s, or the factor itself.
    pub rates: Arc<[f64]>,
    pub at: ScaledAt,
}

/// When in a step velocities are multiplied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScaledAt {
    Start,
    /// After the kick of symplectic Euler, before its drift.
    Kick,
    End,
}

impl ScaledAt {
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Start => "before the kick",
            Self::Kick => "after the kick",
            Self::End => "at the end of the step",
        }
    }
}

impl Candidate {
    /// A candidate under these forces, in one step.
    pub fn new(forces: &Forces, step: Step, meant: &'static str) -> Self {
        Self {
            id: meant.to_owned(),
            substeps: 1,
            meant,
            says: None,
            mistake: false,
            stretch: 1.0,
            forces: Arc::clone(forces),
            step: Box::new(step),
            around: None,
            alone: false,
            first: None,
            scaling: None,
            keeping: None,
            bounce: None,
            remembered: Arc::default(),
        }
    }

    /// A registry method in this many substeps.
    pub fn method(system: &ParticleSystem, method: &'static Method, substeps: u32) -> Self {
        let forces: Forces = Arc::new(system.clone());
        Self::new(&forces, Step::Method(method), method.id).in_substeps(substeps)
    }

    /// Every registry method that is one of its own here in this many substeps, in the registry's order.
    pub(super) fn plain(system: &ParticleSystem, substeps: u32) -> impl Iterator<Item = Self> {
        let kinds = system.kinds();
        let methods = fixed()
            .iter()
            .filter(move |method| method.is_its_own(kinds));
        methods.map(move |method| Self::method(system, method, substeps))
    }

    /// The same in this many substeps.
    pub fn in_substeps(self, substeps: u32) -> Self {
        Self { substeps, ..self }
    }

    /// The same under another name.
    pub fn named(self, id: impl Into<String>, says: impl Into<Cow<'static, str>>) -> Self {
        Self {
            id: id.into(),
            says: Some(says.into()),
            ..self
        }
    }

    /// The same, as a known mistake.
    pub fn mistaken(self) -> Self {
        Self {
            mistake: true,
            ..self
        }
    }

    /// The same scheme under other forces; those of rods are as it has them.
    pub fn under(&self, system: &ParticleSystem) -> Self {
        let forces = match &self.keeping {
            Some(keeping) => keeping.forces(system.clone()),
            None => system.clone(),
        };
        Self {
            forces: Arc::new(forces),
            keeping: self.keeping.as_ref().and_then(|by| by.on(system)),
            ..self.clone()
        }
    }

    /// The same scheme under these forces with rods kept in another way.
    pub(super) fn keeping(self, system: &ParticleSystem, keeping: &Keeping) -> Self {
        let keeping = Some(keeping.clone());
        Self { keeping, ..self }.under(system)
    }

    /// The same scheme with contact treated so; None where its forces are not the scene's and would have to be.
    pub(super) fn bouncing(
        &self,
        scene: &Scene,
        system: &ParticleSystem,
        bounce: &Bounce,
    ) -> Option<Self> {
        let own = !self.mistake && self.scaling.is_none();
        let right = ["newton", "coulomb"] == [bounce.restitution.id, bounce.friction.id];
        let alters = bounce.alters();
        let mut same = match bounce.way.does {
            Way::Event if right && !alters => self.clone(),
            Way::Event => {
                let law = bounce.law();
                let struck = bounce.met_by(system);
                self.under(&struck.with_obstacles(|all| Some(all.struck_by(law))))
            }
            Way::Force { .. } => self.under(&pressed(scene, system, bounce)?),
            Way::Soft if !self.has_soft(system) => return None,
            Way::Soft => Self {
                bounce: Some(Box::new(*bounce)),
                ..self.clone()
            },
            Way::Of(method, _) if self.meant != method => return None,
            Way::Once(_) | Way::Of(..) | Way::Within(_) | Way::Never => {
                let forced = if alters {
                    self.under(&bounce.met_by(system))
                } else {
                    self.clone()
                };
                Self {
                    bounce: Some(Box::new(*bounce)),
                    ..forced
                }
            }
        };
        if bounce.mistakes().next().is_some() {
            let says = same.says.iter().map(|says| format!("{says}; "));
            let says = says.collect::<String>();
            same.says = Some(format!("{says}at contact it {}", bounce.says()).into());
            same.mistake = true;
        }
        let kept = !alters && (right || same.bounce.is_some());
        (own || kept).then_some(same)
    }

    /// Whether the soft step is this scheme where nothing touches. Contact of particles with each other is not written here.
    fn has_soft(&self, system: &ParticleSystem) -> bool {
        let constant = system.effects().iter().all(|(row, _)| row.constant);
        let schemes = &SOFT_SCHEMES[..if constant { 2 } else { 1 }];
        let plain = self.says.is_none() && !self.remembers() && self.stretch == 1.0;
        let among = system.obstacles().is_some_and(Obstacles::among_particles);
        let method = self.step.method().filter(|_| plain && !among);
        method.is_some_and(|method| schemes.contains(&method.id))
    }

    /// Whether its steps keep impulses of contact.
    pub(super) fn is_soft(&self) -> bool {
        let bounce = self.bounce.as_ref();
        bounce.is_some_and(|bounce| matches!(bounce.way.does, Way::Soft))
    }

    /// The same, with what its steps keep at each row.
    pub(super) fn remembering(self, remembered: Arc<Vec<Vec<Remembered>>>) -> Self {
        Self { remembered, ..self }
    }

    /// What its steps keep at row `k`.
    pub(super) fn remembered(&self, k: usize) -> &[Remembered] {
        self.remembered.get(k).map_or(&[], Vec::as_slice)
    }

    /// The same scheme under another candidate's forces, in its steps, with rods kept as that does.
    pub(super) fn forced_as(&self, other: &Self) -> Self {
        Self {
            forces: Arc::clone(&other.forces),
            stretch: other.stretch,
            keeping: other.keeping.clone(),
            ..self.clone()
        }
    }

    /// The same with steps of `factor` h while rows stay h apart: not substeps, of which several
    /// make a whole step.
    pub fn stretched(&self, factor: f64) -> Self {
        Self {
            stretch: self.stretch * factor,
            ..self.clone()
        }
    }

    /// The same with velocities multiplied beside it.
    pub fn scaled(self, scaling: Scaling) -> Self {
        Self {
            scaling: Some(Box::new(scaling)),
            ..self
        }
    }

    /// The same with its step applied so.
    pub fn around(self, around: Option<Around>) -> Self {
        Self { around, ..self }
    }

    /// The same, one particle after the other.
    pub(super) fn each_alone(self, around: Around) -> Self {
        Self {
            around: Some(around),
            alone: true,
            ..self
        }
    }

    /// The same from rows that do not begin as the scene does: those are begun already.
    pub(super) fn begun_before(self) -> Self {
        self.begun(None)
    }

    /// The same, begun with another step.
    pub(super) fn begun(self, first: Option<Step>) -> Self {
        let first = first.map(Box::new);
        Self { first, ..self }
    }

    /// Whether its step depends on the state one step before, or on whether there is one: it can be replayed only
    /// from the first state and from states whose predecessor is known.
    pub fn remembers(&self) -> bool {
        self.first.is_some() || self.step.looks_back()
    }

    /// About how many roundings of positions or velocities one of its whole steps makes.
    pub fn roundings(&self) -> u32 {
        let stages = match self.step.method() {
            // Force, matrix, factors and their solve; iterations before the last are corrected.
            Some(_) if self.solves() => 4,
            Some(method) => match method.evaluations {
                // The force, and what it is added to.
                PerStep::Exactly(n) => 2 * n.max(1),
                PerStep::PerIteration { plus } => 2 * (1 + plus),
            },
            // Taken as many as RK4's: no other step has more.
            None => 8,
        };
        stages.saturating_mul(self.substeps.max(1))
    }

    /// Whether its steps solve linear systems, which costs as much as many that do not.
    pub fn solves(&self) -> bool {
        self.step.solves() || self.is_soft()
    }

    /// Whether it is a tableau that takes forces at several times.
    pub(super) fn has_stages(&self) -> bool {
        let coefficients = self.step.method().map(|method| method.coefficients);
        matches!(coefficients, Some(Coefficients::Tableau(t)) if t.c.iter().any(|c| *c != 0.0))
    }

    /// Whether its steps end on rods by themselves.
    pub(super) fn keeps_rods(&self) -> bool {
        let coefficients = self.step.method().map(|method| method.coefficients);
        matches!(coefficients, Some(Coefficients::Rattle(_)))
    }

    /// Whether its velocities are what positions moved by in the step before, over h.
    pub(super) fn moves_by_differences(&self) -> bool {
        let by = |keeping: &Keeping| matches!(keeping, Keeping::By(kept, _) if kept.differences());
        self.substeps == 1 && self.keeping.as_ref().is_some_and(by)
    }

    /// Whether programs find its velocities from positions: they are then rounded as those, over h.
    pub(super) fn differences(&self) -> bool {
        match &self.keeping {
            Some(Keeping::By(kept, _)) => kept.differences() || self.around.is_some(),
            _ => self.keeps_rods() && self.forces.rods().is_some(),
        }
    }

    /// Whether its steps end without velocity along rods that are stabilised so.
    fn ends_still(&self, by: Stabilisation) -> bool {
        let coefficients = self.step.method().map(|method| method.coefficients);
        match coefficients {
            Some(Coefficients::Rattle(velocities)) => velocities == Velocities::Still,
            _ => by == Stabilisation::Project,
        }
    }

    /// What it does beside its step, and about which obstacles of these forces.
    fn beside<'a>(&'a self, system: &'a dyn System) -> Option<(&'a Bounce, &'a Obstacles)> {
        self.bounce.as_deref().zip(system.obstacles())
    }

    /// The obstacles that it meets; None where contact is a force alone.
    pub(super) fn meets(&self) -> Option<&Obstacles> {
        self.forces.obstacles()
    }

    /// The obstacles that it locates impacts with, to a part of a step.
    pub(super) fn locates(&self) -> Option<&Obstacles> {
        self.forces.obstacles().filter(|_| self.bounce.is_none())
    }

    /// Multiplies the velocities, if this is when. `x` is where the step began.
    fn scale(&self, at: ScaledAt, h: f64, x: &[f64], state: &mut State) {
        let Some(scaling) = self.scaling.as_ref().filter(|s| s.at == at) else {
            return;
        };
        for (i, rate) in scaling.rates.iter().enumerate() {
            let factor = (scaling.factor)(*rate, h);
            state.v[i] *= factor;
            if at == ScaledAt::Kick {
                // The drift was h v.
                state.x[i] = x[i] + factor * (state.x[i] - x[i]);
            }
        }
    }

    /// What a step costs besides its forces, in evaluations of them.
    pub(super) fn keeping_effort(&self) -> u64 {
        self.keeping.as_ref().map_or(0, Keeping::effort)
    }

    /// Whether each particle takes its step alone.
    pub(super) fn steps_each_alone(&self) -> bool {
        self.alone
    }

    /// Whether its steps end when a residual is small, not when a formula is through.
    pub fn iterates(&self) -> bool {
        let whole = self.step.method().filter(|_| self.around.is_none());
        whole.is_some_and(|method| matches!(method.evaluations, PerStep::PerIteration { .. }))
    }

    /// Its name in the reports' `equivalent`: the id, and after a slash the substeps if there are several.
    pub fn label(&self) -> String {
        label(&self.id, self.substeps)
    }
}

/// An id, and after a slash the substeps if there are several.
pub(super) fn label(id: &str, substeps: u32) -> String {
    match substeps {
        0 | 1 => id.to_owned(),
        n => format!("{id}/{n}"),
    }
}
