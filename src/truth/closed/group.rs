//! Groups of particles that move independently of all others: each has a closed form of its own, or none.

use crate::joined::least_joined;
use crate::physics::State;
use crate::scene::{DampingModel, Drive, Scene, Spring};
use nalgebra::Vector3;

/// Free particles joined by springs, and what acts on them from t = 0 to `until`.
#[derive(Debug, Clone)]
pub(super) struct Group<'a> {
    /// In the order of their ids.
    pub bodies: Vec<Body>,
    pub links: Vec<Link<'a>>,
    pub rods: Vec<Held>,
    pub until: f64,
    /// The scene's size, m.
    pub size: f64,
}

/// A free particle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    /// Index in the scene.
    pub id: usize,
    pub mass: f64,
    /// m.
    pub radius: f64,
    pub drag: f64,
    /// c of its quadratic drag, N s²/m².
    pub quadratic: f64,
    /// Velocity of the air, m/s.
    pub air: Vector3<f64>,
    /// At the start: position, m, and velocity, m/s.
    pub position: Vector3<f64>,
    pub velocity: Vector3<f64>,
    /// Acceleration under gravity, wind and the linear drag of air that moves at what is at rest, m/s²: equal
    /// masses and drags have the same bits, and under gravity alone all have.
    pub constant: Vector3<f64>,
    /// q B / m, 1/s: a magnetic field turns the velocity v by v x this a second.
    pub turning: Vector3<f64>,
}

/// A rod of a group.
#[derive(Debug, Clone)]
pub(super) struct Held {
    /// Index in `bodies` of each end; None for a fixed end.
    pub ends: [Option<usize>; 2],
    /// Positions of its ends at the start, m.
    pub at: [Vector3<f64>; 2],
    /// Whether one of them is driven.
    pub driven: bool,
}

/// A spring and damper of a group.
#[derive(Debug, Clone)]
pub(super) struct Link<'a> {
    pub spring: &'a Spring,
    /// Index in `bodies` of each end; None for a fixed end.
    pub ends: [Option<usize>; 2],
    /// Positions of its ends at the start, m.
    pub at: [Vector3<f64>; 2],
    /// The motion of each end that is driven.
    pub drives: [Option<Drive>; 2],
    /// Damping along its direction alone, N s/m; 0 where the scene's dampers have none.
    pub axial_damping: f64,
}

/// The groups of a scene: free particles that springs or rods join, directly or through one another; fixed
/// ones join nothing. Groups are in order of their first particle.
pub(super) fn groups<'a>(scene: &'a Scene, start: &State, until: f64) -> Vec<Group<'a>> {
    let fixed = |i: usize| scene.particles[i].fixed;
    let acts = |spring: &&Spring| {
        (spring.stiffness > 0.0 || spring.damping > 0.0) && !spring.ends.into_iter().all(fixed)
    };
    let springs: Vec<&Spring> = scene.springs.iter().filter(acts).collect();
    let joined = springs.iter().map(|spring| spring.ends);
    let joined = joined.chain(scene.rods.iter().map(|rod| rod.ends));
    let free = joined.filter(|ends| !ends.iter().any(|end| fixed(*end)));
    let first = least_joined(scene.particles.len(), free);
    let gravity = Vector3::from(scene.gravity());
    let wind = scene.wind.as_ref().map_or(Vector3::zeros(), |wind| {
        wind.strength * Vector3::from(wind.direction)
    });
    let air = Vector3::from(scene.air().velocity);
    let field = scene
        .magnetic
        .as_ref()
        .map_or(Vector3::zeros(), |magnetic| magnetic.field.into());
    let position = |i: usize| Vector3::from_column_slice(&start.x[3 * i..3 * i + 3]);
    let drives = scene.drives();
    let drive = |i: usize| drives.iter().find(|drive| drive.particle == i).cloned();
    let size = scene.size();
    let mut groups: Vec<Group> = Vec::new();
    let mut group_of = vec![usize::MAX; first.len()];
    for i in (0..first.len()).filter(|&i| !fixed(i)) {
        let root = first[i];
        if group_of[root] == usize::MAX {
            group_of[root] = groups.len();
            groups.push(Group {
                bodies: Vec::new(),
                links: Vec::new(),
                rods: Vec::new(),
                until,
                size,
            });
        }
        let particle = &scene.particles[i];
        groups[group_of[root]].bodies.push(Body {
            id: i,
            mass: particle.mass,
            radius: particle.radius,
            drag: particle.drag,
            position: position(i),
            velocity: Vector3::from_column_slice(&start.v[3 * i..3 * i + 3]),
            quadratic: particle.quadratic_drag,
            air,
            constant: gravity + (wind + air * particle.drag) / particle.mass,
            turning: field * particle.charge / particle.mass,
        });
    }
    for spring in springs {
        let [a, b] = spring.ends;
        let root = first[if fixed(a) { b } else { a }];
        let group = &mut groups[group_of[root]];
        let place = |end| group.bodies.binary_search_by_key(&end, |body| body.id).ok();
        group.links.push(Link {
            spring,
            ends: spring.ends.map(place),
            at: spring.ends.map(position),
            drives: spring.ends.map(drive),
            axial_damping: match scene.damping_model {
                DampingModel::Axial => spring.damping,
                DampingModel::Isotropic => 0.0,
            },
        });
    }
    for rod in &scene.rods {
        let [a, b] = rod.ends;
        let root = first[if fixed(a) { b } else { a }];
        let group = &mut groups[group_of[root]];
        let place = |end| group.bodies.binary_search_by_key(&end, |body| body.id).ok();
        group.rods.push(Held {
            ends: rod.ends.map(place),
            at: rod.ends.map(position),
            driven: rod.ends.iter().any(|end| drive(*end).is_some()),
        });
    }
    groups
}

/// The smallest number of which a rounding is still a normal one.
const SMALLEST: f64 = f64::MIN_POSITIVE / f64::EPSILON;

/// Whether a number is 0 or far from both ends of a double's range: then it is right to a rounding, and so are its sums.
/// Nearer to 0 it has lost digits, and what is divided by it has lost as many.
pub(super) fn is_plain(x: f64) -> bool {
    x == 0.0 || (SMALLEST..=1.0 / SMALLEST).contains(&x.abs())
}

impl Group<'_> {
    /// Whether all rates, accelerations and velocities are [plain](is_plain) numbers. Where one is not, no form's error
    /// bar holds.
    pub fn is_plain(&self) -> bool {
        let bodies = self.bodies.iter().all(|body| {
            let vectors = [body.velocity, body.constant, body.turning];
            let rates = [body.drag, body.quadratic].map(|of| of / body.mass);
            let vectors = vectors.iter().flat_map(|vector| vector.iter());
            vectors.chain(&rates).copied().all(is_plain)
        });
        let links = self.links.iter().all(|link| {
            let ends = link.ends.into_iter().flatten();
            let mut rates = ends.flat_map(|end| {
                let mass = self.bodies[end].mass;
                [link.spring.stiffness, link.spring.damping].map(|of| of / mass)
            });
            rates.all(is_plain)
        });
        bodies && links
    }

    /// Whether some spring ends at a driven particle.
    pub fn is_driven(&self) -> bool {
        self.links
            .iter()
            .any(|link| link.drives.iter().any(Option::is_some))
    }

    /// Whether every force is linear wherever the particles are: no spring has a rest length, and no
    /// damper a direction.
    pub fn is_linear(&self) -> bool {
        let linear = |link: &Link| !link.has_rest_length() && link.axial_damping <= 0.0;
        self.links.iter().all(linear)
    }
}

impl Link<'_> {
    /// Whether the spring pulls towards a length other than 0.
    pub fn has_rest_length(&self) -> bool {
        self.spring.stiffness > 0.0 && self.spring.rest_length > 0.0
    }

    /// The vector from its first end to its second at the start, m.
    pub fn between(&self) -> Vector3<f64> {
        self.at[1] - self.at[0]
    }
}
