//! How a program treats contact: what it does to particles that are inside obstacles, or about to be, beside the free
//! step of any method. A treatment is a row of each of four tables.

mod list;
mod penalty;
mod rows;

pub(super) use list::all;
pub(super) use penalty::pressed;
pub use rows::{FRICTIONS, PLACES, RESTITUTIONS, WAYS, treatments};

use crate::integrators::StepError;
use crate::physics::State;
use crate::physics::constraints::contact::{Beside, Hit, ImpactLaw, Obstacles, Surface};
use crate::vector::axpy;
use std::fmt;

type Stepped = Result<(), StepError>;
/// The step of a method as if there were no obstacles.
pub(super) type Free<'a> = dyn FnMut(&mut State) -> Stepped + 'a;

/// One row of a table: what a program does in one respect.
#[derive(Debug)]
pub struct Row<T> {
    /// As reports name it.
    pub id: &'static str,
    /// What it does, after "at contact it"; of a mistake also what to change. Empty for what is right.
    pub says: &'static str,
    pub mistake: bool,
    pub does: T,
}

/// When and how steps and obstacles meet.
#[derive(Debug, Clone, Copy)]
pub enum Way {
    /// At the instant of each impact, within the step.
    Event,
    /// Once a step, beside it.
    Once(fn(&Bounce, &Obstacles, f64, &mut State, &mut Free) -> Stepped),
    /// By a force while a particle is inside.
    Force {
        /// Whether a damper may pull it back while it leaves.
        pulls: bool,
    },
    /// Not at all.
    Never,
}

/// How far what is inside is moved out, m, from its gap, m, and the restitution.
pub type Lift = fn(f64, f64) -> f64;

/// What the normal velocity gains.
#[derive(Debug, Clone, Copy)]
pub struct Restitution {
    /// m/s.
    pub gains: fn(&Hit) -> f64,
    /// Whether it acts on what already leaves, too.
    pub leaving: bool,
}

/// What the sliding speed loses, m/s, where the normal velocity gains so much.
pub type Friction = fn(&Hit, f64) -> f64;

/// A treatment of contact.
#[derive(Clone, Copy)]
pub struct Bounce {
    pub way: &'static Row<Way>,
    pub place: &'static Row<Lift>,
    pub restitution: &'static Row<Restitution>,
    pub friction: &'static Row<Friction>,
    /// Stiffness, N/m, and damping, N s/m, of a force; 0 where there is none.
    pub force: [f64; 2],
}

impl Bounce {
    /// Newton's impulse and Coulomb's friction in this way.
    pub const fn new(way: &'static Row<Way>) -> Self {
        Self {
            way,
            place: &PLACES[0],
            restitution: &RESTITUTIONS[0],
            friction: &FRICTIONS[0],
            force: [0.0; 2],
        }
    }

    /// What is said of each of its rows but the right ones: id, sentence, whether it is a mistake.
    fn rows(&self) -> [(&'static str, &'static str, bool); 4] {
        let Self {
            way,
            place,
            restitution,
            friction,
            ..
        } = self;
        [
            (way.id, way.says, way.mistake),
            (place.id, place.says, place.mistake),
            (restitution.id, restitution.says, restitution.mistake),
            (friction.id, friction.says, friction.mistake),
        ]
    }

    /// The ids of its rows, without those that are right in every respect but when: `flip_at_end+clamped`.
    pub fn label(&self) -> String {
        let rows = self.rows();
        let others = rows.iter().skip(1).filter(|(_, says, _)| !says.is_empty());
        let ids: Vec<&str> = rows[..1].iter().chain(others).map(|row| row.0).collect();
        ids.join("+")
    }

    /// What it does, in clauses after "at contact it".
    pub fn says(&self) -> String {
        let rows = self.rows();
        let says = rows.iter().map(|row| row.1).filter(|says| !says.is_empty());
        says.collect::<Vec<_>>().join("; it ")
    }

    /// The ids of its mistakes.
    pub fn mistakes(&self) -> impl Iterator<Item = &'static str> {
        let rows = self.rows().into_iter();
        rows.filter(|(.., mistake)| *mistake).map(|(id, ..)| id)
    }

    /// Whether its rows go together: an event is followed by no other at once, and something is done.
    pub(super) fn is_sensible(&self) -> bool {
        let id = self.restitution.id;
        let left = self.place.says.is_empty();
        match self.way.does {
            Way::Event => {
                let parts = matches!(id, "newton" | "restitution_as_one" | "restitution_as_zero");
                left && parts
            }
            Way::Force { .. } => left,
            Way::Once(_) => !left || id != "velocity_kept",
            Way::Never => *self == Self::new(self.way),
        }
    }

    /// Its law of impacts.
    pub(super) fn law(&self) -> ImpactLaw {
        ImpactLaw {
            restitution: self.restitution.does.gains,
            friction: self.friction.does,
        }
    }

    /// A step of `h` seconds: the free one, and what is done beside it.
    pub(super) fn step(
        &self,
        obstacles: &Obstacles,
        h: f64,
        state: &mut State,
        free: &mut Free,
    ) -> Stepped {
        match self.way.does {
            Way::Once(once) => once(self, obstacles, h, state, free),
            Way::Event | Way::Force { .. } | Way::Never => free(state),
        }
    }

    /// Turns velocities of particles that are inside obstacles, and moves these out, one obstacle after the other.
    /// Returns the particles that it acts on.
    fn meet(&self, obstacles: &Obstacles, h: f64, state: &mut State) -> Vec<usize> {
        let mut met = Vec::new();
        for (particle, obstacle) in obstacles.pairs() {
            let beside = obstacles.beside(particle, obstacle, state);
            let surface = obstacles.surface(obstacle);
            let out = self.moved_out(&beside, surface);
            let change = self.turned(&beside, surface, h);
            let own = 3 * particle..3 * particle + 3;
            axpy(&mut state.x[own.clone()], out, &beside.normal);
            if let Some(change) = change {
                axpy(&mut state.v[own], 1.0, &change);
                met.push(particle);
            }
        }
        met
    }

    /// The change of velocity, m/s, of a particle beside an obstacle; None where nothing is done.
    fn turned(&self, beside: &Beside, surface: Surface, h: f64) -> Option<[f64; 3]> {
        let inside = beside.gap <= 0.0;
        let due = beside.parting() < 0.0 || self.restitution.does.leaving;
        (inside && due).then(|| self.law().change(beside, surface, h))
    }

    fn moved_out(&self, beside: &Beside, surface: Surface) -> f64 {
        if beside.gap < 0.0 {
            (self.place.does)(beside.gap, surface.restitution)
        } else {
            0.0
        }
    }
}

impl fmt::Debug for Bounce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.label(), self.force)
    }
}

impl PartialEq for Bounce {
    fn eq(&self, other: &Self) -> bool {
        self.label() == other.label() && self.force == other.force
    }
}
