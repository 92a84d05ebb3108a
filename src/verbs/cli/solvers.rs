//! The solvers a command line names: `--integrators`, `--engines`, `--rapier dt=0.001,iterations=8,pgs=4`.

use crate::integrators::{self, Method};
use crate::scene::Scene;
use crate::solvers::{self, Kind, Solver, rapier};
use anyhow::{Context, bail};
use std::str::FromStr;

/// The solvers of one command, in the order of its report: the named integrators, or the `usual` ones without
/// names; then the engines, likewise; after them the rapier rows with settings of the user's own, the same
/// settings once.
///
/// `all` integrators are those of the registry, the scene's own first. Adaptive pairs are taken where there
/// are usual ones, and `all` takes these in.
pub fn chosen(
    integrators: &[String],
    engines: &[String],
    custom: &[Custom],
    scene: &Scene,
    usual: &[Solver],
) -> anyhow::Result<Vec<Solver>> {
    let mut chosen = if usual.iter().any(|solver| solver.as_pair().is_some()) {
        with_pairs(integrators, scene, usual)?
    } else {
        methods(integrators, scene, usual)?
    };
    let known = || format!("engines: {}, or none", rapier::IDS.join(", "));
    let find = |id: &str| solvers::find(id).filter(|solver| solver.kind == Kind::Rapier);
    chosen.extend(match engines {
        [] => of_kind(usual, Kind::Rapier),
        [none] if none == "none" => Vec::new(),
        ids => each(ids, find, known)?,
    });
    for custom in custom.iter().map(Custom::solver) {
        if !chosen.iter().any(|known| known.id == custom.id) {
            chosen.push(custom);
        }
    }
    Ok(chosen)
}

fn methods(ids: &[String], scene: &Scene, usual: &[Solver]) -> anyhow::Result<Vec<Solver>> {
    let fixed = integrators::fixed();
    let known = || {
        format!(
            "integrators: {}, or all",
            integrators::ids(fixed).join(", ")
        )
    };
    let find = |id: &str| among(fixed, id);
    match ids {
        [] => Ok(of_kind(usual, Kind::Integrator)),
        [all] if all == "all" => Ok(solvers::methods(&scene.solver.method)),
        ids => each(ids, find, known),
    }
}

/// Methods first, then pairs.
fn with_pairs(ids: &[String], scene: &Scene, usual: &[Solver]) -> anyhow::Result<Vec<Solver>> {
    let find = |id: &str| among(integrators::pairs(), id);
    let (pairs, others): (Vec<String>, Vec<String>) =
        ids.iter().cloned().partition(|id| find(id).is_some());
    let pairs = each(&pairs, find, String::new)?;
    if others.is_empty() && !pairs.is_empty() {
        return Ok(pairs);
    }
    let known = || {
        let pairs = integrators::ids(integrators::pairs()).join(", ");
        format!("--integrators (adaptive: {pairs})")
    };
    let all = others.first().is_some_and(|id| id == "all");
    let mut chosen = methods(&others, scene, usual).with_context(known)?;
    chosen.extend(if all && pairs.is_empty() {
        usual
            .iter()
            .filter(|s| s.as_pair().is_some())
            .cloned()
            .collect()
    } else {
        pairs
    });
    Ok(chosen)
}

fn among(methods: &'static [Method], id: &str) -> Option<Solver> {
    let found = methods.iter().find(|method| method.id == id);
    found.map(Solver::method)
}

fn of_kind(solvers: &[Solver], kind: Kind) -> Vec<Solver> {
    let of = |solver: &&Solver| solver.kind == kind;
    solvers.iter().filter(of).cloned().collect()
}

/// Refuses a timestep of its own where steps are what is looked for.
pub fn without_timestep(rapier: &[Custom], what: &str) -> anyhow::Result<()> {
    if rapier.iter().any(|custom| custom.timestep.is_some()) {
        bail!("--rapier dt=...: here the step is what is {what}");
    }
    Ok(())
}

/// Looks each id up, once; an unknown one is an error that lists what there is.
fn each(
    ids: &[String],
    find: impl Fn(&str) -> Option<Solver>,
    known: impl Fn() -> String,
) -> anyhow::Result<Vec<Solver>> {
    let mut rows = Vec::new();
    for (at, id) in ids.iter().enumerate() {
        if ids[..at].contains(id) {
            continue;
        }
        rows.push(find(id).with_context(|| format!("unknown `{id}`; known {}", known()))?);
    }
    Ok(rows)
}

/// rapier's settings as the flag states them; what it leaves out keeps rapier's default.
#[derive(Debug, Clone)]
pub struct Custom {
    /// Seconds; None takes everybody's.
    pub timestep: Option<f64>,
    settings: rapier::Settings,
}

/// More iterations or sweeps than this are a typing error.
const MOST: u32 = 1_000_000;

impl FromStr for Custom {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut custom = Self {
            timestep: None,
            settings: rapier::Settings::DEFAULT,
        };
        for pair in text.split(',') {
            let (key, value) = pair
                .split_once('=')
                .ok_or_else(|| format!("expected key=value, found `{pair}`"))?;
            let count = |least: u32| match value.parse::<u32>() {
                Ok(count) if (least..=MOST).contains(&count) => Ok(count),
                _ => Err(format!(
                    "{key}: expected a whole number from {least} to {MOST}, found `{value}`"
                )),
            };
            let positive = |unit: &str| {
                let number = value.parse::<f64>().ok();
                let number = number.filter(|x| x.is_finite() && *x > 0.0);
                number.ok_or_else(|| format!("{key}: expected positive {unit}, found `{value}`"))
            };
            match key {
                "dt" => custom.timestep = Some(positive("seconds")?),
                "speed" => custom.settings.speed = Some(positive("metres per second")?),
                "iterations" => custom.settings.iterations = count(1)?,
                "pgs" => custom.settings.pgs = count(1)?,
                "stabilization" => custom.settings.stabilization = count(0)?,
                _ => {
                    return Err(format!(
                        "unknown key `{key}`; known: dt, iterations, pgs, stabilization, \
                         speed"
                    ));
                }
            }
        }
        Ok(custom)
    }
}

impl Custom {
    /// The engine, named after its settings. Others are not compared with it.
    pub fn solver(&self) -> Solver {
        let mut solver = Solver::rapier(self.settings);
        solver.reference = false;
        solver.timestep = self.timestep;
        if let Some(dt) = self.timestep {
            let changes = self.settings.changes();
            solver.id = format!("rapier(dt={dt},{changes})").into();
        }
        solver
    }
}
