//! Where on a trajectory the limit is tightest: springs turn, and their stiffness with them.

use super::{Effort, Limit, Linearised};
use crate::integrators::Method;
use crate::system::{State, System};

/// Where along a trajectory a limit is tightest.
#[derive(Debug, Clone, PartialEq)]
pub struct Tightest {
    /// Seconds.
    pub limit_s: f64,
    /// When, s.
    pub t_s: f64,
}

/// A trajectory linearised at some of its states; made once for all methods.
#[derive(Debug, Clone)]
pub struct Along {
    states: Vec<(f64, Linearised)>,
}

/// States looked at, where a part couples few coordinates; of larger scenes fewer.
const STATES: usize = 64;
/// Coordinates times states.
const WORK: usize = 8_000;
/// States at least.
const FEWEST: usize = 8;

impl Along {
    /// Of states in order of time, evenly thinned, both ends included, to at most 64.
    pub fn new<'a, S: System + ?Sized>(
        system: &S,
        states: impl IntoIterator<Item = &'a State>,
    ) -> Self {
        let states: Vec<_> = states.into_iter().collect();
        let kept = (WORK / system.dim().max(1)).clamp(FEWEST, STATES);
        let last = states.len().saturating_sub(1);
        let mut places: Vec<usize> = (0..kept).map(|i| i * last / (kept - 1)).collect();
        places.dedup();
        let states = places
            .into_iter()
            .filter_map(|at| states.get(at))
            .map(|state| {
                let State { t, x, v, .. } = state;
                (*t, Linearised::with(Effort::BRIEF, system, *t, x, v))
            })
            .collect();
        Self { states }
    }

    /// The least limit, and when. None where no state has one that is known: it is stable at every
    /// step, or at none.
    pub fn tightest(&self, method: &Method) -> Option<Tightest> {
        let limits = self.states.iter().filter_map(|(t, linearised)| {
            // Any timestep: growth is not asked for.
            match linearised.verdict(method, 1.0).limit {
                Limit::At(limit) => Some(Tightest {
                    limit_s: limit,
                    t_s: *t,
                }),
                Limit::Between(..) | Limit::Never | Limit::Unconditional | Limit::Unknown(_) => {
                    None
                }
            }
        });
        limits.reduce(|least, next| {
            if next.limit_s < least.limit_s {
                next
            } else {
                least
            }
        })
    }
}

/// As [`Along`], for one method.
pub fn along<'a, S: System + ?Sized>(
    system: &S,
    states: impl IntoIterator<Item = &'a State>,
    method: &Method,
) -> Option<Tightest> {
    Along::new(system, states).tightest(method)
}
