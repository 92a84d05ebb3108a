//! The force of a uniform magnetic field on charged particles.

use super::{Effect, EffectRow, boxed, count_members};
use crate::physics::{ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::Scene;

pub(super) const ROW: EffectRow = EffectRow {
    id: "magnetic",
    summary: "the force of a magnetic field on particles with a `charge`",
    source: "Lorentz: f = q v x B; it turns the velocity and does no work",
    elastic: false,
    constant: false,
    build: |scene| MagneticForce::new(scene).map(boxed),
};

/// f = q v x B on each free particle with a charge. Seen from where B points to, a positive charge goes round
/// clockwise, at q B / m radians a second.
///
/// Not to be confused with an electric force q E, which does work (a constant one is `wind`), or with a force
/// between charges, which scenes do not have.
pub struct MagneticForce {
    /// Particle and its q B, kg/s.
    fields: Vec<(usize, [f64; 3])>,
}

impl MagneticForce {
    /// None without a field, or when no free particle has a charge.
    pub fn new(scene: &Scene) -> Option<Self> {
        let field = scene.magnetic.as_ref()?.field;
        let fields: Vec<_> = scene
            .particles
            .iter()
            .enumerate()
            .filter(|(_, p)| !p.fixed)
            .map(|(i, p)| (i, field.map(|b| p.charge * b)))
            .filter(|(_, field)| *field != [0.0; 3])
            .collect();
        (!fields.is_empty()).then_some(Self { fields })
    }
}

impl Effect for MagneticForce {
    fn members(&self) -> usize {
        self.fields.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::GYROSCOPIC
    }

    fn add_force(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        self.add_damping(x, v, f);
        Power::default()
    }

    fn add_rounding(&self, _t: f64, _x: &[f64], v: &[f64], f: &mut [f64]) {
        // Each component is a difference of two products, which may cancel.
        for (i, [bx, by, bz]) in &self.fields {
            let at = 3 * i;
            let [vx, vy, vz] = [v[at].abs(), v[at + 1].abs(), v[at + 2].abs()];
            f[at] += super::FEW_OPERATIONS * (vy * bz.abs() + vz * by.abs());
            f[at + 1] += super::FEW_OPERATIONS * (vz * bx.abs() + vx * bz.abs());
            f[at + 2] += super::FEW_OPERATIONS * (vx * by.abs() + vy * bx.abs());
        }
    }

    fn add_damping(&self, _x: &[f64], w: &[f64], f: &mut [f64]) {
        for (i, [bx, by, bz]) in &self.fields {
            let at = 3 * i;
            f[at] += w[at + 1] * bz - w[at + 2] * by;
            f[at + 1] += w[at + 2] * bx - w[at] * bz;
            f[at + 2] += w[at] * by - w[at + 1] * bx;
        }
    }

    fn count_dampers(&self, at: &mut [u32]) -> bool {
        count_members(&self.fields, at)
    }

    fn sweep(&self, sweep: &mut Sweep) {
        // Each turn moves one particle: the order does not matter.
        for &(i, field) in &self.fields {
            sweep.turn(i, field);
        }
    }

    fn add_jacobian(
        &self,
        _t: f64,
        _x: &[f64],
        _v: &[f64],
        _linearization: Linearization,
        out: &mut Jacobian,
    ) {
        for (i, [bx, by, bz]) in &self.fields {
            let at = 3 * i;
            for (row, column, b) in [(0, 1, bz), (1, 2, bx), (2, 0, by)] {
                out.velocity.push((at + row, at + column, *b));
                out.velocity.push((at + column, at + row, -b));
            }
        }
    }
}
