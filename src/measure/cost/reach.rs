//! From which setting on a target is reached.

use crate::outcome::{CostPoint, Status};

/// Why a curve reaches a target at no setting.
#[derive(Debug, Clone, PartialEq)]
pub enum Misses {
    /// There is nothing finer than what was tried, and that has this error, m.
    Nearest(f64),
    /// Some setting is near enough, and a finer one is not: a lucky zero crossing, or rounding. The
    /// error of the finest that is not, m.
    Unsettled(f64),
    /// The finest setting has no error.
    Ended,
    /// No setting was tried.
    Nothing,
}

/// The first of `points` (coarse to fine) from which on every finer one, itself included, has at most
/// the error `target`, m.
///
/// Not the coarsest that does: an error that changes its sign passes through 0 on its way, and a
/// setting there would be credited with an accuracy that its neighbours on both sides have not.
///
/// # Errors
/// [`Misses`] where the finest does not reach it.
pub fn reach(points: &[CostPoint], target: f64) -> Result<usize, Misses> {
    let near = |point: &CostPoint| near(point, target);
    let fine = points.iter().rev().take_while(|point| near(point)).count();
    if fine > 0 {
        return Ok(points.len() - fine);
    }
    let Some(finest) = points.last() else {
        return Err(Misses::Nothing);
    };
    let Some(error) = finest.error_m else {
        return Err(Misses::Ended);
    };
    let errors = points.iter().filter_map(|point| point.error_m);
    let nearest = errors.fold(error, f64::min);
    Err(if nearest <= target {
        Misses::Unsettled(error)
    } else {
        Misses::Nearest(nearest)
    })
}

fn near(point: &CostPoint, target: f64) -> bool {
    point.status == Status::Completed && point.error_m.is_some_and(|error| error <= target)
}
