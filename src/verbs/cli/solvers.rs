//! The solvers a command line names: `--integrators`, `--engines`, `--rapier dt=0.001,iterations=8,pgs=4`.

use crate::integrators::{self, Method};
use crate::scene::Scene;
use crate::scene::words::aside;
use crate::solvers::{self, Solver, SolverKind, rapier};
use anyhow::{Context, bail};
use std::str::FromStr;

/// The solvers of one command, in the order of its report: the named integrators, or the `usual` ones where none is
/// named; then the engines, likewise; then the rapier rows with the user's settings, each only once.
///
/// `all` means the integrators of the registry, the scene's own first. Adaptive pairs are allowed where `usual` has
/// any, and `all` then includes those.
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
        methods(integrators, scene, usual, &[])?
    };
    let known = ("engines", rapier::IDS.to_vec(), "none");
    let find = |id: &str| solvers::find(id).filter(|solver| solver.kind == SolverKind::Rapier);
    chosen.extend(match engines {
        [] => of_kind(usual, SolverKind::Rapier),
        [none] if none == "none" => Vec::new(),
        ids => look_up(ids, find, &known)?,
    });
    for custom in custom.iter().map(Custom::solver) {
        if !chosen.iter().any(|known| known.id == custom.id) {
            chosen.push(custom);
        }
    }
    Ok(chosen)
}

/// The methods of these ids. An error names those `beside` them too.
fn methods(
    ids: &[String],
    scene: &Scene,
    usual: &[Solver],
    beside: &[&'static str],
) -> anyhow::Result<Vec<Solver>> {
    let fixed = integrators::fixed();
    let names = [integrators::ids(fixed), beside.to_vec()].concat();
    let known = ("integrators", names, "all");
    let find = |id: &str| find_in(fixed, id);
    match ids {
        [] => Ok(of_kind(usual, SolverKind::Integrator)),
        [all] if all == "all" => Ok(solvers::methods(&scene.solver.method)),
        ids => look_up(ids, find, &known),
    }
}

/// The methods and the adaptive pairs, in this order.
fn with_pairs(ids: &[String], scene: &Scene, usual: &[Solver]) -> anyhow::Result<Vec<Solver>> {
    let find = |id: &str| find_in(integrators::pairs(), id);
    let (pairs, others): (Vec<String>, Vec<String>) =
        ids.iter().cloned().partition(|id| find(id).is_some());
    let pairs = look_up(&pairs, find, &Known::default())?;
    if others.is_empty() && !pairs.is_empty() {
        return Ok(pairs);
    }
    let all = others.first().is_some_and(|id| id == "all");
    let mut chosen = methods(
        &others,
        scene,
        usual,
        &integrators::ids(integrators::pairs()),
    )?;
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

fn find_in(methods: &'static [Method], id: &str) -> Option<Solver> {
    let found = (methods.iter()).find(|method| method.id == integrators::meant(id));
    found.map(Solver::method)
}

fn of_kind(solvers: &[Solver], kind: SolverKind) -> Vec<Solver> {
    let of = |solver: &&Solver| solver.kind == kind;
    solvers.iter().filter(of).cloned().collect()
}

/// Refuses `dt` for a verb that varies or searches the step itself.
pub fn without_timestep(rapier: &[Custom], what: &str) -> anyhow::Result<()> {
    if rapier.iter().any(|custom| custom.timestep.is_some()) {
        bail!("--rapier dt=...: here the step is what is {what}");
    }
    Ok(())
}

/// What ids may name: the kind, the ids, and the word that stands for all or none of them.
type Known = (&'static str, Vec<&'static str>, &'static str);

/// Looks up each id once. An unknown one is an error that lists the known ones, and the nearest of them.
fn look_up(
    ids: &[String],
    find: impl Fn(&str) -> Option<Solver>,
    (kind, known, word): &Known,
) -> anyhow::Result<Vec<Solver>> {
    let mut rows: Vec<Solver> = Vec::new();
    for id in ids {
        if id == word {
            bail!("`{word}` stands alone: name {kind}, or {word}");
        }
        let row = find(id).with_context(|| {
            let words = known.iter().copied().chain([*word]).collect::<Vec<_>>();
            format!(
                "unknown `{id}`{}; known {kind}: {}, or {word}",
                aside(id, &words),
                known.join(", ")
            )
        })?;
        if !rows.iter().any(|known| known.id == row.id) {
            rows.push(row);
        }
    }
    Ok(rows)
}

/// rapier's settings as the flag states them; settings that it omits keep rapier's defaults.
#[derive(Debug, Clone)]
pub struct Custom {
    /// The timestep, s; None for that of the command.
    pub timestep: Option<f64>,
    settings: rapier::RapierSettings,
}

/// The largest number of iterations or sweeps; more is a typing error.
const MAX_COUNT: u32 = 1_000_000;
/// The keys of the flag.
const KEYS: [&str; 5] = ["dt", "iterations", "pgs", "stabilization", "speed"];

impl FromStr for Custom {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut custom = Self {
            timestep: None,
            settings: rapier::RapierSettings::DEFAULT,
        };
        for pair in text.split(',') {
            let (key, value) = pair
                .split_once('=')
                .ok_or_else(|| format!("expected key=value, found `{pair}`"))?;
            let count = |least: u32| match value.parse::<u32>() {
                Ok(count) if (least..=MAX_COUNT).contains(&count) => Ok(count),
                _ => Err(format!(
                    "{key}: expected a whole number from {least} to {MAX_COUNT}, found `{value}`"
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
                        "unknown key `{key}`{}; known: {}",
                        aside(key, &KEYS),
                        KEYS.join(", ")
                    ));
                }
            }
        }
        Ok(custom)
    }
}

impl Custom {
    /// The engine, named after its settings. It is no reference for deviations.
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
