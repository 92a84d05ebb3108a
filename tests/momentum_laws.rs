//! Who keeps momentum and angular momentum: the methods by their rows, the effects by their word.

mod common;
use common::mutants::{self, mutant};
use common::{
    Build, Random, advance, built, distance, everything, force, free_triangle, method, own, sample,
};
use springcheck::effects::{self, Effect};
use springcheck::integrators::{Method, REGISTRY};
use springcheck::scene::DampingModel;
use springcheck::system::{Power, State, System};

/// Total momentum and angular momentum.
fn momenta(system: &dyn System, s: &State) -> [[f64; 3]; 2] {
    let mut totals = [[0.0; 3]; 2];
    for i in (0..system.dim()).step_by(3) {
        let m = 1.0 / system.inverse_mass()[i];
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            totals[0][a] += m * s.v[i + a];
            totals[1][a] += m * (s.x[i + b] * s.v[i + c] - s.x[i + c] * s.v[i + b]);
        }
    }
    totals
}

fn momentum_law(row: &Method, model: DampingModel, build: Build) -> Result<(), String> {
    let (system, mut state) = built(&free_triangle(0.8, model));
    let start = momenta(&system, &state);
    advance(build().as_mut(), &system, 0.005, 200, &mut state);
    let end = momenta(&system, &state);
    let (linear, angular) = (distance(&start[0], &end[0]), distance(&start[1], &end[1]));
    // 200 steps of half a last bit on sums of order 1, as a random walk: 14 * 1.1e-16 = 1.6e-15,
    // measured 2.2e-15 and 1.1e-15. Newton's corrections are pairwise forces too and add nothing.
    const TOL: f64 = 6e-15;
    let keeps_angular = row.symplectic && model == DampingModel::Axial;
    let holds = linear < TOL && (!keeps_angular || angular < TOL);
    // Isotropic dampers brake rotation: nothing may claim to keep it. Measured 0.189 and more.
    let loses = model == DampingModel::Axial || angular > 0.07;
    if holds && loses {
        Ok(())
    } else {
        Err(format!(
            "{}: linear {linear:.1e}, angular {angular:.1e}",
            row.id
        ))
    }
}

#[test]
fn momentum_is_kept_by_all_and_angular_momentum_by_symplectic_methods() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        for row in REGISTRY {
            momentum_law(row, model, &own(row)).unwrap();
        }
    }
    // Explicit Euler does not keep angular momentum: claimed as Verlet it is caught.
    let euler = mutant(mutants::euler_drifting_with_the_old_velocity);
    assert!(momentum_law(method("velocity_verlet"), DampingModel::Axial, &euler).is_err());
    // Nor is linear momentum what a force on one particle alone leaves.
    let pushed = mutant(mutants::euler_forgetting_a_reaction);
    assert!(momentum_law(method("explicit_euler"), DampingModel::Axial, &pushed).is_err());
    // Without the dampers nothing brakes the rotation.
    let undamped = mutant(mutants::verlet_without_damping);
    let verlet = method("velocity_verlet");
    assert!(momentum_law(verlet, DampingModel::Axial, &undamped).is_ok());
    assert!(momentum_law(verlet, DampingModel::Isotropic, &undamped).is_err());
}

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
        let scene = everything(model);
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
