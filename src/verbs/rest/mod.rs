//! Where a scene comes to rest, how it oscillates about that, and what refining its objects does to both.

mod args;
mod balance;
mod figures;
mod refine;
mod result;
mod text;

pub use args::{Args, rest};
pub(super) use figures::FIGURES;
pub use result::{AtRest, Balance, Moved, Oscillation, Pull, Refined, RestShape, Trend};
pub(super) use text::{page, view};

use crate::measure::energy_scale;
use crate::physics::ParticleSystem;
use crate::report::Header;
use crate::scene::Scene;
use crate::truth::Truth;
use crate::verbs::session::{Label, TimeEstimate};
use crate::verbs::{Body, Report, Series, SeriesState, facts};
use std::time::Instant;

/// The most particles of a scene that is drawn: the file of the picture has them all.
const DRAWN: usize = 20_000;

/// Why nothing is looked for among obstacles.
const OBSTACLES: &str = "contact is not part of the search: run the scene with some damping until it rests, or remove `colliders` and `contact`";

/// Seconds that a particle takes; in a sheet times the number of particles to the power 0.2: a cloth of 40 x 40 takes 2 s.
const EACH: f64 = 2.5e-4;

/// The question about one scene.
#[derive(Debug, Clone)]
pub struct RestPlan<'a> {
    pub scene: &'a Scene,
    /// How many links each link of an object becomes, ascending; empty where nobody asks.
    pub links: Vec<u64>,
}

impl RestPlan<'_> {
    /// About how long the scene itself takes, before anything is known of it.
    pub fn estimates(&self) -> [TimeEstimate; 1] {
        let particles = self.scene.particles.len();
        // Rows of particles have factors as long as themselves.
        let sheet = self.scene.springs.len() as f64 > 1.5 * particles as f64;
        let power = if sheet { 1.2 } else { 1.0 };
        [TimeEstimate {
            label: Label {
                engine: "the scene".to_owned(),
                timestep: 0.0,
                steps: 0,
                particles,
            },
            seconds: EACH * (particles as f64).powf(power),
        }]
    }

    /// Finds the rest, and that of finer scenes in parallel. Returns the report, and the scene at rest where there is one.
    ///
    /// What refining will take is told to `expect`, from what the scene itself took.
    pub fn execute(&self, expect: impl FnOnce(&[TimeEstimate])) -> (Report, Option<Scene>) {
        let scene = self.scene;
        let system = ParticleSystem::new(scene);
        let clock = Instant::now();
        let (reason, found) = match balance::find(scene) {
            // The search knows of no obstacle.
            _ if scene.collides() => (Some(OBSTACLES.to_owned()), None),
            Ok(found) => (None, Some(found)),
            Err(error) => (Some(error.to_string()), None),
        };
        let watched = found.as_ref().and_then(|(_, balance)| balance.farthest);
        let watched = watched.map(|moved| moved.particle);
        expect(&refine::estimates(scene, &self.links, clock.elapsed()));
        let refined = refine::refined(scene, &self.links, watched);
        let settled = found.as_ref().map(|(rest, _)| settled(scene, &rest.x));
        let truth = Truth::none("rest compares nothing with a truth");
        let report = Report {
            header: Header {
                scene: facts::scene(scene, &system, [0; 2], energy_scale(scene, &system, None)),
                truth: facts::truth(&truth),
                checks: Vec::new(),
                advice: Vec::new(),
            },
            body: Body::Rest {
                outcomes: [],
                rest: AtRest {
                    reason,
                    found: found.map(|(_, balance)| balance),
                    trends: refine::trends(&refined),
                    refined,
                },
            },
            series: match &settled {
                Some(scene) if scene.particles.len() <= DRAWN => {
                    SeriesState::Loaded(Series::Shape(RestShape {
                        scene: Box::new(scene.clone()),
                        start: ParticleSystem::initial_state(self.scene).x,
                    }))
                }
                _ => SeriesState::Nothing,
            },
        };
        (report, settled)
    }
}

/// The scene as it starts from its rest: nothing moves, and nothing is expected any more. What is driven keeps its place,
/// since its motion is added to that.
fn settled(scene: &Scene, x: &[f64]) -> Scene {
    let mut settled = scene.clone();
    let driven: Vec<usize> = scene.driven.iter().map(|motion| motion.particle).collect();
    for (id, (particle, x)) in settled
        .particles
        .iter_mut()
        .zip(x.chunks_exact(3))
        .enumerate()
    {
        if !driven.contains(&id) {
            particle.position.copy_from_slice(x);
            particle.velocity = [0.0; 3];
        }
    }
    settled.bodies.clear();
    settled.written = None;
    settled.expect.clear();
    settled.skip.clear();
    settled
}
