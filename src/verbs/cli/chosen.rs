//! The integrators and engines a command line names.

use super::rapier::Custom;
use crate::integrators::{self, Method};
use crate::scene::Scene;
use crate::solvers::Kind;
use crate::solvers::{self, Solver};
use crate::truth::Demand;
use anyhow::{Context, bail};

/// `--truth`.
#[derive(Debug, Clone, Copy, clap::ValueEnum)]
pub enum Truth {
    Auto,
    Closed,
    None,
}

impl Truth {
    pub fn demand(self) -> Demand {
        match self {
            Self::Auto => Demand::Auto,
            Self::Closed => Demand::Closed,
            Self::None => Demand::None,
        }
    }
}

/// The integrators of these ids in this order, all of them for `all`, and the `usual` ones for none.
pub fn integrators(ids: &[String], scene: &Scene, usual: &[Solver]) -> anyhow::Result<Vec<Solver>> {
    let known = || {
        format!(
            "integrators: {}, or all",
            integrators::ids(integrators::fixed()).join(", ")
        )
    };
    let find = |id: &str| among(integrators::fixed(), id);
    match ids {
        [] => Ok(of_kind(usual, Kind::Integrator)),
        [all] if all == "all" => Ok(crate::solvers::methods(&scene.solver.method)),
        ids => each(ids, find, known),
    }
}

/// The same where adaptive pairs stand beside the others: `all` takes them in.
pub fn with_pairs(ids: &[String], scene: &Scene, usual: &[Solver]) -> anyhow::Result<Vec<Solver>> {
    let (pairs, others): (Vec<String>, Vec<String>) = ids
        .iter()
        .cloned()
        .partition(|id| among(integrators::pairs(), id).is_some());
    let find = |id: &str| among(integrators::pairs(), id);
    let pairs = each(&pairs, find, String::new)?;
    if others.is_empty() && !pairs.is_empty() {
        return Ok(pairs);
    }
    let known = || {
        format!(
            "--integrators (adaptive: {})",
            integrators::ids(integrators::pairs()).join(", ")
        )
    };
    let all = others.first().is_some_and(|id| id == "all");
    let mut chosen = integrators(&others, scene, usual).with_context(known)?;
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

/// The engines of these ids, none for `none`, and the `usual` ones without ids; after them the rapier rows
/// with settings of the user's own, the same settings once.
pub fn engines(ids: &[String], rapier: &[Custom], usual: &[Solver]) -> anyhow::Result<Vec<Solver>> {
    let known = || format!("engines: {}, or none", solvers::rapier::IDS.join(", "));
    let find = |id: &str| solvers::find(id).filter(|solver| solver.kind == Kind::Rapier);
    let mut chosen = match ids {
        [] => of_kind(usual, Kind::Rapier),
        [none] if none == "none" => Vec::new(),
        ids => each(ids, find, known)?,
    };
    for custom in rapier.iter().map(Custom::solver) {
        if !chosen.iter().any(|known| known.id == custom.id) {
            chosen.push(custom);
        }
    }
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
