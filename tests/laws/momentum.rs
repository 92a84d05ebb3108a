//! Which effects keep momentum and angular momentum: as they say. The methods' part is a law of the
//! public kit (`conformance`).

use crate::testkit::{Random, force, pressed, sample};
use springcheck::physics::effects::{self, Effect};
use springcheck::physics::{ForceKinds, Power};
use springcheck::scene::DampingModel;

/// Total force and torque vanish exactly where the effect says that momentum is kept.
fn effect_law(effect: &dyn Effect, x: &[f64], v: &[f64]) -> Result<(), String> {
    let (f, _) = force(effect, x, v);
    let (mut total, mut torque) = ([0.0_f64; 3], [0.0_f64; 3]);
    for i in (0..x.len()).step_by(3) {
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            total[a] += f[i + a];
            torque[a] += x[i + b] * f[i + c] - x[i + c] * f[i + b];
        }
    }
    let norm = |u: [f64; 3]| u.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
    let (total, torque) = (norm(total), norm(torque));
    // Sums of a dozen forces of order 1 to 10 cancel to their last bits: measured 1.8e-15.
    let kept = [total < 5e-15, torque < 5e-15];
    if kept == [effect.keeps_momentum(), effect.keeps_angular_momentum()] {
        Ok(())
    } else {
        Err(format!("force {total:.1e}, torque {torque:.1e}"))
    }
}

/// An effect that claims to keep what it does not, or the reverse.
struct Claims(Box<dyn Effect>, [bool; 2]);

impl Effect for Claims {
    fn members(&self) -> usize {
        self.0.members()
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds()
    }
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        self.0.add_force(t, x, v, f)
    }
    fn keeps_momentum(&self) -> bool {
        self.1[0]
    }
    fn keeps_angular_momentum(&self) -> bool {
        self.1[1]
    }
}

#[test]
fn momentum_is_kept_exactly_where_an_effect_says_so() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = pressed(model);
        let (x, v) = sample(&scene, &mut Random(11));
        for row in effects::REGISTRY {
            let build = || (row.build)(&scene).expect("built");
            let effect = build();
            effect_law(effect.as_ref(), &x, &v).unwrap_or_else(|e| panic!("{}: {e}", row.id));
            // Any other claim is caught.
            let truth = [effect.keeps_momentum(), effect.keeps_angular_momentum()];
            for claim in [[true, true], [true, false], [false, true], [false, false]] {
                let law = effect_law(&Claims(build(), claim), &x, &v);
                assert_eq!(law.is_ok(), claim == truth, "{}: {claim:?}", row.id);
            }
        }
    }
}
