//! `springcheck show FILE.json`

use crate::report::json::{self, Tool};
use crate::verbs::cli::note::note;
use crate::verbs::cli::output::{self, Output};
use crate::verbs::cli::place::Place;
use crate::verbs::{Body, Report, SeriesState, formats, series};

use anyhow::{Context, bail};
use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
#[command(mut_arg("output", |arg| arg.help("Where the report's files go, figures among them. Default: nowhere")))]
pub struct Args {
    /// What `--format json` printed, or the report.json, stability.json or cost.json a verb wrote.
    #[arg(value_name = "FILE.json")]
    file: PathBuf,

    #[command(flatten)]
    output: Output,
}

/// The largest size of a report's file, bytes.
const MAX_BYTES: u64 = 1 << 28;

/// Runs the verb.
pub fn show(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let (tool, reports) = stored(&args.file)?;
    if reports.is_empty() {
        bail!("{}: there is no report in this file", args.file.display());
    }
    let places = places(args, &reports)?;
    for place in places.iter().flatten() {
        place.prepare()?;
    }
    let write = |(report, place): (&Report, &Option<Place>)| match place {
        Some(place) => place.write(&tool, report),
        None => Ok(()),
    };
    let saved: Vec<_> = reports.iter().zip(&places).map(write).collect();
    if args.output.is_human() && quiet {
        let lines: String = reports.iter().map(output::summary).collect();
        output::print(&(lines + &output::closing(&reports, quiet)))?;
    } else if args.output.is_human() {
        let places = places.iter().zip(&saved);
        let places = places.map(|(place, saved)| place.as_ref().filter(|_| saved.is_ok()));
        let tables = reports.iter().zip(places);
        let tables = tables.map(|(report, place)| output::table(report, place));
        output::print(&formats::together(&reports, tables, output::columns()))?;
    } else {
        args.output.print(&tool, &reports)?;
    }
    saved.into_iter().collect::<anyhow::Result<()>>()?;
    let missing = |report: &Report| matches!(report.series, SeriesState::Missing);
    if args.output.draws() && !quiet && reports.iter().any(missing) {
        note(&format!(
            "figures of curves over time are left out: {} is missing, or of another run",
            args.file.with_extension(series::EXTENSION).display()
        ));
    }
    Ok(ExitCode::SUCCESS)
}

/// The reports of a file, with their series where the file of these lies beside it.
fn stored(file: &Path) -> anyhow::Result<(Tool, Vec<Report>)> {
    let name = || file.display().to_string();
    let text = read(file).with_context(|| format!("cannot read {}", name()))?;
    let (tool, reports) = json::read(&text).with_context(name)?;
    drop(text);
    let beside = file.with_extension(series::EXTENSION);
    let reports = match read(&beside) {
        Ok(bytes) => series::unpack(reports, &bytes),
        Err(error) if error.kind() == ErrorKind::NotFound => reports,
        Err(error) => {
            return Err(error).with_context(|| format!("cannot read {}", beside.display()));
        }
    };
    Ok((tool, reports))
}

/// The bytes of a report's file, or of its series.
pub(in crate::verbs) fn read(file: &Path) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(file)?
        .take(MAX_BYTES + 1)
        .read_to_end(&mut bytes)?;
    if bytes.len() as u64 > MAX_BYTES {
        let why = format!("it has more than {MAX_BYTES} bytes");
        return Err(std::io::Error::new(ErrorKind::FileTooLarge, why));
    }
    Ok(bytes)
}

/// The folder of each report: that of its scene, as for the verb that made it; for a comparison, that of its file.
fn places(args: &Args, reports: &[Report]) -> anyhow::Result<Vec<Option<Place>>> {
    let mut places: Vec<Option<Place>> = Vec::new();
    for report in reports {
        let named = match &report.body {
            Body::Compare { outcomes, .. } => outcomes.first().map(|o| &o.engine),
            _ => None,
        };
        let named = named.unwrap_or(&report.header.scene.file);
        let place = args.output.stated_place(named.as_ref());
        if let Some(place) = &place {
            let file = place.report(report);
            let mut others = reports.iter().zip(places.iter().flatten());
            if others.any(|(other, at)| at.report(other) == file) {
                bail!(
                    "{}: two of its reports would be written to {}",
                    args.file.display(),
                    place.folder().display()
                );
            }
        }
        places.push(place);
    }
    Ok(places)
}
