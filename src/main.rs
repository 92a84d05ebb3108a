//! The command line: verbs in, exit codes out.

use clap::{ColorChoice, CommandFactory, Parser, Subcommand};
use springcheck::verbs::cli::{interrupt, note, output};
use springcheck::verbs::{
    check, compare, completions, cost, expand, explain, init, list, merge, report, rest, run,
    schema, show, stability,
};
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

    /// One line a scene instead of the text; no progress bar and no notes. Errors still show.
    #[arg(short, long, global = true)]
    quiet: bool,
}

/// Examples, one a line, for the end of a verb's help.
macro_rules! examples {
    ($($line:literal)+) => {
        concat!("Examples:", $("\n  springcheck ", $line),+)
    };
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Cross-check scenes: every chosen integrator beside rapier; a table and reports/<scene>/.
    #[command(after_help = examples!(
        "run scenes/pa1/scene01.yml"
        "run scenes/pa1 --integrators all -q"
        "run scenes/pa1/scene04.yml --external mine='python3 mine.py {scene_json}'"
    ))]
    Run(run::Args),
    /// A trajectory some other program computed: is it right, and which scheme is it really?
    #[command(after_help = examples!(
        "compare mine.npz --scene scenes/pa1/scene01.yml"
        "compare mine.csv --scene scene.yml --timestep 0.01 --axes xy"
        "compare mine.npz --scene scene.yml --format json"
    ))]
    Compare(compare::Args),
    /// The gate: what scenes expect, the laws they imply, and an accepted run; for CI.
    #[command(after_help = examples!(
        "check scenes"
        "check scenes --format github --write junit=check.xml"
        "check scene.yml --external mine='python3 mine.py {scene_json}' --claims mine=rk4"
    ))]
    Check(check::Args),
    /// How large a step each integrator may take: predicted, measured, and as a map.
    #[command(after_help = examples!(
        "stability scenes/pa1/scene01.yml"
        "stability scene.yml --vary springs.stiffness=1e2..1e6"
        "stability scene.yml --largest springs.stiffness --timestep 0.001"
    ))]
    Stability(stability::Args),
    /// What accuracy costs: errors over time and evaluations, and the cheapest way to a target.
    #[command(after_help = examples!(
        "cost scenes/pa1/scene01.yml"
        "cost scene.yml --targets 1e-2,1e-4 --budget 10s"
        "cost scene.yml --timestep 0.04,0.02,0.01"
    ))]
    Cost(cost::Args),
    /// One page of a scene: what runs, how large a step may be, what accuracy costs; and an index of several.
    #[command(after_help = examples!(
        "report scenes/pa1/scene01.yml --open"
        "report scenes/contact"
        "report scene.yml --output pages --budget 2s"
    ))]
    Report(report::Args),
    /// Where a scene comes to rest, how it oscillates about that, and what refining its objects does.
    #[command(after_help = examples!(
        "rest scenes/string/hanging.yml"
        "rest scenes/cloth/net.yml --refine 1,2,4,8"
        "rest scene.yml --write hanging.yml --release 'rope[0]'"
    ))]
    Rest(rest::Args),
    /// A stored report once more: printed and drawn as by the verb that made it.
    #[command(after_help = examples!(
        "show reports/pa1/scene01/report.json"
        "show report.json --format markdown"
        "show report.json --output figures"
    ))]
    Show(show::Args),
    /// The JSON of parts of a run, joined into that of the whole.
    #[command(after_help = examples!(
        "merge part1.json part2.json > whole.json"
        "merge part1.json part2.json --format human"
        "merge part1.json part2.json --format junit"
    ))]
    Merge(merge::Args),
    /// A scene with all defaults written out, as the flat arrays that other programs get, or as a picture.
    #[command(after_help = examples!(
        "expand scene.yml > whole.yml"
        "expand scene.yml --format json > flat.json"
        "expand scene.yml --format svg > scene.svg"
    ))]
    Expand(expand::Args),
    /// A scene, a solver and a workflow to start from: your own solver, held to its scheme in CI.
    #[command(after_help = examples!(
        "init ."
        "init mine"
        "init solvers/mine"
    ))]
    Init(init::Args),
    /// The JSON Schema of scene files, for editors, or of reports, for programs that read them.
    #[command(after_help = examples!(
        "schema scene"
        "schema scene > scene.schema.json"
        "schema report > report.schema.json"
    ))]
    Schema(schema::Args),
    /// What an id means: a check, an integrator, an engine, an effect, a mistake.
    #[command(after_help = examples!(
        "explain balance"
        "explain rk4"
        "explain midpoint_end_velocity"
    ))]
    Explain(explain::Args),
    /// What there is: integrators, effects, engines, mistakes, with their facts.
    #[command(after_help = examples!(
        "list integrators"
        "list engines"
        "list mistakes"
    ))]
    List(list::Args),
    /// Completions of the command line for a shell, or its man pages.
    #[command(after_help = examples!(
        "completions bash > ~/.local/share/bash-completion/completions/springcheck"
        "completions zsh > ~/.zfunc/_springcheck"
        "completions man run > springcheck-run.1"
    ))]
    Completions(completions::Args),
}

/// The exit code for usage, scene and input errors.
const USAGE: u8 = 2;

/// Parses the arguments, runs the verb, and turns whatever happens into an exit code.
fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // What the caller wrote may hold what a terminal acts on; help holds nothing of it.
            if error.use_stderr() {
                note::note(error.render().to_string().trim_end());
            } else if let Err(error) = output::print(&error.render().ansi().to_string()) {
                note::error(&error);
                return ExitCode::from(USAGE);
            }
            // clap's own code is 2 for usage and 0 for --help.
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(USAGE));
        }
    };
    match cli.color {
        ColorChoice::Auto => anstream::ColorChoice::Auto,
        ColorChoice::Always => anstream::ColorChoice::Always,
        ColorChoice::Never => anstream::ColorChoice::Never,
    }
    .write_global();
    interrupt::watch();
    let done = match cli.verb {
        Verb::Run(args) => run::run(&args, cli.quiet),
        Verb::Compare(args) => compare::compare(&args, cli.quiet),
        Verb::Check(args) => check::check(&args, cli.quiet),
        Verb::Stability(args) => stability::stability(&args, cli.quiet),
        Verb::Cost(args) => cost::cost(&args, cli.quiet),
        Verb::Report(args) => report::report(&args, cli.quiet),
        Verb::Rest(args) => rest::rest(&args, cli.quiet),
        Verb::Show(args) => show::show(&args, cli.quiet),
        Verb::Merge(args) => merge::merge(&args),
        Verb::Expand(args) => expand::expand(&args),
        Verb::Init(args) => init::init(&args),
        Verb::Schema(args) => schema::schema(&args),
        Verb::Explain(args) => explain::explain(&args),
        Verb::List(args) => list::list(&args),
        Verb::Completions(args) => completions::completions(&args, &mut Cli::command()),
    };
    match done {
        Ok(code) => code,
        Err(error) => {
            note::error(&error);
            ExitCode::from(USAGE)
        }
    }
}
