//! `--external NAME='COMMAND ...'`: one more row, computed by another program.

mod process;
mod program;
mod tree;

use crate::integrators;
use crate::solvers::external::Command;
use crate::solvers::{Solver, rapier};
use crate::verbs::cli::time::Time;
use anyhow::bail;
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;

/// The flag's value: what reports call the program, and how it is started.
#[derive(Debug, Clone)]
pub struct External {
    name: String,
    command: Command,
}

/// Longer names would push numbers out of the table.
const NAME: usize = 32;

impl FromStr for External {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, command) = text
            .split_once('=')
            .ok_or_else(|| format!("expected NAME=COMMAND, found `{text}`"))?;
        // It is a part of tables, figures and of the report's keys.
        let plain = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
        let starts = name.starts_with(char::is_alphanumeric);
        if !starts || !name.chars().all(plain) || name.chars().count() > NAME {
            return Err(format!(
                "expected a name of 1 to {NAME} letters, digits, `_`, `.`, `+` and `-`, beginning \
                 with a letter or digit, found `{name}`"
            ));
        }
        Ok(Self {
            name: name.to_owned(),
            command: command
                .parse()
                .map_err(|error: crate::solvers::external::CommandError| error.to_string())?,
        })
    }
}

/// Refuses names that mean something else already. Before any work.
pub fn distinct(externals: &[External]) -> anyhow::Result<()> {
    let taken = [&integrators::ids(integrators::fixed())[..], &rapier::IDS].concat();
    for (at, External { name, .. }) in externals.iter().enumerate() {
        // As file systems do that ignore case.
        let same = |other: &str| other.eq_ignore_ascii_case(name);
        if taken.iter().any(|id| same(id)) {
            bail!("--external {name}: an integrator or engine has this name, choose another");
        }
        if externals[..at].iter().any(|other| same(&other.name)) {
            bail!("--external {name}: the name is given twice");
        }
    }
    Ok(())
}

/// The programs, ready to run on this scene.
pub fn chosen(externals: &[External], scene: &Path, timeout: Time) -> Vec<Solver> {
    let ready = |external: &External| {
        let program = program::Started {
            command: external.command.clone(),
            scene: std::path::absolute(scene).unwrap_or_else(|_| scene.to_owned()),
            timeout: timeout.0,
        };
        Solver::program(&external.name, Arc::new(program))
    };
    externals.iter().map(ready).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_plain_and_not_taken() {
        let flag = |name: &str| format!("{name}=./a {{scene}}").parse::<External>();
        for name in ["mine", "mine.py", "2nd-try", "größe", "a+b_c"] {
            assert!(flag(name).is_ok(), "{name}");
        }
        let long = "x".repeat(33);
        for name in [
            "",
            " ",
            ".hidden",
            "-x",
            "a b",
            "a/b",
            "a\nb",
            "rapier(x)",
            &long,
        ] {
            assert!(flag(name).is_err(), "{name:?}");
        }
        assert!("mine".parse::<External>().is_err());
        let both = |names: &[&str]| {
            let flags: Vec<_> = names.iter().map(|n| flag(n).expect("a flag")).collect();
            distinct(&flags).map_err(|e| e.to_string())
        };
        assert_eq!(both(&["mine", "yours"]), Ok(()));
        for names in [&["rk4"][..], &["Rapier"], &["mine", "yours", "MINE"]] {
            assert!(both(names).is_err(), "{names:?}");
        }
    }
}
