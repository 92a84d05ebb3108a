//! `springcheck list integrators|effects|engines|mistakes`

use clap::ValueEnum;
use comfy_table::{ColumnConstraint, ContentArrangement, Table, presets};
use springcheck::integrators::{EnergyLaw, Method, PerStep, Stable};
use springcheck::measure::identify::{MISTAKES, Mistake, Wrong};
use springcheck::{effects, engines, integrators};
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
    Engines,
    /// Wrong integrators that `compare` knows by name.
    Mistakes,
}

/// Prints a registry.
pub fn list(args: &Args) -> anyhow::Result<ExitCode> {
    let text = match args.what {
        What::Integrators => format!("{}\n\n{}", of_integrators(), sources()),
        What::Effects => {
            let rows = effects::REGISTRY.iter();
            table(
                &["effect", "what", "formula"],
                rows.map(|row| vec![row.id.into(), row.summary.into(), row.source.into()]),
            )
            .to_string()
        }
        What::Engines => {
            let rows = engines::REGISTRY.iter();
            table(
                &["engine", "what"],
                rows.map(|row| vec![row.id.to_string(), row.summary.into()]),
            )
            .to_string()
        }
        What::Mistakes => {
            let rows = MISTAKES.iter();
            table(
                &["mistake", "meant to be", "what is wrong"],
                rows.map(|row| vec![row.id.into(), meant(row).into(), row.says.into()]),
            )
            .to_string()
        }
    };
    super::print(&format!("{text}\n"))?;
    Ok(ExitCode::SUCCESS)
}

fn of_integrators() -> Table {
    table(
        &[
            "integrator",
            "order",
            "geometry",
            "forces a step",
            "stable, z = hω",
            "energy a step",
        ],
        integrators::REGISTRY.iter().map(|method| {
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

/// The method a mistake is a wrong form of.
fn meant(mistake: &Mistake) -> &'static str {
    match mistake.wrong {
        Wrong::Step { meant, .. } => meant,
        Wrong::Physics(_) | Wrong::Length(_) => "any",
    }
}

/// Where each method is from and what it is not.
fn sources() -> Table {
    table(
        &["integrator", "from", "not to be confused with"],
        integrators::REGISTRY
            .iter()
            .map(|method| vec![method.id.into(), method.source.into(), method.not.into()]),
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
        .set_width(100)
        .set_header(header.to_vec());
    for row in rows {
        table.add_row(row);
    }
    // Ids stay whole, to be copied.
    if let Some(ids) = table.column_mut(0) {
        ids.set_constraint(ColumnConstraint::ContentWidth);
    }
    table
}
