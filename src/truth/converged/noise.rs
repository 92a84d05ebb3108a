//! What rounding does to an estimate, measured by making it larger.

use crate::physics::{Power, System};
use std::cell::RefCell;

/// Noise is this many times a last bit: far above rounding, far below everything else.
pub(super) const MAGNIFIED: f64 = 4096.0;

/// A system seen through noise: positions and velocities on the way in and accelerations on the way
/// out are off by up to [`MAGNIFIED`] last bits, each by an amount that its own bits and the seed
/// decide. A motion computed with it leaves the true one as rounding makes it leave, so many times
/// faster; two estimates that happen to be rounded alike do not hide that.
///
/// The idea of CESTAC (Vignes 1993), with noise well above what it stands for.
pub(super) struct Noisy<'a> {
    system: &'a dyn System,
    seed: u64,
    /// Positions and velocities as the system sees them.
    seen: RefCell<[Vec<f64>; 2]>,
}

impl<'a> Noisy<'a> {
    pub fn new(system: &'a dyn System, seed: u64) -> Self {
        let zero = vec![0.0; system.dim()];
        Self {
            system,
            seed,
            seen: RefCell::new([zero.clone(), zero]),
        }
    }

    fn off(&self, value: f64) -> f64 {
        value + value * (MAGNIFIED * f64::EPSILON * uniform(value.to_bits() ^ self.seed))
    }
}

impl System for Noisy<'_> {
    fn dim(&self) -> usize {
        self.system.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.system.inverse_mass()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        let mut seen = self.seen.borrow_mut();
        let [seen_x, seen_v] = &mut *seen;
        for (at, inverse_mass) in self.inverse_mass().iter().enumerate() {
            // What is fixed stands where it stands.
            let free = *inverse_mass > 0.0;
            seen_x[at] = if free { self.off(x[at]) } else { x[at] };
            seen_v[at] = if free { self.off(v[at]) } else { v[at] };
        }
        let power = self.system.acceleration(t, seen_x, seen_v, a);
        for a in a {
            *a = self.off(*a);
        }
        power
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.system.potential(t, x)
    }
}

/// A number in [-1, 1) from all bits of another (Stafford's variant 13 of MurmurHash3's finisher).
fn uniform(mut bits: u64) -> f64 {
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    bits ^= bits >> 31;
    (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}
