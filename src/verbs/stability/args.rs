//! `springcheck stability SCENE`

use crate::scene::{self, Particle, Scene, limits};
use crate::verbs::Report;
use crate::verbs::cli::flags;
use crate::verbs::cli::interrupt;
use crate::verbs::cli::output::{self, Output};
use crate::verbs::cli::solvers::{Custom, chosen, without_timestep};
use crate::verbs::cli::terminal::{self, Terminal};
use crate::verbs::run::{Choice, Plan};
use crate::verbs::session::TimeEstimate;
use crate::verbs::stability::{MapPlan, Range, StabilityPlan, StabilityRow, VariedKey, Vary};
use anyhow::{Context, bail};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene file (YAML).
    #[arg(value_name = "SCENE")]
    scene: PathBuf,

    /// Integrators to look at, in this order: ids separated by commas, or `all`.
    /// Default: all, the scene's own first.
    #[arg(long, value_name = "A,B|all", value_delimiter = ',')]
    integrators: Vec<String>,

    /// Reference engines: ids separated by commas, or `none`. Default: rapier.
    #[arg(long, value_name = "A,B|none", value_delimiter = ',')]
    engines: Vec<String>,

    /// One more rapier row with these settings, such as `iterations=8,pgs=4`; repeatable.
    #[arg(long, value_name = "KEY=VALUE,...")]
    rapier: Vec<Custom>,

    /// The step at which growth is taken, seconds. Default: the scene's.
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    timestep: Option<f64>,

    /// How far the trajectory is followed in search of tighter limits, seconds. Default: the scene's.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    duration: Option<f64>,

    /// Draw a map of timestep against this: `springs.stiffness=1e2..1e8`, of one member
    /// `particles[1].mass=0.01..100` or `sheet[3,4].mass=...`, of an object `rope.stiffness=...`, with `:N` for N values
    /// (default 24).
    #[arg(long, value_name = "KEY=A..B[:N]", allow_hyphen_values = true)]
    vary: Option<String>,

    /// The map's timesteps, seconds. Default: 24 around the predicted limits, a decade on both sides.
    #[arg(
        long,
        value_name = "A..B[:N]",
        allow_hyphen_values = true,
        requires = "vary"
    )]
    steps: Option<Range>,

    /// Steps times particles that the whole map may take; each cell gets its share. Default: 4e7, or
    /// 256 steps a cell where that is more.
    #[arg(long, value_name = "STEPS", allow_hyphen_values = true, requires = "vary", value_parser = count)]
    budget: Option<u64>,

    /// Find the largest value of this that is stable at the timestep: `springs.stiffness`, of one member
    /// `particles[1].drag`, of an object `rope.stiffness`.
    #[arg(long, value_name = "KEY")]
    largest: Option<String>,

    /// Draw from where a step does not enlarge the spring's force, at these stiffnesses, N/m. For two
    /// free particles on one spring.
    #[arg(
        long,
        value_name = "K,...",
        allow_hyphen_values = true,
        value_delimiter = ','
    )]
    admissible: Vec<f64>,

    #[command(flatten)]
    output: Output,
}

/// The flags that shorten a run of this verb.
const SHORTER: &str = "--integrators A,B, --engines none, --budget, fewer values or steps";

/// The exit code where a row has no answer.
const UNANSWERED: u8 = 1;

/// Runs the verb.
pub fn stability(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let scene = read(args)?;
    let plan = plan(args, &scene)?;
    // What is refused is found before anything runs, and leaves no folder behind.
    let place = args.output.place(&args.scene);
    let terminal = Terminal::new(quiet);
    let estimates = estimates(&plan)?;
    plan.picture()?;
    if let Some(place) = &place {
        place.prepare()?;
    }
    interrupt::unfinished(std::slice::from_ref(&args.scene));
    let expected = terminal::expected(&estimates);
    terminal.expect(plan.steps()?, expected, &estimates, SHORTER);
    let mut report = plan.execute(&terminal)?;
    drop(terminal);
    report.header.advice = next(args, &scene, &report).into_iter().collect();
    let otherwise = "springcheck stability --help";
    let report = args.output.finish(report, place, otherwise, quiet)?;
    let mut rows = report.stability().into_iter().flat_map(|s| &s.rows);
    // An unsupported engine has no limit; its reason is the answer.
    let answered = rows.all(|row| row.limit().is_some() || row.unsupported);
    Ok(ExitCode::from(if answered { 0 } else { UNANSWERED }))
}

fn read(args: &Args) -> anyhow::Result<Scene> {
    let scene = flags::scene(&args.scene, args.duration)?;
    let own = scene.solver.timestep;
    scene::check_times(own, scene.duration)
        .with_context(|| format!("{}: timestep {own}", args.scene.display()))?;
    Ok(scene)
}

fn plan<'a>(args: &Args, scene: &'a Scene) -> anyhow::Result<StabilityPlan<'a>> {
    without_timestep(&args.rapier, "searched; leave dt out")?;
    let usual = StabilityPlan::default_for(scene);
    let map = match &args.vary {
        None => None,
        Some(text) => Some(MapPlan {
            vary: Vary::parse(text, scene).with_context(|| "--vary")?,
            timesteps: args.steps,
            budget: args.budget,
        }),
    };
    let largest = args.largest.as_ref();
    let largest = largest.map(|key| VariedKey::parse(key, scene));
    for h in args.steps.iter().flat_map(|range| [range.low, range.high]) {
        within(h, limits::TIMESTEP).context("--steps")?;
    }
    for &k in &args.admissible {
        within(k, limits::STIFFNESS).context("--admissible")?;
    }
    let timestep = args.timestep.unwrap_or(scene.solver.timestep);
    within(timestep, limits::TIMESTEP).context("--timestep")?;
    let plan = StabilityPlan {
        scene,
        solvers: chosen(
            &args.integrators,
            &args.engines,
            &args.rapier,
            scene,
            &usual.solvers,
        )?,
        timestep,
        map,
        largest: largest.transpose().context("--largest")?,
        admissible: args.admissible.clone(),
    };
    if plan.solvers.is_empty() {
        bail!("nothing to look at: no integrators and no engines");
    }
    Ok(plan)
}

fn within(value: f64, quantity: limits::Bounds) -> anyhow::Result<()> {
    let limits::Bounds { low, high, unit } = quantity;
    if !(low..=high).contains(&value) {
        bail!("expected {low:e} to {high:e} ({unit}), found {value}");
    }
    Ok(())
}

/// Reads a whole number, also as `4e7`.
fn count(text: &str) -> Result<u64, String> {
    let number = text.parse::<f64>().ok();
    let whole = number.filter(|n| (1.0..=1e15).contains(n) && n.fract() == 0.0);
    whole
        .map(|n| n as u64)
        .ok_or_else(|| format!("expected a whole number from 1 to 1e15, found `{text}`"))
}

/// How long each engine will take, from its first few steps of the scene.
pub fn estimates(plan: &StabilityPlan) -> anyhow::Result<Vec<TimeEstimate>> {
    let by_row = plan.steps_by_row();
    let rows = by_row.len().max(1) as u64;
    let of_map = plan.steps()?.saturating_sub(by_row.iter().sum()) / rows;
    let choice = Choice {
        solvers: plan.solvers.clone(),
        ..Choice::default_for(plan.scene)
    };
    // There is one case for each solver: none has a timestep of its own here.
    let mut runs = Plan::new(plan.scene, &choice);
    for (case, steps) in runs.cases.iter_mut().zip(by_row) {
        case.label.steps = steps + of_map;
    }
    let mut estimates = runs.estimate();
    // Of the trajectory followed each step costs what one of the scene's own integrator does, or the first's.
    let followed = plan.steps_followed();
    let own = |estimate: &&TimeEstimate| estimate.label.engine == plan.scene.solver.method;
    let stepped = estimates.iter().find(own).or(estimates.first()).cloned();
    estimates.extend(stepped.filter(|_| followed > 0).map(|mut estimate| {
        estimate.seconds *= followed as f64 / estimate.label.steps.max(1) as f64;
        estimate.label.steps = followed;
        estimate.label.engine = "the trajectory followed".to_owned();
        estimate
    }));
    Ok(estimates)
}

/// The command to run next: a map, or after a map a run at a step well inside the limit.
fn next(args: &Args, scene: &Scene, report: &Report) -> Option<String> {
    let path = output::quoted(&args.scene)?;
    if args.vary.is_none() {
        let stiffest = scene
            .springs
            .iter()
            .fold(0.0, |k: f64, s| k.max(s.stiffness));
        let particles = || scene.particles.iter().filter(|p| !p.fixed);
        let most = |of: fn(&Particle) -> f64| particles().map(of).fold(0.0, f64::max);
        let keys = [
            ("springs.stiffness", stiffest),
            ("particles.drag", most(|p| p.drag)),
            ("particles.quadratic_drag", most(|p| p.quadratic_drag)),
            ("particles.charge", most(|p| p.charge.abs())),
        ];
        let (key, largest) = keys.into_iter().find(|(_, largest)| *largest > 0.0)?;
        let [low, high] = [largest / 100.0, largest * 100.0].map(output::rounded);
        return Some(format!(
            "springcheck stability {path} --vary {key}={low}..{high}"
        ));
    }
    let own = report.stability().into_iter().flat_map(|s| &s.rows);
    let own = own.filter(|row| report.header.is_own(&row.engine));
    let limit = own.filter_map(StabilityRow::limit).next()?;
    let h = if limit > 0.0 && limit.is_finite() {
        output::rounded(0.9 * limit).min(scene.duration)
    } else {
        scene.solver.timestep
    };
    Some(format!("springcheck run {path} --timestep {h}"))
}
