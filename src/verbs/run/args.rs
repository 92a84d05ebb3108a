//! `springcheck run SCENE...`

use crate::measure::CheckStatus;
use crate::report::json::Tool;
use crate::scene::{self, Scene};
use crate::truth::Demand;
use crate::verbs;
use crate::verbs::Report;
use crate::verbs::cli::announce;
use crate::verbs::cli::cache::Cache;
use crate::verbs::cli::chosen;
use crate::verbs::cli::chosen::Truth;
use crate::verbs::cli::external::{self, External};
use crate::verbs::cli::host::host;
use crate::verbs::cli::progress::Progress;
use crate::verbs::cli::rapier::Custom;
use crate::verbs::cli::save::{FileKind, Files};
use crate::verbs::cli::shown::{self, HUMAN, format_ids};
use crate::verbs::cli::time::Time;
use crate::verbs::run::{Choice, Expectations, Orders, Plan};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene files (YAML).
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,

    /// Integrators to run, in this order: ids separated by commas, or `all`.
    /// Default: the scene's own first, then the usual six.
    #[arg(long, value_name = "A,B|all", value_delimiter = ',')]
    integrators: Vec<String>,

    /// Reference engines: ids separated by commas, or `none`. Default: rapier,rapier-forces.
    #[arg(long, value_name = "A,B|none", value_delimiter = ',')]
    engines: Vec<String>,

    /// One more rapier row with these settings, such as `dt=0.001,iterations=8,pgs=4`; repeatable.
    #[arg(long, value_name = "KEY=VALUE,...")]
    rapier: Vec<Custom>,

    /// One more row from a program that prints `t,id,x,y,z[,vx,vy,vz]`, started without a shell;
    /// repeatable. In the command: {scene}, {scene_json}, {timestep}, {duration}, and {output}, an
    /// .npz read instead of stdout.
    #[arg(long, value_name = "NAME=COMMAND")]
    external: Vec<External>,

    /// A program that takes longer is stopped: 60s, 2m, 500ms.
    #[arg(
        long,
        value_name = "TIME",
        requires = "external",
        default_value = "60s"
    )]
    external_timeout: Time,

    /// Timesteps in seconds, separated by commas: everything runs at each. Default: the scene's.
    #[arg(long, value_name = "H,...", value_delimiter = ',')]
    timestep: Vec<f64>,

    /// Seconds to simulate. Default: the scene's.
    #[arg(long, value_name = "SECONDS")]
    duration: Option<f64>,

    /// What errors are measured against: a closed form or else a converged reference (auto), a
    /// closed form or nothing (closed), nothing (none).
    #[arg(long, value_enum, default_value_t = Truth::Auto, value_name = "KIND")]
    truth: Truth,

    /// Measure every integrator's order, also where that takes long.
    #[arg(long)]
    order: bool,

    /// What goes to stdout.
    #[arg(long, default_value = HUMAN, value_parser = format_ids())]
    format: String,

    /// Where reports go [default: reports; with a --format other than human, nowhere].
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,

    /// Save every step of every engine beside the report.
    #[arg(long, value_enum, value_name = "FORMAT")]
    save: Option<FileKind>,

    /// Save only every N-th step, and the last.
    #[arg(long, value_name = "N", requires = "save", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
}

/// Runs the verb.
pub fn run(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    // All scenes are read before any runs: a typo in the last one costs nothing.
    let scenes = args
        .scenes
        .iter()
        .map(|path| read(args, path))
        .collect::<anyhow::Result<Vec<_>>>()?;
    distinct(args)?;
    external::distinct(&args.external)?;
    let mut reports = Vec::new();
    for (read, path) in scenes.iter().zip(&args.scenes) {
        let report = one(args, quiet, read, path)?;
        if args.format == HUMAN {
            let several = if reports.is_empty() { "" } else { "\n" };
            crate::verbs::cli::print(&format!("{several}{}", human(args, path, &report)))?;
        }
        reports.push(report);
    }
    if args.format != HUMAN {
        shown::print(&args.format, &Tool::this(), &reports)?;
    }
    let failed = |report: &Report| {
        report
            .header
            .checks
            .iter()
            .any(|c| c.status == CheckStatus::Fail)
    };
    Ok(ExitCode::from(u8::from(reports.iter().any(failed))))
}

/// Reads a scene and applies the flags that change it.
fn read(args: &Args, path: &Path) -> anyhow::Result<Read> {
    let mut scene = scene::read(path, verbs::names())?;
    let stated = scene.duration;
    if let Some(duration) = args.duration {
        scene.duration = duration;
    }
    let custom = args.rapier.iter().filter_map(|c| c.timestep.as_ref());
    // A flag replaces the file's timestep, which then need not fit.
    let common = if args.timestep.is_empty() {
        std::slice::from_ref(&scene.solver.timestep)
    } else {
        &args.timestep
    };
    for &timestep in common.iter().chain(custom) {
        scene::check_times(timestep, scene.duration)
            .with_context(|| format!("{}: timestep {timestep}", path.display()))?;
    }
    Ok(Read { scene, stated })
}

/// A scene as it will run.
struct Read {
    scene: Scene,
    /// The duration its file states, s.
    stated: f64,
}

fn one(args: &Args, quiet: bool, read: &Read, path: &Path) -> anyhow::Result<Report> {
    let scene = &read.scene;
    let place = shown::place(args.output.as_deref(), &args.format, path);
    let files = match (args.save, &place) {
        (None, _) => None,
        (Some(kind), Some(place)) => Some(Files::new(kind, place, args.every)),
        (Some(_), None) => bail!("--save needs --output when --format is not human"),
    };
    let mut choice = choice(args, scene)?;
    choice.expectations = expectations(args, read);
    let programs = external::chosen(&args.external, path, args.external_timeout);
    choice.solvers.extend(programs);
    let plan = Plan::new(scene, &choice);
    let estimates = plan.estimate();
    let expected = announce::expected(&estimates);
    if !quiet {
        announce::announce(
            &estimates,
            expected,
            "--duration, a larger --timestep, --integrators A,B, --engines none",
        );
    }
    if let Some(place) = &place {
        place.create()?;
    }
    let steps = plan.cases.iter().map(|case| case.label.steps).sum();
    let progress = Progress::new(steps, expected, quiet);
    let report = plan.execute(&host(&progress, files.as_ref(), &Cache::new()))?;
    progress.finish();
    shown::written(report, place.as_ref())
}

/// What the scene expects of what ran, unless flags changed what it is about.
fn expectations(args: &Args, read: &Read) -> Expectations {
    if read.scene.duration != read.stated {
        Expectations::Skipped(format!("they are about {:?} s", read.stated))
    } else if args.truth.demand() != Demand::Auto {
        let why = "they are about errors and energies against the truth, and --truth changed it";
        Expectations::Skipped(why.to_owned())
    } else {
        Expectations::Judged
    }
}

/// Two scenes must not write into one folder.
fn distinct(args: &Args) -> anyhow::Result<()> {
    for (at, path) in args.scenes.iter().enumerate() {
        let place = |path: &Path| shown::place(args.output.as_deref(), &args.format, path);
        let Some(own) = place(path) else {
            return Ok(());
        };
        let same = |other: &&PathBuf| place(other).is_some_and(|p| p.folder() == own.folder());
        if let Some(other) = args.scenes[..at].iter().find(same) {
            bail!(
                "{} and {} would both write to {}",
                other.display(),
                path.display(),
                own.folder().display()
            );
        }
    }
    Ok(())
}

/// The table and, as its last three lines, verdict, report path, next command.
fn human(args: &Args, path: &Path, report: &Report) -> String {
    let place = shown::place(args.output.as_deref(), &args.format, path);
    shown::human(
        report,
        place.as_ref(),
        next(args, path, report),
        "springcheck run --help",
    )
}

/// A command worth trying next: other steps, or other integrators; None where the path cannot be
/// written down.
fn next(args: &Args, path: &Path, report: &Report) -> Option<String> {
    let path = shown::quoted(path)?;
    if args.timestep.len() > 1 {
        return Some(format!("springcheck run {path} --integrators all"));
    }
    let h = args
        .timestep
        .first()
        .copied()
        .unwrap_or(report.header.scene.timestep);
    // Six digits are enough for a suggestion.
    let steps: Vec<String> = [2.0 * h, h, 0.5 * h]
        .iter()
        .filter_map(|h| format!("{h:.5e}").parse::<f64>().ok())
        .filter(|h| *h <= report.header.scene.duration)
        .map(|h| h.to_string())
        .collect();
    Some(format!(
        "springcheck run {path} --timestep {}",
        steps.join(",")
    ))
}

fn choice(args: &Args, scene: &Scene) -> anyhow::Result<Choice> {
    let mut choice = Choice::default_for(scene);
    choice.truth = args.truth.demand();
    if args.order {
        choice.order = Orders::Always;
    }
    let engines = chosen::engines(&args.engines, &args.rapier, &choice.solvers)?;
    choice.solvers = chosen::integrators(&args.integrators, scene, &choice.solvers)?;
    choice.solvers.extend(engines);
    if !args.timestep.is_empty() {
        choice.timesteps.clear();
        for &timestep in &args.timestep {
            if !choice.timesteps.contains(&timestep) {
                choice.timesteps.push(timestep);
            }
        }
    }
    Ok(choice)
}
