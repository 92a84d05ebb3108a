//! How far a replay ends from the data, and how far counts as following.

/// A transition follows a scheme if its defect is at most this many units.
///
/// A unit holds every rounding of the data once at its largest, and the candidate's own; what
/// becomes of them in a step is measured in random directions, of which the unit takes the largest
/// result: one standard deviation or more, where the sum of many uniform roundings stays below 3 and
/// that of a few in the worst case below 4. The rest is for programs that compute the same otherwise.
pub const FIT: f64 = 8.0;
/// Above this, a transition follows another scheme. Between the two nothing can be told.
pub const BEYOND: f64 = 2.0 * FIT;

/// A defect so small needs no finer unit.
pub(super) const CLEAR: f64 = 0.5 * FIT;
/// Nor does one so large: more directions never raise a unit by as much.
pub(super) const HOPELESS: f64 = 64.0 * FIT;
/// Most directions in which inputs are moved by their rounding.
pub(super) const NUDGES: u64 = 8;

/// How far a replay ends from the data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Defect {
    /// Largest over the coordinates of |predicted - recorded|, in units of what rounding explains;
    /// infinite where the candidate cannot take the steps.
    pub units: f64,
    /// Whether every coordinate is equal to the last bit.
    pub exact: bool,
    /// The same difference relative to what the transition moves.
    pub relative: f64,
}

impl Defect {
    /// The candidate cannot take these steps.
    pub(super) const IMPOSSIBLE: Self = Self {
        units: f64::INFINITY,
        exact: false,
        relative: f64::INFINITY,
    };

    /// Whether rounding explains it.
    pub fn fits(&self) -> bool {
        self.units <= FIT
    }
}

/// The largest of `a / b`, with 0 / anything = 0.
pub(super) fn largest_ratio(a: &[f64], b: &[f64]) -> f64 {
    let ratios = a.iter().zip(b).filter(|(a, _)| **a > 0.0);
    ratios.fold(0.0, |most, (a, b)| f64::max(most, a / b))
}
