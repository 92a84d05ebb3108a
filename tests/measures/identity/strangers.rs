//! Schemes that are in no list are not named.

use super::*;
use crate::testkit::swinging_triangle;
use springcheck::integrators::{Integrator, RungeKutta, Tableau, fixed};
use springcheck::measure::identify::Sameness;
use springcheck::scene::DampingModel;

/// Third order, Heun 1900.
const HEUN: Tableau = Tableau {
    a: &[&[], &[1.0 / 3.0], &[0.0, 2.0 / 3.0]],
    b: &[0.25, 0.0, 0.75],
    c: &[0.0, 1.0 / 3.0, 2.0 / 3.0],
};
/// Third order of least error bound, Ralston 1962.
const RALSTON: Tableau = Tableau {
    a: &[&[], &[0.5], &[0.0, 0.75]],
    b: &[2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0],
    c: &[0.0, 0.5, 0.75],
};
/// Fourth order with other nodes than RK4's, Kutta's 3/8 rule.
const THREE_EIGHTHS: Tableau = Tableau {
    a: &[&[], &[1.0 / 3.0], &[-1.0 / 3.0, 1.0], &[1.0, -1.0, 1.0]],
    b: &[1.0 / 8.0, 3.0 / 8.0, 3.0 / 8.0, 1.0 / 8.0],
    c: &[0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0],
};

fn of(scene: &Scene, integrator: Box<dyn Integrator>) -> Identity {
    let h = scene.solver.timestep;
    let mut engine = IntegratorEngine::with(scene, ParticleSystem::new(scene), integrator, h);
    name(scene, &record(&mut engine, h, 200))
}

/// Nothing explains it, and nothing is claimed to.
fn unnamed(identity: &Identity) -> Result<(), String> {
    let nothing = identity.same == Sameness::NothingFits && !identity.decisive;
    // Far beyond rounding, whatever is nearest.
    if nothing && identity.defect > 1e3 && identity.followed == 0 {
        Ok(())
    } else {
        Err(format!("{identity:?}"))
    }
}

#[test]
fn unknown_schemes_are_not_named() {
    for damping in [0.0, 0.7] {
        let scene = swinging_triangle(damping, DampingModel::Axial);
        for tableau in [&HEUN, &RALSTON, &THREE_EIGHTHS] {
            unnamed(&of(&scene, Box::new(RungeKutta::new(*tableau)))).unwrap();
        }
        // What is in the list is.
        for method in fixed().iter() {
            let known = of(&scene, method.build(&Settings::default()));
            assert!(unnamed(&known).is_err(), "{}", method.id);
        }
    }
}
