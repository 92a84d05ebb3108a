//! `springcheck report SCENE...`: run, stability and cost of each scene on one page, and an index of several.

use crate::measure::CheckStatus;
use crate::report::json::Tool;
use crate::report::page::index::{self, Entry};
use crate::report::verdict;
use crate::scene::{self, Scene};
use crate::verbs::cli::cache::Cache;
use crate::verbs::cli::flags::{self, Time};
use crate::verbs::cli::interrupt;
use crate::verbs::cli::note::note;
use crate::verbs::cli::output;
use crate::verbs::cli::place::{INDEX, Place, put};
use crate::verbs::cli::terminal::{self, Terminal};
use crate::verbs::cost::{CostChoice, CostPlan};
use crate::verbs::run::{Choice, Expectations, Plan};
use crate::verbs::stability::{self, StabilityPlan};
use crate::verbs::{Report, formats};
use anyhow::Context;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// Scene files (YAML), or folders of them.
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<PathBuf>,

    /// Where pages go, with all that the verbs write.
    #[arg(long, value_name = "DIR", default_value = "reports")]
    output: PathBuf,

    /// About what the sweep of costs may take, for each scene.
    #[arg(
        long,
        value_name = "TIME",
        allow_hyphen_values = true,
        default_value = "10s"
    )]
    budget: Time,

    /// Open the page, or the index of several, in the browser.
    #[arg(long)]
    open: bool,
}

/// The flags that shorten this verb.
const SHORTER: &str = "--budget";

/// Runs the verb.
pub fn report(args: &Args, quiet: bool) -> anyhow::Result<ExitCode> {
    flags::refuse_empty(&args.scenes)?;
    let paths = flags::scenes(&args.scenes)?;
    let read = |path: &PathBuf| {
        let scene = flags::scene(path, None)?;
        scene::check_times(scene.solver.timestep, scene.duration)
            .with_context(|| path.display().to_string())?;
        Ok(scene)
    };
    let scenes: Vec<Scene> = paths.iter().map(read).collect::<anyhow::Result<_>>()?;
    let places: Vec<Place> = paths
        .iter()
        .map(|path| Place::new(&args.output, path))
        .collect();
    for place in &places {
        place.prepare()?;
    }
    let mut entries = Vec::new();
    let mut failed = false;
    for (at, (scene, place)) in scenes.iter().zip(&places).enumerate() {
        interrupt::unfinished(&paths[at..]);
        let reports = reports(args, scene, quiet)?;
        for report in &reports {
            place.write(&Tool::this(), report)?;
        }
        let page = place.write_page(&formats::page(&Tool::this(), &reports))?;
        let lines = reports.iter().map(output::summary);
        output::print(&(lines.collect::<String>() + &written(&page)))?;
        let mut checks = reports.iter().flat_map(|report| &report.header.checks);
        failed |= checks.any(|check| check.status == CheckStatus::Fail);
        entries.push(entry(&args.output, &page, &reports));
    }
    interrupt::unfinished(&[]);
    let mut first = places[0].folder().join(INDEX);
    if entries.len() > 1 {
        first = args.output.join(INDEX);
        put(&first, index::render(&Tool::this(), &entries).as_bytes())?;
        output::print(&written(&first))?;
    }
    if args.open
        && let Err(error) = open::that_detached(&first)
    {
        note(&format!(
            "no browser was found ({error}): open {}",
            first.display()
        ));
    }
    Ok(ExitCode::from(u8::from(failed)))
}

fn written(page: &Path) -> String {
    format!(
        "page: {}\n",
        scene::words::in_line(&page.display().to_string())
    )
}

/// What the three verbs find with their defaults.
fn reports(args: &Args, scene: &Scene, quiet: bool) -> anyhow::Result<[Report; 3]> {
    let choice = Choice {
        expectations: Expectations::Judged,
        ..Choice::default_for(scene)
    };
    let mut plan = Plan::new(scene, &choice).expecting(false, &Cache::new());
    plan.played = true;
    let terminal = Terminal::new(quiet);
    let estimates = plan.estimate();
    terminal.expect(
        plan.units(),
        terminal::expected(&estimates),
        &estimates,
        SHORTER,
    );
    let run = plan.execute(&terminal)?;
    drop(terminal);

    let plan = StabilityPlan::default_for(scene);
    let terminal = Terminal::new(quiet);
    let estimates = stability::estimates(&plan)?;
    terminal.expect(
        plan.steps()?,
        terminal::expected(&estimates),
        &estimates,
        SHORTER,
    );
    let stability = plan.execute(&terminal)?;
    drop(terminal);

    let choice = CostChoice {
        budget_s: args.budget.0.as_secs_f64(),
        ..CostChoice::default_for(scene)
    };
    let plan = CostPlan::new(scene, &choice);
    let terminal = Terminal::new(quiet);
    let estimates = plan.estimate();
    let expected = estimates.iter().map(|estimate| estimate.seconds).sum();
    terminal.expect(plan.work(), expected, &estimates, SHORTER);
    let cost = plan.execute(&terminal);
    Ok([run, stability, cost])
}

/// What the index says of a scene.
fn entry(output: &Path, page: &Path, reports: &[Report]) -> Entry {
    let link = page.strip_prefix(output).unwrap_or(page);
    Entry {
        title: reports[0].header.scene.name.clone(),
        file: reports[0].header.scene.file.clone(),
        link: link.to_string_lossy().into_owned(),
        said: reports
            .iter()
            .map(|report| (report.title(), verdict::verdict(&report.named().view())))
            .collect(),
    }
}
