//! What scenes expect of their engines: the table of keys, and how an expectation is judged.

mod judged;
mod table;

use crate::testkit::scenes::parsed;
use springcheck::scene::Scene;
use springcheck::verbs::Report;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

/// One mass on one spring without rest length, a turn and a half in 100 steps; with this `expect`.
fn oscillator(expect: &str) -> Scene {
    let yaml = format!(
        "solver: {{type: rk4, timestep: 0.1, gravity: 0}}\nduration: 10\nparticles:\n\
         - {{pos: [0, 0, 0], fixed: true}}\n- {{pos: [1, 0, 0], mass: 1}}\n\
         springs: [{{particle_ids: [0, 1], stiffness: 1, rest_length: 0}}]\nexpect:\n{expect}\n"
    );
    parsed(&yaml)
}

fn run(scene: &Scene, choice: &Choice) -> Report {
    Plan::new(scene, choice).execute(&Quiet).expect("no files")
}
