//! `springcheck run SCENE...`

use super::cache::Cache;
use super::external::{self, External, Timeout};
use super::host::host;
use super::output::Place;
use super::progress::Progress;
use super::rapier::Custom;
use super::save::{FileKind, Files};
use anyhow::{Context, bail};
use clap::builder::PossibleValuesParser;
use springcheck::crosscheck::{self, Choice, ChosenEngine, Estimate, Orders, Plan, expect};
use springcheck::engines;
use springcheck::integrators;
use springcheck::outcome::{Check, CheckStatus, Figures, Report};
use springcheck::report;
use springcheck::scene::{self, Scene};
use springcheck::truth::Demand;
use std::io::Write;
use std::path::PathBuf;
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
    external_timeout: Timeout,

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
    #[arg(long, default_value = HUMAN, value_parser = formats())]
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

/// `--truth`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Truth {
    Auto,
    Closed,
    None,
}

impl Truth {
    pub fn demand(self) -> Demand {
        match self {
            Self::Auto => Demand::Auto,
            Self::Closed => Demand::Closed,
            Self::None => Demand::None,
        }
    }
}

/// The format whose texts are tables for people, with files beside them.
pub const HUMAN: &str = "human";

pub fn formats() -> PossibleValuesParser {
    PossibleValuesParser::new(report::FORMATS.iter().map(|format| format.id))
}

/// Work expected to take longer than this is announced, seconds.
const ANNOUNCED: f64 = 10.0;

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
            super::print(&format!("{several}{}", human(args, path, &report)))?;
        }
        reports.push(report);
    }
    if args.format != HUMAN {
        if args.output.is_none() {
            // No files, so no links to them.
            for report in &mut reports {
                report.figures = Figures::default();
            }
        }
        let format = report::format(&args.format).context("a format without a row")?;
        super::print(&(format.render)(&reports))?;
    }
    let failed = |report: &Report| report.checks.iter().any(|c| c.status == CheckStatus::Fail);
    Ok(ExitCode::from(u8::from(reports.iter().any(failed))))
}

/// Reads a scene and applies the flags that change it.
fn read(args: &Args, path: &std::path::Path) -> anyhow::Result<Read> {
    let mut scene = scene::read(path, crosscheck::names())?;
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

fn one(args: &Args, quiet: bool, read: &Read, path: &std::path::Path) -> anyhow::Result<Report> {
    let scene = &read.scene;
    let place = place(args, path);
    let files = match (args.save, &place) {
        (None, _) => None,
        (Some(kind), Some(place)) => Some(Files::new(kind, place, args.every)),
        (Some(_), None) => bail!("--save needs --output when --format is not human"),
    };
    let mut choice = choice(args, scene)?;
    choice.programs = external::chosen(&args.external, path, args.external_timeout);
    let plan = Plan::new(scene, &choice);
    let estimates = plan.estimate();
    let expected = expected(&estimates);
    if expected > ANNOUNCED && !quiet {
        announce(&estimates, expected);
    }
    if let Some(place) = &place {
        place.create()?;
    }
    let steps = plan.cases.iter().map(|case| case.label.steps).sum();
    let progress = Progress::new(steps, expected, quiet);
    let mut report = plan.execute(&host(&progress, files.as_ref(), &Cache::new()))?;
    report.checks.extend(expectations(args, read, &report));
    progress.finish();
    if let Some(place) = &place {
        place.write(&report)?;
    }
    Ok(report)
}

/// What the scene expects of what ran, unless flags changed what it is about.
fn expectations(args: &Args, read: &Read, report: &Report) -> Vec<Check> {
    let changed = if read.scene.duration != read.stated {
        format!("they are about {:?} s", read.stated)
    } else if args.truth.demand() != Demand::Auto {
        "they are about errors and energies against the truth, and --truth changed it".to_owned()
    } else {
        return expect::check(&read.scene, report);
    };
    let any = !read.scene.expect.is_empty();
    any.then(|| expect::not_judged(&changed))
        .into_iter()
        .collect()
}

/// Two scenes must not write into one folder.
fn distinct(args: &Args) -> anyhow::Result<()> {
    for (at, path) in args.scenes.iter().enumerate() {
        let Some(own) = place(args, path) else {
            return Ok(());
        };
        let same =
            |other: &&PathBuf| place(args, other).is_some_and(|p| p.folder() == own.folder());
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

/// Reports are files only where somebody asked for them or looks at the table.
fn place(args: &Args, scene: &std::path::Path) -> Option<Place> {
    match &args.output {
        Some(output) => Some(Place::new(output, scene)),
        None if args.format == HUMAN => Some(Place::new("reports".as_ref(), scene)),
        None => None,
    }
}

/// The table and, as its last three lines, verdict, report path, next command.
fn human(args: &Args, path: &std::path::Path, report: &Report) -> String {
    let table = report::terminal::render(report);
    let written = place(args, path).map_or_else(String::new, |place| {
        let file = place.report().display().to_string();
        format!("report: {}\n", file.replace(char::is_control, "?"))
    });
    let next = next(args, path, report)
        .filter(|next| next.chars().count() + "next: ".len() <= report::terminal::WIDTH)
        .unwrap_or_else(|| "springcheck run --help".to_owned());
    format!("{table}{written}next: {next}\n")
}

/// A command worth trying next: other steps, or other integrators; None where the path cannot be
/// written down.
fn next(args: &Args, path: &std::path::Path, report: &Report) -> Option<String> {
    let path = quoted(path)?;
    if args.timestep.len() > 1 {
        return Some(format!("springcheck run {path} --integrators all"));
    }
    let h = args
        .timestep
        .first()
        .copied()
        .unwrap_or(report.scene.timestep);
    // Six digits are enough for a suggestion.
    let steps: Vec<String> = [2.0 * h, h, 0.5 * h]
        .iter()
        .filter_map(|h| format!("{h:.5e}").parse::<f64>().ok())
        .filter(|h| *h <= report.scene.duration)
        .map(|h| h.to_string())
        .collect();
    Some(format!(
        "springcheck run {path} --timestep {}",
        steps.join(",")
    ))
}

/// The path as a POSIX shell takes it for one word; None with what a terminal cannot show.
fn quoted(path: &std::path::Path) -> Option<String> {
    let text = path
        .to_str()
        .filter(|text| !text.contains(char::is_control))?;
    let text = if text.starts_with('-') {
        format!("./{text}")
    } else {
        text.to_owned()
    };
    let plain = |c: char| c.is_alphanumeric() || "/._-+,:@%".contains(c);
    if text.chars().all(plain) {
        Some(text)
    } else {
        Some(format!("'{}'", text.replace('\'', "'\\''")))
    }
}

fn choice(args: &Args, scene: &Scene) -> anyhow::Result<Choice> {
    let mut choice = Choice::default_for(scene);
    choice.truth = args.truth.demand();
    if args.order {
        choice.order = Orders::Always;
    }
    if args.integrators == ["all"] {
        choice.methods = Choice::all_methods(scene);
    } else if !args.integrators.is_empty() {
        choice.methods = each(&args.integrators, integrators::find, || {
            format!("integrators: {}, or all", integrators::ids().join(", "))
        })?;
    }
    if args.engines == ["none"] {
        choice.engines.clear();
    } else if !args.engines.is_empty() {
        let rows = each(&args.engines, engines::find, || {
            format!("engines: {}, or none", engines::ids().join(", "))
        })?;
        choice.engines = rows.into_iter().map(ChosenEngine::from).collect();
    }
    for chosen in args.rapier.iter().map(Custom::chosen) {
        let known = |e: &ChosenEngine| e.row.id == chosen.row.id;
        if !choice.engines.iter().any(known) {
            choice.engines.push(chosen);
        }
    }
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

/// Looks each id up, once; an unknown one is an error that lists what there is.
fn each<T>(
    ids: &[String],
    find: impl Fn(&str) -> Option<&'static T>,
    known: impl Fn() -> String,
) -> anyhow::Result<Vec<&'static T>> {
    let mut rows = Vec::new();
    for (at, id) in ids.iter().enumerate() {
        if ids[..at].contains(id) {
            continue;
        }
        rows.push(find(id).with_context(|| format!("unknown `{id}`; known {}", known()))?);
    }
    Ok(rows)
}

/// Wall seconds all cases will take together: no less than the longest, no less than a fair share.
fn expected(estimates: &[Estimate]) -> f64 {
    let sum: f64 = estimates.iter().map(|e| e.seconds).sum();
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let longest = estimates.iter().fold(0.0, |m: f64, e| m.max(e.seconds));
    longest.max(sum / threads as f64)
}

fn announce(estimates: &[Estimate], expected: f64) {
    let mut err = anstream::stderr().lock();
    let _ = writeln!(err, "about {expected:.0} s expected:");
    for estimate in estimates {
        let Estimate { label, seconds } = estimate;
        let _ = writeln!(
            err,
            "  {:<30} {seconds:>8.1} s  ({} steps)",
            label.engine, label.steps
        );
    }
    let _ = writeln!(
        err,
        "shorter: --duration, a larger --timestep, --integrators A,B, --engines none"
    );
}
