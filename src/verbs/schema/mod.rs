//! `springcheck schema scene|report`: JSON Schema, draft 7, which every editor and validator reads.

mod scene;

use crate::verbs::cli::output;
use crate::verbs::{formats, names};
use clap::ValueEnum;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[arg(value_enum)]
    what: What,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    /// Of scene files.
    Scene,
    /// Of the JSON that `run`, `compare`, `check`, `stability`, `rest` and `cost` write.
    Report,
}

/// Prints a schema.
pub fn schema(args: &Args) -> anyhow::Result<ExitCode> {
    let text = match args.what {
        What::Scene => scene_text(),
        What::Report => format!("{:#}\n", formats::schema().as_value()),
    };
    output::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// The schema of scene files as text.
pub fn scene_text() -> String {
    format!("{:#}\n", scene::schema(names()))
}
