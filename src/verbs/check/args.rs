//! `springcheck check PATH...`

use super::select::Partition;
use super::targets::Targets;
use super::{Baseline, Claim, Gate, Verdict, text, verdict};
use crate::report::github;
use crate::report::json::Tool;
use crate::scene::{Names, Scene};
use crate::solvers::Solver;
use crate::trajectory::{self, Plane};
use crate::verbs::Report;
use crate::verbs::cli::external::{self, External, Terms};
use crate::verbs::cli::flags::{self, Time};
use crate::verbs::cli::interrupt;
use crate::verbs::cli::note::note;
use crate::verbs::cli::output;
use crate::verbs::cli::terminal::{self, Terminal};
use crate::verbs::compare::{Recorded, read};
use crate::verbs::run::Choice;
use anyhow::{Context, bail};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;
use std::sync::Arc;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene files, and folders of them (*.yml, *.yaml).
    #[arg(required = true, value_name = "PATH")]
    paths: Vec<PathBuf>,

    /// A program that the scene may expect something of, as in `run`; repeatable.
    #[arg(long, value_name = "NAME=COMMAND")]
    external: Vec<External>,

    /// A program that takes longer is stopped: 60s, 2m, 500ms.
    #[arg(
        long,
        value_name = "TIME",
        default_value = "60s",
        allow_hyphen_values = true
    )]
    external_timeout: Time,

    /// The axes that two-dimensional rows of programs have. Default: rows have all three.
    #[arg(long, value_parser = flags::plane(), value_name = "AXES")]
    axes: Option<Plane>,

    /// A trajectory that some program computed of the one scene that is checked; repeatable.
    #[arg(long, value_name = "NAME=FILE")]
    trajectory: Vec<Named<PathBuf>>,

    /// The scheme that a program claims to be, such as mine=symplectic_euler, or any other that `compare` names;
    /// repeatable.
    #[arg(long, value_name = "NAME=SCHEME")]
    claims: Vec<Named<String>>,

    /// A program of the scenes' `externals` that is not given is a failure, not a skip.
    #[arg(long)]
    require_all: bool,

    /// Compare counts, errors, energies and schemes with those of an accepted run.
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,

    /// Write those of this run; numbers that have not moved stay as they are.
    #[arg(long, value_name = "FILE")]
    accept: Option<PathBuf>,

    /// Accept also where the environment variable CI is `true`.
    #[arg(long, requires = "accept")]
    force: bool,

    /// Check only a part of the scenes: slice:1/4 (every fourth), hash:1/4 (by the path alone).
    #[arg(long, value_name = "PART", allow_hyphen_values = true)]
    partition: Option<Partition>,

    /// What could not be decided fails.
    #[arg(long)]
    strict: bool,

    /// What goes to stdout.
    #[arg(long, default_value = "human", value_parser = output::format_ids())]
    format: String,

    /// Write the results in another format to a file as well, such as junit=check.xml; repeatable.
    #[arg(long, value_name = "FORMAT=FILE")]
    write: Vec<Named<PathBuf>>,
}

/// NAME=VALUE.
#[derive(Debug, Clone)]
struct Named<T> {
    name: String,
    value: T,
}

impl<T: FromStr> FromStr for Named<T> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected NAME=VALUE, found `{text}`");
        let (name, value) = text.split_once('=').ok_or_else(wrong)?;
        let value = Some(value).filter(|value| !value.is_empty());
        let value = value.and_then(|value| value.parse().ok());
        let value = value.ok_or_else(wrong)?;
        let name = name.to_owned();
        Ok(Self { name, value })
    }
}

/// The exit codes beside those of every verb: something is inconclusive; nothing was selected.
const OPEN: u8 = 3;
const NOTHING: u8 = 4;

/// The flags that shorten this verb, for the announcement.
const SHORTER: &str = "--partition slice:1/4, fewer scenes";

/// Runs the verb.
pub fn check(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let ci = std::env::var_os("CI").is_some_and(|ci| ci == "true");
    if args.accept.is_some() && ci && !args.force {
        bail!(
            "--accept does not run in CI, where nobody looks at what it accepts: --force does it all the same"
        );
    }
    for Named { name, .. } in &args.write {
        output::known(name).context("--write")?;
    }
    let all = flags::scenes(&args.paths)?;
    let files = match args.partition {
        Some(partition) => partition.of(&all),
        None => all.clone(),
    };
    if files.is_empty() {
        note("no scene was selected");
        return Ok(ExitCode::from(NOTHING));
    }
    let names = names(args)?;
    let scenes = files
        .iter()
        .map(|path| Ok((path, flags::scene_of(path, &names)?)));
    let scenes: Vec<(&PathBuf, Scene)> = scenes.collect::<anyhow::Result<_>>()?;
    let claims = claimed(args)?;
    let trajectories = trajectories(args, &scenes)?;
    let choices = scenes
        .iter()
        .map(|(path, scene)| choice(args, scene, path, &trajectories));
    let choices: Vec<Choice> = choices.collect::<anyhow::Result<_>>()?;
    let baseline = args.baseline.as_deref().map(baseline).transpose()?;
    let Targets { accept, writes } = targets(args, &all)?;
    // What was accepted before stays, where it was kept.
    let accepted = match (&accept, args.accept.as_deref()) {
        (Some(target), Some(path)) if target.file().is_some_and(Path::exists) => {
            self::baseline(path)?
        }
        _ => Baseline::default(),
    };
    let human = args.format == "human";
    let by_line = args.format == "jsonl";
    let rendered = |reports: &[Report]| output::rendered(&args.format, &Tool::this(), reports);
    let mut reports = Vec::new();
    for (at, ((_, scene), choice)) in scenes.iter().zip(&choices).enumerate() {
        interrupt::unfinished(&files[at..]);
        let mut report = one(args, quiet, scene, choice, &claims)?;
        if let Some(baseline) = &baseline {
            report.header.checks.extend(baseline.check(&report, scene));
        }
        if human {
            output::print(&match quiet {
                true => output::summary(&report),
                false => report.human(output::columns()),
            })?;
        } else if by_line {
            output::print(&rendered(std::slice::from_ref(&report))?)?;
        }
        reports.push(report);
    }
    interrupt::unfinished(&[]);
    if human {
        output::print(&output::closing(&reports, quiet))?;
    } else if !by_line {
        output::print(&rendered(&reports)?)?;
    }
    for (name, target) in &writes {
        let text = output::rendered(name, &Tool::this(), &reports)?;
        // A file has no colours.
        let text = anstream::adapter::strip_str(&text).to_string();
        target.put(text.as_bytes())?;
    }
    if args.format == "github" {
        // A job's log shows a line that is no command as it is.
        output::print(&format!("{}\n", text::closing(&reports)))?;
        summarise(&reports)?;
    }
    if let Some(target) = accept {
        let mut accepted = accepted;
        accepted.accept(reports.iter().zip(scenes.iter().map(|(_, scene)| scene)));
        target.put(accepted.text().as_bytes())?;
    }
    Ok(ExitCode::from(code(&reports, args.strict)))
}

/// 1: something failed; 3: nothing failed, but something is open; 4: nothing was judged.
pub fn code(reports: &[Report], strict: bool) -> u8 {
    let has = |wanted| reports.iter().any(|report| verdict(report) == wanted);
    if has(Verdict::Failed) || strict && has(Verdict::Inconclusive) {
        1
    } else if has(Verdict::Inconclusive) {
        OPEN
    } else if has(Verdict::Passed) {
        0
    } else {
        NOTHING
    }
}

/// The files to write, found and tried before the work.
fn targets<'a>(args: &'a Args, scenes: &[PathBuf]) -> anyhow::Result<Targets<'a>> {
    let trajectories = args.trajectory.iter().map(|named| &named.value);
    let read = scenes.iter().chain(trajectories);
    let write = |Named { name, value }: &'a Named<PathBuf>| (name.as_str(), value.as_path());
    let writes = args.write.iter().map(write);
    Targets::find(
        read,
        args.baseline.as_deref(),
        args.accept.as_deref(),
        writes,
    )
}

/// What scenes may speak of: what there is, and the programs of this command.
fn names(args: &Args) -> anyhow::Result<Names> {
    external::distinct(&args.external)?;
    let mut names = crate::verbs::names().clone();
    names.externals = args.external.iter().map(|e| e.name().to_owned()).collect();
    for Named { name, .. } in &args.trajectory {
        if let Err(refusal) = crate::scene::limits::external(name) {
            bail!("--trajectory {name}: {refusal}");
        }
        if crate::solvers::find(name).is_some() || names.externals.contains(name) {
            bail!(
                "--trajectory {name}: an integrator, engine or program has this name, choose another"
            );
        }
        names.externals.push(name.clone());
    }
    Ok(names)
}

/// The schemes that programs claim to be.
fn claimed(args: &Args) -> anyhow::Result<Vec<Claim>> {
    let claim = |Named { name, value }: &Named<String>| -> anyhow::Result<Claim> {
        let command = args.external.iter().any(|e| e.name() == name);
        if !command && !args.trajectory.iter().any(|t| t.name == *name) {
            bail!("--claims {name}: no --external and no --trajectory has this name");
        }
        Ok(Claim {
            name: name.clone(),
            scheme: value
                .parse()
                .map_err(|why| anyhow::anyhow!("--claims {name}={value}: {why}"))?,
            repeats: command,
        })
    };
    args.claims.iter().map(claim).collect()
}

/// The recorded trajectories, ready to be judged. They are of one scene.
fn trajectories(args: &Args, scenes: &[(&PathBuf, Scene)]) -> anyhow::Result<Vec<Solver>> {
    if args.trajectory.is_empty() {
        return Ok(Vec::new());
    }
    let [(_, scene)] = scenes else {
        bail!(
            "--trajectory: a trajectory is of one scene, and {} are checked",
            scenes.len()
        );
    };
    let expected = flags::expected(scene, scene.solver.timestep, args.axes)?;
    let solver = |Named { name, value }: &Named<PathBuf>| -> anyhow::Result<Solver> {
        let file = value.display().to_string();
        let bytes = read(value).with_context(|| format!("cannot read {file}"))?;
        let rows = trajectory::read(&bytes, &file, None, &expected)?;
        Ok(Solver::program(name, Arc::new(Recorded(Arc::new(rows)))))
    };
    args.trajectory.iter().map(solver).collect()
}

fn baseline(path: &Path) -> anyhow::Result<Baseline> {
    let name = || path.display().to_string();
    let text = std::fs::read(path).with_context(|| format!("cannot read {}", name()))?;
    Baseline::read(&text).with_context(name)
}

/// The solvers of a scene's gate, with the programs of this command.
fn choice(
    args: &Args,
    scene: &Scene,
    path: &Path,
    trajectories: &[Solver],
) -> anyhow::Result<Choice> {
    let mut choice = Gate::choice(scene);
    let terms = Terms {
        timeout: args.external_timeout,
        axes: args.axes,
    };
    let programs = external::chosen(&args.external, scene, path, terms)?;
    choice.solvers.extend(programs);
    choice.solvers.extend(trajectories.iter().cloned());
    Ok(choice)
}

fn one(
    args: &Args,
    quiet: bool,
    scene: &Scene,
    choice: &Choice,
    claims: &[Claim],
) -> anyhow::Result<Report> {
    let mut gate = Gate::of(scene, choice);
    gate.claims = claims.to_vec();
    gate.require_all = args.require_all;
    let terminal = Terminal::new(quiet);
    let estimates = gate.plan.estimate();
    // Every integrator runs twice.
    let expected = 2.0 * terminal::expected(&estimates);
    terminal.expect(gate.plan.units(), expected, &estimates, SHORTER);
    Ok(gate.run(&terminal)?)
}

/// Appends what did not fit into annotations to the summary of a step on GitHub.
fn summarise(reports: &[Report]) -> anyhow::Result<()> {
    let Some(path) = std::env::var_os("GITHUB_STEP_SUMMARY").filter(|path| !path.is_empty()) else {
        return Ok(());
    };
    let shown: Vec<_> = reports.iter().map(Report::named).collect();
    let mut summary = github::summary(shown.iter().map(|report| &report.header));
    summary += &format!("\n{}\n", text::closing(reports));
    let mut options = std::fs::OpenOptions::new();
    let file = options.create(true).append(true).open(&path);
    let written = file.and_then(|mut file| file.write_all(summary.as_bytes()));
    written.with_context(|| format!("cannot write {}", Path::new(&path).display()))
}
