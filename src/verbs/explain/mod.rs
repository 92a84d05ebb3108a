//! `springcheck explain ID` says what an id means: a check, an integrator, an engine, an effect, a mistake.

use crate::integrators;
use crate::measure::identify::MISTAKES;
use crate::physics::effects;
use crate::report::terminal::wrap;
use crate::scene::words::nearest;
use crate::solvers::catalogue;
use crate::verbs::check;
use crate::verbs::cli::output;
use anyhow::bail;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The id of a check, an integrator, an engine, an effect or a mistake.
    #[arg(value_name = "ID")]
    id: String,
}

/// Prints what the id means.
pub fn explain(args: &Args) -> anyhow::Result<ExitCode> {
    let id = integrators::meant(&args.id);
    let Some((kind, facts)) = facts(id) else {
        let known = known();
        match nearest(id, &known) {
            Some(near) => bail!("unknown id `{id}`: did you mean `{near}`?"),
            None => bail!(
                "unknown id `{id}`: `list checks`, `list integrators`, `list engines`, `list effects` and \
                           `list mistakes` show what there is"
            ),
        }
    };
    let mut text = format!("{id}, {kind}\n");
    for (label, fact) in facts {
        let lines = wrap(&format!("{label}: {fact}"), output::columns(), "  ");
        text += &format!("\n{}\n", lines.join("\n"));
    }
    output::print(&text)?;
    Ok(ExitCode::SUCCESS)
}

type Facts = Vec<(&'static str, String)>;

/// What kind of thing the id names, and what is known of it.
fn facts(id: &str) -> Option<(&'static str, Facts)> {
    if let Some(row) = check::find(id) {
        let facts = [
            ("requires", row.requires),
            ("the bound", row.derivation),
            ("what to do", row.remedy),
        ];
        let mut facts = owned(&facts);
        let skip = format!("`expect: {{skip: {{{id}: \"why\"}}}}` in the scene's file");
        facts.push(("to skip it", skip));
        return Some(("a check", facts));
    }
    if let Some(method) = integrators::find(id) {
        let facts = [
            ("name", method.name),
            ("from", method.source),
            ("not to be confused with", method.not),
        ];
        let mut facts = owned(&facts);
        facts.push(("order", method.order.to_string()));
        return Some(("an integrator", facts));
    }
    if let Some(solver) = catalogue().find(|solver| solver.id == id) {
        return Some(("an engine", owned(&[("what", solver.summary)])));
    }
    if let Some(row) = effects::REGISTRY.iter().find(|row| row.id == id) {
        return Some((
            "an effect",
            owned(&[("what", row.summary), ("formula", row.source)]),
        ));
    }
    let mistake = MISTAKES.iter().find(|mistake| mistake.id == id)?;
    Some(("a known mistake", owned(&[("what is wrong", mistake.says)])))
}

fn owned(facts: &[(&'static str, &str)]) -> Facts {
    facts
        .iter()
        .map(|(label, fact)| (*label, (*fact).to_owned()))
        .collect()
}

/// Every id that is explained.
fn known() -> Vec<&'static str> {
    let methods = integrators::REGISTRY.iter().map(|method| method.id);
    let engines = crate::solvers::rapier::IDS.into_iter();
    let effects = effects::REGISTRY.iter().map(|row| row.id);
    let mistakes = MISTAKES.iter().map(|mistake| mistake.id);
    let checks = check::ids().into_iter();
    checks
        .chain(methods)
        .chain(engines)
        .chain(effects)
        .chain(mistakes)
        .collect()
}
