//! An integrator of your own, run on a scene beside this crate's methods.
//!
//! `cargo run --release --example own_integrator`

use springcheck::engines::{Engine, IntegratorEngine};
use springcheck::integrators::{self, Integrator, Settings, StepError};
use springcheck::scene;
use springcheck::system::{ParticleSystem, State, System};

/// Position Verlet: half a drift, a kick, half a drift.
struct PositionVerlet {
    a: Vec<f64>,
}

impl Integrator for PositionVerlet {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        self.a.resize(system.dim(), 0.0);
        for (x, v) in state.x.iter_mut().zip(&state.v) {
            *x += 0.5 * h * v;
        }
        let power = system.acceleration(state.t + 0.5 * h, &state.x, &state.v, &mut self.a);
        for (v, a) in state.v.iter_mut().zip(&self.a) {
            *v += h * a;
        }
        for (x, v) in state.x.iter_mut().zip(&state.v) {
            *x += 0.5 * h * v;
        }
        state.work.advance(power, h);
        state.t += h;
        Ok(())
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = scene::read("scenes/pa1/scene05.yml".as_ref(), &integrators::ids())?;
    let system = ParticleSystem::new(&scene);
    let h = scene.solver.timestep;
    let energy = |state: &State| system.kinetic(&state.v) + system.potential(state.t, &state.x);

    let own = Box::new(PositionVerlet { a: Vec::new() });
    let mut engines = vec![(
        "position verlet",
        IntegratorEngine::with(&scene, system.clone(), own, h),
    )];
    for id in ["velocity_verlet", "symplectic_euler"] {
        let method = integrators::find(id).ok_or("no such method")?;
        let engine = IntegratorEngine::new(&scene, system.clone(), method, &Settings::default(), h);
        engines.push((id, engine));
    }
    for (name, mut engine) in engines {
        let start = energy(engine.state());
        let mut worst = 0.0_f64;
        for _ in 0..scene.steps(h) {
            engine.step()?;
            worst = worst.max((energy(engine.state()) - start).abs());
        }
        println!("{name:<18} largest energy error {worst:.2e} J");
    }
    Ok(())
}
