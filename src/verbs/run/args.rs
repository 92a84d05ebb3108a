//! `springcheck run SCENE...`

use crate::measure::{CheckStatus, Statics};
use crate::report::json::Tool;
use crate::scene::{self, Scene};
use crate::trajectory::Plane;
use crate::truth::Demand;
use crate::verbs::Report;
use crate::verbs::cli::cache::Cache;
use crate::verbs::cli::external::{self, External, Terms};
use crate::verbs::cli::flags::{self, Time, demand};
use crate::verbs::cli::interrupt;
use crate::verbs::cli::output::{self, Output};
use crate::verbs::cli::place::Place;
use crate::verbs::cli::save::{Column, FileKind, Files};
use crate::verbs::cli::solvers::{Custom, chosen};
use crate::verbs::cli::terminal::{self, Terminal};
use crate::verbs::run::{Choice, Expectations, Orders, Plan};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene files (YAML), or folders of them.
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
        allow_hyphen_values = true,
        requires = "external",
        default_value = "60s"
    )]
    external_timeout: Time,

    /// The axes that two-dimensional rows of programs have. Default: rows have all three.
    #[arg(long, value_parser = flags::plane(), value_name = "AXES")]
    axes: Option<Plane>,

    /// Timesteps in seconds, separated by commas: everything runs at each. Default: the scene's.
    #[arg(
        long,
        value_name = "H,...",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    timestep: Vec<f64>,

    /// Seconds to simulate. Default: the scene's.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    duration: Option<f64>,

    /// What errors are measured against: a closed form or else a converged reference (auto), a
    /// closed form or nothing (closed), nothing (none).
    #[arg(long, default_value = "auto", value_parser = demand(), value_name = "KIND")]
    truth: Demand,

    /// Measure every integrator's order, also where that takes long.
    #[arg(long)]
    order: bool,

    #[command(flatten)]
    output: Output,

    /// Save every step of every engine beside the report.
    #[arg(long, value_enum, value_name = "FORMAT")]
    save: Option<FileKind>,

    /// State the largest tensions of springs and the reactions of fixed particles, N; with --save those of every step
    /// are saved, too.
    #[arg(long, value_enum, value_name = "A,B", value_delimiter = ',')]
    columns: Vec<Column>,

    /// Save only every N-th step, and the last.
    #[arg(long, value_name = "N", requires = "save", allow_hyphen_values = true, default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
}

/// The flags that shorten this verb, for the announcement.
const SHORTER: &str = "--duration, a larger --timestep, --integrators A,B, --engines none";

/// Runs the verb.
pub fn run(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    // All scenes are read before any of them runs: a typo in the last one costs no time.
    flags::refuse_empty(&args.scenes)?;
    let paths = flags::scenes(&args.scenes)?;
    distinct(args, &paths)?;
    external::distinct(&args.external)?;
    let read = |path: &PathBuf| {
        let (scene, stated) = read(args, path)?;
        let choice = choice(args, &scene, stated, path)?;
        Ok((scene, choice))
    };
    let scenes = paths.iter().map(read).collect::<anyhow::Result<Vec<_>>>()?;
    let places: Vec<_> = paths.iter().map(|path| args.output.place(path)).collect();
    if args.save.is_some() && places.contains(&None) {
        bail!("--save needs a folder: state --output");
    }
    for place in places.iter().flatten() {
        place.prepare()?;
    }
    let mut reports = Vec::new();
    let mut failure = Ok(());
    let mut is_read = true;
    for (at, ((scene, choice), place)) in scenes.iter().zip(&places).enumerate() {
        interrupt::unfinished(&paths[at..]);
        let (report, saved) = one(args, quiet, scene, choice, &paths[at], place.as_ref())?;
        if args.output.is_human() && !quiet && at > 0 {
            output::print("\n")?;
        }
        if args.output.is_human() || args.output.is_by_line() {
            // The path of a report is not shown where the report could not be written.
            let place = place.as_ref().filter(|_| saved.is_ok());
            let otherwise = "springcheck run --help";
            is_read = args.output.print_one(&report, place, otherwise, quiet)?;
        }
        failure = failure.and(saved);
        reports.push(report);
        if !is_read && places.iter().all(Option::is_none) {
            // The reader of stdout is gone, and nothing else is written.
            break;
        }
    }
    interrupt::unfinished(&[]);
    if args.output.is_human() {
        output::print(&output::closing(&reports, quiet))?;
    } else if !args.output.is_by_line() {
        args.output.print(&Tool::this(), &reports)?;
    }
    failure?;
    let mut checks = reports.iter().flat_map(|report| &report.header.checks);
    let failed = checks.any(|check| check.status == CheckStatus::Fail);
    Ok(ExitCode::from(u8::from(failed)))
}

/// A scene with the flags that change it applied, and the duration its file states, s.
fn read(args: &Args, path: &Path) -> anyhow::Result<(Scene, f64)> {
    let mut scene = flags::scene(path, None)?;
    let stated = scene.duration;
    scene.duration = args.duration.unwrap_or(stated);
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
    Ok((scene, stated))
}

/// The report of one scene, and whether all of it could be written.
fn one(
    args: &Args,
    quiet: bool,
    scene: &Scene,
    choice: &Choice,
    path: &Path,
    place: Option<&Place>,
) -> anyhow::Result<(Report, anyhow::Result<()>)> {
    let files = args.save.zip(place).map(|(kind, place)| Files {
        kind,
        folder: place.folder().to_owned(),
        every: args.every,
        columns: args.columns.clone(),
        statics: Statics::new(scene),
        springs: scene.springs.len(),
        rods: scene.rods.len(),
    });
    let saving = files.is_some();
    let terminal = Terminal::new(quiet).saving(files);
    let mut plan = Plan::new(scene, choice).expecting(saving, &Cache::new());
    plan.loads = !args.columns.is_empty();
    plan.played = args.output.plays(place);
    let estimates = plan.estimate();
    let expected = terminal::expected(&estimates);
    terminal.expect(plan.units(), expected, &estimates, SHORTER);
    let mut report = plan.execute(&terminal)?;
    report.header.advice = next(args, path, &report).into_iter().collect();
    let (report, written) = args.output.written(report, place);
    let saved = terminal.saved().context("--save");
    Ok((report, saved.and(written)))
}

/// Whether the scene's expectations are judged: flags may have changed the run they are stated for.
fn expectations(args: &Args, scene: &Scene, stated: f64) -> Expectations {
    if scene.duration != stated {
        Expectations::Skipped(format!("they are about {stated:?} s"))
    } else if args.truth != Demand::Auto {
        let why = "they are about errors and energies against the truth, and --truth changed it";
        Expectations::Skipped(why.to_owned())
    } else {
        Expectations::Judged
    }
}

/// Refuses two scenes that would write into one folder.
fn distinct(args: &Args, paths: &[PathBuf]) -> anyhow::Result<()> {
    let folder = |path: &PathBuf| Some(args.output.place(path)?.folder().to_owned());
    for (at, path) in paths.iter().enumerate() {
        let Some(own) = folder(path) else {
            return Ok(());
        };
        let same = |other: &&PathBuf| folder(other).as_ref() == Some(&own);
        if let Some(other) = paths[..at].iter().find(same) {
            let (other, path, own) = (other.display(), path.display(), own.display());
            bail!("{other} and {path} would both write to {own}");
        }
    }
    Ok(())
}

/// A command to try next, with other steps or other integrators; None where the path cannot be
/// written in a shell command.
fn next(args: &Args, path: &Path, report: &Report) -> Option<String> {
    let path = output::quoted(path)?;
    if args.timestep.len() > 1 {
        return Some(format!("springcheck run {path} --integrators all"));
    }
    let scene = &report.header.scene;
    let h = args.timestep.first().copied().unwrap_or(scene.timestep);
    // Expectations are about the own step, which stays exact.
    let steps: Vec<String> = [output::rounded(2.0 * h), h, output::rounded(0.5 * h)]
        .into_iter()
        .filter(|h| *h <= scene.duration)
        .map(|h| h.to_string())
        .collect();
    let steps = steps.join(",");
    Some(format!("springcheck run {path} --timestep {steps}"))
}

/// What runs on this scene; `stated` is the duration that its file states, s.
fn choice(args: &Args, scene: &Scene, stated: f64, path: &Path) -> anyhow::Result<Choice> {
    let mut choice = Choice::default_for(scene);
    choice.expectations = expectations(args, scene, stated);
    choice.truth = args.truth;
    if args.order {
        choice.order = Orders::Always;
    }
    let usual = &choice.solvers;
    choice.solvers = chosen(&args.integrators, &args.engines, &args.rapier, scene, usual)?;
    let terms = Terms {
        timeout: args.external_timeout,
        axes: args.axes,
    };
    let programs = external::chosen(&args.external, scene, path, terms)?;
    choice.solvers.extend(programs);
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
