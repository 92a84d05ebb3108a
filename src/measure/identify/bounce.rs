//! How a program treats contact: what it does to particles that are inside obstacles, or about to be, beside the free
//! step of any method. A treatment is a row of each of four tables.

mod list;
mod own;
mod penalty;
mod rows;
mod ways;

pub(super) use list::{all, relevant, same_here};
pub use own::{Own, Size, Wrong};
pub(super) use penalty::pressed;
pub use rows::{FRICTIONS, PARTNERS, PLACES, RESTITUTIONS, WAYS, treatments};

use crate::integrators::StepError;
use crate::physics::State;
use crate::physics::constraints::contact::{Against, Beside, Hit, ImpactLaw, Obstacles};
use crate::space::{minus, three};
use crate::vector::axpy;
use std::borrow::Cow;
use std::fmt;

type Stepped = Result<(), StepError>;
/// The step of a method as if there were no obstacles, of so many seconds.
pub(super) type Free<'a> = dyn FnMut(f64, &mut State) -> Stepped + 'a;

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
    Once(Treating),
    /// Within the step of this method, whatever its forces.
    Of(&'static str, Treating),
    /// Within any step, which leaves nothing inside.
    Within(Treating),
    /// By a force while a particle is inside.
    Force {
        /// Whether a damper may pull it back while it leaves.
        pulls: bool,
        /// Whether the scene's contact is such a force, and steps are not cut where it begins and ends.
        whole: bool,
    },
    /// By rapier's step, in the substeps of the scheme, which keeps impulses from one step to the next.
    Soft,
    /// Not at all.
    Never,
}

/// A step of a treatment, with the method's own and so many seconds long.
pub type Treating = fn(&Bounce, &Obstacles, f64, &mut State, &mut Free) -> Stepped;

/// Where what is inside is put.
#[derive(Debug, Clone, Copy)]
pub struct Lift {
    /// How far it is moved out, m, from its gap, m, and the restitution.
    pub by: fn(f64, f64) -> f64,
    /// Whether two particles move by half of it each; else each by its part of both 1/m.
    pub halves: bool,
    /// Whether it is put where the step began instead.
    pub back: bool,
}

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

/// The changes of both velocities, m/s, from the change of the one relative to the other, and from both 1/m, 1/kg.
pub type Shares = fn(&Beside, [f64; 3], [f64; 2]) -> [[f64; 3]; 2];

/// What the other of a contact is to a program.
#[derive(Debug, Clone, Copy)]
pub struct Partner {
    pub shares: Shares,
    /// Obstacles have so many times the velocity that the scene gives them.
    pub speed: f64,
    /// Whether particles collide with each other.
    pub meets: bool,
    /// Whether velocities are turned about the normal; else about the axis nearest to it.
    pub slopes: bool,
}

/// A treatment of contact.
#[derive(Clone, Copy)]
pub struct Bounce {
    pub way: &'static Row<Way>,
    pub place: &'static Row<Lift>,
    pub restitution: &'static Row<Restitution>,
    pub friction: &'static Row<Friction>,
    pub partner: &'static Row<Partner>,
    /// The program's own coefficients and sizes.
    pub own: Own,
    /// Stiffness, N/m, and damping, N s/m, of a force; 0 where there is none.
    pub force: [f64; 2],
    /// What counts as inside.
    pub touching: Touching,
}

/// What counts as inside, where rounding decides.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Touching {
    /// What touches does not.
    Inside,
    /// What touches exactly does.
    Exactly,
    /// What touches but for rounding does.
    Near,
}

impl Bounce {
    /// Newton's impulse and Coulomb's friction in this way.
    pub const fn new(way: &'static Row<Way>) -> Self {
        Self {
            way,
            place: &PLACES[0],
            restitution: &RESTITUTIONS[0],
            friction: &FRICTIONS[0],
            partner: &PARTNERS[0],
            own: Own::NONE,
            force: [0.0; 2],
            touching: Touching::Exactly,
        }
    }

    /// What is said of each of its rows but the right ones: id, sentence, whether it is a mistake.
    fn rows(&self) -> Vec<(&'static str, Cow<'static, str>, bool)> {
        let Self {
            way,
            place,
            restitution,
            friction,
            partner,
            ..
        } = self;
        let kept = restitution.id == "velocity_kept";
        // What leaves the velocity as it is does not turn it at any time.
        let when = if kept { "" } else { way.says };
        let rows = [
            (way.id, when, way.mistake),
            (place.id, place.says, place.mistake),
            (restitution.id, restitution.says, restitution.mistake),
            (friction.id, friction.says, friction.mistake),
            (partner.id, partner.says, partner.mistake),
        ];
        let rows = rows.map(|(id, says, mistake)| (id, Cow::Borrowed(says), mistake));
        let own = self
            .own
            .rows()
            .map(|(id, says)| (id, Cow::Owned(says), true));
        rows.into_iter().chain(own).collect()
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
        let says = rows.iter().map(|row| row.1.as_ref());
        let says = says.filter(|says| !says.is_empty());
        says.collect::<Vec<_>>().join("; it ")
    }

    /// What is wrong about it, in such clauses.
    pub fn wrongs(&self) -> String {
        let rows = self.rows();
        let wrong = rows.iter().filter(|(.., mistake)| *mistake);
        let says = wrong.map(|row| row.1.as_ref());
        says.collect::<Vec<_>>().join("; it ")
    }

    /// The ids of its mistakes.
    pub fn mistakes(&self) -> impl Iterator<Item = &'static str> {
        let rows = self.rows().into_iter();
        rows.filter(|(.., mistake)| *mistake).map(|(id, ..)| id)
    }

    /// Whether sliding is slowed.
    pub(super) fn rubs(&self) -> bool {
        self.friction.id != "friction_forgotten"
    }

    /// Whether its rows go together: an event is followed by no other at once, and something is done.
    pub(super) fn is_sensible(&self) -> bool {
        let id = self.restitution.id;
        let left = self.place.says.is_empty();
        match self.way.does {
            Way::Event => {
                let parts = matches!(id, "newton" | "restitution_as_one" | "restitution_as_zero");
                left && parts && self.partner.does.speed == 1.0 && !self.partner.mistake
            }
            Way::Force { .. } => left,
            Way::Within(_) => left && id != "velocity_kept",
            Way::Once(_) if self.place.does.back => self.way.id == "flip_at_end",
            Way::Of(..) => !self.place.does.back && (!left || id != "velocity_kept"),
            Way::Once(_) => !left || id != "velocity_kept",
            Way::Soft | Way::Never => *self == Self::new(self.way),
        }
    }

    /// Whether it is one of the first things that a program does: others are looked for with fewer mistakes.
    pub(super) fn is_usual(&self) -> bool {
        !self.place.does.back && !matches!(self.way.does, Way::Of(..) | Way::Within(_))
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
            Way::Once(does) | Way::Of(_, does) | Way::Within(does) => {
                does(self, obstacles, h, state, free)
            }
            Way::Event | Way::Force { .. } | Way::Soft | Way::Never => free(h, state),
        }
    }

    /// Turns velocities of particles that are inside obstacles, and of those in each other, and moves these out, one pair
    /// after the other. Returns the particles that it acts on. `from` are the positions at the start of the step.
    fn meet(&self, obstacles: &Obstacles, h: f64, from: &[f64], state: &mut State) -> Vec<usize> {
        let mut met = Vec::new();
        let inside = |pair: (usize, Against), state: &State| {
            let beside = obstacles.beside(pair.0, pair.1, state);
            beside.gap <= self.within(&beside)
        };
        for pair in obstacles.pairs() {
            if inside(pair, state) {
                self.act(obstacles, pair, (h, from), state, &mut met);
            }
        }
        if obstacles.among_particles() && self.partner.does.meets {
            let near = obstacles.near_now(state);
            let among = |(_, against): &(usize, Against)| matches!(against, Against::Particle(_));
            for pair in near.pairs().filter(among) {
                if inside(pair, state) {
                    self.act(obstacles, pair, (h, from), state, &mut met);
                }
            }
        }
        met
    }

    /// The largest gap that counts as inside, m.
    fn within(&self, beside: &Beside) -> f64 {
        match self.touching {
            Touching::Inside => -beside.close,
            Touching::Exactly => 0.0,
            Touching::Near => beside.close,
        }
    }

    fn act(
        &self,
        obstacles: &Obstacles,
        (particle, against): (usize, Against),
        (h, from): (f64, &[f64]),
        state: &mut State,
        met: &mut Vec<usize>,
    ) {
        let mut beside = obstacles.beside(particle, against, state);
        if let Against::Obstacle(_) = against {
            let v = three(&state.v, particle);
            let slower = 1.0 - self.partner.does.speed;
            let surface = minus(v, beside.velocity);
            beside.velocity = [0, 1, 2].map(|axis| beside.velocity[axis] + slower * surface[axis]);
        }
        let outward = beside.normal;
        if !self.partner.does.slopes {
            beside.normal = axis(beside.normal);
        }
        let surface = obstacles.surface(against);
        let with = against.with(particle);
        let weights = [0, 1].map(|end| with.get(end).map_or(0.0, |one| obstacles.weight(*one)));
        let place = self.place.does;
        let out = match beside.gap {
            gap if gap < 0.0 => (place.by)(gap, surface.restitution),
            _ => 0.0,
        };
        let lifted = outward.map(|n| out * n);
        let lifted = match place.halves && with.len() > 1 {
            true => rows::halves(&beside, lifted, weights),
            false => rows::by_mass(&beside, lifted, weights),
        };
        let due = beside.parting() < 0.0 || self.restitution.does.leaving;
        let change = due.then(|| self.law().change(&beside, surface, h));
        let change = change.map(|change| (self.partner.does.shares)(&beside, change, weights));
        for (end, one) in with.into_iter().enumerate() {
            let own = 3 * one..3 * one + 3;
            axpy(&mut state.x[own.clone()], 1.0, &lifted[end]);
            if let Some(old) = from.get(own.clone()).filter(|_| place.back) {
                state.x[own.clone()].copy_from_slice(old);
            }
            if let Some(change) = &change {
                axpy(&mut state.v[own], 1.0, &change[end]);
                met.push(one);
            }
        }
    }
}

/// The axis that is nearest to a direction, either way round.
fn axis(n: [f64; 3]) -> [f64; 3] {
    let largest = n.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    let first = n.iter().position(|c| c.abs() == largest);
    [0, 1, 2].map(|at| {
        if Some(at) == first {
            n[at].signum()
        } else {
            0.0
        }
    })
}

impl fmt::Debug for Bounce {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.label(), self.force)
    }
}

impl PartialEq for Bounce {
    fn eq(&self, other: &Self) -> bool {
        self.label() == other.label() && self.force == other.force && self.own == other.own
    }
}
