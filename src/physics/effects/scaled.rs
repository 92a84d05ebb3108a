//! An effect with all its forces multiplied by a factor: physics that is wrong on purpose.

use super::Effect;
use crate::physics::{ForceKinds, Jacobian, Linearization, Power, Sweep};
use crate::scene::Drive;

/// `factor` times another effect: -1 flips its sign, 2 applies it twice.
///
/// No scene can ask for it. A replay compares a faulty program with it.
pub struct Scaled {
    effect: Box<dyn Effect>,
    factor: f64,
    /// Its motions, so many times as far.
    drives: Vec<Drive>,
}

impl Scaled {
    pub fn new(effect: Box<dyn Effect>, factor: f64) -> Self {
        let drives = effect.drives().iter().map(|drive| drive.times(factor));
        Self {
            drives: drives.collect(),
            effect,
            factor,
        }
    }

    /// Calls `add`, and adds `factor` times the force it computes.
    fn scaled<T>(&self, f: &mut [f64], add: impl FnOnce(&mut [f64]) -> T) -> T {
        let mut own = vec![0.0; f.len()];
        let result = add(&mut own);
        for (f, own) in f.iter_mut().zip(own) {
            *f += self.factor * own;
        }
        result
    }
}

impl Effect for Scaled {
    fn members(&self) -> usize {
        self.effect.members()
    }

    fn kinds(&self) -> ForceKinds {
        let kinds = self.effect.kinds();
        if self.factor < 0.0 {
            kinds.negated()
        } else {
            kinds
        }
    }

    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let power = self.scaled(f, |own| self.effect.add_force(t, x, v, own));
        Power {
            dissipated: self.factor * power.dissipated,
            injected: self.factor * power.injected,
        }
    }

    fn add_rounding(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let mut own = vec![0.0; f.len()];
        self.effect.add_rounding(t, x, v, &mut own);
        for (f, own) in f.iter_mut().zip(own) {
            *f += self.factor.abs() * own;
        }
    }

    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.factor * self.effect.potential(t, x)
    }

    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        self.scaled(f, |own| self.effect.add_damping(x, w, own));
    }

    fn count_dampers(&self, at: &mut [u32]) -> bool {
        self.effect.count_dampers(at)
    }

    fn sweep(&self, sweep: &mut Sweep) {
        sweep.scaled(self.factor, |sweep| self.effect.sweep(sweep));
    }

    fn injected_power(&self, t: f64, v: &[f64]) -> f64 {
        self.factor * self.effect.injected_power(t, v)
    }

    fn drives(&self) -> &[Drive] {
        &self.drives
    }

    fn add_jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        let mut own = Jacobian::default();
        self.effect.add_jacobian(t, x, v, linearization, &mut own);
        for (from, to) in [
            (own.position, &mut out.position),
            (own.velocity, &mut out.velocity),
        ] {
            to.extend(
                from.into_iter()
                    .map(|(r, c, slope)| (r, c, self.factor * slope)),
            );
        }
    }

    fn keeps_momentum(&self) -> bool {
        self.effect.keeps_momentum()
    }

    fn keeps_angular_momentum(&self) -> bool {
        self.effect.keeps_angular_momentum()
    }
}
