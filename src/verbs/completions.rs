//! `springcheck completions SHELL|man`

use crate::scene::words::aside;
use crate::verbs::cli::output;
use anyhow::Context;
use clap::{Command, ValueEnum};
use std::process::ExitCode;

#[derive(Debug, clap::Args)]
pub struct Args {
    /// The shell, or `man` for a man page.
    #[arg(value_enum)]
    what: What,

    /// The verb whose man page it is. Default: the program's own page.
    #[arg(value_name = "VERB")]
    verb: Option<String>,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum What {
    Bash,
    Elvish,
    Fish,
    #[value(name = "powershell")]
    PowerShell,
    Zsh,
    Man,
}

/// Prints the completions, or the man page, that follow from the description of the command line.
pub fn completions(args: &Args, program: &mut Command) -> anyhow::Result<ExitCode> {
    use clap_complete::Shell;
    let shell = match args.what {
        What::Bash => Shell::Bash,
        What::Elvish => Shell::Elvish,
        What::Fish => Shell::Fish,
        What::PowerShell => Shell::PowerShell,
        What::Zsh => Shell::Zsh,
        What::Man => return page(args, program),
    };
    if let Some(verb) = &args.verb {
        anyhow::bail!("`{verb}`: completions are of all verbs; only man pages are of one");
    }
    let name = program.get_name().to_owned();
    let mut text = Vec::new();
    clap_complete::generate(shell, program, name, &mut text);
    output::print(&String::from_utf8_lossy(&text))?;
    Ok(ExitCode::SUCCESS)
}

fn page(args: &Args, program: &mut Command) -> anyhow::Result<ExitCode> {
    // Makes names of verbs whole and adds the flags that all of them have.
    program.build();
    let names: Vec<&str> = program.get_subcommands().map(Command::get_name).collect();
    let described = match &args.verb {
        None => program.clone(),
        Some(verb) => {
            let found = program.find_subcommand(verb).with_context(|| {
                let (near, known) = (aside(verb, &names), names.join(", "));
                format!("unknown verb `{verb}`{near}; known: {known}")
            })?;
            let name = format!("{}-{verb}", program.get_name());
            found.clone().display_name(name)
        }
    };
    let mut text = Vec::new();
    clap_mangen::Man::new(described).render(&mut text)?;
    output::print(&String::from_utf8_lossy(&text))?;
    Ok(ExitCode::SUCCESS)
}
