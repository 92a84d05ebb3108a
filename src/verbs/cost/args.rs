//! `springcheck cost SCENE`

use crate::scene::{self, Scene};
use crate::solvers::Solver;
use crate::truth::Demand;
use crate::verbs::Report;
use crate::verbs::cli::flags::{self, Time, demand};
use crate::verbs::cli::interrupt;
use crate::verbs::cli::output::{self, Output};
use crate::verbs::cli::solvers::{Custom, chosen, without_timestep};
use crate::verbs::cli::terminal::Terminal;
use crate::verbs::cost::{self, CostChoice, CostPlan};
use anyhow::{Context, bail};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene file (YAML).
    #[arg(value_name = "SCENE")]
    scene: PathBuf,

    /// Integrators to sweep, in this order: ids separated by commas, or `all`.
    /// Default: all, the scene's own first.
    #[arg(long, value_name = "A,B|all", value_delimiter = ',')]
    integrators: Vec<String>,

    /// Reference engines: ids separated by commas, or `none`. Default: rapier at 4, 1 and 16 iterations.
    #[arg(long, value_name = "A,B|none", value_delimiter = ',')]
    engines: Vec<String>,

    /// One more rapier row with these settings, such as `iterations=8,pgs=4`; repeatable.
    #[arg(long, value_name = "KEY=VALUE,...")]
    rapier: Vec<Custom>,

    /// Errors to reach, metres, separated by commas.
    #[arg(long, value_name = "M,...", value_delimiter = ',', default_value = "1e-3,1e-6,1e-9",
          value_parser = target, allow_hyphen_values = true)]
    targets: Vec<f64>,

    /// Steps (of adaptive pairs: tolerances) to try of each engine.
    #[arg(long, value_name = "N", allow_hyphen_values = true, default_value_t = cost::SETTINGS as u32, value_parser = clap::value_parser!(u32).range(2..=200))]
    steps: u32,

    /// About what the sweep may take: 30s, 2m. It sets the finest step of each engine, by counted work on
    /// a nominal machine, so that every machine tries the same steps.
    #[arg(
        long,
        value_name = "TIME",
        allow_hyphen_values = true,
        default_value = "30s"
    )]
    budget: Time,

    /// Exactly these timesteps, seconds, separated by commas, and a picture of them side by side; without
    /// adaptive pairs, which choose their own.
    #[arg(long, value_name = "H,...", value_delimiter = ',', allow_hyphen_values = true, conflicts_with_all = ["steps", "budget"])]
    timestep: Vec<f64>,

    /// Seconds to simulate. Default: the scene's.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    duration: Option<f64>,

    /// What errors are measured against: a closed form or else a converged reference (auto), a
    /// closed form or nothing (closed), nothing (none).
    #[arg(long, default_value = "auto", value_parser = demand(), value_name = "KIND")]
    truth: Demand,

    #[command(flatten)]
    output: Output,
}

/// The flags that shorten a run of this verb.
const SHORTER: &str = "--budget, fewer --steps, --integrators A,B, --engines none";
/// Bounds of the targets, m.
const TARGETS: std::ops::RangeInclusive<f64> = 1e-30..=1e30;
/// The most targets or timesteps the command line takes: more are a mistake.
const MAX_VALUES: usize = 32;

/// Reads a target, m.
fn target(text: &str) -> Result<f64, String> {
    let metres = text.parse().ok().filter(|metres| TARGETS.contains(metres));
    metres.ok_or_else(|| "expected metres from 1e-30 to 1e30".to_owned())
}

/// Runs the verb.
pub fn cost(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let scene = read(args)?;
    let plan = CostPlan::new(&scene, &choice(args, &scene)?);
    let place = args.output.place(&args.scene);
    if let Some(place) = &place {
        place.prepare()?;
    }
    interrupt::unfinished(std::slice::from_ref(&args.scene));
    let terminal = Terminal::new(quiet);
    let estimates = plan.estimate();
    let expected = estimates.iter().map(|e| e.seconds).sum();
    terminal.expect(plan.work(), expected, &estimates, SHORTER);
    let mut report = plan.execute(&terminal);
    drop(terminal);
    report.header.advice = next(args, &scene, &report).into_iter().collect();
    let otherwise = "springcheck cost --help";
    args.output.finish(report, place, otherwise, quiet)?;
    Ok(ExitCode::SUCCESS)
}

fn read(args: &Args) -> anyhow::Result<Scene> {
    let scene = flags::scene(&args.scene, args.duration)?;
    let file = args.scene.display();
    if args.timestep.is_empty() {
        // The file's step is not run here, so the duration may be below it.
        let step = scene.solver.timestep;
        let within = scene.duration > 0.0 && scene.duration < step;
        let step = if within { scene.duration } else { step };
        scene::check_times(step, scene.duration).with_context(|| file.to_string())?;
    }
    for &timestep in &args.timestep {
        scene::check_times(timestep, scene.duration)
            .with_context(|| format!("{file}: timestep {timestep}"))?;
    }
    Ok(scene)
}

fn choice(args: &Args, scene: &Scene) -> anyhow::Result<CostChoice> {
    without_timestep(&args.rapier, "swept; leave dt out, or give --timestep")?;
    if args.targets.len() > MAX_VALUES || args.timestep.len() > MAX_VALUES {
        bail!("at most {MAX_VALUES} targets and {MAX_VALUES} timesteps");
    }
    let usual = CostChoice::default_for(scene);
    let mut targets = args.targets.clone();
    targets.sort_by(|a, b| b.total_cmp(a));
    targets.dedup();
    let choice = CostChoice {
        solvers: chosen(
            &args.integrators,
            &args.engines,
            &args.rapier,
            scene,
            &usual.solvers,
        )?,
        targets,
        settings: args.steps as usize,
        budget_s: args.budget.0.as_secs_f64(),
        timesteps: (!args.timestep.is_empty()).then(|| args.timestep.clone()),
        truth: args.truth,
    };
    if choice.solvers.is_empty() {
        bail!("nothing to sweep: no integrators and no engines");
    }
    let is_swept = |solver: &Solver| solver.as_pair().is_none();
    if choice.timesteps.is_some() && !choice.solvers.iter().any(is_swept) {
        bail!("nothing to sweep: adaptive pairs choose their own steps; leave --timestep out");
    }
    Ok(choice)
}

/// The command to run next: the picture of a few steps, or after it a cross-check of the cheapest
/// integrator.
fn next(args: &Args, scene: &Scene, report: &Report) -> Option<String> {
    let path = output::quoted(&args.scene)?;
    let flag = |duration| format!(" --duration {duration}");
    let duration = args.duration.map_or_else(String::new, flag);
    let step = |h: f64| output::rounded(h).min(scene.duration);
    if args.timestep.is_empty() {
        let h = scene.solver.timestep;
        let mut steps = [4.0 * h, 2.0 * h, h].map(|h| step(h).to_string()).to_vec();
        steps.dedup();
        let steps = steps.join(",");
        return Some(format!(
            "springcheck cost {path}{duration} --timestep {steps}"
        ));
    }
    let targets = &report.cost()?.targets;
    let cheapest = targets.iter().rev().find_map(|t| t.cheapest.as_ref())?;
    Some(format!(
        "springcheck run {path}{duration} --integrators {} --timestep {}",
        cheapest.engine,
        step(cheapest.timestep)
    ))
}
