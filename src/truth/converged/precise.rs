//! States that remember what rounding took from them.

use crate::system::State;

/// Positions and velocities whose updates are summed with compensation (Kahan 1965, in Knuth's
/// branch-free form): each coordinate is the unevaluated sum of a double and a small remainder.
///
/// Not double-double arithmetic: forces see doubles.
#[derive(Debug, Clone)]
pub struct Precise {
    /// Positions, m.
    pub x: Vec<f64>,
    /// Velocities, m/s.
    pub v: Vec<f64>,
    /// What belongs to the positions below their last bit, m.
    pub x_low: Vec<f64>,
    /// The same of the velocities, m/s.
    pub v_low: Vec<f64>,
}

impl Precise {
    pub fn new(x: &[f64], v: &[f64]) -> Self {
        Self {
            x: x.to_vec(),
            v: v.to_vec(),
            x_low: vec![0.0; x.len()],
            v_low: vec![0.0; v.len()],
        }
    }

    /// Becomes a copy of plain positions and velocities, as long as before.
    pub fn set(&mut self, x: &[f64], v: &[f64]) {
        self.x.copy_from_slice(x);
        self.v.copy_from_slice(v);
        self.x_low.fill(0.0);
        self.v_low.fill(0.0);
    }

    /// Becomes a copy of an equally long state, without allocating.
    pub fn copy_from(&mut self, other: &Precise) {
        self.x.copy_from_slice(&other.x);
        self.v.copy_from_slice(&other.v);
        self.x_low.copy_from_slice(&other.x_low);
        self.v_low.copy_from_slice(&other.v_low);
    }

    /// Adds to one coordinate's position and velocity.
    #[inline(always)]
    pub fn add(&mut self, at: usize, dx: f64, dv: f64) {
        (self.x[at], self.x_low[at]) = two_sum(self.x[at], self.x_low[at] + dx);
        (self.v[at], self.v_low[at]) = two_sum(self.v[at], self.v_low[at] + dv);
    }

    pub fn is_finite(&self) -> bool {
        self.x.iter().chain(&self.v).all(|c| c.is_finite())
    }
}

impl From<&State> for Precise {
    fn from(state: &State) -> Self {
        Self::new(&state.x, &state.v)
    }
}

/// a + b as the nearest double and the exact rest (Knuth, TAOCP 2, 4.2.2).
#[inline(always)]
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_seen = sum - a;
    let rest = (a - (sum - b_seen)) + (b - b_seen);
    (sum, rest)
}
