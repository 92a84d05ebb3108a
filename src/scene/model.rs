//! The scene as a file states it, checked and complete, and the table of all keys a file may have.
//!
//! Each key is a [`Row`]. Reading and its messages, `--vary`, the flat arrays for
//! [other programs](crate::solvers::external) and the cache key of the
//! [converged truth](crate::truth::converged) follow from it. A field is declared with its row:
//! ```text
//! /// What it is, and its unit.
//! field: type = default, "key" => kind and bounds, meaning of an absent key, its flat array;
//! ```
//! A key that takes a number or vectors has two rows, the number's first; the one that is not given is 0 or empty.
//!
//! `Default` is the value of an absent key. Where the key is required, it is something harmless, such as
//! a force of 0.

use super::expectation::{Expectation, Scope, Skipped};
use super::limits::{self, Bounds, Form};
use super::object::{Body, Object};
use super::table::{Field, Value, Vectors, declare, member, part, words};
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use serde::Serialize;
use std::sync::Arc;

/// All parts: the mappings a file consists of.
pub static PARTS: [&Part; 26] = [
    &SPRINGS,
    &RODS,
    &CONSTRAINTS,
    &STRAIN_LIMIT,
    &BENDING,
    &PARTICLES,
    &TRIANGLES,
    &GRAVITATIONAL,
    &DRIVEN,
    &SINE,
    &COLLIDERS,
    &PLANE,
    &BALL,
    &BOX,
    &CAPSULE,
    &MESH,
    &MOTION,
    &MOTION_SINE,
    &CONTACT,
    &PENALTY,
    &WIND,
    &AIR,
    &MAGNETIC,
    &SOLVER,
    &PLOT,
    &SCENE,
];

/// One mapping of the file, or each of a list of them.
#[derive(Debug)]
pub struct Part {
    /// `springs`; `driven.sine` for a mapping inside each member of a list; `file` for the file itself.
    pub key: &'static str,
    /// Whether the file has a list of such mappings.
    pub list: bool,
    /// What is expected there, as messages say it.
    pub(super) expected: &'static str,
    /// Keys that the format reserves, but this version does not read.
    pub(super) reserved: &'static [&'static str],
    pub rows: &'static [Row],
    /// How many members the scene has; 0 or 1 where the part is not a list.
    pub count: fn(&Scene) -> usize,
}

/// One key of a mapping.
#[derive(Debug)]
pub struct Row {
    pub key: &'static str,
    /// One line that says what the key is.
    pub summary: &'static str,
    pub kind: ValueKind,
    pub absent: Absent,
    /// Its name among the flat arrays; several rows may share one. None where the key does not influence
    /// the motion, or there is no truth with it; the truth's cache key leaves it out too.
    pub flat: Option<&'static str>,
    /// The component of the member of this index; None where it does not exist.
    pub get: fn(&Scene, usize, usize) -> Option<Value<'_>>,
    /// Sets a component, unchecked. A value of another kind, or a member that does not exist, changes
    /// nothing. Where the key holds a part, any value adds a member with its defaults.
    pub set: fn(&mut Scene, usize, usize, Value<'_>),
}

impl Part {
    /// The list and the key there, of a mapping inside each of its members. It has as many members as the list, of
    /// which some may be absent.
    pub fn inside(&self) -> Option<(&'static str, &'static str)> {
        self.key.split_once('.')
    }

    /// The path of a key, for one member or for all: `springs[3].stiffness`, `springs.stiffness`.
    pub fn path(&self, member: Option<usize>, key: &str) -> String {
        match member {
            Some(at) if let Some((outer, inner)) = self.inside() => {
                let list = PARTS.iter().any(|part| part.key == outer && part.list);
                let at = if list {
                    format!("[{at}]")
                } else {
                    String::new()
                };
                format!("{outer}{at}.{inner}.{key}")
            }
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

/// A particle that a key names, such as `sheet[3,4]`.
#[derive(Debug, Clone)]
pub(super) struct Named {
    pub(super) part: &'static Part,
    pub(super) row: &'static Row,
    pub(super) at: usize,
    pub(super) component: usize,
    pub(super) name: String,
}

impl PartialEq for Named {
    fn eq(&self, other: &Self) -> bool {
        (self.path(), &self.name) == (other.path(), &other.name)
    }
}

impl Named {
    /// The path of the value.
    pub(super) fn path(&self) -> String {
        let path = self.part.path(Some(self.at), self.row.key);
        match self.row.kind {
            ValueKind::Ids(_) => format!("{path}[{}]", self.component),
            _ => path,
        }
    }
}

/// A scene as its file has it, before objects were expanded.
#[derive(Debug, PartialEq)]
pub struct Written {
    pub(super) scene: Scene,
    /// The particles that it names.
    pub(super) named: Vec<Named>,
}

/// The kind of value under a key.
#[derive(Debug)]
pub enum ValueKind {
    Number(Bounds),
    /// A list of this many numbers.
    Numbers(usize, Bounds),
    /// A list of such lists, at least so many. Components follow one another, row by row.
    Table(usize, usize, Bounds),
    /// A list of three numbers, or a list of such lists.
    Vectors(Bounds),
    /// The id of a particle.
    Id,
    /// A list of this many particle ids.
    Ids(usize),
    /// 0, 1 or 2 for x, y, z.
    Coordinate,
    /// A whole number.
    Count(Bounds),
    /// `true` or `false`.
    Flag,
    /// One of these words.
    Word(&'static [&'static str]),
    /// The id of an integrator.
    Method,
    /// Text of this form.
    Text(Form),
    /// A list of names of this form.
    Names(Form),
    /// A mapping or a list of them, with rows of its own.
    Part(&'static Part),
    /// Expectations, by engine and key.
    Expect,
    /// A list of [`Object`]s.
    Objects,
}

/// The meaning of an absent key.
#[derive(Debug)]
pub enum Absent {
    /// The file is refused, with this advice.
    Required(&'static str),
    /// The same, unless this other key is there.
    Unless(&'static str, &'static str),
    /// The default of the model.
    Usual,
    /// A number that follows from the rest of the scene. It is NaN until the whole file is read.
    Derived,
}
use Absent::{Derived, Required, Unless, Usual};

declare! {
    /// A checked scene. Particle ids are indices into `particles`.
    SCENE: Scene, itself file, "a scene: a mapping with `solver` and `particles`",
    reserved [];
    [
        /// The file as it was named on the command line; empty for a scene built in code.
        file: String = String::new()
    ]
    [
        /// What objects made of their particles, in the order of the file.
        bodies: Vec<Body> = Vec::new()
    ]
    [
        /// The scene before its objects were expanded; None without objects, and for a scene built in code.
        written: Option<Arc<Written>> = None
    ]
    [
        /// The checks that are not made, in the order of the file's `expect.skip`.
        skip: Vec<Skipped> = Vec::new()
    ]

    /// One line; the file's stem if absent, `scene` if that has none.
    name: String = "scene".into(), "name" => ValueKind::Text(limits::NAME), Usual, None;
    /// Any text.
    description: Option<String> = None,
        "description" => ValueKind::Text(limits::DESCRIPTION), Usual, None;
    /// Method, step and gravity.
    solver: SolverSpec = SolverSpec::default(), "solver" => ValueKind::Part(&SOLVER),
        Required("add `solver: {type: symplectic_euler, timestep: 0.0005}`"), None;
    /// Seconds, at least one timestep.
    duration: f64 = 5.0, "duration" => ValueKind::Number(limits::DURATION), Usual, None;
    /// The axis that a number under `gravity` is along; vectors have axes of their own.
    up: Axis = Axis::Z, "up" => ValueKind::Word(Axis::WORDS), Usual, Some("gravity");
    /// The part of the ends' relative velocity that dampers resist.
    damping_model: DampingModel = DampingModel::Axial,
        "damping_model" => ValueKind::Word(DampingModel::WORDS), Usual, Some("damping_model");
    /// The curve the report shows first.
    plot: Option<Plot> = None, "plot" => ValueKind::Part(&PLOT), Usual, None;
    /// The particles, at least one of them free.
    particles: Vec<Particle> = Vec::new(),
        "particles" => ValueKind::Part(&PARTICLES), Unless("objects", NO_PARTICLES), None;
    /// Strings, hair, cloth and the like. A scene that was read has none: they are [expanded](Scene::expand).
    objects: Vec<Object> = Vec::new(), "objects" => ValueKind::Objects, Usual, None;
    /// Springs with dampers.
    springs: Vec<Spring> = Vec::new(), "springs" => ValueKind::Part(&SPRINGS), Usual, None;
    /// Exact distances.
    rods: Vec<Rod> = Vec::new(), "rods" => ValueKind::Part(&RODS), Usual, None;
    /// How rods are kept to their lengths.
    constraints: Option<Constraints> = None, "constraints" => ValueKind::Part(&CONSTRAINTS), Usual, None;
    /// The strain that no spring goes beyond.
    strain_limit: Option<StrainLimit> = None, "strain_limit" => ValueKind::Part(&STRAIN_LIMIT), Usual, None;
    /// Triangles of particles, which the air drags at.
    triangles: Vec<Triangle> = Vec::new(),
        "triangles" => ValueKind::Part(&TRIANGLES), Usual, None;
    /// Hinges that resist bending.
    bending: Vec<Bending> = Vec::new(), "bending" => ValueKind::Part(&BENDING), Usual, None;
    /// Attractions.
    gravitational: Vec<GravitationalPair> = Vec::new(),
        "gravitational" => ValueKind::Part(&GRAVITATIONAL), Usual, None;
    /// Motions of fixed particles.
    driven: Vec<Driven> = Vec::new(), "driven" => ValueKind::Part(&DRIVEN), Usual, None;
    /// Obstacles that particles collide with.
    colliders: Vec<Collider> = Vec::new(), "colliders" => ValueKind::Part(&COLLIDERS), Usual, None;
    /// Whether particles collide with each other, and how.
    contact: Option<Contact> = None, "contact" => ValueKind::Part(&CONTACT), Usual, None;
    /// A constant force.
    wind: Option<Wind> = None, "wind" => ValueKind::Part(&WIND), Usual, None;
    /// The air that drag acts against; at rest, as at sea level, where the scene says nothing of it.
    air: Option<Air> = None, "air" => ValueKind::Part(&AIR), Usual, None;
    /// A uniform magnetic field.
    magnetic: Option<Magnetic> = None, "magnetic" => ValueKind::Part(&MAGNETIC), Usual, None;
    /// Names of other programs that the file expects something of; the command line says what they are.
    externals: Vec<String> = Vec::new(),
        "externals" => ValueKind::Names(limits::EXTERNAL), Usual, None;
    /// Expectations of engines, in the order of the file. They change no run.
    expect: Vec<Expectation> = Vec::new(), "expect" => ValueKind::Expect, Usual, None;
}

declare! {
    /// The block `solver`. Not to be confused with [`solvers::Solver`](crate::solvers::Solver), which runs
    /// a scene.
    SOLVER: SolverSpec, one solver, "a mapping with `type` and `timestep`", reserved [];

    /// An integrator's id.
    method: String = "symplectic_euler".into(), "type" => ValueKind::Method,
        Required("name an integrator, as symplectic_euler"), None;
    /// Seconds, positive.
    timestep: f64 = 1e-3, "timestep" => ValueKind::Number(limits::TIMESTEP),
        Required("give the step in seconds, as 0.0005"), None;
    /// Signed acceleration along `up`, m/s².
    gravity: f64 = -9.81,
        "gravity" => ValueKind::Number(limits::GRAVITY), Usual, Some("gravity");
    /// Or accelerations that add up, m/s², whatever `up` is.
    gravities: Vectors = Vectors::default(),
        "gravity" => ValueKind::Vectors(limits::GRAVITY), Usual, Some("gravity");
    /// Relative residual at which an implicit solve ends; the method's default if absent.
    tolerance: Option<f64> = None,
        "tolerance" => ValueKind::Number(Bounds::from(1e-300, 1.0, "relative")), Usual, None;
}

declare! {
    /// The curve the report shows first.
    PLOT: Plot, maybe plot, "a mapping with `particle_id` and `dof`", reserved [];

    /// The particle whose curve is shown.
    particle: usize = 0,
        "particle_id" => ValueKind::Id, Required("say which particle's curve to show"), None;
    /// Coordinate 0, 1 or 2.
    dof: usize = 0,
        "dof" => ValueKind::Coordinate, Required("say which coordinate to show: 0, 1 or 2"), None;
    /// Lower and upper end, m; fitted to the data if absent.
    y_range: Option<[f64; 2]> = None,
        "y_range" => ValueKind::Numbers(2, limits::POSITION), Usual, None;
}

declare! {
    /// A mass point.
    PARTICLES: Particle, list particles, "a particle: a mapping with `pos` and `mass`", reserved [];

    /// Metres, at the start.
    position: [f64; 3] = [0.0; 3], "pos" => ValueKind::Numbers(3, limits::POSITION),
        Required("give its position: `pos: [x, y, z]`"), Some("positions");
    /// Metres per second, at the start; zero for a fixed particle.
    velocity: [f64; 3] = [0.0; 3], "vel" => ValueKind::Numbers(3, Bounds::signed(1e12, "m/s")),
        Usual, Some("velocities");
    /// Whether it never moves.
    fixed: bool = false, "fixed" => ValueKind::Flag, Usual, Some("fixed");
    /// Kilograms, positive. Only a fixed particle that attracts nothing may leave it out.
    mass: f64 = 1.0,
        "mass" => ValueKind::Number(Bounds::from(1e-40, 1e30, "kg")), Derived, Some("masses");
    /// Metres; the radius of the ball where the scene has contact.
    radius: f64 = 0.1, "radius" => ValueKind::Number(Bounds::not_negative(1e12, "m")), Usual, None;
    /// Linear drag coefficient b, N s/m: the force is -b u, u the velocity relative to the air.
    drag: f64 = 0.0,
        "drag" => ValueKind::Number(Bounds::not_negative(1e18, "N s/m")), Usual, Some("drag");
    /// Quadratic drag coefficient c, N s²/m²: the force is -c |u| u.
    quadratic_drag: f64 = 0.0, "quadratic_drag" =>
        ValueKind::Number(Bounds::not_negative(1e18, "N s²/m²")), Usual, Some("quadratic_drag");
    /// Charge q, coulombs; acts in a magnetic field alone. Charges do not attract or repel each other.
    charge: f64 = 0.0,
        "charge" => ValueKind::Number(Bounds::signed(1e12, "C")), Usual, Some("charges");
}

declare! {
    /// A spring and the damper beside it.
    SPRINGS: Spring, list springs, "a spring: a mapping with `particle_ids` and `stiffness`",
    reserved [];

    /// Two different particles.
    ends: [usize; 2] = [0, 1], "particle_ids" => ValueKind::Ids(2),
        Required("name the two ends: `particle_ids: [0, 1]`"), Some("ids");
    /// k, N/m, not negative.
    stiffness: f64 = 0.0, "stiffness" => ValueKind::Number(limits::STIFFNESS),
        Required("a spring needs its stiffness in N/m"), Some("stiffness");
    /// q, N/m³, not negative: adds q (l - L)³ to the pull.
    cubic: f64 = 0.0,
        "cubic" => ValueKind::Number(Bounds::not_negative(1e18, "N/m³")), Usual, Some("cubic");
    /// c, N s/m, not negative.
    damping: f64 = 0.0,
        "damping" => ValueKind::Number(Bounds::not_negative(1e18, "N s/m")), Usual, Some("damping");
    /// L, metres, not negative. A file without it means the initial distance of the ends.
    rest_length: f64 = 0.0, "rest_length" => ValueKind::Number(Bounds::not_negative(1e12, "m")),
        Derived, Some("rest_lengths");
}

declare! {
    /// An exact distance of two particles, kept by the forces that this takes. Not to be confused with a stiff spring.
    RODS: Rod, list rods, "a rod: a mapping with `particle_ids`", reserved [];

    /// Two different particles, at least one of them free.
    ends: [usize; 2] = [0, 1], "particle_ids" => ValueKind::Ids(2),
        Required("name the two ends: `particle_ids: [0, 1]`"), Some("ids");
    /// Metres, positive: the distance at the start, to 1e-9 of it. A file without it means just that distance.
    length: f64 = 1.0, "length" => ValueKind::Number(Bounds::from(1e-30, 1e12, "m")),
        Derived, Some("lengths");
}

declare! {
    /// How rods are kept to their lengths. It is the method's, not the motion's: no truth depends on it.
    CONSTRAINTS: Constraints, maybe constraints, "a mapping with `stabilisation`", reserved [];

    /// What is done about the drift of rods.
    stabilisation: Stabilisation = Stabilisation::Project,
        "stabilisation" => ValueKind::Word(Stabilisation::WORDS), Usual, None;
    /// The rate of baumgarte, 1/s, at which an error of a rod decays.
    rate: f64 = 10.0, "rate" => ValueKind::Number(Bounds::not_negative(1e12, "1/s")), Usual, None;
}

declare! {
    /// The strain that no spring goes beyond: after each step springs that are too long are shortened (Provot 1995). Springs
    /// without a rest length, and between fixed particles, are left out. There is no truth with it: what comes out depends
    /// on the timestep and on the sweeps.
    STRAIN_LIMIT: StrainLimit, maybe strain_limit, "a mapping such as {ratio: 0.1}", reserved [];

    /// The part of its rest length by which a spring may be longer.
    ratio: f64 = 0.1, "ratio" => ValueKind::Number(Bounds::not_negative(1e6, "a part of the rest length")), Usual, None;
    /// The most sweeps over all springs, in the order of the scene, after a step; none where no spring is beyond its limit.
    iterations: usize = 10, "iterations" => ValueKind::Count(Bounds::from(1.0, 1e6, "sweeps")), Usual, None;
    /// Whether springs may not be shorter by that part either.
    also_compression: bool = false, "also_compression" => ValueKind::Flag, Usual, None;
}

declare! {
    /// A triangle of particles that the air drags at, such as a patch of cloth.
    TRIANGLES: Triangle, list triangles, "a triangle: a mapping with `particle_ids` and `air_drag`",
    reserved [];

    /// Three different particles, in any order.
    corners: [usize; 3] = [0, 1, 2], "particle_ids" => ValueKind::Ids(3),
        Required("name the three corners: `particle_ids: [0, 1, 2]`"), Some("ids");
    /// Drag coefficient C, a pure number: the force is -density C A |u·n| (u·n) n / 2.
    air_drag: f64 = 0.0,
        "air_drag" => ValueKind::Number(Bounds::not_negative(1e12, "a pure number")),
        Required("give its drag coefficient, as 1.0"), Some("air_drag");
}

declare! {
    /// A hinge at the middle of three particles, which resists bending.
    BENDING: Bending, list bending, "a hinge: a mapping with `particle_ids` and `stiffness`",
    reserved [];

    /// Three different particles, in the order of the chain they form.
    particles: [usize; 3] = [0, 1, 2], "particle_ids" => ValueKind::Ids(3),
        Required("name three particles in a row: `particle_ids: [0, 1, 2]`"), Some("ids");
    /// kb, N m/rad, not negative.
    stiffness: f64 = 0.0,
        "stiffness" => ValueKind::Number(Bounds::not_negative(1e18, "N m/rad")),
        Required("a hinge needs its stiffness in N m/rad"), Some("stiffness");
    /// θ0, rad, from 0 (straight) to π (folded back).
    rest_angle: f64 = 0.0,
        "rest_angle" => ValueKind::Number(Bounds::not_negative(std::f64::consts::PI, "rad")),
        Usual, Some("rest_angles");
    /// c, N m s/rad, not negative: resists the rate of the angle.
    damping: f64 = 0.0,
        "damping" => ValueKind::Number(Bounds::not_negative(1e18, "N m s/rad")),
        Usual, Some("damping");
}

declare! {
    /// Attraction G m1 m2 / r² between two particles.
    GRAVITATIONAL: GravitationalPair, list gravitational,
    "a pair: a mapping with `particle_ids` and `G`",
    reserved [];

    /// Two different particles.
    ends: [usize; 2] = [0, 1], "particle_ids" => ValueKind::Ids(2),
        Required("name the two particles: `particle_ids: [0, 1]`"), Some("ids");
    /// G, N m²/kg²; negative repels.
    g: f64 = 0.0, "G" => ValueKind::Number(Bounds::signed(1e30, "N m²/kg²")),
        Required("give the constant of attraction in N m²/kg²"), Some("g");
}

declare! {
    /// The motion of a fixed particle, in addition to its position: one of the three.
    DRIVEN: Driven, list driven,
    "a motion: a mapping with `particle_id` and one of `sine`, `velocity` and `table`",
    reserved [];

    /// A fixed particle.
    particle: usize = 0, "particle_id" => ValueKind::Id,
        Required("say which particle it moves"), Some("ids");
    /// It swings.
    sine: Option<Sine> = None, "sine" => ValueKind::Part(&SINE), Usual, None;
    /// Metres per second: it moves on and on.
    velocity: Option<[f64; 3]> = None,
        "velocity" => ValueKind::Numbers(3, Bounds::signed(limits::DRIVEN_SPEED, "m/s")), Usual, Some("velocities");
    /// Rows of a time, s, ascending, and a displacement, m: it passes them on a natural cubic spline.
    table: Option<Knots> = None,
        "table" => ValueKind::Table(4, 2, Bounds::signed(1e12, "s, then m")), Usual, Some("tables");
}

declare! {
    /// A displacement amplitude sin(omega t + phase).
    SINE (driven sine) and MOTION_SINE (colliders driven sine): Sine, inside, "a mapping with `amplitude` and `omega`",
    reserved [];

    /// Metres.
    amplitude: [f64; 3] = [0.0; 3], "amplitude" => ValueKind::Numbers(3, limits::POSITION),
        Required("give how far it swings: `amplitude: [x, y, z]`"), Some("amplitudes");
    /// Rate of the phase, rad/s. Not to be confused with the frequency in 1/s, which is omega / 2π.
    omega: f64 = 0.0, "omega" => ValueKind::Number(Bounds::signed(1e12, "rad/s")),
        Required("give the rate of its phase in rad/s"), Some("omegas");
    /// Phase at t = 0, rad.
    phase: f64 = 0.0, "phase" => ValueKind::Number(Bounds::signed(1e12, "rad")),
        Usual, Some("phases");
}

declare! {
    /// An obstacle: one shape, at rest or moved. Free particles collide with it, each as a ball of its radius.
    COLLIDERS: Collider, list colliders,
    "an obstacle: a mapping with one of `plane`, `ball`, `box`, `capsule` and `mesh`", reserved [];

    /// All behind a plane.
    plane: Option<Plane> = None, "plane" => ValueKind::Part(&PLANE), Usual, None;
    /// A ball.
    ball: Option<Ball> = None, "ball" => ValueKind::Part(&BALL), Usual, None;
    /// A box.
    block: Option<Block> = None, "box" => ValueKind::Part(&BOX), Usual, None;
    /// A cylinder with a half ball at each end.
    capsule: Option<Capsule> = None, "capsule" => ValueKind::Part(&CAPSULE), Usual, None;
    /// Triangles.
    mesh: Option<Mesh> = None, "mesh" => ValueKind::Part(&MESH), Usual, None;
    /// Its motion, in addition to its place.
    driven: Option<Motion> = None, "driven" => ValueKind::Part(&MOTION), Usual, None;
    /// e, from 0 to 1: the part of the normal velocity that an impact gives back (Newton).
    restitution: f64 = 0.0, "restitution" => ValueKind::Number(Bounds::from(0.0, 1.0, "a part of the speed")),
        Usual, Some("restitution");
    /// µ: sliding friction is µ times the normal force (Coulomb).
    friction: f64 = 0.0, "friction" => ValueKind::Number(Bounds::not_negative(1e6, "a pure number")),
        Usual, Some("friction");
    /// What sticks slides beyond this times the normal force; not below `friction`, which it is where it is absent.
    static_friction: f64 = 0.0,
        "static_friction" => ValueKind::Number(Bounds::not_negative(1e6, "a pure number")),
        Derived, Some("static_friction");
}

declare! {
    /// A half space: what is behind a plane is solid.
    PLANE: Plane, inside (colliders plane), "a mapping with `normal` and `offset`", reserved [];

    /// Points out of the solid; a unit vector, in the file of any length but 0.
    normal: [f64; 3] = [0.0, 0.0, 1.0],
        "normal" => ValueKind::Numbers(3, Bounds::signed(1e12, "any unit")),
        Required("say which side is free: `normal: [0, 0, 1]`"), Some("normals");
    /// Metres along the unit normal from the origin.
    offset: f64 = 0.0, "offset" => ValueKind::Number(limits::POSITION), Usual, Some("offsets");
}

declare! {
    /// A solid ball.
    BALL: Ball, inside (colliders ball), "a mapping with `center` and `radius`", reserved [];

    /// Metres.
    center: [f64; 3] = [0.0; 3], "center" => ValueKind::Numbers(3, limits::POSITION),
        Required("say where it is: `center: [x, y, z]`"), Some("centers");
    /// Metres, positive.
    radius: f64 = 1.0, "radius" => ValueKind::Number(limits::OBSTACLE),
        Required("give its radius in metres"), Some("radii");
}

declare! {
    /// A solid box.
    BOX: Block, inside (colliders block), "a mapping with `center` and `half_extents`", reserved [];

    /// Metres.
    center: [f64; 3] = [0.0; 3], "center" => ValueKind::Numbers(3, limits::POSITION),
        Required("say where it is: `center: [x, y, z]`"), Some("centers");
    /// Metres from the centre to each side, positive.
    half_extents: [f64; 3] = [1.0; 3], "half_extents" => ValueKind::Numbers(3, limits::OBSTACLE),
        Required("give half of its length, depth and height in metres"), Some("half_extents");
    /// The axis it is turned about, of a length that is the angle, rad, up to a whole turn.
    rotation: [f64; 3] = [0.0; 3], "rotation" => ValueKind::Numbers(3, Bounds::signed(std::f64::consts::TAU, "rad")),
        Usual, Some("rotations");
}

declare! {
    /// All points within a radius of a segment.
    CAPSULE: Capsule, inside (colliders capsule), "a mapping with `a`, `b` and `radius`", reserved [];

    /// One end of the segment, m.
    a: [f64; 3] = [0.0; 3], "a" => ValueKind::Numbers(3, limits::POSITION),
        Required("give one end of its axis: `a: [x, y, z]`"), Some("a");
    /// The other end, m.
    b: [f64; 3] = [1.0, 0.0, 0.0], "b" => ValueKind::Numbers(3, limits::POSITION),
        Required("give the other end of its axis: `b: [x, y, z]`"), Some("b");
    /// Metres, positive.
    radius: f64 = 1.0, "radius" => ValueKind::Number(limits::OBSTACLE),
        Required("give its radius in metres"), Some("radii");
}

declare! {
    /// A surface of triangles, solid from both sides and without an inside.
    MESH: Mesh, inside (colliders mesh), "a mapping with `vertices` and `triangles`", reserved [];

    /// Rows x, y, z, m.
    vertices: Table<3> = Table(Vec::new()), "vertices" => ValueKind::Table(3, 3, limits::POSITION),
        Required("list its corners: `vertices: [[x, y, z], ...]`"), Some("vertices");
    /// Rows of three vertices, which count from 0.
    triangles: Table<3> = Table(Vec::new()),
        "triangles" => ValueKind::Table(3, 1, Bounds::not_negative(limits::VERTICES, "a vertex")),
        Required("list its triangles: `triangles: [[0, 1, 2], ...]`"), Some("triangles");
}

declare! {
    /// The motion of an obstacle, in addition to its place: one of the three, as of a driven particle.
    MOTION: Motion, inside (colliders driven), "one of `sine`, `velocity` and `table`", reserved [];

    /// It swings.
    sine: Option<Sine> = None, "sine" => ValueKind::Part(&MOTION_SINE), Usual, None;
    /// Metres per second: it moves on and on. A plane that moves along itself is a belt.
    velocity: Option<[f64; 3]> = None,
        "velocity" => ValueKind::Numbers(3, Bounds::signed(limits::DRIVEN_SPEED, "m/s")), Usual, Some("velocities");
    /// Rows of a time, s, ascending, and a displacement, m: it passes them on a natural cubic spline.
    table: Option<Knots> = None,
        "table" => ValueKind::Table(4, 2, Bounds::signed(1e12, "s, then m")), Usual, Some("tables");
}

declare! {
    /// How particles collide: with each other, if they do, and all of them by a spring instead of impulses, if that is asked
    /// for. Particles that a spring or a rod joins do not collide, nor do fixed ones.
    CONTACT: Contact, maybe contact, "a mapping such as {particles: true, restitution: 0.5}", reserved [];

    /// Whether free particles collide with each other, each as a ball of its radius.
    particles: bool = false, "particles" => ValueKind::Flag, Usual, Some("particles");
    /// e of particles with each other, from 0 to 1.
    restitution: f64 = 0.0, "restitution" => ValueKind::Number(Bounds::from(0.0, 1.0, "a part of the speed")),
        Usual, Some("restitution");
    /// µ of particles with each other.
    friction: f64 = 0.0, "friction" => ValueKind::Number(Bounds::not_negative(1e6, "a pure number")),
        Usual, Some("friction");
    /// µ of particles that stick to each other; not below `friction`, which it is where it is absent.
    static_friction: f64 = 0.0,
        "static_friction" => ValueKind::Number(Bounds::not_negative(1e6, "a pure number")),
        Derived, Some("static_friction");
    /// A spring and a damper at every contact, instead of impulses and constraints.
    penalty: Option<Penalty> = None, "penalty" => ValueKind::Part(&PENALTY), Usual, None;
}

declare! {
    /// A spring and a damper while a particle is inside: the force k d + c d' for the depth d, from d = 0 until d = 0 again.
    PENALTY: Penalty, inside (contact penalty), "a mapping with `stiffness`", reserved [];

    /// k, N/m, positive.
    stiffness: f64 = 1.0, "stiffness" => ValueKind::Number(Bounds::from(1e-12, 1e15, "N/m")),
        Required("give its stiffness in N/m, as 10000"), Some("stiffness");
    /// c, N s/m.
    damping: f64 = 0.0, "damping" => ValueKind::Number(Bounds::not_negative(1e15, "N s/m")),
        Usual, Some("damping");
}

/// Rows [t, x, y, z] of a table, s and m.
pub type Knots = Table<4>;

/// Rows of as many numbers.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table<const N: usize>(pub Vec<[f64; N]>);

impl<const N: usize> Field for Table<N> {
    fn value(&self, component: usize) -> Option<Value<'_>> {
        self.0.get(component / N)?.value(component % N)
    }

    fn put(&mut self, component: usize, value: Value<'_>) {
        if component / N == self.0.len() {
            self.0.push([0.0; N]);
        }
        if let Some(row) = self.0.get_mut(component / N) {
            row.put(component % N, value);
        }
    }
}

declare! {
    /// A constant force on every free particle, whatever its mass. Not to be confused with moving air.
    WIND: Wind, maybe wind, "a mapping with `direction` and `strength`",
    reserved ["profile"];

    /// Unit vector; in the file of any length but 0.
    direction: [f64; 3] = [1.0, 0.0, 0.0],
        "direction" => ValueKind::Numbers(3, Bounds::signed(1e12, "any unit")),
        Required("say where it blows: `direction: [1, 0, 0]`"), Some("wind_force");
    /// Newtons; negative blows the other way.
    strength: f64 = 0.0, "strength" => ValueKind::Number(Bounds::signed(1e18, "N")),
        Required("give its force in newtons"), Some("wind_force");
}

declare! {
    /// The air, the same everywhere. Not to be confused with `wind`, which is a force and needs no drag.
    AIR: Air, maybe air, "a mapping with `velocity` and `density`", reserved [];

    /// Metres per second.
    velocity: [f64; 3] = [0.0; 3],
        "velocity" => ValueKind::Numbers(3, Bounds::signed(1e12, "m/s")), Usual,
        Some("air_velocity");
    /// Kilograms per cubic metre, by which triangles are dragged at.
    density: f64 = 1.2, "density" => ValueKind::Number(Bounds::not_negative(1e12, "kg/m³")),
        Usual, Some("air_density");
}

declare! {
    /// A uniform, constant magnetic field, which acts on charged particles.
    MAGNETIC: Magnetic, maybe magnetic, "a mapping with `field`", reserved [];

    /// B, tesla: the force is q v x B.
    field: [f64; 3] = [0.0; 3], "field" => ValueKind::Numbers(3, Bounds::signed(1e12, "T")),
        Required("give the field in tesla: `field: [0, 0, 3]`"), Some("magnetic_field");
}

/// Expectations have a reader of their own, and no rows.
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
    /// The index of the coordinate in a position: 0, 1 or 2.
    pub fn index(self) -> usize {
        self as usize
    }
}

/// What is done about the drift of rods: their forces keep accelerations right, so lengths drift with a method's errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Stabilisation {
    /// Positions and velocities are moved onto the rods after each step, each particle by its 1/m.
    Project,
    /// Forces pull a rod back like a damped oscillator (Baumgarte 1972).
    Baumgarte,
    /// Nothing.
    None,
}

words!(Stabilisation: "project" => Project, "baumgarte" => Baumgarte, "none" => None);

/// Which part of the relative velocity of a spring's ends its damper resists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum DampingModel {
    /// Only the component along the spring, as a physical dashpot.
    Axial,
    /// The full relative velocity. It resists rotation too, so angular momentum is lost.
    Isotropic,
}

words!(DampingModel: "axial" => Axial, "isotropic" => Isotropic);

impl Scene {
    /// Number of steps that cover the duration: N = ceil(duration / h - 1e-9), at least 1.
    pub fn steps(&self, timestep: f64) -> u64 {
        steps(self.duration, timestep)
    }

    /// The acceleration of gravity, m/s²: the number along `up` and the vectors, of which a file has either.
    pub fn gravity(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        sum[self.up.index()] = self.solver.gravity;
        for vector in &self.solver.gravities.0 {
            for (sum, part) in sum.iter_mut().zip(vector) {
                *sum += part;
            }
        }
        sum
    }

    /// The air, whether or not the scene says something of it.
    pub fn air(&self) -> Air {
        self.air.clone().unwrap_or_default()
    }

    /// The scene's size L in metres: the [diagonal](Self::diagonal) plus the longest spring at rest, or rod. It is the
    /// length scale of energies and tolerances; 0 for a lone particle.
    pub fn size(&self) -> f64 {
        let lengths = self.springs.iter().map(|s| s.rest_length);
        let lengths = lengths.chain(self.rods.iter().map(|rod| rod.length));
        self.diagonal() + lengths.fold(0.0, f64::max)
    }

    /// The diagonal of the box around all initial positions, m; 0 for a lone particle.
    pub fn diagonal(&self) -> f64 {
        if self.particles.is_empty() {
            return 0.0;
        }
        let corners = self.starts().into_iter().map(Vector::from);
        Aabb::from_points(corners).extents().length()
    }

    /// The expectations of an engine, each key once: those of its own line (or, for an integrator without
    /// one, of `rest`), then for an `integrator` those of `all` on other keys.
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
