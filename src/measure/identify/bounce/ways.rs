//! Steps of the ways in which programs meet obstacles beside or within the step of a method.

use super::{Bounce, Free, Stepped};
use crate::integrators::StepError;
use crate::physics::State;
use crate::physics::constraints::contact::{Against, Obstacles};
use crate::vector::axpy;

/// Impacts in a step, at most: programs that find each are of a few particles.
const IMPACTS: usize = 4;
/// Bisections that find an impact to rounding.
const BISECTIONS: u32 = 60;

/// Inside and approaching at the end.
pub(super) fn at_end(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let (end, from) = (state.t + h, state.x.clone());
    free(h, state)?;
    state.t = end;
    bounce.meet(obstacles, h, &from, state);
    Ok(())
}

/// Inside and approaching at the start.
pub(super) fn at_start(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    bounce.meet(obstacles, h, &[], state);
    free(h, state)
}

/// Inside at the start and approaching after the kick: v1 = v0 + h a, turned, x1 = x0 + h v1.
pub(super) fn after_kick(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let start = state.clone();
    free(h, state)?;
    let mut kicked = State {
        v: state.v.clone(),
        ..start.clone()
    };
    bounce.meet(obstacles, h, &[], &mut kicked);
    for at in 0..state.x.len() {
        let moved = kicked.x[at] - start.x[at];
        let turned = kicked.v[at] - state.v[at];
        state.x[at] += moved + h * turned;
        state.v[at] = kicked.v[at];
    }
    Ok(())
}

/// Inside and approaching at the start: turned, and no force, x1 = x0 + h v1; else the free step (SimBenchmark's ODE).
pub(super) fn before_kick(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let mut turned = state.clone();
    let met = bounce.meet(obstacles, h, &[], &mut turned);
    free(h, state)?;
    for particle in met {
        let own = 3 * particle..3 * particle + 3;
        let v = &turned.v[own.clone()];
        state.v[own.clone()].copy_from_slice(v);
        state.x[own.clone()].copy_from_slice(&turned.x[own.clone()]);
        axpy(&mut state.x[own], h, v);
    }
    Ok(())
}

/// Inside after the drift, approaching at the velocity of the drift, (x1 - x0)/h: turned before the second kick.
pub(super) fn between_kicks(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let start = state.clone();
    free(h, state)?;
    let pairs = start.x.iter().zip(&state.x);
    let drifted: Vec<f64> = pairs.map(|(from, to)| (to - from) / h).collect();
    let mut turned = State {
        x: state.x.clone(),
        v: drifted.clone(),
        ..start
    };
    turned.t += h;
    bounce.meet(obstacles, h, &[], &mut turned);
    state.x = turned.x;
    for at in 0..state.v.len() {
        state.v[at] += turned.v[at] - drifted[at];
    }
    Ok(())
}

/// Inside at the end if nothing were done: turned before the drift.
pub(super) fn ahead(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let end = state.t + h;
    free(h, state)?;
    state.t = end;
    let before = state.v.clone();
    bounce.meet(obstacles, h, &[], state);
    for at in 0..state.x.len() {
        state.x[at] += h * (state.v[at] - before[at]);
    }
    Ok(())
}

/// Cut where gaps that changed evenly would be 0.
pub(super) fn interpolated(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let (end, mut left) = (state.t + h, h);
    for _ in 0..IMPACTS {
        let ended = ended(left, end, state, free)?;
        let met = inside(obstacles, &ended)?.into_iter().filter_map(|pair| {
            let [from, to] = [&*state, &ended].map(|one| gap(obstacles, pair, one));
            (from > 0.0).then(|| (from / (from - to), pair))
        });
        let Some((part, pair)) = met.min_by(|a, b| a.0.total_cmp(&b.0)) else {
            *state = ended;
            return Ok(());
        };
        free(part * left, state)?;
        left *= 1.0 - part;
        state.t = end - left;
        bounce.act(obstacles, pair, (h, &[]), state, &mut Vec::new());
    }
    free(left, state)
}

/// Ended at the first impact.
pub(super) fn to_impact(
    bounce: &Bounce,
    obstacles: &Obstacles,
    h: f64,
    state: &mut State,
    free: &mut Free,
) -> Stepped {
    let (start, end) = (state.clone(), state.t + h);
    let whole = ended(h, end, &start, free)?;
    let first = |state: &State| Ok::<_, StepError>(inside(obstacles, state)?.first().copied());
    let Some(mut pair) = first(&whole)? else {
        *state = whole;
        return Ok(());
    };
    let [mut low, mut high] = [0.0, h];
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        match first(&ended(middle, start.t + middle, &start, free)?)? {
            Some(struck) => (high, pair) = (middle, struck),
            None => low = middle,
        }
    }
    *state = ended(low, start.t + low, &start, free)?;
    bounce.act(obstacles, pair, (h, &[]), state, &mut Vec::new());
    state.t = end;
    Ok(())
}

/// The state after `h` seconds without obstacles, at the time `t`.
fn ended(h: f64, t: f64, state: &State, free: &mut Free) -> Result<State, StepError> {
    let mut ended = state.clone();
    free(h, &mut ended)?;
    ended.t = t;
    Ok(ended)
}

fn gap(obstacles: &Obstacles, (particle, against): (usize, Against), state: &State) -> f64 {
    obstacles.beside(particle, against, state).gap
}

/// What is inside.
///
/// # Errors
/// [`StepError::TooManyEvents`] where more is than a program would find one by one.
fn inside(obstacles: &Obstacles, state: &State) -> Result<Vec<(usize, Against)>, StepError> {
    let inside = pairs(obstacles, state).filter(|pair| gap(obstacles, *pair, state) < 0.0);
    let few: Vec<(usize, Against)> = inside.take(IMPACTS + 1).collect();
    match few.len() > IMPACTS {
        true => Err(StepError::TooManyEvents { t: state.t }),
        false => Ok(few),
    }
}

/// All that may touch.
fn pairs<'a>(
    obstacles: &'a Obstacles,
    state: &State,
) -> impl Iterator<Item = (usize, Against)> + 'a {
    let near = obstacles
        .among_particles()
        .then(|| obstacles.near_now(state));
    let among = |pair: &(usize, Against)| matches!(pair.1, Against::Particle(_));
    let others = near.map_or_else(Vec::new, |near| near.pairs().filter(among).collect());
    obstacles.pairs().chain(others)
}
