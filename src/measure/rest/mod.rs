//! Where a scene comes to rest: the state in which no force is left, and how it oscillates about it.

mod modes;
mod rods;
mod still;

pub use modes::{Mode, Modes, modes};

use crate::integrators::{Implicit, ImplicitScheme, Integrator, Settings};
use crate::physics::ParticleSystem;
use crate::scene::Scene;
use still::Still;

/// A state at rest.
#[derive(Debug, Clone, PartialEq)]
pub struct Rest {
    /// Positions, m, three a particle.
    pub x: Vec<f64>,
    /// The largest force left on a free particle, N: rounding.
    pub force_left: f64,
    /// Iterations of Newton's method that it took.
    pub iterations: u64,
}

/// Why no rest was found.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RestError {
    /// Nothing holds it.
    #[error("nothing holds particle {particle} and what it hangs on: that moves on without end")]
    NotHeld { particle: usize },
    /// Forces that change faster than numbers can tell, or that have no minimum.
    #[error(
        "no rest was found: a force of {force_left:.1e} N is left, largest at particle {particle}"
    )]
    NotFound { force_left: f64, particle: usize },
}

/// The first step is this part of the time in which the largest acceleration crosses the scene; each that was solved is
/// followed by one so many times longer, up to the longest, s.
const FIRST: f64 = 0.25;
const GROWTH: f64 = 8.0;
const LONGEST: f64 = 1e30;
/// A step that fails, or after which forces are so many times larger since air pulls another way, is too long: no longer than
/// this part of it are the next ones.
const SHORTER: f64 = 0.25;
const WORSE: f64 = 2.0;
/// Steps so many times longer than the first one are Newton's, which leave rounding.
const SETTLING: f64 = 1e4;
/// Where all forces have a potential the longest step grows by this in each.
const OPENED: f64 = 1.5;
/// The most steps, the most iterations of Newton's method in one, and in all.
const STEPS: usize = 400;
const ITERATIONS: u32 = 200;
const BUDGET: u64 = 6_000;
/// Moving air is given up where so many steps do not halve the forces.
const PATIENCE: usize = 40;
const HALVED: f64 = 0.5;
/// A particle that has moved by so many sizes of the scene is held by nothing.
const FAR: f64 = 1e9;
/// The part of the largest force of an effect that may be left where rounding of positions far from the origin leaves more.
const NEAR: f64 = 1e-9;

/// The scene as a rest sees it: nothing is driven; what would be is where it starts.
pub fn held(scene: &Scene) -> Scene {
    let start = ParticleSystem::initial_state(scene);
    let mut held = scene.clone();
    for (particle, x) in held.particles.iter_mut().zip(start.x.chunks_exact(3)) {
        particle.position.copy_from_slice(x);
        particle.velocity = [0.0; 3];
    }
    held.driven.clear();
    held
}

/// Finds the rest that the start leads to, as it would in honey: steps of implicit Euler, each from rest and longer than
/// the one before, are Newton's iteration on the potential in the end, and descend it until then.
///
/// Where several rests are, it is the one in whose valley the start lies; a start on a ridge may stay there, which
/// [`modes`] tell. Drives stand still at their start. Dampers do nothing at rest, and moving air pulls: what has no
/// potential changes in each step by the symmetric part of its slopes, so that the steps converge by a ratio.
///
/// # Errors
/// [`RestError`].
pub fn find(scene: &Scene) -> Result<Rest, RestError> {
    let scene = held(scene);
    if scene.rods.is_empty() {
        settle(&scene)
    } else {
        rods::find(&scene, settle)
    }
}

/// The same of a scene without rods, in which nothing is driven.
fn settle(scene: &Scene) -> Result<Rest, RestError> {
    let mut still = Still::new(scene);
    let start = ParticleSystem::initial_state(scene);
    let settings = Settings {
        iterations: ITERATIONS,
        ..Settings::default()
    };
    let mut method = Implicit::new(ImplicitScheme::Euler, &settings);
    let size = size(scene);
    let mut state = start.clone();
    let mut left = still.left(&state.x);
    let first = FIRST * (size / still.fastest(&state.x)).sqrt();
    let mut h = first;
    let mut longest = LONGEST;
    // The state with the least of its forces left, and the step at which these halved last.
    let (mut best, mut least, mut halved) = (state.clone(), left, (left.force, 0));
    for count in 0..STEPS {
        // What is left is nothing, or rounding that gets no less.
        let ended = least.force == 0.0
            || (least.rounded && h > SETTLING * first && left.force > HALVED * least.force);
        let stuck = still.is_pulled() && count > halved.1 + PATIENCE;
        if ended || stuck || method.newton_iterations() > BUDGET {
            break;
        }
        let before = state.clone();
        state.v.fill(0.0);
        let stepped = method.step(&still, h, &mut state);
        let (particle, moved) = farthest(&start.x, &state.x);
        let gone = !state.is_finite() || moved > FAR * size;
        if gone && !still.changes() {
            return Err(RestError::NotHeld { particle });
        }
        if gone || stepped.is_err() {
            state = before;
            (longest, h) = (SHORTER * h, SHORTER * SHORTER * h);
            continue;
        }
        let last = left.force;
        left = still.left(&state.x);
        if left.force < least.force {
            (best, least) = (state.clone(), left);
        }
        if left.force < halved.0 * HALVED {
            halved = (left.force, count);
        }
        // Where air pulls the other way than it did, shorter steps lead there.
        if left.force > WORSE * last && still.is_pulled() {
            longest = SHORTER * h;
        } else if !still.is_pulled() {
            longest *= OPENED;
        }
        h = (h * GROWTH).min(longest);
    }
    if least.rounded || least.force <= NEAR * still.largest_share(&best.x) {
        return Ok(Rest {
            x: best.x,
            force_left: least.force,
            iterations: method.newton_iterations(),
        });
    }
    Err(RestError::NotFound {
        force_left: least.force,
        particle: least.particle,
    })
}

/// The softest [`modes`] of a scene about its rest. Where there are rods they are right to 1e-7 of each frequency.
pub fn modes_of(scene: &Scene, x: &[f64]) -> Option<Modes> {
    if scene.rods.is_empty() {
        return modes(&ParticleSystem::new(scene), x);
    }
    let mut found = modes(&rods::about(scene, x)?, x)?;
    // The stiffest are those of the springs that stand for rods.
    let free = scene.particles.iter().filter(|p| !p.fixed).count();
    found
        .lowest
        .truncate((3 * free).saturating_sub(scene.rods.len()));
    Some(found)
}

/// The diagonal of the box around all particles at the start, m; 1 where they are in one place.
pub fn size(scene: &Scene) -> f64 {
    let diagonal = scene.diagonal();
    if diagonal > 0.0 { diagonal } else { 1.0 }
}

/// The particle that is farthest from where it was, and by how much, m.
pub fn farthest(from: &[f64], to: &[f64]) -> (usize, f64) {
    let pairs = from.chunks_exact(3).zip(to.chunks_exact(3)).enumerate();
    let moved = pairs.map(|(id, (a, b))| (id, (b[0] - a[0]).hypot(b[1] - a[1]).hypot(b[2] - a[2])));
    // Of equal ones the first.
    moved.fold(
        (0, 0.0),
        |most, one| if one.1 > most.1 { one } else { most },
    )
}
