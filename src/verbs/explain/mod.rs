//! `springcheck explain ID` says what an id means: a check, an integrator, an engine, an effect, a constraint, a mistake, a
//! scheme, a law or a treatment of contact, a word of the energy column.

use crate::integrators::{self, Method, Stable};
use crate::measure::identify::{MISTAKES, treatments};
use crate::measure::{Behaviour, CONTACT_LAWS};
use crate::physics::{ForceKinds, constraints, effects};
use crate::report::terminal::wrap;
use crate::scene::words::nearest;
use crate::solvers::catalogue;
use crate::verbs::check;
use crate::verbs::cli::output;
use crate::verbs::scheme;
use anyhow::bail;
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The id of a check, an integrator or another scheme, an engine, an effect, a constraint or a mistake; a word
    /// such as `bounded`.
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
                "unknown id `{id}`: `list checks`, `list integrators`, `list engines`, `list effects`, \
                           `list constraints` and `list mistakes` show what there is"
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
        let order = match (method.order, method.order_damped) {
            (order, damped) if order == damped => order.to_string(),
            (order, damped) => format!("{order}; {damped} with dampers or drag"),
        };
        facts.push(("order", order));
        facts.push(("on rods", on_rods(method)));
        facts.push((
            "stable for z = h times the angular frequency",
            stable(method),
        ));
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
    if let Some(row) = constraints::REGISTRY.iter().find(|row| row.id == id) {
        return Some((
            "a constraint",
            owned(&[("what", row.summary), ("formula", row.source)]),
        ));
    }
    if let Some(says) = scheme::says(id) {
        return Some((
            "a scheme that programs follow",
            owned(&[("what it does", says)]),
        ));
    }
    if let Some(behaviour) = Behaviour::ALL.into_iter().find(|b| b.word() == id) {
        return Some((
            "what an energy does",
            owned(&[("what it means", behaviour.says())]),
        ));
    }
    if let Some((_, says)) = CONTACT_LAWS.iter().find(|law| law.0 == id) {
        return Some(("a law of contact", owned(&[("it says", says)])));
    }
    if let Some((_, says, mistake)) = treatments().find(|row| row.0 == id) {
        let kind = if mistake {
            "a known mistake at contact"
        } else {
            "a treatment of contact"
        };
        return Some((kind, owned(&[("at contact it", says)])));
    }
    let mistake = MISTAKES.iter().find(|mistake| mistake.id == id)?;
    Some(("a known mistake", owned(&[("what is wrong", mistake.says)])))
}

/// What a method is where there are rods.
fn on_rods(method: &Method) -> String {
    if !method.takes().has(ForceKinds::CONSTRAINED) {
        return "refused; `rattle` takes them".to_owned();
    }
    match method.under(ForceKinds::CONSTRAINED) {
        of if of.order == of.order_damped => format!("order {}", of.order),
        of => format!(
            "order {}; {} with dampers or drag, and where they are not stabilised by `project`",
            of.order, of.order_damped
        ),
    }
}

/// Where an integrator is stable on an undamped oscillator.
fn stable(method: &Method) -> String {
    match method.oscillator.stable {
        Stable::Never => "no step, without damping".to_owned(),
        Stable::Below(z) => format!("z < {z:.4}"),
        Stable::Always => "every step, where forces are linear".to_owned(),
        Stable::AlwaysAlong { across } => {
            format!("every step along a spring, z < {across} across it")
        }
    }
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
    let constraints = constraints::REGISTRY.iter().map(|row| row.id);
    let mistakes = MISTAKES.iter().map(|mistake| mistake.id);
    let checks = check::ids().into_iter();
    let schemes = scheme::ids().into_iter();
    let words = Behaviour::ALL.map(Behaviour::word).into_iter();
    checks
        .chain(schemes)
        .chain(words)
        .chain(methods)
        .chain(engines)
        .chain(effects)
        .chain(constraints)
        .chain(mistakes)
        .chain(CONTACT_LAWS.iter().map(|law| law.0))
        .chain(treatments().map(|row| row.0))
        .collect()
}
