//! `springcheck compare FILE --scene SCENE` checks one trajectory that another program computed: its errors, and the
//! scheme that it follows.

use crate::measure::identify::{Identity, Undecided};
use crate::measure::{Check, CheckStatus};
use crate::solvers::Solver;
use crate::solvers::external::{Failure, Program, Recording, Task};
use crate::trajectory::{self, Plane, Rows, SaveError, limits};
use crate::truth::Demand;
use crate::verbs::cli::cache::Cache;
use crate::verbs::cli::flags::{self, demand, plane};
use crate::verbs::cli::interrupt;
use crate::verbs::cli::output::{self, Output};
use crate::verbs::cli::terminal::{self, Terminal};
use crate::verbs::run::{Choice, Expectations, Orders, Plan, identity, missed};
use crate::verbs::scheme::Scheme;
use crate::verbs::session::Session;
use crate::verbs::{Body, Report};
use anyhow::{Context, bail};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

#[derive(Debug, clap::Args)]
#[command(mut_arg("output", |arg| arg.help("Where a report goes. Default: nowhere")))]
pub struct Args {
    /// What some program computed: CSV (`t,id,x,y,z[,vx,vy,vz]`, or wide: `t,x0,y0,z0,x1,...`), NPZ (`t`, `x`, `v`) or NPY.
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The scene it simulates (YAML).
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,

    /// The step it took, seconds; rows may lie several of them apart. Default: the scene's.
    #[arg(long, value_name = "H", allow_hyphen_values = true)]
    timestep: Option<f64>,

    /// The axes that two-dimensional data has. Default: data has all three.
    #[arg(long, value_parser = plane(), value_name = "AXES")]
    axes: Option<Plane>,

    /// What errors are measured against, as in `run`.
    #[arg(long, default_value = "auto", value_parser = demand(), value_name = "KIND")]
    truth: Demand,

    /// The scheme it has to follow, as `compare` names it: anything else is a failed check.
    #[arg(long, value_name = "SCHEME")]
    expect: Option<Scheme>,

    /// The largest energy error it may have, in units of the scene's energy.
    #[arg(long, value_name = "PART", value_parser = positive, allow_hyphen_values = true)]
    max_energy: Option<f64>,

    /// The largest distance from the truth that a particle may have, m.
    #[arg(long, value_name = "METRES", value_parser = positive, allow_hyphen_values = true)]
    max_error: Option<f64>,

    #[command(flatten)]
    output: Output,
}

fn positive(text: &str) -> Result<f64, String> {
    let number = text
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite() && *x > 0.0);
    number.ok_or_else(|| format!("expected a positive number, found `{text}`"))
}

/// The exit code where no scheme explains the file to rounding.
const NOT_EXACT: u8 = 3;

/// Runs the verb.
pub fn compare(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let mut scene = flags::scene(&args.scene, None)?;
    let timestep = args.timestep.unwrap_or(scene.solver.timestep);
    if !(timestep.is_finite() && timestep > 0.0) {
        bail!("--timestep {timestep}: expected a positive number of seconds");
    }
    let name = args.file.display().to_string();
    let bytes = read(&args.file).with_context(|| format!("cannot read {name}"))?;
    let expected = flags::expected(&scene, timestep, args.axes)?;
    let rows = trajectory::read(&bytes, &name, None, &expected)?;
    drop(bytes);
    // The file determines the duration.
    scene.duration = rows
        .steps
        .last()
        .map_or(scene.duration, |n| *n as f64 * timestep);
    let file_name = args.file.file_name();
    let name = file_name.map_or(name, |n| n.to_string_lossy().into_owned());
    let place = args.output.stated_place(&args.file);
    if let Some(place) = &place {
        place.prepare()?;
    }
    interrupt::unfinished(std::slice::from_ref(&args.file));
    let terminal = Terminal::new(quiet);
    let rows = Arc::new(rows);
    let choice = choice(&rows, &name, args.truth);
    let mut plan = Plan::new(&scene, &choice).expecting(false, &Cache::new());
    plan.played = args.output.plays(place.as_ref());
    let estimates = plan.estimate();
    let expected = terminal::expected(&estimates);
    terminal.expect(plan.units(), expected, &estimates, "--truth closed");
    let mut report = report(&plan, &rows, &terminal)?;
    report.header.checks.extend(wanted(args, &report));
    drop(terminal);
    let (report, saved) = args.output.written(report, place.as_ref());
    let place = place.filter(|_| saved.is_ok());
    if args.output.is_human() && !quiet {
        output::print(&output::table(&report, place.as_ref()))?;
    } else {
        args.output.print_one(&report, place.as_ref(), "", quiet)?;
    }
    saved?;
    Ok(ExitCode::from(code(&report)))
}

/// A check for each flag that says what the file has to be.
fn wanted(args: &Args, report: &Report) -> Vec<Check> {
    let Some(outcome) = report.outcomes().first() else {
        return Vec::new();
    };
    let at_most = |flag: &str, what: &str, most: Option<f64>, found: Option<f64>| {
        let most = most?;
        let holds = found.is_some_and(|found| found <= most);
        let message = match found {
            Some(found) => format!("{what}: {found:.3e}, at most {most:.3e}"),
            None => format!("{what}: not known, at most {most:.3e} is wanted"),
        };
        Some(asked(flag, holds, found, Some(most), message))
    };
    let energy = outcome
        .energy
        .as_ref()
        .and_then(|energy| energy.relative_error_max);
    let error = outcome.position_error_m.as_ref().map(|error| error.max);
    let scheme = args.expect.as_ref().map(|scheme| {
        let found = outcome.identified.as_ref();
        let holds = found.is_some_and(|found| found.is(&scheme.label));
        let name = found.map_or_else(|| "no known scheme".to_owned(), Identity::label);
        let message = format!("it is to follow {}, and follows {name}", scheme.label);
        asked("--expect", holds, None, None, message)
    });
    let energy = at_most(
        "--max-energy",
        "largest energy error, in units of S",
        args.max_energy,
        energy,
    );
    let error = at_most(
        "--max-error",
        "largest distance from the truth, m",
        args.max_error,
        error,
    );
    scheme.into_iter().chain(energy).chain(error).collect()
}

fn asked(
    flag: &str,
    holds: bool,
    measured: Option<f64>,
    bound: Option<f64>,
    message: String,
) -> Check {
    Check {
        id: "expect".to_owned(),
        subject: flag.to_owned(),
        status: if holds {
            CheckStatus::Pass
        } else {
            CheckStatus::Fail
        },
        measured: measured.filter(|x| x.is_finite()),
        bound,
        derivation: "the command line".to_owned(),
        message,
        ..Check::default()
    }
}

/// Reads the file, up to one byte more than the parser accepts.
pub(in crate::verbs) fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let limit = limits::FILE_BYTES as u64 + 1;
    File::open(path)?.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// The exit code. 0: it follows a scheme throughout; 1: it follows a known mistake, leaves its scheme, or misses a law of
/// contact; 3: no scheme explains it to rounding.
fn code(report: &Report) -> u8 {
    let left = matches!(report.body, Body::Compare { fault: Some(_), .. });
    let checks = &report.header.checks;
    let asked: Vec<&Check> = checks
        .iter()
        .filter(|check| check.subject.starts_with("--"))
        .collect();
    if !asked.is_empty() {
        // What the command asks for decides, and nothing else.
        let failed = asked.iter().any(|check| check.status == CheckStatus::Fail);
        let left = left && asked.iter().any(|check| check.subject == "--expect");
        return u8::from(failed || left);
    }
    let misses = |outcome| !missed(outcome).is_empty();
    let found = report
        .outcomes()
        .first()
        .is_some_and(|outcome| outcome.identified.is_some() && misses(outcome));
    if left || found {
        return 1;
    }
    let found = report
        .outcomes()
        .first()
        .and_then(|o| o.identified.as_ref());
    match found.map(|found| found.undecided) {
        None | Some(Some(Undecided::Near)) => NOT_EXACT,
        // Schemes that no data, or not this data, tells apart.
        Some(None | Some(Undecided::SameMap | Undecided::DataTooCoarse)) => 0,
    }
}

/// A program whose rows are known already.
pub struct Recorded(pub Arc<Rows>);

impl Program for Recorded {
    fn record(&self, _task: &Task) -> Result<Recording, Failure> {
        Ok(Recording {
            rows: Rows::clone(&self.0),
            seconds: None,
        })
    }
}

/// A plan of these rows alone, under this name. All their steps are replayed beside it, instead of some.
fn choice(rows: &Arc<Rows>, name: &str, truth: Demand) -> Choice {
    Choice {
        solvers: vec![Solver::program(name, Arc::new(Recorded(Arc::clone(rows))))],
        timesteps: vec![rows.timestep],
        truth,
        order: Orders::Never,
        identify: false,
        prove: false,
        expectations: Expectations::Ignored,
    }
}

/// The report, with one outcome: errors, energy, identity over every step, and the first fault. The scene's duration
/// must be that of the rows.
fn report(plan: &Plan, rows: &Rows, session: &dyn Session) -> Result<Report, SaveError> {
    let mut report = plan.execute(session)?;
    let (found, fault) = identity::of_rows(plan, rows);
    let identified = found.identity;
    if let Body::Run { outcomes } = &mut report.body {
        let mut outcomes = std::mem::take(outcomes);
        for outcome in &mut outcomes {
            outcome.identified.clone_from(&identified);
            outcome.explained.clone_from(&found.explained);
        }
        report.body = Body::Compare { outcomes, fault };
    }
    Ok(report)
}
