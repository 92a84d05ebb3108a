//! `springcheck rest SCENE`

use crate::scene::{self, Scene};
use crate::verbs::cli::flags;
use crate::verbs::cli::interrupt;
use crate::verbs::cli::note::note;
use crate::verbs::cli::output::{self, Output};
use crate::verbs::cli::target::Target;
use crate::verbs::cli::terminal::{self, Terminal};
use crate::verbs::rest::RestPlan;
use crate::verbs::session::TimeEstimate;
use anyhow::{Context, anyhow, bail};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene file (YAML).
    #[arg(value_name = "SCENE")]
    scene: PathBuf,

    /// Find it again with each link of the scene's objects cut into this many, with and without scaling: 1,2,4,8.
    #[arg(
        long,
        value_name = "N,...",
        allow_hyphen_values = true,
        value_delimiter = ','
    )]
    refine: Vec<u64>,

    /// Write the scene as it starts from its rest to this file.
    #[arg(long, value_name = "FILE")]
    write: Option<PathBuf>,

    /// Fixed particles that `--write` lets go, once the rest is found: ids or names such as rope[0].
    #[arg(long, value_name = "ID,...", requires = "write", value_parser = ids)]
    release: Option<Ids>,

    #[command(flatten)]
    output: Output,
}

/// Ids and names with commas. The comma of `sheet[3,4]` separates nothing.
#[derive(Debug, Clone)]
struct Ids(Vec<String>);

fn ids(text: &str) -> Result<Ids, String> {
    let mut ids = vec![String::new()];
    let mut inside = false;
    for c in text.chars() {
        inside = (inside || c == '[') && c != ']';
        match ids.last_mut() {
            Some(_) if c == ',' && !inside => ids.push(String::new()),
            Some(id) => id.push(c),
            None => {}
        }
    }
    if ids.iter().any(|id| id.trim().is_empty()) {
        return Err("expected ids with commas, such as 0 or rope[0],rope[20]".to_owned());
    }
    Ok(Ids(ids))
}

/// The most links that one may become: a text of more than a few rows is wanted by nobody.
const MOST: u64 = 10_000;

/// The flag that shortens a run of this verb.
const SHORTER: &str = "--refine with fewer or smaller numbers";

/// The exit code where there is no rest.
const NONE: u8 = 1;

/// Runs the verb.
pub fn rest(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    let scene = flags::scene(&args.scene, None)?;
    let plan = plan(args, &scene)?;
    let released = released(args, &scene)?;
    let place = args.output.place(&args.scene);
    if let Some(place) = &place {
        place.prepare()?;
    }
    let target = args.write.as_ref().map(|path| {
        let named = || format!("cannot write {}", path.display());
        let target = Target::of(path).with_context(named)?;
        let same = args.scene.canonicalize().ok();
        if same.is_some() && same.as_deref() == target.file() {
            bail!("--write {}: that is the scene itself", path.display());
        }
        target.prepare()?;
        Ok(target)
    });
    let target = target.transpose()?;
    interrupt::unfinished(std::slice::from_ref(&args.scene));
    let terminal = Terminal::new(quiet);
    let announce = |estimates: &[TimeEstimate]| {
        terminal.expect(0, terminal::expected(estimates), estimates, SHORTER);
    };
    announce(&plan.estimates());
    let (mut report, settled) = plan.execute(announce);
    drop(terminal);
    let rests = settled.is_some();
    report.header.advice = next(args, &scene, rests).into_iter().collect();
    let printed = args
        .output
        .finish(report, place, "springcheck rest --help", quiet);
    if let Some(target) = target {
        let Some(mut settled) = settled else {
            note("--write: nothing is written, since no rest was found");
            return printed.map(|_| ExitCode::from(NONE));
        };
        for id in released {
            settled.particles[id].fixed = false;
        }
        target.put(scene::yaml(&settled).as_bytes())?;
    }
    printed?;
    Ok(ExitCode::from(if rests { 0 } else { NONE }))
}

fn plan<'a>(args: &Args, scene: &'a Scene) -> anyhow::Result<RestPlan<'a>> {
    let mut links = args.refine.clone();
    if let Some(wrong) = links.iter().find(|n| !(1..=MOST).contains(*n)) {
        bail!("--refine {wrong}: expected 1 to {MOST} links in the place of each");
    }
    if !links.is_empty() && scene.bodies.is_empty() {
        bail!("--refine: the scene has no objects, whose links could be cut (docs/objects.md)");
    }
    links.sort_unstable();
    links.dedup();
    if let Some(most) = links.last() {
        scene
            .refined(*most, scene::object::Scaling::None)
            .with_context(|| format!("--refine {most}"))?;
    }
    Ok(RestPlan { scene, links })
}

/// The ids of particles that are let go.
fn released(args: &Args, scene: &Scene) -> anyhow::Result<Vec<usize>> {
    let names = args.release.iter().flat_map(|ids| &ids.0);
    let id = |name: &String| {
        let id = match name.trim().parse() {
            Ok(id) => id,
            Err(_) => scene
                .particle_named(name)
                .map_err(|refusal| anyhow!("--release: {refusal} ({})", refusal.help))?,
        };
        let Some(particle) = scene.particles.get(id) else {
            bail!(
                "--release {name}: the scene has {} particles, from 0",
                scene.particles.len()
            );
        };
        if !particle.fixed {
            bail!("--release {name}: this particle is not fixed");
        }
        if scene.driven.iter().any(|motion| motion.particle == id) {
            bail!("--release {name}: this particle is driven");
        }
        Ok(id)
    };
    names.map(id).collect()
}

/// The command to run next.
fn next(args: &Args, scene: &Scene, rests: bool) -> Option<String> {
    let path = output::quoted(&args.scene)?;
    if rests && args.refine.is_empty() && !scene.bodies.is_empty() {
        return Some(format!("springcheck rest {path} --refine 1,2,4,8"));
    }
    Some(format!("springcheck run {path}"))
}
