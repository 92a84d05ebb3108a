//! The problem as an integrator sees it: flat vectors and a [`System`] that gives accelerations.
//!
//! Nothing here knows of particles or scenes except [`ParticleSystem`], which is built from one.

pub mod constraints;
mod counting;
pub mod effects;
mod jacobian;
mod kinds;
mod particles;
mod state;
mod sweep;

pub use counting::{Counting, Evaluations};
pub(crate) use jacobian::PairBlock;
pub use jacobian::{Derivative, Jacobian, Linearization, Triplets};
pub use kinds::{ForceKinds, Refused};
pub use particles::{Effects, ParticleSystem};
pub use state::{Injected, Power, State, Work};
pub use sweep::{Bound, Dampers, Sweep};
pub(crate) use sweep::{phi1, phi2};

use constraints::contact::Obstacles;
use constraints::{Rods, StrainLimiter};

/// A second-order mechanical system M x'' = f(t, x, v) over `dim` coordinates.
///
/// Every vector has length [`dim`](System::dim) (for particles 3n: x, y, z of particle 0, then of
/// particle 1, ...). Fixed coordinates are part of the vectors; their inverse mass is 0, their
/// acceleration 0.
///
/// The system states how its force depends on v ([`kinds`](System::kinds)). Some methods treat the force
/// as linear, f(t, x, v) = f(t, x, 0) + D(x) v, and refuse any other.
pub trait System {
    /// 1/m of each coordinate, 1/kg; 0 for a fixed one.
    fn inverse_mass(&self) -> &[f64];

    /// Number of coordinates.
    fn dim(&self) -> usize {
        self.inverse_mass().len()
    }

    /// Overwrites `a` with the acceleration, m/s², and returns the powers at this point, W.
    ///
    /// Not to be confused with a force: `a` is already divided by the mass.
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power;

    /// Overwrites `a` with a bound of how far rounding moves the acceleration, m/s²: what another program's,
    /// computed in another order, may differ by.
    ///
    /// The default is that of a force without cancellation.
    fn rounding(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.acceleration(t, x, v, a);
        for a in a {
            *a = 4.0 * f64::EPSILON * a.abs();
        }
    }

    /// The kinds of all forces together.
    ///
    /// By default the force is assumed to depend on velocity in any way, and methods for which that would
    /// be wrong refuse it. [`ForceKinds::NONE`] is a force that does not depend on velocity.
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NON_LINEAR
    }

    /// Overwrites the coordinates whose motion is given with their positions and velocities at a time, s. They are
    /// fixed coordinates that move. [`acceleration`](System::acceleration), [`rounding`](System::rounding),
    /// [`potential`](System::potential) and [`jacobian`](System::jacobian) see them there whatever they are passed; a
    /// caller of [`damping`](System::damping) and [`sweep`](System::sweep) has placed them.
    fn place(&self, _t: f64, _x: &mut [f64], _v: &mut [f64]) {}

    /// The times, s, ascending, at which some derivative of a given motion jumps.
    fn jumps(&self) -> &[f64] {
        &[]
    }

    /// Overwrites `a` with M⁻¹ D(x) w, the acceleration due to velocity `w` alone, m/s². Only called
    /// where the force [depends on velocity](ForceKinds::depends_on_velocity), linearly.
    fn damping(&self, _t: f64, _x: &[f64], _w: &[f64], a: &mut [f64]) {
        a.fill(0.0);
    }

    /// How its dampers can be applied.
    fn dampers(&self) -> Dampers {
        Dampers::Whole
    }

    /// Advances the sweep's velocities by the flow of one damper after the other, in an order that is always the
    /// same, or its reverse. Only called where they can be applied so ([`dampers`](Self::dampers)).
    fn sweep(&self, _sweep: &mut Sweep) {}

    /// The work that forces without a potential, other than damping, and given motions put in over `h` seconds at
    /// frozen positions `x`, while the particles move by `moved`, m: linear in both together. Only called for
    /// [`ForceKinds::DRIVEN`], where forces are linear in the velocity.
    fn injected(&self, _t: f64, _x: &[f64], _moved: &[f64], _h: f64) -> Injected {
        Injected::default()
    }

    /// The rods, whose forces are part of the [acceleration](Self::acceleration); None where there are none.
    fn rods(&self) -> Option<&Rods> {
        None
    }

    /// The strain limit, which acts after a step and not in the acceleration; None where there is none.
    fn strain_limiter(&self) -> Option<&StrainLimiter> {
        None
    }

    /// The obstacles, which act between and within steps and not in the acceleration, unless by penalty; None where there are
    /// none.
    fn obstacles(&self) -> Option<&Obstacles> {
        None
    }

    /// As [`acceleration`](Self::acceleration), without the forces of rods.
    fn free_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.acceleration(t, x, v, a)
    }

    /// As [`free_acceleration`](Self::free_acceleration), at the end of a step or where one begins: a system may remember it
    /// for the next step.
    fn remembered_acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.free_acceleration(t, x, v, a)
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
        let one = |v: f64, w: f64| if w > 0.0 { v * v / w } else { 0.0 };
        // Several sums, which do not wait for each other.
        let mut sums = [0.0; 8];
        let (v, rest_v) = v.as_chunks::<8>();
        let (w, rest_w) = self.inverse_mass().as_chunks::<8>();
        for (v, w) in v.iter().zip(w) {
            for (at, sum) in sums.iter_mut().enumerate() {
                *sum += one(v[at], w[at]);
            }
        }
        for (sum, (v, w)) in sums.iter_mut().zip(rest_v.iter().zip(rest_w)) {
            *sum += one(*v, *w);
        }
        0.5 * sums.iter().sum::<f64>()
    }
}
