//! What an integrator sees: flat vectors and a [`System`] that gives accelerations.
//!
//! Nothing here knows of particles or scenes except [`ParticleSystem`], which is built from one.

mod counting;
mod jacobian;
mod particles;
mod state;

pub use counting::{Counting, Evaluations};
pub use jacobian::{Jacobian, Linearization, Triplets};
pub(crate) use jacobian::{PairBlock, Slope};
pub use particles::{Effects, ParticleSystem};
pub use state::{Power, State, Work};

/// A second-order mechanical system M x'' = f(t, x, v) over `dim` coordinates.
///
/// Every vector has length [`dim`](System::dim) (for particles 3n: x, y, z of particle 0, then of
/// particle 1, ...). Fixed coordinates are part of the vectors; their inverse mass is 0, their
/// acceleration 0.
///
/// The velocity-dependent part of the force must be *linear in v*:
/// f(t, x, v) = f(t, x, 0) + D(x) v. Dampers and linear drag are; quadratic drag is not.
pub trait System {
    /// Number of coordinates.
    fn dim(&self) -> usize;

    /// 1/m of each coordinate, 1/kg; 0 for a fixed one.
    fn inverse_mass(&self) -> &[f64];

    /// Overwrites `a` with the acceleration, m/s², and returns the powers at this point, W.
    ///
    /// Not to be confused with a force: `a` is already divided by the mass.
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power;

    /// Whether the force depends on velocity, that is, whether D(x) can be non-zero.
    fn is_damped(&self) -> bool {
        false
    }

    /// Overwrites `a` with M⁻¹ D(x) w, the acceleration due to velocity `w` alone, 1/s · m/s.
    /// Only called where [`is_damped`](System::is_damped).
    fn damping(&self, _t: f64, _x: &[f64], _w: &[f64], a: &mut [f64]) {
        a.fill(0.0);
    }

    /// Whether forces that belong to no potential, other than damping, do work (wind).
    fn is_driven(&self) -> bool {
        false
    }

    /// Power of those external forces at velocity `v`, W; linear in `v`, so handing in a
    /// displacement gives joules. Only called where [`is_driven`](System::is_driven).
    fn injected_power(&self, _t: f64, _x: &[f64], _v: &[f64]) -> f64 {
        0.0
    }

    /// Potential energy, J.
    fn potential(&self, t: f64, x: &[f64]) -> f64;

    /// Adds the force Jacobians to `out` (N/m and N s/m), cleared by the caller.
    ///
    /// The default takes central differences of [`acceleration`](System::acceleration), dense and
    /// good to about eight digits: enough for Newton to converge, slowly.
    fn jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        _linearization: Linearization,
        out: &mut Jacobian,
    ) {
        jacobian::central_differences(self, t, x, v, out);
    }

    /// Kinetic energy, J, of the free coordinates.
    fn kinetic(&self, v: &[f64]) -> f64 {
        let mut twice = 0.0;
        for (v, w) in v.iter().zip(self.inverse_mass()) {
            if *w > 0.0 {
                twice += v * v / w;
            }
        }
        0.5 * twice
    }
}
