//! A command line with placeholders, split as a POSIX shell would split it, without a shell.

use crate::scene::words::aside;
use std::ffi::{OsStr, OsString};
use std::str::FromStr;

/// A value of the run that a command can contain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Placeholder {
    /// Path of the scene file (YAML) on disk, without changes by flags.
    Scene,
    /// Path of a file with the scene as flat arrays: [`Flat`](super::Flat).
    SceneJson,
    /// Seconds a step.
    Timestep,
    /// Seconds of the whole run.
    Duration,
    /// Path of an `.npz` file that is read instead of stdout.
    Output,
}

const NAMES: [(&str, Placeholder); 5] = [
    ("scene", Placeholder::Scene),
    ("scene_json", Placeholder::SceneJson),
    ("timestep", Placeholder::Timestep),
    ("duration", Placeholder::Duration),
    ("output", Placeholder::Output),
];

/// The words of a command, with parts that are filled in for each run.
///
/// Quotes and backslashes are removed first and placeholders replaced afterwards, so a path with spaces
/// stays one word. `{{` and `}}` stand for braces.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Command {
    words: Vec<Vec<Part>>,
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Part {
    Text(String),
    Value(Placeholder),
}

/// The reason why a command cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CommandError {
    #[error("expected a command, found nothing")]
    Empty,
    #[error("a quote is not closed in `{0}`")]
    Quote(String),
    #[error(
        "unknown placeholder `{{{found}}}`{}; known: {}; braces themselves are `{{{{` and `}}}}`",
        aside(found, &NAMES.map(|(name, _)| name)),
        known()
    )]
    Unknown { found: String },
    #[error(
        "a single brace in `{0}`: a placeholder is `{{name}}`, braces themselves are `{{{{` and `}}}}`"
    )]
    Brace(String),
}

fn known() -> String {
    let names: Vec<String> = NAMES
        .iter()
        .map(|(name, _)| format!("{{{name}}}"))
        .collect();
    names.join(", ")
}

impl FromStr for Command {
    type Err = CommandError;

    fn from_str(text: &str) -> Result<Self, CommandError> {
        let words = shell_words::split(text).map_err(|_| CommandError::Quote(text.to_owned()))?;
        if words.first().is_none_or(String::is_empty) {
            return Err(CommandError::Empty);
        }
        let words = words.iter().map(|word| parts(word));
        Ok(Self {
            words: words.collect::<Result<_, _>>()?,
        })
    }
}

/// The text and the placeholders of a word.
fn parts(word: &str) -> Result<Vec<Part>, CommandError> {
    let single = || CommandError::Brace(word.to_owned());
    let mut parts = Vec::new();
    let mut text = String::new();
    let mut rest = word;
    while let Some(at) = rest.find(['{', '}']) {
        let (before, from) = rest.split_at(at);
        text.push_str(before);
        if let Some(after) = from.strip_prefix("{{") {
            text.push('{');
            rest = after;
        } else if let Some(after) = from.strip_prefix("}}") {
            text.push('}');
            rest = after;
        } else {
            let inside = from.strip_prefix('{').ok_or_else(single)?;
            let (name, after) = inside.split_once('}').ok_or_else(single)?;
            let value = NAMES.iter().find(|(known, _)| *known == name);
            let (_, value) = value.ok_or_else(|| CommandError::Unknown {
                found: name.to_owned(),
            })?;
            parts.push(Part::Text(std::mem::take(&mut text)));
            parts.push(Part::Value(*value));
            rest = after;
        }
    }
    text.push_str(rest);
    parts.push(Part::Text(text));
    Ok(parts)
}

impl Command {
    /// Whether the command contains this placeholder.
    pub fn uses(&self, placeholder: Placeholder) -> bool {
        let mut parts = self.words.iter().flatten();
        parts.any(|part| *part == Part::Value(placeholder))
    }

    /// The program and its arguments, with each placeholder replaced by its value.
    pub fn words<V: AsRef<OsStr>>(&self, value: impl Fn(Placeholder) -> V) -> Vec<OsString> {
        let word = |parts: &Vec<Part>| {
            let mut word = OsString::new();
            for part in parts {
                match part {
                    Part::Text(text) => word.push(text),
                    Part::Value(placeholder) => word.push(value(*placeholder)),
                }
            }
            word
        };
        self.words.iter().map(word).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<String> {
        let command: Command = text.parse().expect("a command");
        let value = |placeholder| match placeholder {
            Placeholder::Scene => "my scene.yml",
            Placeholder::Timestep => "0.5",
            Placeholder::Output => "'{scene}'.npz",
            _ => "?",
        };
        let words = command.words(value).into_iter();
        words.map(|w| w.into_string().expect("UTF-8")).collect()
    }

    #[test]
    fn split_first_and_filled_in_afterwards() {
        assert_eq!(words("a 'b c' \"d e\" f\\ g"), ["a", "b c", "d e", "f g"]);
        // Neither a space nor a quote nor a placeholder in a value is looked at again.
        assert_eq!(
            words("run --in={scene} -h{timestep} {output}"),
            ["run", "--in=my scene.yml", "-h0.5", "'{scene}'.npz"]
        );
        // No shell: nothing is expanded, nothing redirected.
        assert_eq!(words("a $HOME *.c > b"), ["a", "$HOME", "*.c", ">", "b"]);
        assert_eq!(
            words("p '{{\"h\": {timestep}}}' ''"),
            ["p", "{\"h\": 0.5}", ""]
        );
        assert_eq!(words("p {{scene}} }}{{"), ["p", "{scene}", "}{"]);
    }

    #[test]
    fn what_is_used_is_known() {
        let command: Command = "a {timestep} x{output}".parse().expect("a command");
        assert!(command.uses(Placeholder::Output) && command.uses(Placeholder::Timestep));
        assert!(!command.uses(Placeholder::Scene) && !command.uses(Placeholder::SceneJson));
    }

    #[test]
    fn what_cannot_be_used_says_why() {
        let message = |text: &str| text.parse::<Command>().expect_err(text).to_string();
        for text in ["", "  ", "''", "# only a comment"] {
            assert!(message(text).contains("expected a command"), "{text}");
        }
        assert!(message("a 'b").contains("not closed"));
        let unknown = message("a {scene_yaml}");
        for name in [
            "{scene_yaml}",
            "{scene}",
            "{scene_json}",
            "{timestep}",
            "{duration}",
        ] {
            assert!(unknown.contains(name), "{unknown}");
        }
        for text in ["a {", "a }", "a {scene", "a {scene}}", "a {{{"] {
            assert!(message(text).contains("single brace"), "{text}");
        }
    }
}
