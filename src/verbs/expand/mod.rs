//! `springcheck expand SCENE`: the scene as the program takes it.

use crate::physics::ParticleSystem;
use crate::scene;
use crate::solvers::external::{Flat, Task};
use crate::verbs::cli::{flags, output};
use crate::verbs::shape::shape;
use anyhow::Context;
use clap::ValueEnum;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene file.
    scene: PathBuf,

    /// What goes to stdout.
    #[arg(long, value_enum, default_value = "yaml")]
    format: Format,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Format {
    /// A scene file with all defaults written out.
    Yaml,
    /// The flat arrays that other programs get, as behind {scene_json}.
    Json,
    /// A picture of it at its start.
    Svg,
}

/// Prints a scene.
pub fn expand(args: &Args) -> anyhow::Result<ExitCode> {
    let scene = flags::scene(&args.scene, None)?;
    let text = match args.format {
        Format::Yaml => scene::yaml(&scene),
        Format::Svg => shape(&scene, &[("start", &scene.starts().concat())]).draw(),
        Format::Json => {
            let timestep = scene.solver.timestep;
            let task = Task {
                scene: &scene,
                system: &ParticleSystem::new(&scene),
                timestep,
                steps: scene.steps(timestep),
            };
            let flat = serde_json::to_string(&Flat(&task)).context("cannot write the scene")?;
            format!("{flat}\n")
        }
    };
    output::print(&text)?;
    Ok(ExitCode::SUCCESS)
}
