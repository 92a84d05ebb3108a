//! `springcheck compare FILE --scene SCENE`

use crate::measure::identify::Undecided;
use crate::report::json::Tool;
use crate::scene;
use crate::trajectory::{self, Expected, limits};
use crate::verbs;
use crate::verbs::cli::cache::Cache;
use crate::verbs::cli::chosen::Truth;
use crate::verbs::cli::host::host;
use crate::verbs::cli::output::Place;
use crate::verbs::cli::progress::Progress;
use crate::verbs::cli::shown::{self, HUMAN, format_ids};
use crate::verbs::compare::Comparison;
use crate::verbs::{Body, Report};
use anyhow::{Context, bail};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// What some program computed: CSV (`t,id,x,y,z[,vx,vy,vz]`), NPZ (`t`, `x`, `v`) or NPY.
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The scene it simulates (YAML).
    #[arg(long, value_name = "SCENE")]
    scene: PathBuf,

    /// The step it took, seconds; rows may lie several of them apart. Default: the scene's.
    #[arg(long, value_name = "H")]
    timestep: Option<f64>,

    /// What errors are measured against, as in `run`.
    #[arg(long, value_enum, default_value_t = Truth::Auto, value_name = "KIND")]
    truth: Truth,

    /// What goes to stdout.
    #[arg(long, default_value = HUMAN, value_parser = format_ids())]
    format: String,

    /// Where a report goes. Default: nowhere.
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// No scheme, or more than one, explains the file.
const UNDECIDED: u8 = 3;

/// Runs the verb.
pub fn compare(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let mut scene = scene::read(&args.scene, verbs::names())?;
    let timestep = args.timestep.unwrap_or(scene.solver.timestep);
    if !(timestep.is_finite() && timestep > 0.0) {
        bail!("--timestep {timestep}: expected a positive number of seconds");
    }
    let name = args.file.display().to_string();
    let bytes = read(&args.file).with_context(|| format!("cannot read {name}"))?;
    let rows = trajectory::read(&bytes, &name, None, &Expected::new(&scene, timestep))?;
    drop(bytes);
    // The file says how long it is.
    scene.duration = rows
        .steps
        .last()
        .map_or(scene.duration, |n| *n as f64 * timestep);
    let comparison = Comparison {
        scene: &scene,
        rows: Arc::new(rows),
        name: args
            .file
            .file_name()
            .map_or(name, |n| n.to_string_lossy().into_owned()),
        demand: args.truth.demand(),
    };
    let steps = comparison.rows.steps.last().copied().unwrap_or(0);
    let progress = Progress::new(steps, 0.0, quiet);
    let report = comparison.execute(&host(&progress, None, &Cache::new()))?;
    progress.finish();
    let output = args.output.as_ref();
    let place = output.map(|output| Place::new(output, &args.file));
    let report = shown::written(report, place.as_ref())?;
    if args.format == HUMAN {
        crate::verbs::cli::print(&shown::table(&report, place.as_ref()))?;
    } else {
        shown::print(&args.format, &Tool::this(), std::slice::from_ref(&report))?;
    }
    Ok(ExitCode::from(code(&report)))
}

/// The file, no further than the reader would look at it.
fn read(path: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let limit = limits::FILE_BYTES as u64 + 1;
    File::open(path)?.take(limit).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// 0: it follows a scheme throughout; 1: it has a fault; 3: which scheme it follows is open.
fn code(report: &Report) -> u8 {
    if let Body::Compare { fault: Some(_), .. } = report.body {
        return 1;
    }
    let found = report
        .outcomes()
        .first()
        .and_then(|o| o.identified.as_ref());
    match found.map(|found| found.undecided) {
        // Which of several names one map has is no question the data could answer.
        Some(None | Some(Undecided::SameMap)) => 0,
        _ => UNDECIDED,
    }
}
