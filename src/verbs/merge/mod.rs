//! `springcheck merge FILE...` joins the JSON of parts of a run into that of the whole.

use crate::report::json::{self, Tool};
use crate::verbs::Report;
use crate::verbs::check;
use crate::verbs::cli::output;
use crate::verbs::show::read;
use anyhow::{Context, bail};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// What `--format json` printed for each part.
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,

    /// Exit as `check --strict` does.
    #[arg(long)]
    strict: bool,

    /// What goes to stdout.
    #[arg(long, default_value = "json", value_parser = output::format_ids())]
    format: String,
}

/// Prints the reports of all files in the order of their scenes, and exits as the gate would have on the whole.
pub fn merge(args: &Args) -> anyhow::Result<ExitCode> {
    let mut whole: Option<Tool> = None;
    let mut reports: Vec<Report> = Vec::new();
    for file in &args.files {
        let name = || file.display().to_string();
        let text = read(file).with_context(|| format!("cannot read {}", name()))?;
        let (tool, part): (Tool, Vec<Report>) = json::read(&text).with_context(name)?;
        match &whole {
            Some(whole) if *whole != tool => bail!(
                "{}: made by {} {} on {}, and the parts before it by another: run them with one program",
                name(),
                tool.name,
                tool.version,
                tool.platform
            ),
            _ => whole = Some(tool),
        }
        reports.extend(part);
    }
    // As paths are walked: folder by folder, not letter by letter.
    reports.sort_by(|a, b| Path::new(&a.header.scene.file).cmp(Path::new(&b.header.scene.file)));
    let mut seen = BTreeSet::new();
    for report in &reports {
        let file = &report.header.scene.file;
        if !seen.insert((report.stem(), file)) {
            bail!("{file}: two parts hold a report of it");
        }
    }
    let tool = whole.unwrap_or_else(Tool::this);
    output::print(&output::shown(&args.format, &tool, &reports)?)?;
    Ok(ExitCode::from(check::code(&reports, args.strict)))
}
