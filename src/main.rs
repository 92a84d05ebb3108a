//! The command line: verbs in, exit codes out.

use clap::{ColorChoice, Parser, Subcommand};
use springcheck::verbs::{
    check, compare, cost, expand, explain, init, list, merge, run, schema, show, stability,
};
use std::io::Write;
use std::process::ExitCode;

/// Is a particle-spring integrator right, and what does being right cost?
///
/// Runs hand-written integrators side by side with the equivalent rapier world and the truth, and
/// reports errors, energy, orders, and the scheme each really follows.
#[derive(Debug, Parser)]
#[command(name = "springcheck", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,

    /// When to colour.
    #[arg(long, global = true, value_enum, default_value_t)]
    color: ColorChoice,

    /// No progress bar, no notes on stderr; errors still show.
    #[arg(long, global = true)]
    quiet: bool,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Cross-check scenes: every chosen integrator beside rapier; a table and reports/<scene>/.
    Run(run::Args),
    /// A trajectory some other program computed: is it right, and which scheme is it really?
    Compare(compare::Args),
    /// The gate: what scenes expect, the laws they imply, and an accepted run; for CI.
    Check(check::Args),
    /// How large a step each integrator may take: predicted, measured, and as a map.
    Stability(stability::Args),
    /// What accuracy costs: errors over time and evaluations, and the cheapest way to a target.
    Cost(cost::Args),
    /// A stored report once more: printed and drawn as by the verb that made it.
    Show(show::Args),
    /// The JSON of parts of a run, joined into that of the whole.
    Merge(merge::Args),
    /// A scene with all defaults written out, or as the flat arrays that other programs get.
    Expand(expand::Args),
    /// A scene, a solver and a workflow to start from: your own solver, held to its scheme in CI.
    Init(init::Args),
    /// The JSON Schema of scene files, for editors, or of reports, for programs that read them.
    Schema(schema::Args),
    /// What an id means: a check, an integrator, an engine, an effect, a mistake.
    Explain(explain::Args),
    /// What there is: integrators, effects, engines, mistakes, with their facts.
    List(list::Args),
}

/// The exit code for usage, scene and input errors.
const USAGE: u8 = 2;

/// Parses the arguments, runs the verb, and turns whatever happens into an exit code.
fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // clap's own code is 2 for usage and 0 for --help.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(USAGE));
        }
    };
    match cli.color {
        ColorChoice::Auto => anstream::ColorChoice::Auto,
        ColorChoice::Always => anstream::ColorChoice::Always,
        ColorChoice::Never => anstream::ColorChoice::Never,
    }
    .write_global();
    let done = match cli.verb {
        Verb::Run(args) => run::run(&args, cli.quiet),
        Verb::Compare(args) => compare::compare(&args, cli.quiet),
        Verb::Check(args) => check::check(&args, cli.quiet),
        Verb::Stability(args) => stability::stability(&args, cli.quiet),
        Verb::Cost(args) => cost::cost(&args, cli.quiet),
        Verb::Show(args) => show::show(&args, cli.quiet),
        Verb::Merge(args) => merge::merge(&args),
        Verb::Expand(args) => expand::expand(&args),
        Verb::Init(args) => init::init(&args),
        Verb::Schema(args) => schema::schema(&args),
        Verb::Explain(args) => explain::explain(&args),
        Verb::List(args) => list::list(&args),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            let _ = writeln!(anstream::stderr(), "{}", message(&error));
            ExitCode::from(USAGE)
        }
    }
}

/// A scene error stands for itself; anything else is introduced, with its causes.
fn message(error: &anyhow::Error) -> String {
    let placed = error.is::<springcheck::scene::SceneError>()
        || error.is::<springcheck::trajectory::ReadError>();
    if placed {
        error.to_string()
    } else {
        format!("error: {error:#}")
    }
}
