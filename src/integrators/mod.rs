//! Time-stepping methods: a file for each family, and for each method a row of facts in [`REGISTRY`].

pub mod adaptive;
mod amplification;
pub mod events;
mod facts;
mod implicit;
mod newton;
pub(crate) mod nystrom;
mod rapier_contact;
mod rattle;
mod runge_kutta;
mod splitting;
mod velocity_flow;

pub use amplification::{Amplification, Rational};
pub(crate) use amplification::{bisect, map};
pub use facts::MethodRow;
pub(crate) use facts::is_exact;
pub use implicit::{Implicit, ImplicitScheme};
pub use rapier_contact::{RapierContact, Remembered, Softness, Ties};
pub use rattle::{Rattle, Velocities};
pub use runge_kutta::{RungeKutta, Tableau};
pub use splitting::{DampingTreatment, Splitting, Stage};

use crate::physics::constraints::RodError;
use crate::physics::constraints::contact::{BlowError, Obstacles, TooManyTouch};
use crate::physics::{ForceKinds, Refused, State, System};
use crate::scene::Stabilisation;
use crate::vector::axpy;
use adaptive::Pair;
use std::sync::LazyLock;

/// Advances a state by one step.
///
/// An integrator keeps scratch memory and may keep the last force evaluation. It serves one system, and
/// accepts any state at any time: it uses a kept evaluation only if that fits the state.
pub trait Integrator: Send {
    /// Advances `state` from t to t + h: positions, velocities and work. On an error the state is
    /// left as it was.
    ///
    /// # Errors
    /// [`StepError`] when an implicit step cannot be solved, or when the integrator does not
    /// [accept](Self::takes) the system's forces.
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError>;

    /// The kinds of forces it accepts: those it integrates to its order. Others are refused before a run
    /// starts ([`ParticleSystem::admits`](crate::physics::ParticleSystem::admits)).
    fn takes(&self) -> ForceKinds {
        ForceKinds::ANY
    }

    /// Forgets what it keeps of the last step: the next one is under other forces.
    fn forget(&mut self) {}

    /// Whether its steps end on the rods of a system, so that nothing has to be done about them.
    fn keeps_rods(&self) -> bool {
        false
    }

    /// Whether its steps deal with the obstacles of a system themselves, so that no event is located.
    fn keeps_contact(&self) -> bool {
        false
    }

    /// Linear systems solved so far; 0 for explicit methods.
    fn linear_solves(&self) -> u64 {
        0
    }

    /// Iterations of Newton's method so far; 0 for methods that do not iterate. Not to be confused
    /// with [`linear_solves`](Self::linear_solves), of which a hard iteration may take several.
    fn newton_iterations(&self) -> u64 {
        0
    }
}

/// Why a step could not be taken.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StepError {
    #[error(transparent)]
    Refused(#[from] Refused),
    #[error(transparent)]
    Rods(#[from] RodError),
    #[error(transparent)]
    TooManyTouch(#[from] TooManyTouch),
    #[error(transparent)]
    Blows(#[from] BlowError),
    #[error(
        "Newton's iteration stopped at a relative residual of {residual:.1e} after {iterations} \
         iterations (wanted {tolerance:.0e}), largest at particle {particle}: a smaller timestep \
         helps"
    )]
    NotConverged {
        iterations: u32,
        residual: f64,
        tolerance: f64,
        /// The particle with the largest residual.
        particle: usize,
    },
    #[error(
        "the implicit step's matrix cannot be factorised: the stiffness is indefinite at this state, \
         with the largest residual at particle {particle}"
    )]
    Singular {
        /// The particle with the largest residual.
        particle: usize,
    },
    #[error(
        "the damping is too stiff for its exact flow at this step, fastest at particle {particle}: a \
         smaller timestep helps"
    )]
    DampingTooStiff {
        /// The particle with the largest acceleration.
        particle: usize,
    },
    #[error(
        "the step fell below the spacing of time at t = {t} s, with the largest error at particle \
         {particle}: the forces are not smooth there, or the motion explodes"
    )]
    TooShort {
        /// The time at which the step would start, s.
        t: f64,
        /// The particle with the largest estimated error.
        particle: usize,
    },
    #[error(
        "more impacts and other events in one step than can be located, at t = {t} s: a particle is squeezed between \
         obstacles, or bounces on and on"
    )]
    TooManyEvents {
        /// s.
        t: f64,
    },
    #[error("the step left the range of finite numbers at particle {particle}")]
    NotFinite {
        /// The first particle with a number that is not finite.
        particle: usize,
    },
}

/// The facts of a method, which reports state and laws test. [`Method::new`] derives them from the
/// coefficients.
#[derive(Clone, Copy)]
pub struct Method {
    /// The id scenes, reports and the command line use.
    pub id: &'static str,
    pub name: &'static str,
    /// Order of the global error on smooth problems without damping.
    pub order: u32,
    /// Order with dampers, drag or a magnetic field.
    pub order_damped: u32,
    /// Whether it preserves the symplectic form on undamped problems.
    pub symplectic: bool,
    /// Whether stepping h, flipping velocities and stepping h again returns to the start.
    pub reversible: bool,
    pub evaluations: PerStep,
    /// Stability and energy on x'' = -w² x, with z = h w.
    pub oscillator: OscillatorFacts,
    /// The coefficients it steps with.
    pub coefficients: Coefficients,
    /// The one-step map on any linear system; `oscillator` summarises it.
    pub amplification: Amplification,
    /// Whether it follows free fall without any error but rounding, at every step size.
    pub exact: bool,
    /// Paper or textbook.
    pub source: &'static str,
    /// What it must not be confused with.
    pub not: &'static str,
}

/// The coefficients of a method, which also decide its stepper.
#[derive(Debug, Clone, Copy)]
pub enum Coefficients {
    /// An explicit Runge-Kutta method.
    Tableau(Tableau),
    /// A product of kicks and drifts, in the order they are applied.
    Composition(&'static [Stage], DampingTreatment),
    /// Velocity Verlet with impulses along rods.
    Rattle(Velocities),
    /// A scheme of implicit stage equations.
    Implicit(ImplicitScheme),
    /// An explicit Runge-Kutta method with an estimate of its error.
    Pair(Pair),
}

impl Method {
    /// The kinds of forces it accepts, as [`Integrator::takes`].
    pub const fn takes(&self) -> ForceKinds {
        match self.coefficients {
            Coefficients::Tableau(_) | Coefficients::Pair(_) => ForceKinds::ANY,
            Coefficients::Composition(stages, damping) => damping.takes_in(stages),
            Coefficients::Rattle(_) => ForceKinds::LINEAR.with(ForceKinds::CONSTRAINED),
            Coefficients::Implicit(scheme) => scheme.takes(),
        }
    }

    /// Whether it has steps of its own under forces of these kinds: it takes them, and is not another row's map.
    /// Boris' method is position Verlet where no force depends on velocity, RATTLE velocity Verlet without rods.
    pub fn is_its_own(&self, kinds: ForceKinds) -> bool {
        let same = match self.coefficients {
            Coefficients::Composition(_, DampingTreatment::Boris) => !kinds.depends_on_velocity(),
            Coefficients::Rattle(_) => !kinds.has(ForceKinds::CONSTRAINED),
            _ => false,
        };
        kinds.without(self.takes()) == ForceKinds::NONE && !same
    }

    /// The facts of the steps it takes under forces of these kinds. On rods every kick is explicit, since their forces
    /// depend on the velocity of the moment; RATTLE's, which leave them out, are not.
    pub fn under(&self, kinds: ForceKinds) -> Self {
        match self.coefficients {
            Coefficients::Composition(stages, _) if kinds.has(ForceKinds::CONSTRAINED) => {
                facts::of_explicit_kicks(self, stages)
            }
            _ => *self,
        }
    }

    /// Its order on smooth forces of a system's kinds.
    ///
    /// An explicit kick's errors in the forces of rods lie across them, where a projection takes them away: with it a
    /// composition keeps its order, without it has that of dampers.
    ///
    /// On obstacles that bend, methods that take no rods slide on the plane that touches them, and are moved back as by
    /// RATTLE, which is of order 2.
    pub fn order_on<S: System + ?Sized>(&self, system: &S) -> u32 {
        let by_impulses = |all: &&Obstacles| all.penalty().is_none();
        let obstacles = system.obstacles().filter(by_impulses);
        let bends = obstacles.is_some_and(Obstacles::bend);
        let most = if bends && !self.takes().has(ForceKinds::CONSTRAINED) {
            2
        } else {
            u32::MAX
        };
        let (kinds, rods) = (system.kinds(), system.rods());
        let of = self.under(kinds);
        let kicks = matches!(self.coefficients, Coefficients::Composition(..));
        let projected = rods.is_none_or(|rods| rods.stabilisation() == Stabilisation::Project);
        let own = if kinds.depends_on_velocity() || (kicks && !projected) {
            of.order_damped
        } else {
            of.order
        };
        own.min(most)
    }

    /// The adaptive pair; None for a method of fixed steps.
    pub const fn pair(&self) -> Option<&Pair> {
        match &self.coefficients {
            Coefficients::Pair(pair) => Some(pair),
            _ => None,
        }
    }

    /// A fresh integrator of fixed steps; for a pair, its advancing formula
    /// ([`Adaptive`](adaptive::Adaptive) is the stepper that chooses its steps).
    pub fn build(&self, settings: &Settings) -> Box<dyn Integrator> {
        self.coefficients.build(settings)
    }
}

impl Coefficients {
    /// The stepper of their family, as [`Method::build`].
    pub fn build(self, settings: &Settings) -> Box<dyn Integrator> {
        match self {
            Self::Pair(pair) => Box::new(RungeKutta::new(pair.tableau)),
            Self::Tableau(tableau) => Box::new(RungeKutta::new(tableau)),
            Self::Composition(stages, damping) => Box::new(Splitting::new(stages, damping)),
            Self::Rattle(velocities) => Box::new(Rattle::new(velocities)),
            Self::Implicit(scheme) => Box::new(Implicit::new(scheme, settings)),
        }
    }
}

impl std::fmt::Debug for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Method").field("id", &self.id).finish()
    }
}

/// The force evaluations a step takes on an undamped system, after the first step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PerStep {
    Exactly(u32),
    /// One for each Newton iteration, and `plus` more: one to see that each stage has converged, and those
    /// of the explicit part of a method that has one.
    PerIteration {
        plus: u32,
    },
}

/// Stability and energy of a method on the undamped linear oscillator. Not to be confused with
/// [`systems::Oscillator`](crate::conformance::systems::Oscillator), which is one.
#[derive(Debug, Clone, Copy)]
pub struct OscillatorFacts {
    pub stable: Stable,
    pub energy: EnergyLaw,
}

/// The z = h w for which the oscillator's amplitude stays bounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stable {
    Never,
    Below(f64),
    /// Stable at every step for linear forces; non-linear ones can still break it.
    Always,
    /// Motion along springs is stable at every step. Motion across them, whose stiffness the method leaves
    /// out, is stable below `across` only.
    AlwaysAlong {
        across: f64,
    },
}

/// A function of z = h w.
pub type OfZ<T> = &'static (dyn Fn(f64) -> T + Send + Sync);

/// The law of the oscillator's energy, as a function of z = h w. The formulas are for readers.
#[derive(Clone, Copy)]
pub enum EnergyLaw {
    /// Every step multiplies the energy by this factor.
    Factor {
        factor: OfZ<f64>,
        formula: &'static str,
    },
    /// From rest, the energy stays between these multiples of its initial value for ever.
    Band {
        band: OfZ<(f64, f64)>,
        formula: &'static str,
    },
    /// The energy is bounded for ever; the band has no short formula.
    Bounded,
}

impl std::fmt::Debug for EnergyLaw {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Factor { formula, .. } | Self::Band { formula, .. } => formula,
            Self::Bounded => "bounded",
        })
    }
}

/// Settings of a fresh integrator. Not to be confused with those of rapier,
/// [`RapierSettings`](crate::solvers::rapier::RapierSettings).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Relative residual at which Newton's iteration stops.
    pub tolerance: f64,
    /// Newton's iterations after which a solve has failed. Quadratic convergence takes four to six, a path around
    /// maxima of the incremental potential a few dozen, and one along a curved valley hundreds.
    pub iterations: u32,
}

impl Settings {
    /// The settings with the tolerance that a scene states, if it states one.
    pub fn stated(tolerance: Option<f64>) -> Self {
        Self {
            tolerance: tolerance.unwrap_or(Self::default().tolerance),
            ..Self::default()
        }
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            tolerance: 1e-12,
            iterations: 2_000,
        }
    }
}

/// The methods that most programs have; they run by default beside a scene's own.
pub const USUAL: [&str; 6] = [
    "explicit_euler",
    "symplectic_euler",
    "midpoint",
    "velocity_verlet",
    "rk4",
    "implicit_euler",
];

/// Every method, in the order reports list them: first those of [`fixed`] steps, then [`pairs`].
pub static REGISTRY: LazyLock<Vec<Method>> = LazyLock::new(|| {
    let rows = [
        runge_kutta::EXPLICIT_EULER,
        splitting::SYMPLECTIC_EULER,
        splitting::SYMPLECTIC_EULER_DRIFT_FIRST,
        runge_kutta::MIDPOINT,
        runge_kutta::HEUN,
        runge_kutta::RALSTON,
        splitting::VELOCITY_VERLET,
        splitting::POSITION_VERLET,
        splitting::BORIS,
        rattle::RATTLE,
        rattle::SHAKE,
        runge_kutta::RK3,
        runge_kutta::SSPRK3,
        runge_kutta::RK4,
        splitting::YOSHIDA4,
        splitting::PEFRL,
        implicit::IMPLICIT_EULER,
        implicit::LINEARIZED_IMPLICIT_PREDICTED,
        implicit::LINEARIZED_IMPLICIT_AT_START,
        implicit::LINEARIZED_IMPLICIT_MATERIAL,
        implicit::IMPLICIT_MIDPOINT,
        implicit::TRAPEZOIDAL,
        implicit::TR_BDF2,
        adaptive::DORMAND_PRINCE_54,
        adaptive::DOP853,
    ];
    rows.map(Method::new).to_vec()
});

/// Short ids, each with the id of the row it means. Scenes and command lines may use either; reports use the
/// row's.
pub const ALIASES: &[(&str, &str)] = &[("linearized_implicit", "linearized_implicit_predicted")];

/// The id of the row that an id means: its own, unless it is one of the [`ALIASES`].
pub fn meant(id: &str) -> &str {
    let alias = ALIASES.iter().find(|(short, _)| *short == id);
    alias.map_or(id, |(_, row)| row)
}

/// The method of this id.
pub fn find(id: &str) -> Option<&'static Method> {
    REGISTRY.iter().find(|method| method.id == meant(id))
}

/// The methods of fixed steps. They are maps of a state, so they can be replayed and have a stability limit.
pub fn fixed() -> &'static [Method] {
    halves().0
}

/// The adaptive pairs, which choose their steps from a tolerance.
pub fn pairs() -> &'static [Method] {
    halves().1
}

fn halves() -> (&'static [Method], &'static [Method]) {
    let fixed = REGISTRY.partition_point(|method| method.pair().is_none());
    REGISTRY.split_at(fixed)
}

/// The ids of these methods.
pub fn ids(methods: &[Method]) -> Vec<&'static str> {
    methods.iter().map(|method| method.id).collect()
}

/// Refuses forces that the integrator does not accept, and would silently get wrong.
fn refuse(integrator: &dyn Integrator, system: &dyn System) -> Result<(), Refused> {
    let kinds = system.kinds().without(integrator.takes());
    if kinds == ForceKinds::NONE {
        return Ok(());
    }
    Err(Refused {
        method: "this integrator".to_owned(),
        kinds,
        effects: Vec::new(),
    })
}

/// Whether two positions are the same where motions are not given: a given one depends on the time alone.
fn agree(system: &dyn System, a: &[f64], b: &[f64]) -> bool {
    let free = || {
        let both = a.iter().zip(b).zip(system.inverse_mass());
        a.len() == b.len() && both.into_iter().all(|((a, b), w)| a == b || *w == 0.0)
    };
    a == b || (system.kinds().has(ForceKinds::DRIVEN) && free())
}

/// Resizes scratch memory on first use or when the system's size changed.
fn fit(buffer: &mut Vec<f64>, n: usize) {
    if buffer.len() != n {
        *buffer = vec![0.0; n];
    }
}

/// The largest magnitude; 0 for no values.
fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    let magnitudes = values.into_iter().map(|c| c.abs());
    magnitudes.fold(0.0, f64::max)
}

/// The particle with the largest component in these coordinates, or the first that is not finite.
fn worst_particle(values: &[f64]) -> usize {
    if let Some(at) = values.iter().position(|c| !c.is_finite()) {
        return at / 3;
    }
    let mut worst = (0, 0.0);
    for (at, c) in values.iter().enumerate() {
        if c.abs() > worst.1 {
            worst = (at / 3, c.abs());
        }
    }
    worst.0
}
