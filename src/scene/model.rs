//! The scene as the file states it, checked and complete: every default resolved, every id valid.

use super::expectation::Expectation;
use parry3d::bounding_volume::Aabb;
use parry3d::math::Vector;
use serde::Serialize;

/// A checked scene. Particle ids are indices into `particles`.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// `name`, or the file's stem.
    pub name: String,
    pub description: Option<String>,
    /// The file as it was named on the command line; empty for a scene built in code.
    pub file: String,
    pub solver: Solver,
    /// Seconds, at least one timestep. Default 5.
    pub duration: f64,
    /// The axis gravity acts along. Default z.
    pub up: Axis,
    pub damping_model: DampingModel,
    pub plot: Option<Plot>,
    pub particles: Vec<Particle>,
    pub springs: Vec<Spring>,
    pub gravitational: Vec<GravitationalPair>,
    pub wind: Option<Wind>,
    /// What engines must do, in the order of the file. Changes no run.
    pub expect: Vec<Expectation>,
}

/// What the file asks for under `solver`.
#[derive(Debug, Clone, PartialEq)]
pub struct Solver {
    /// An integrator's id: `type` in the file.
    pub method: String,
    /// Seconds, positive.
    pub timestep: f64,
    /// Signed acceleration along `up`, m/s². Default -9.81.
    pub gravity: f64,
    /// Relative residual at which an implicit method's solve ends; the method's own if absent.
    pub tolerance: Option<f64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    X,
    Y,
    Z,
}

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

#[derive(Debug, Clone, PartialEq)]
pub struct Particle {
    /// Metres.
    pub position: [f64; 3],
    /// Metres per second; zero for a fixed particle.
    pub velocity: [f64; 3],
    pub fixed: bool,
    /// Kilograms, positive.
    pub mass: f64,
    /// Metres; the ball's radius once a scene asks for contact. Default 0.1.
    pub radius: f64,
    /// Linear drag coefficient, N s/m. Default 0.
    pub drag: f64,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Spring {
    /// Two different particles.
    pub ends: [usize; 2],
    /// N/m, not negative.
    pub stiffness: f64,
    /// N/m³, not negative: adds cubic (l - L)³ to the pull. Default 0.
    pub cubic: f64,
    /// N s/m, not negative. Default 0.
    pub damping: f64,
    /// Metres, not negative. Default: the initial distance of the ends.
    pub rest_length: f64,
}

/// Attraction G m1 m2 / r² between two particles.
#[derive(Debug, Clone, PartialEq)]
pub struct GravitationalPair {
    pub ends: [usize; 2],
    /// N m²/kg².
    pub g: f64,
}

/// A constant force on every free particle.
#[derive(Debug, Clone, PartialEq)]
pub struct Wind {
    /// Unit vector.
    pub direction: [f64; 3],
    /// Newtons.
    pub strength: f64,
}

/// The curve the report shows first.
#[derive(Debug, Clone, PartialEq)]
pub struct Plot {
    pub particle: usize,
    /// Coordinate 0, 1 or 2.
    pub dof: usize,
    pub y_range: Option<[f64; 2]>,
}

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
}

/// N = ceil(duration / h - 1e-9): the run ends at N h, at or just past the duration.
pub fn steps(duration: f64, timestep: f64) -> u64 {
    ((duration / timestep - 1e-9).ceil() as u64).max(1)
}
