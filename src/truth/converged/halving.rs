//! Halving the steps until two independent estimates agree.

use super::level::{LOST, Level};
use super::mesh::Mesh;
use super::rate::fastest_rate;
use super::reference::STEPS;
use super::stepper::Precise;
use super::{NotConverged, thousands};
use crate::physics::constraints::contact::Obstacles;
use crate::physics::{State, System};

/// Most bytes of kept states.
const MEMORY: usize = 10 << 20;

/// The first steps are at most this long, in units of the fastest time constant: barely stable.
const FIRST_STEP: f64 = 1.0;

/// No fewer pieces than this at first: a scene without forces still has its bar.
const FEWEST: u64 = 16;

/// Halving ends when halving all steps shrinks the gaps by less than this: what is left is rounding.
const WORTHWHILE: f64 = 1.4;

/// It also ends when they shrink by less than this twice in a row: what is left is of order 2 or less.
const SMOOTH: f64 = 4.0;

/// A motion on rods that ends before its time in so many levels does so whatever the steps.
const MOST_OVER: u32 = 5;

/// Of the rate of a penalty no more than this over the whole time is asked for.
const PRESSED: f64 = 4096.0;

/// Halvings of single steps may go on this many times without bringing the estimates closer: a
/// collision has to be resolved first.
const MOST_IDLE: u32 = 16;

/// The level to use, and how well it is known. Lists have an entry for each instant of the level's
/// mesh and never fall.
pub(super) struct Halved {
    pub level: Level,
    /// The given size, or that of the motion where it is 0, m.
    pub size: f64,
    /// How far neighbours have parted, in units of their distance at the start.
    pub amplification: Vec<f64>,
    /// The error bar, m.
    pub bars: Vec<f64>,
    /// Force evaluations times coordinates that were spent.
    pub spent: u64,
    pub ended: StopReason,
}

/// Why no further halving was done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum StopReason {
    /// The estimates agree.
    Agreed,
    /// Smaller steps no longer bring them closer.
    Stalled,
    /// Smaller steps would cost more than was allowed.
    Spent,
}

/// Starts with as many steps as the fastest rate asks for. Then halves those whose own error is too
/// large; and once there are none, all. Time is in s, the size in m, 0 if it has none; the budget
/// counts force evaluations times coordinates.
///
/// # Errors
/// When the budget does not allow even the first, or forces are not finite.
pub(super) fn halve(
    system: &(dyn System + Sync),
    start: &State,
    until: f64,
    size: f64,
    budget: u64,
) -> Result<Halved, NotConverged> {
    let dim = system.dim() as u64;
    let rate = fastest_rate(system, start, size).ok_or_else(not_finite)?;
    // A penalty is not felt at the start, and comes to act for moments alone: smaller steps there follow by halving.
    let pressed = system.obstacles().map_or(0.0, Obstacles::fastest);
    let rate = rate.max(pressed.min(PRESSED / until));
    let start = Precise::from(start);
    let most = instants(system.dim());
    let [per_piece, at_the_end] = Level::costs().map(|cost| cost * dim);

    let pieces = first_pieces(rate, until);
    let first_cost = (per_piece + at_the_end).saturating_mul(pieces);
    if first_cost > budget {
        return Err(NotConverged::new(format!(
            "the fastest motion, {rate:.1e} /s over {until} s, takes at least {} steps of an \
             explicit method: {:.1e} coordinates of forces, where {:.1e} are allowed",
            thousands(pieces.saturating_mul(u64::from(STEPS))),
            first_cost as f64,
            budget as f64
        )));
    }
    let mut mesh = Mesh::uniform(until, pieces, most);
    let mut all = true;
    let mut progress = Progress::default();
    let mut over = 0;
    let mut spent = 0_u64;
    let mut coarser: Option<Level> = None;
    let mut best: Option<Level> = None;
    let ended = loop {
        let pieces = mesh.pieces() as u64;
        let cost = (per_piece + at_the_end).saturating_mul(pieces);
        if spent.saturating_add(cost) > budget {
            break StopReason::Spent;
        }
        spent += per_piece * pieces;
        let level = Level::new(system, &start, mesh);
        let size = level.size_or(size);
        let target = level.target(size);
        let (next, next_all) = level.halved(size, most);
        mesh = next;
        let agreed = level.gap() <= target;
        // Rods that depend on each other end a motion, and so do obstacles that close in: no smaller steps lead past that.
        let ends = system.rods().is_some() || system.obstacles().is_some();
        over += u32::from(ends && level.ends_early());
        let shrunk = best
            .as_ref()
            .map(|best| best.shrunk_to(&level, target, size));
        if shrunk.is_none_or(|factor| factor >= 1.0) {
            coarser = best.replace(level);
        }
        if agreed {
            break StopReason::Agreed;
        }
        if over == MOST_OVER {
            break StopReason::Stalled;
        }
        if shrunk.is_some_and(|factor| progress.is_over(factor, all)) {
            break StopReason::Stalled;
        }
        all = next_all;
    };
    let Some(mut level) = best else {
        return Err(not_finite());
    };
    let size = level.size_or(size);
    // Larger steps show the effect of rounding as well, unless they are too large to follow the motion.
    let with = coarser.filter(|coarser| coarser.gap() < LOST * size);
    let with = with.as_ref().unwrap_or(&level);
    let (gaps, (amplification, rounding)) = rayon::join(
        || level.gaps_of_three(system, &start),
        || {
            rayon::join(
                || with.amplification(system, &start, size),
                || with.rounding(system, &start),
            )
        },
    );
    let (amplification, rounding) = (level.spread(&amplification), level.spread(&rounding));
    spent += at_the_end * level.mesh.pieces() as u64;
    level.gaps = gaps;
    Ok(Halved {
        amplification,
        bars: level.bars(&rounding, system.obstacles().map_or(0.0, Obstacles::unseen)),
        size,
        spent,
        ended,
        level,
    })
}

/// Force evaluations times coordinates of the first level; None where forces are not finite.
pub(super) fn first_cost(
    system: &(dyn System + Sync),
    start: &State,
    until: f64,
    size: f64,
) -> Option<u64> {
    let pieces = first_pieces(fastest_rate(system, start, size)?, until);
    let each: u64 = Level::costs().iter().sum();
    Some((each * system.dim() as u64).saturating_mul(pieces))
}

fn not_finite() -> NotConverged {
    NotConverged::new("the forces at the start are not finite")
}

/// Counts the halvings that helped little.
#[derive(Default)]
struct Progress {
    slow: u32,
    idle: u32,
}

impl Progress {
    /// Whether to end, after gaps shrank by `factor` as `all` steps were halved, or some.
    fn is_over(&mut self, factor: f64, all: bool) -> bool {
        if factor >= SMOOTH {
            *self = Self::default();
            return false;
        }
        if all {
            self.slow += 1;
            return factor < WORTHWHILE || self.slow == 2;
        }
        self.idle += 1;
        self.idle == MOST_IDLE
    }
}

/// The most intervals, a power of two, whose states fit into memory.
fn instants(dim: usize) -> u64 {
    let states = MEMORY / (16 * dim.max(1));
    1 << states.saturating_sub(1).max(1).ilog2()
}

/// The number of pieces to start with, a power of two.
fn first_pieces(rate: f64, until: f64) -> u64 {
    let needed = (rate * until / (FIRST_STEP * f64::from(STEPS))).ceil();
    (needed.min(1e15) as u64).max(FEWEST).next_power_of_two()
}
