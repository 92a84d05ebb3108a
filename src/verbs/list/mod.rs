//! `springcheck list integrators|effects|constraints|engines|mistakes|checks`

use crate::integrators::adaptive::ErrorEstimate;
use crate::integrators::{self, EnergyLaw, Method, PerStep, Stable};
use crate::measure::identify::{MISTAKES, Mistake, Wrong, treatments};
use crate::physics::{constraints, effects};
use crate::solvers::SolverKind;
use crate::solvers::catalogue;
use crate::verbs::check;
use crate::verbs::cli::output::{columns, print};
use clap::ValueEnum;
use comfy_table::{ColumnConstraint, ContentArrangement, Table, presets};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    #[arg(value_enum)]
    what: What,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum What {
    Integrators,
    Effects,
    Constraints,
    Engines,
    /// Wrong integrators that `compare` knows by name.
    Mistakes,
    /// What `check` requires.
    Checks,
}

/// Prints a registry.
pub fn list(args: &Args) -> anyhow::Result<ExitCode> {
    let text = match args.what {
        What::Integrators => {
            let (fixed, adaptive, sources) = (integrator_table(), pair_table(), source_table());
            format!("{fixed}\n\nadaptive (cost only)\n{adaptive}\n\n{sources}")
        }
        What::Effects => {
            let rows = effects::REGISTRY.iter();
            table(
                &["effect", "what", "formula"],
                rows.map(|row| vec![row.id.into(), row.summary.into(), row.source.into()]),
            )
            .to_string()
        }
        What::Constraints => {
            let rows = constraints::REGISTRY.iter();
            table(
                &["constraint", "what", "formula"],
                rows.map(|row| vec![row.id.into(), row.summary.into(), row.source.into()]),
            )
            .to_string()
        }
        What::Engines => {
            let rows = catalogue().filter(|solver| solver.kind == SolverKind::Rapier);
            table(
                &["engine", "what"],
                rows.map(|row| vec![row.id.to_string(), row.summary.into()]),
            )
            .to_string()
        }
        What::Checks => {
            let rows = check::CHECKS.iter();
            table(
                &["check", "requires"],
                rows.map(|row| vec![row.id.into(), row.requires.into()]),
            )
            .to_string()
        }
        What::Mistakes => {
            let rows = MISTAKES
                .iter()
                .map(|row| (row.id, meant(row), row.says.to_owned()));
            let contact = treatments().filter(|(.., mistake)| *mistake);
            let contact = contact.map(|(id, says, _)| (id, "any", format!("at contact it {says}")));
            table(
                &["mistake", "meant to be", "what is wrong"],
                rows.chain(contact)
                    .map(|(id, meant, says)| vec![id.into(), meant.into(), says]),
            )
            .to_string()
        }
    };
    print(&format!("{text}\n"))?;
    Ok(ExitCode::SUCCESS)
}

fn integrator_table() -> Table {
    table(
        &[
            "integrator",
            "order",
            "geometry",
            "forces a step",
            "stable, z = hω",
            "energy a step",
        ],
        integrators::fixed().iter().map(|method| {
            vec![
                method.id.into(),
                order(method),
                geometry(method),
                match method.evaluations {
                    PerStep::Exactly(n) => n.to_string(),
                    PerStep::PerIteration { plus } => format!("solves + {plus}"),
                },
                match method.oscillator.stable {
                    Stable::Never => "never".into(),
                    Stable::Below(z) => format!("z < {z:.4}"),
                    Stable::Always => "linear springs".into(),
                    Stable::AlwaysAlong { across } => format!("along; across z < {across}"),
                },
                match method.oscillator.energy {
                    EnergyLaw::Factor { formula, .. } => format!("times {formula}"),
                    EnergyLaw::Band { formula, .. } => format!("within {formula}"),
                    EnergyLaw::Bounded => "bounded".into(),
                },
            ]
        }),
    )
}

/// The adaptive pairs, which choose their own steps; only `cost` runs them.
fn pair_table() -> Table {
    table(
        &[
            "pair",
            "order",
            "estimate",
            "stages",
            "forces a step",
            "and a rejected one",
        ],
        integrators::pairs().iter().filter_map(|method| {
            let pair = method.pair()?;
            let [accepted, rejected] = pair.evaluations();
            Some(vec![
                method.id.into(),
                method.order.to_string(),
                match pair.estimate {
                    ErrorEstimate::Embedded { order, .. } => format!("of order {order}"),
                    ErrorEstimate::Mixed53 { .. } => "of orders 5 and 3, mixed".into(),
                },
                pair.stages().to_string(),
                accepted.to_string(),
                rejected.to_string(),
            ])
        }),
    )
}

/// The method that a mistake is a wrong form of.
fn meant(mistake: &Mistake) -> &'static str {
    match mistake.wrong {
        Wrong::Step { meant, .. } => meant,
        _ => "any",
    }
}

/// The source of each method, and what it must not be confused with.
fn source_table() -> Table {
    let methods = integrators::REGISTRY.iter();
    table(
        &["integrator", "from", "not to be confused with"],
        methods.map(|method| {
            [method.id, method.source, method.not]
                .map(String::from)
                .into()
        }),
    )
}

fn order(method: &Method) -> String {
    if method.order == method.order_damped {
        method.order.to_string()
    } else {
        format!("{} (damped {})", method.order, method.order_damped)
    }
}

fn geometry(method: &Method) -> String {
    let mut facts = Vec::new();
    if method.symplectic {
        facts.push("symplectic");
    }
    if method.reversible {
        facts.push("reversible");
    }
    facts.join(", ")
}

fn table(header: &[&str], rows: impl Iterator<Item = Vec<String>>) -> Table {
    let mut table = Table::new();
    table
        .load_style(presets::NOTHING)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(u16::try_from(columns()).unwrap_or(u16::MAX))
        .set_header(header.to_vec());
    for row in rows {
        table.add_row(row);
    }
    // Ids are not wrapped, so that they can be copied.
    if let Some(ids) = table.column_mut(0) {
        ids.set_constraint(ColumnConstraint::ContentWidth);
    }
    table
}
