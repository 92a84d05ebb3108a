//! Fixed particles whose motion is given.

use super::{Effect, EffectRow, boxed};
use crate::physics::{ForceKinds, Power};
use crate::scene::{Drive, Scene};

pub(super) const ROW: EffectRow = EffectRow {
    id: "driven",
    summary: "fixed particles that move by a sine, at a velocity, or along a table",
    source: "x = pos + motion(t), a natural cubic spline of a table (de Boor, A Practical Guide to Splines, IV); the \
             drive does minus the work of all other forces on the particle",
    elastic: false,
    constant: false,
    build: |scene| Driven::new(scene).map(boxed),
};

/// The motions of driven particles. It is no force: other forces act on what is driven, and the
/// [`ParticleSystem`](crate::physics::ParticleSystem) puts that in its place wherever they are evaluated, and books the
/// work of the drive.
///
/// Not to be confused with a force that depends on time.
pub struct Driven {
    drives: Vec<Drive>,
}

impl Driven {
    /// None without `driven`.
    pub fn new(scene: &Scene) -> Option<Self> {
        let drives = scene.drives();
        (!drives.is_empty()).then_some(Self { drives })
    }
}

impl Effect for Driven {
    fn members(&self) -> usize {
        self.drives.len()
    }

    fn kinds(&self) -> ForceKinds {
        ForceKinds::DRIVEN
    }

    fn add_force(&self, _t: f64, _x: &[f64], _v: &[f64], _f: &mut [f64]) -> Power {
        Power::default()
    }

    fn drives(&self) -> &[Drive] {
        &self.drives
    }

    /// It has no force of its own. What is driven is fixed, so nothing is kept in a scene that has it.
    fn keeps_momentum(&self) -> bool {
        true
    }

    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}
