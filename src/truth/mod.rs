//! The true motion of a scene: a closed form where its contents allow one, otherwise a reference
//! converged until two independent estimates agree. Both come with an error bar.
//!
//! Not to be confused with rapier, which is one more method.

pub mod closed;
pub mod converged;

use crate::physics::{ParticleSystem, System};
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TruthKind {
    ClosedForm,
    Converged,
    None,
}

/// A known motion.
pub trait Motion: Send + Sync {
    /// Positions (m) and velocities (m/s) of all coordinates at each of these times, s, which are
    /// ascending and lie between 0 and the `until` the motion was found for.
    fn states(&self, times: &[f64]) -> States;

    /// Bound on the distance of any position in [0, t] from the true one, m.
    fn error_bar(&self, t: f64) -> f64;

    /// Ascending times in [0, `until`] at which states cost least, close enough together to show
    /// the motion.
    fn landmarks(&self, until: f64) -> Vec<f64> {
        let part = |k: u32| until * f64::from(k) / f64::from(LANDMARKS);
        (0..=LANDMARKS).map(part).collect()
    }
}

const LANDMARKS: u32 = 1_000;

/// States at given times, all of one length.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct States {
    /// Number of coordinates of a state.
    pub dim: usize,
    /// One state after the other.
    pub x: Vec<f64>,
    pub v: Vec<f64>,
}

impl States {
    /// No states yet, with room for `states` states of `dim` coordinates.
    pub fn with_room(dim: usize, states: usize) -> Self {
        Self {
            dim,
            x: Vec::with_capacity(states * dim),
            v: Vec::with_capacity(states * dim),
        }
    }

    /// Adds a state.
    pub fn push(&mut self, x: &[f64], v: &[f64]) {
        self.x.extend_from_slice(x);
        self.v.extend_from_slice(v);
    }

    /// Number of states.
    pub fn len(&self) -> usize {
        self.x.len() / self.dim.max(1)
    }

    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    pub fn x(&self, k: usize) -> &[f64] {
        &self.x[k * self.dim..(k + 1) * self.dim]
    }

    pub fn v(&self, k: usize) -> &[f64] {
        &self.v[k * self.dim..(k + 1) * self.dim]
    }
}

/// Largest distance between the same particle of two states, three coordinates each, m; infinite where a
/// coordinate is not finite. A system of fewer than three coordinates is one particle.
pub(crate) fn farthest(a: &[f64], b: &[f64]) -> f64 {
    let particles = a.chunks(3).zip(b.chunks(3));
    let squares = particles.map(|(a, b)| {
        let coordinates = a.iter().zip(b);
        coordinates.map(|(a, b)| (a - b) * (a - b)).sum::<f64>()
    });
    let largest = squares.fold(0.0, |most: f64, square| {
        if square.is_nan() {
            f64::INFINITY
        } else {
            most.max(square)
        }
    });
    largest.sqrt()
}

/// The truths that are wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Demand {
    /// A closed form if there is one, else a converged reference.
    #[default]
    Auto,
    /// A closed form or none.
    Closed,
    None,
}

/// Keeps results that are expensive to compute, under a key made of what they depend on. It may forget, and
/// it may be shared by programs that run at once; what it returns is checked before it is used.
pub trait Store: Sync {
    /// The bytes saved under this key, which is in lower-case hexadecimal digits.
    fn load(&self, key: &str) -> Option<Vec<u8>>;

    /// Failing to save is no error: it is computed again next time.
    fn save(&self, key: &str, bytes: &[u8]);
}

/// Keeps nothing.
#[derive(Debug, Clone, Copy, Default)]
pub struct NoStore;

impl Store for NoStore {
    fn load(&self, _key: &str) -> Option<Vec<u8>> {
        None
    }
    fn save(&self, _key: &str, _bytes: &[u8]) {}
}

/// A scene's truth.
pub struct Truth {
    pub kind: TruthKind,
    /// Such as `parabola`, or the reference's method and steps; None without truth.
    pub method: Option<String>,
    /// Why this form applies, or why there is none.
    pub reason: String,
    /// The last time at which the error bar is below 1e-6 of the scene's size; 0 without truth.
    pub horizon: f64,
    /// Largest bar up to the horizon, m.
    pub error_bound: f64,
    motion: Option<Box<dyn Motion>>,
}

/// The truth of a scene up to `until` seconds, as far as demanded.
pub fn find(
    scene: &Scene,
    system: &ParticleSystem,
    demand: Demand,
    until: f64,
    store: &dyn Store,
) -> Truth {
    if demand == Demand::None {
        return Truth::none("not asked for");
    }
    if system.strain_limiter().is_some() {
        return Truth::none(
            "what a strain limit does depends on the timestep and on its sweeps: no motion is the true one",
        );
    }
    if let Some(found) = closed::find(scene, system, until)
        && found.error_bound.is_finite()
    {
        return found;
    }
    if demand == Demand::Closed {
        return Truth::none("no closed form known for what this scene contains");
    }
    match converged::find(scene, system, until, store) {
        Ok(found) => Truth {
            kind: TruthKind::Converged,
            method: Some(found.facts.method),
            reason: found.facts.reason,
            horizon: found.facts.horizon,
            error_bound: found.facts.error_bound,
            motion: Some(Box::new(found.motion)),
        },
        Err(not) => Truth::none(not.to_string()),
    }
}

/// Closed forms of larger scenes are not looked for beforehand.
const FEW: usize = 200;

/// About what [`find`] will take, in force evaluations times coordinates; 0 where it finds at once that there is a
/// closed form, a stored reference, or none.
pub fn expected(
    scene: &Scene,
    system: &ParticleSystem,
    demand: Demand,
    until: f64,
    store: &dyn Store,
) -> u64 {
    let few = scene.particles.len() <= FEW;
    if demand != Demand::Auto
        || system.strain_limiter().is_some()
        || (few && closed::find(scene, system, until).is_some())
    {
        return 0;
    }
    converged::expected(scene, system, until, store)
}

impl Truth {
    /// No truth, and why.
    pub fn none(reason: impl Into<String>) -> Self {
        Self {
            kind: TruthKind::None,
            method: None,
            reason: reason.into(),
            horizon: 0.0,
            error_bound: 0.0,
            motion: None,
        }
    }

    /// The motion, where there is a truth.
    pub fn motion(&self) -> Option<&dyn Motion> {
        self.motion.as_deref()
    }
}
