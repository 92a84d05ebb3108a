//! `springcheck show FILE.json`

use crate::report::json;
use crate::report::json::Tool;
use crate::verbs::cli::output::Place;
use crate::verbs::cli::shown::{self, HUMAN, format_ids};
use crate::verbs::series;
use crate::verbs::{Beside, Body, Report};
use anyhow::{Context, bail};
use std::fs::File;
use std::io::{ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// What `--format json` printed, or the report.json, stability.json or cost.json a verb wrote.
    #[arg(value_name = "FILE.json")]
    file: PathBuf,

    /// What goes to stdout.
    #[arg(long, default_value = HUMAN, value_parser = format_ids())]
    format: String,

    /// Where the report's files go, figures among them. Default: nowhere.
    #[arg(long, value_name = "DIR")]
    output: Option<PathBuf>,
}

/// More than this is no report.
const BYTES: u64 = 1 << 28;

/// Runs the verb.
pub fn show(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let (tool, reports) = stored(&args.file)?;
    let places = places(args, &reports)?;
    for (report, place) in reports.iter().zip(places.iter().flatten()) {
        place.create()?;
        place.write(&tool, report)?;
    }
    if args.format == HUMAN {
        let places = places.iter().map(Option::as_ref);
        let tables = reports.iter().zip(places);
        let tables: Vec<String> = tables.map(|(r, place)| shown::table(r, place)).collect();
        crate::verbs::cli::print(&tables.join("\n"))?;
    } else {
        shown::print(&args.format, &tool, &reports)?;
    }
    let missing = |report: &Report| matches!(report.beside, Beside::Missing);
    let drawn = args.output.is_some() || args.format == "markdown";
    if drawn && !quiet && reports.iter().any(missing) {
        let _ = writeln!(
            anstream::stderr(),
            "figures of curves over time are left out: {} is missing, or of another run",
            args.file.with_extension(series::EXTENSION).display()
        );
    }
    Ok(ExitCode::SUCCESS)
}

/// The reports of a file, and their series where these lie beside it.
fn stored(file: &Path) -> anyhow::Result<(Tool, Vec<Report>)> {
    let name = || file.display().to_string();
    let text = read(file, BYTES).with_context(|| format!("cannot read {}", name()))?;
    let (tool, reports) = json::read(&text).with_context(name)?;
    drop(text);
    let beside = file.with_extension(series::EXTENSION);
    let reports = match read(&beside, BYTES) {
        Ok(bytes) => series::unpack(reports, &bytes),
        Err(error) if error.kind() == ErrorKind::NotFound => reports,
        Err(error) => {
            return Err(error).with_context(|| format!("cannot read {}", beside.display()));
        }
    };
    Ok((tool, reports))
}

fn read(file: &Path, most: u64) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(file)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let why = format!("it has more than {most} bytes");
        return Err(std::io::Error::new(ErrorKind::FileTooLarge, why));
    }
    Ok(bytes)
}

/// Where each report goes: by its scene, as the verb that made it had it; a comparison by its file's name.
fn places(args: &Args, reports: &[Report]) -> anyhow::Result<Vec<Option<Place>>> {
    let Some(output) = &args.output else {
        return Ok(vec![None; reports.len()]);
    };
    let mut places: Vec<Option<Place>> = Vec::new();
    for report in reports {
        let about = match &report.body {
            Body::Compare { outcomes, .. } => outcomes.first().map(|o| &o.engine),
            _ => None,
        };
        let place = Place::new(output, about.unwrap_or(&report.header.scene.file).as_ref());
        let taken = |(other, at): (&Report, &Option<Place>)| {
            let same = at.as_ref().is_some_and(|at| at.folder() == place.folder());
            same && other.stem() == report.stem()
        };
        if reports.iter().zip(&places).any(taken) {
            bail!(
                "{}: two of its reports would be written to {}",
                args.file.display(),
                place.folder().display()
            );
        }
        places.push(Some(place));
    }
    Ok(places)
}
