//! An integrator of your own: held to what it claims, then run beside rapier.
//!
//! `cargo run --release --example custom_integrator`
//!
//! Exits with 1 if the honest one is accused or the one that lies is believed.

use springcheck::conformance::{Claims, check};
use springcheck::integrators::{Integrator, PerStep, StepError};
use springcheck::measure::CheckStatus;
use springcheck::physics::{State, System};
use springcheck::scene;
use springcheck::solvers::Solver;
use springcheck::verbs;
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;
use std::process::ExitCode;

/// Kicks and drifts with these coefficients, in turn.
struct KickDrift(&'static [(f64, f64)]);

impl Integrator for KickDrift {
    fn step(&mut self, system: &dyn System, h: f64, state: &mut State) -> Result<(), StepError> {
        let mut a = vec![0.0; system.dim()];
        let (start, mut drifted) = (state.t, 0.0);
        for &(kick, drift) in self.0 {
            let time = start + drifted * h;
            let power = system.acceleration(time, &state.x, &state.v, &mut a);
            state.work.advance(power, kick * h);
            for ((x, v), a) in state.x.iter_mut().zip(&mut state.v).zip(&a) {
                *v += kick * h * a;
                *x += drift * h * *v;
            }
            drifted += drift;
        }
        state.t = start + h;
        Ok(())
    }
}

/// Ruth 1983, IEEE Trans. Nucl. Sci. 30: symplectic, of order 3.
const RUTH: &[(f64, f64)] = &[
    (7.0 / 24.0, 2.0 / 3.0),
    (3.0 / 4.0, -2.0 / 3.0),
    (-1.0 / 24.0, 1.0),
];

/// "Leapfrog" that starts without its half kick: symplectic Euler, of order 1.
const LEAPFROG: &[(f64, f64)] = &[(1.0, 1.0)];

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let claims = |order, evaluations| Claims {
        symplectic: true,
        evaluations: Some(PerStep::Exactly(evaluations)),
        ..Claims::of_order(order)
    };
    let rows = [
        ("ruth3", RUTH, claims(3, 3)),
        ("leapfrog", LEAPFROG, claims(2, 1)),
    ];

    println!("{:<9} {:<14} {:<13} finding", "who", "law", "status");
    let mut caught = Vec::new();
    for (name, coefficients, claims) in rows {
        let findings = check(&|| Box::new(KickDrift(coefficients)), &claims);
        for finding in findings.iter().filter(|f| f.status != CheckStatus::Skip) {
            let status = format!("{:?}", finding.status).to_lowercase();
            println!(
                "{name:<9} {:<14} {status:<13} {}",
                finding.law, finding.message
            );
        }
        caught.push(findings.iter().any(|f| f.status == CheckStatus::Fail));
    }

    let scene = scene::read("scenes/oscillator/circle.yml".as_ref(), verbs::names())?;
    let mut choice = Choice::default_for(&scene);
    for (name, coefficients, _) in rows {
        choice = choice.with(Solver::own(name, move || Box::new(KickDrift(coefficients))));
    }
    let plan = Plan::new(&scene, &choice);
    println!(
        "\n{:<17} {:>12} {:>15}",
        scene.name, "m from truth", "m from rapier"
    );
    for outcome in plan.execute(&Quiet)?.outcomes() {
        let off = outcome.position_error_m.as_ref().map(|e| e.max);
        let apart = outcome.deviation_m.get("rapier").map(|d| d.max);
        let shown = |metres: Option<f64>| metres.map_or("-".into(), |m| format!("{m:.1e}"));
        println!(
            "{:<17} {:>12} {:>15}",
            outcome.engine,
            shown(off),
            shown(apart)
        );
    }
    Ok(ExitCode::from(u8::from(caught != [false, true])))
}
