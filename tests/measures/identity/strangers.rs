//! Schemes that are in no list are not named.

use super::*;
use crate::testkit::swinging_triangle;
use springcheck::integrators::{Integrator, RungeKutta, Tableau, fixed};
use springcheck::measure::identify::Explained;
use springcheck::scene::DampingModel;

/// Third order, Heun 1900.
const HEUN3: Tableau = Tableau {
    a: &[&[], &[1.0 / 3.0], &[0.0, 2.0 / 3.0]],
    b: &[0.25, 0.0, 0.75],
    c: &[0.0, 1.0 / 3.0, 2.0 / 3.0],
};
/// Third order, Ralston 1962.
const RALSTON3: Tableau = Tableau {
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

fn of(scene: &Scene, integrator: Box<dyn Integrator>) -> Found {
    let h = scene.solver.timestep;
    let mut engine = IntegratorEngine::with(scene, ParticleSystem::new(scene), integrator, h);
    found(scene, &record(&mut engine, h, 200), None)
}

/// Nothing explains it, and nothing is claimed to.
fn unnamed(found: &Found) -> Result<(), String> {
    // Far beyond rounding, whatever the deviations.
    let left = |explained: &Explained| explained.residual > 1e3;
    if found.identity.is_none() && found.explained.as_ref().is_some_and(left) {
        Ok(())
    } else {
        Err(format!("{found:?}"))
    }
}

#[test]
fn unknown_schemes_are_not_named() {
    for damping in [0.0, 0.7] {
        let scene = swinging_triangle(damping, DampingModel::Axial);
        for tableau in [&HEUN3, &RALSTON3, &THREE_EIGHTHS] {
            unnamed(&of(&scene, Box::new(RungeKutta::new(*tableau)))).unwrap();
        }
        // What is in the list is.
        for method in fixed().iter() {
            let known = of(&scene, method.build(&Settings::default()));
            assert!(unnamed(&known).is_err(), "{}", method.id);
        }
    }
}
