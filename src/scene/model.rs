//! The scene as a file states it, checked and complete, and the one table of what a file may say.
//!
//! Each key is a [`Row`]: reading and its messages, `--vary`, the flat arrays handed to
//! [other programs](crate::solvers::external) and the key of the
//! [converged truth](crate::truth::converged) come from it. A field is declared together with its row:
//! ```text
//! /// What it is, and its unit.
//! field: type = default, "key" => kind and bounds, what a file without it means, its flat array;
//! ```
//! `Default` is what a file means that leaves the key out. Where a file has to give the key it is
//! something harmless, such as a force of 0.

use super::error::Refusal;
use super::expectation::{Expectation, Names, Scope};
use super::limits::{self, Quantity};
use super::table::{Field, Value, declare, members, words};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use serde::Serialize;

/// All parts: the mappings a file consists of.
pub static PARTS: [&Part; 7] = [
    &SPRINGS,
    &PARTICLES,
    &GRAVITATIONAL,
    &WIND,
    &SOLVER,
    &PLOT,
    &SCENE,
];

/// One mapping of the file, or each of a list of them.
#[derive(Debug)]
pub struct Part {
    /// `springs`; `file` for the file itself.
    pub key: &'static str,
    /// Whether the file has a list of such mappings.
    pub list: bool,
    /// What stands there, in a message's words.
    pub(super) expected: &'static str,
    /// Keys the format names, but this version does not read.
    pub(super) later: &'static [&'static str],
    pub rows: &'static [Row],
    /// How many members the scene has: 0 or 1 of what is no list.
    pub count: fn(&Scene) -> usize,
}

/// One key of a mapping.
#[derive(Debug)]
pub struct Row {
    pub key: &'static str,
    /// What it is, for its reader.
    pub summary: &'static str,
    pub kind: Kind,
    pub absent: Absent,
    /// Its name among the flat arrays; several rows may share one. None of what has no say in the
    /// motion, and so does not count in the truth's key either.
    pub flat: Option<&'static str>,
    /// A component of the member of this index; None where there is none.
    pub get: fn(&Scene, usize, usize) -> Option<Value<'_>>,
    /// Sets a component, unjudged. A value of another kind or of a member that is not there changes
    /// nothing. Where the key holds a part, any value adds a member with its defaults.
    pub set: fn(&mut Scene, usize, usize, Value<'_>),
}

impl Part {
    /// Where a key stands, of one member or of all: `springs[3].stiffness`, `springs.stiffness`.
    pub fn path(&self, member: Option<usize>, key: &str) -> String {
        match member {
            Some(at) if self.list => format!("{}[{at}].{key}", self.key),
            _ if self.key == SCENE.key => key.to_owned(),
            _ => format!("{}.{key}", self.key),
        }
    }
}

impl Row {
    /// The components of the member of this index.
    pub fn values<'s>(&self, scene: &'s Scene, at: usize) -> impl Iterator<Item = Value<'s>> {
        let get = self.get;
        (0..).map_while(move |component| get(scene, at, component))
    }
}

/// What stands under a key.
#[derive(Debug)]
pub enum Kind {
    Number(Quantity),
    /// A list of so many numbers.
    Numbers(usize, Quantity),
    /// A particle.
    Id,
    /// A list of two particles.
    Ids,
    /// 0, 1 or 2 for x, y, z.
    Coordinate,
    /// `true` or `false`.
    Flag,
    /// One of these.
    Word(&'static [&'static str]),
    /// Text in which this finds no fault.
    Text(fn(&str, &Names) -> Result<(), Refusal>),
    /// A mapping or a list of them, with rows of its own.
    Part(&'static Part),
    /// What engines must do, by engine and key.
    Expect,
}

/// What a file means that leaves the key out.
#[derive(Debug)]
pub enum Absent {
    /// Nothing: it is refused, with this advice.
    Required(&'static str),
    /// The default of the model.
    Usual,
    /// What follows from the rest of the scene. A number; NaN until the whole file is read.
    Derived,
}
use Absent::{Derived, Required, Usual};

declare! {
    /// A checked scene. Particle ids are indices into `particles`.
    SCENE: Scene, itself file, "a scene: a mapping with `solver` and `particles`",
    later ["air", "bending", "colliders", "driven", "magnetic", "objects", "rods", "strain_limit"];
    [
        /// The file as it was named on the command line; empty for a scene built in code.
        file: String = String::new()
    ]

    /// One line; the file's stem if absent, `scene` if that has none.
    name: String = "scene".into(), "name" => Kind::Text(limits::name), Usual, None;
    /// Any text.
    description: Option<String> = None,
        "description" => Kind::Text(limits::description), Usual, None;
    /// How it is stepped, and in which gravity.
    solver: Solver = Solver::default(), "solver" => Kind::Part(&SOLVER),
        Required("add `solver: {type: symplectic_euler, timestep: 0.0005}`"), None;
    /// Seconds, at least one timestep.
    duration: f64 = 5.0, "duration" => Kind::Number(limits::DURATION), Usual, None;
    /// The axis gravity acts along.
    up: Axis = Axis::Z, "up" => Kind::Word(Axis::WORDS), Usual, Some("gravity");
    /// The part of the ends' relative velocity that dampers resist.
    damping_model: DampingModel = DampingModel::Axial,
        "damping_model" => Kind::Word(DampingModel::WORDS), Usual, Some("damping_model");
    /// The curve the report shows first.
    plot: Option<Plot> = None, "plot" => Kind::Part(&PLOT), Usual, None;
    /// At least one of them free.
    particles: Vec<Particle> = Vec::new(),
        "particles" => Kind::Part(&PARTICLES), Required(NO_PARTICLES), None;
    /// Springs with dampers.
    springs: Vec<Spring> = Vec::new(), "springs" => Kind::Part(&SPRINGS), Usual, None;
    /// Attractions.
    gravitational: Vec<GravitationalPair> = Vec::new(),
        "gravitational" => Kind::Part(&GRAVITATIONAL), Usual, None;
    /// A constant force.
    wind: Option<Wind> = None, "wind" => Kind::Part(&WIND), Usual, None;
    /// What engines must do, in the order of the file. Changes no run.
    expect: Vec<Expectation> = Vec::new(), "expect" => Kind::Expect, Usual, None;
}

declare! {
    /// What the file asks for under `solver`.
    SOLVER: Solver, one solver, "a mapping with `type` and `timestep`", later [];

    /// An integrator's id.
    method: String = "symplectic_euler".into(), "type" => Kind::Text(limits::method),
        Required("name an integrator, as symplectic_euler"), None;
    /// Seconds, positive.
    timestep: f64 = 1e-3, "timestep" => Kind::Number(limits::TIMESTEP),
        Required("give the step in seconds, as 0.0005"), None;
    /// Signed acceleration along `up`, m/s².
    gravity: f64 = -9.81,
        "gravity" => Kind::Number(Quantity::signed(1e12, "m/s²")), Usual, Some("gravity");
    /// Relative residual at which an implicit method's solve ends; the method's own if absent.
    tolerance: Option<f64> = None,
        "tolerance" => Kind::Number(Quantity::from(1e-300, 1.0, "relative")), Usual, None;
}

declare! {
    /// The curve the report shows first.
    PLOT: Plot, maybe plot, "a mapping with `particle_id` and `dof`", later [];

    /// Whose curve.
    particle: usize = 0,
        "particle_id" => Kind::Id, Required("say which particle's curve to show"), None;
    /// Coordinate 0, 1 or 2.
    dof: usize = 0,
        "dof" => Kind::Coordinate, Required("say which coordinate to show: 0, 1 or 2"), None;
    /// Lower and upper, m; fits the data if absent.
    y_range: Option<[f64; 2]> = None, "y_range" => Kind::Numbers(2, limits::POSITION), Usual, None;
}

declare! {
    /// A mass point.
    PARTICLES: Particle, list particles, "a particle: a mapping with `pos` and `mass`", later [];

    /// Metres, at the start.
    position: [f64; 3] = [0.0; 3], "pos" => Kind::Numbers(3, limits::POSITION),
        Required("give its position: `pos: [x, y, z]`"), Some("positions");
    /// Metres per second, at the start; zero for a fixed particle.
    velocity: [f64; 3] = [0.0; 3], "vel" => Kind::Numbers(3, Quantity::signed(1e12, "m/s")),
        Usual, Some("velocities");
    /// Whether it never moves.
    fixed: bool = false, "fixed" => Kind::Flag, Usual, Some("fixed");
    /// Kilograms, positive. Only what is fixed and attracts nothing may leave it out.
    mass: f64 = 1.0,
        "mass" => Kind::Number(Quantity::from(1e-30, 1e30, "kg")), Derived, Some("masses");
    /// Metres; the ball's radius once a scene asks for contact.
    radius: f64 = 0.1, "radius" => Kind::Number(Quantity::not_negative(1e12, "m")), Usual, None;
    /// Linear drag coefficient b, N s/m.
    drag: f64 = 0.0,
        "drag" => Kind::Number(Quantity::not_negative(1e18, "N s/m")), Usual, Some("drag");
}

declare! {
    /// A spring and the damper beside it.
    SPRINGS: Spring, list springs, "a spring: a mapping with `particle_ids` and `stiffness`",
    later [];

    /// Two different particles.
    ends: [usize; 2] = [0, 1], "particle_ids" => Kind::Ids,
        Required("name the two ends: `particle_ids: [0, 1]`"), Some("ids");
    /// k, N/m, not negative.
    stiffness: f64 = 0.0, "stiffness" => Kind::Number(limits::STIFFNESS),
        Required("a spring needs its stiffness in N/m"), Some("stiffness");
    /// q, N/m³, not negative: adds q (l - L)³ to the pull.
    cubic: f64 = 0.0,
        "cubic" => Kind::Number(Quantity::not_negative(1e18, "N/m³")), Usual, Some("cubic");
    /// c, N s/m, not negative.
    damping: f64 = 0.0,
        "damping" => Kind::Number(Quantity::not_negative(1e18, "N s/m")), Usual, Some("damping");
    /// L, metres, not negative. A file without it means the initial distance of the ends.
    rest_length: f64 = 0.0, "rest_length" => Kind::Number(Quantity::not_negative(1e12, "m")),
        Derived, Some("rest_lengths");
}

declare! {
    /// Attraction G m1 m2 / r² between two particles.
    GRAVITATIONAL: GravitationalPair, list gravitational,
    "a pair: a mapping with `particle_ids` and `G`",
    later [];

    /// Two different particles.
    ends: [usize; 2] = [0, 1], "particle_ids" => Kind::Ids,
        Required("name the two particles: `particle_ids: [0, 1]`"), Some("ids");
    /// G, N m²/kg²; negative repels.
    g: f64 = 0.0, "G" => Kind::Number(Quantity::signed(1e30, "N m²/kg²")),
        Required("give the constant of attraction in N m²/kg²"), Some("g");
}

declare! {
    /// A constant force on every free particle, whatever its mass. Not to be confused with moving air.
    WIND: Wind, maybe wind, "a mapping with `direction` and `strength`",
    later ["velocity", "density", "profile"];

    /// Unit vector; in the file of any length but 0.
    direction: [f64; 3] = [1.0, 0.0, 0.0],
        "direction" => Kind::Numbers(3, Quantity::signed(1e12, "any unit")),
        Required("say where it blows: `direction: [1, 0, 0]`"), Some("wind_force");
    /// Newtons; negative blows the other way.
    strength: f64 = 0.0, "strength" => Kind::Number(Quantity::signed(1e18, "N")),
        Required("give its force in newtons"), Some("wind_force");
}

/// An expectation is of no use without its words, and has no rows.
impl Field for Vec<Expectation> {}

/// Advice to a scene without particles.
pub(super) const NO_PARTICLES: &str = "add a particle: `- {pos: [0, 0, 1], mass: 0.1}`";

/// An axis of space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

words!(Axis: "z" => Z, "x" => X, "y" => Y);

impl Axis {
    /// 0, 1 or 2: the coordinate's place in a position.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// Which part of the relative velocity of a spring's ends its damper resists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DampingModel {
    /// Only the component along the spring (the physical dashpot).
    Axial,
    /// The full relative velocity; resists rotation too, so angular momentum is lost.
    Isotropic,
}

words!(DampingModel: "axial" => Axial, "isotropic" => Isotropic);

impl Scene {
    /// Number of steps that cover the duration: N = ceil(duration / h - 1e-9), at least 1.
    pub fn steps(&self, timestep: f64) -> u64 {
        steps(self.duration, timestep)
    }

    /// The scene's size L in metres: the diagonal of the box around all initial positions plus the
    /// longest rest length. The length scale of energies and tolerances; 0 for a lone particle.
    pub fn size(&self) -> f64 {
        let corners = self.particles.iter().map(|p| Vector::from(p.position));
        let diagonal = if self.particles.is_empty() {
            0.0
        } else {
            Aabb::from_points(corners).extents().length()
        };
        let rest_lengths = self.springs.iter().map(|s| s.rest_length);
        diagonal + rest_lengths.fold(0.0, f64::max)
    }

    /// What is expected of an engine, each key once: what its own line says (or, for an integrator
    /// without one, `rest`), then what `all` says of other keys if it is an `integrator`.
    pub fn expected_of(&self, engine: &str, integrator: bool) -> Vec<&Expectation> {
        let own = |e: &Expectation| matches!(&e.scope, Scope::Engine(id) if id == engine);
        let named = self.expect.iter().any(own);
        let rest = |e: &Expectation| integrator && !named && e.scope == Scope::Rest;
        let mut found: Vec<&Expectation> =
            self.expect.iter().filter(|e| own(e) || rest(e)).collect();
        let nearer = found.len();
        for expectation in &self.expect {
            let open = !found[..nearer].iter().any(|e| e.key == expectation.key);
            if integrator && open && expectation.scope == Scope::All {
                found.push(expectation);
            }
        }
        found
    }
}

/// N = ceil(duration / h - 1e-9): the run ends at N h, at or just past the duration.
pub fn steps(duration: f64, timestep: f64) -> u64 {
    ((duration / timestep - 1e-9).ceil() as u64).max(1)
}
