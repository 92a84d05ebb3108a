//! `--external NAME='COMMAND ...'`: one more row, computed by another program.

mod process;
mod program;
mod tree;

use anyhow::bail;
use springcheck::crosscheck::ChosenProgram;
use springcheck::engines::external::Command;
use springcheck::{engines, integrators};
use std::path::Path;
use std::str::FromStr;
use std::sync::Arc;
use std::time::Duration;

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
                .map_err(|error: springcheck::engines::external::CommandError| error.to_string())?,
        })
    }
}

/// Refuses names that mean something else already. Before any work.
pub fn distinct(externals: &[External]) -> anyhow::Result<()> {
    let taken = [integrators::ids(), engines::ids()].concat();
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
pub fn chosen(externals: &[External], scene: &Path, timeout: Timeout) -> Vec<ChosenProgram> {
    let ready = |external: &External| ChosenProgram {
        name: external.name.clone(),
        program: Arc::new(program::Started {
            command: external.command.clone(),
            scene: std::path::absolute(scene).unwrap_or_else(|_| scene.to_owned()),
            timeout: timeout.0,
        }),
    };
    externals.iter().map(ready).collect()
}

/// `60s`, `2m`, `1.5h`, `500ms`, or seconds without a unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timeout(Duration);

impl FromStr for Timeout {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = || format!("expected a time such as 60s, 2m or 500ms, found `{text}`");
        let digits = text.trim_end_matches(char::is_alphabetic);
        let unit = match &text[digits.len()..] {
            "ms" => 1e-3,
            "" | "s" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            _ => return Err(wrong()),
        };
        let seconds = digits.parse::<f64>().map_err(|_| wrong())? * unit;
        // Ten years are as good as for ever, and clocks can count to them.
        if !(seconds > 0.0 && seconds < 3e8) {
            return Err(wrong());
        }
        Duration::try_from_secs_f64(seconds).map_or_else(|_| Err(wrong()), |t| Ok(Self(t)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_with_and_without_units() {
        let ms = |text: &str| text.parse::<Timeout>().map(|t| t.0.as_millis()).ok();
        let good = [
            ("60s", 60_000),
            ("2m", 120_000),
            ("500ms", 500),
            ("1.5h", 5_400_000),
            ("7", 7_000),
            ("0.25", 250),
        ];
        for (text, wanted) in good {
            assert_eq!(ms(text), Some(wanted), "{text}");
        }
        for text in [
            "", "s", "0", "-1s", "inf", "NaN", "1e300", "5 s", "1d", "1m30s", "µs",
        ] {
            assert_eq!(ms(text), None, "{text}");
        }
    }

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
