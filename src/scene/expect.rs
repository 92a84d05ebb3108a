//! Reads `expect`. Engines, keys and words have to exist, and some number has to meet the bounds. All
//! sizes are limited, since YAML aliases could multiply them.

use super::error::{Refusal, refuse};
use super::expectation::{ALL, Expectation, KeyKind, Names, REST, SKIP, Scope, Skipped, Wanted};
use super::limits::{self, BOUND, EXPECTED, WORD_BYTES, known};
use super::place::Problem;
use super::values::{Any, Key, Maybe, index_of, no_merge, number, repeated, text, unknown};
use super::words::{did_you_mean, shorten};
use serde::de::{Error, MapAccess, SeqAccess, Visitor};
use std::fmt;

const MAPPING: &str = "a mapping such as {status: completed}";

/// Reads the whole of `expect`: a line for each engine.
pub(super) struct Engines<'r> {
    pub(super) names: &'r Names,
    pub(super) expect: &'r mut Vec<Expectation>,
    pub(super) skip: &'r mut Vec<Skipped>,
    /// The first unknown key. It is reported last: an error in its value may say better what is wrong.
    pub(super) problem: &'r mut Option<Problem>,
}

impl<'de> Visitor<'de> for Engines<'_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(MAPPING)
    }

    fn visit_map<A: MapAccess<'de>>(mut self, mut map: A) -> Result<(), A::Error> {
        let mut before = Vec::new();
        while let Some(scope) = map.next_key_seed(Key(|engine: &str| {
            let engine = self.names.meant(engine);
            fresh(engine, &mut before)?;
            if engine == SKIP {
                return Ok(None);
            }
            scope(engine, self.names).map(Some)
        }))? {
            match scope {
                Some(scope) => map.next_value_seed(Any(Line(scope, &mut self)))?,
                None => map.next_value_seed(Any(Skips(self.names, self.skip)))?,
            }
        }
        Ok(())
    }
}

/// Refuses a key that is too long, is repeated, exceeds the number of keys, or is a merge key.
fn fresh(key: &str, before: &mut Vec<String>) -> Result<(), Refusal> {
    short(key)?;
    if before.iter().any(|before| before == key) {
        return Err(repeated(key));
    }
    if before.len() >= EXPECTED {
        return Refusal::because(format!("expected at most {EXPECTED} keys"), "");
    }
    before.push(key.to_owned());
    no_merge(key)
}

fn short(text: &str) -> Result<(), Refusal> {
    if text.len() > WORD_BYTES {
        let found = shorten(text);
        let message = format!("expected at most {WORD_BYTES} bytes, found `{found}`");
        return Refusal::because(message, "");
    }
    Ok(())
}

fn scope(engine: &str, names: &Names) -> Result<Scope, Refusal> {
    match engine {
        ALL => Ok(Scope::All),
        REST => Ok(Scope::Rest),
        // Whether there is such an engine is known once the file is read: it may list it among its `externals`.
        name if limits::external(name).is_ok() || names.engines.contains(&name) => {
            Ok(Scope::Engine(name.to_owned()))
        }
        other => Err(no_engine(other, names, &[])),
    }
}

/// Checks that an engine is an integrator, a reference engine, or a program that the file or the command line names.
pub(super) fn engine(id: &str, names: &Names, listed: &[String]) -> Result<(), Refusal> {
    let own = names.methods.contains(&id) || names.engines.contains(&id);
    if own || listed.iter().chain(&names.externals).any(|name| name == id) {
        return Ok(());
    }
    Err(no_engine(id, names, listed))
}

fn no_engine(id: &str, names: &Names, listed: &[String]) -> Refusal {
    // `skip` is a key here, but no engine.
    let mut known = [SKIP, ALL, REST].to_vec();
    known.extend(names.methods.iter().chain(&names.engines));
    known.extend(listed.iter().chain(&names.externals).map(String::as_str));
    let help = did_you_mean(id, &known).unwrap_or_else(|| {
        format!(
            "the engines here are {}; list another program as `externals: [{}]`",
            known[1..].join(", "),
            shorten(id)
        )
    });
    Refusal::new(format!("unknown engine `{}`", shorten(id)), help)
}

/// Reads `skip`: a reason for each check that is not made.
struct Skips<'n, 'r>(&'n Names, &'r mut Vec<Skipped>);

impl<'de> Visitor<'de> for Skips<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a mapping such as {order: \"forces jump here\"}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let Skips(names, skip) = self;
        let mut before = Vec::new();
        while let Some(check) = map.next_key_seed(Key(|check: &str| {
            fresh(check, &mut before)?;
            known(check, &names.checks, "check")?;
            Ok(check.to_owned())
        }))? {
            let reason = map.next_value_seed(Any(text(some_text)))?;
            skip.push(Skipped { check, reason });
        }
        Ok(())
    }
}

/// Reads what is expected of one engine.
struct Line<'l, 'r>(Scope, &'l mut Engines<'r>);

impl<'de> Visitor<'de> for Line<'_, '_> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(MAPPING)
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<(), A::Error> {
        let Line(scope, engines) = self;
        let keys = &engines.names.keys;
        let mut before = Vec::new();
        while let Some(key) = map.next_key_seed(Key(|key: &str| {
            fresh(key, &mut before)?;
            Ok(keys.iter().find(|known| known.path == key))
        }))? {
            let wanted =
                map.next_value_seed(Any(Value(key.map(|key| &key.kind), engines.names)))?;
            let Some(key) = key else {
                let key = before.last().map_or("", String::as_str);
                let paths: Vec<&str> = keys.iter().map(|known| known.path.as_str()).collect();
                let path = format!("expect.{scope}");
                let problem = || Problem::of_key(&path, key, unknown(key, &paths));
                engines.problem.get_or_insert_with(problem);
                continue;
            };
            engines.expect.push(Expectation {
                scope: scope.clone(),
                key: key.path.clone(),
                wanted,
            });
        }
        if before.is_empty() {
            let help = "say what it must do, as {status: completed}";
            return Err(refuse(Refusal::new("expected at least one key", help)));
        }
        Ok(())
    }
}

/// Reads what is expected under a key of this kind. Without a kind only the shape is checked.
struct Value<'k>(Option<&'k KeyKind>, &'k Names);

impl Value<'_> {
    fn takes_words(&self) -> Result<(), Refusal> {
        match self.0 {
            Some(KeyKind::Number) => Refusal::because(
                "expected `below` or `above`, found no bounds",
                "write it as {below: 1e-3}",
            ),
            Some(KeyKind::Text) => Refusal::because(
                "expected `contains`, found a word or words",
                "write it as {contains: \"...\"}",
            ),
            _ => Ok(()),
        }
    }

    fn word(&self, word: &str) -> Result<String, Refusal> {
        short(word)?;
        self.takes_words()?;
        let word = self.1.meant(word);
        if let Some(KeyKind::Word(words)) = self.0 {
            known(word, words, "word")?;
        }
        Ok(word.to_owned())
    }
}

impl<'de> Visitor<'de> for Value<'_> {
    type Value = Wanted;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a word, a list of words, or bounds such as {below: 1e-3}")
    }

    fn visit_str<E: Error>(self, word: &str) -> Result<Wanted, E> {
        let word = self.word(word).map_err(refuse)?;
        Ok(Wanted::Words(vec![word]))
    }

    fn visit_bool<E: Error>(self, truth: bool) -> Result<Wanted, E> {
        self.visit_str(&truth.to_string())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Wanted, A::Error> {
        self.takes_words().map_err(refuse)?;
        let mut words: Vec<String> = Vec::new();
        while let Some(word) = list.next_element_seed(Any(text(|word| {
            if words.len() >= EXPECTED {
                return Refusal::because(format!("expected at most {EXPECTED} words"), "");
            }
            let word = self.word(word)?;
            if words.contains(&word) {
                return Refusal::because(format!("`{word}` is given twice"), "keep one of them");
            }
            Ok(word)
        })))? {
            words.push(word);
        }
        if words.is_empty() && self.0.is_some() {
            let message = "expected at least one word, found an empty list";
            return Err(refuse(Refusal::new(message, "")));
        }
        Ok(Wanted::Words(words))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Wanted, A::Error> {
        if let Some(KeyKind::Word(words)) = self.0 {
            let message = format!("expected {}, found bounds", words.join(" or "));
            let help = "bounds are for numbers and text";
            return Err(refuse(Refusal::new(message, help)));
        }
        let (mut above, mut below, mut contains) = (None, None, None);
        let limit = |n| BOUND.judge(n);
        let mut seen = 0;
        while let Some(key) = map.next_key_seed(Key(|key: &str| bound(key, &mut seen, self.0)))? {
            match key {
                "above" => above = map.next_value_seed(Maybe(Any(number(limit))))?,
                "below" => below = map.next_value_seed(Maybe(Any(number(limit))))?,
                _ => contains = map.next_value_seed(Maybe(Any(text(some_text))))?,
            }
        }
        let wrong = |message: String, help: &str| Err(refuse(Refusal::new(message, help)));
        match (self.0, contains, above, below) {
            (Some(KeyKind::Text), None, ..) => wrong(
                "expected `contains`, found nothing".into(),
                "write it as {contains: \"...\"}",
            ),
            (_, Some(text), ..) => Ok(Wanted::Contains(text)),
            (Some(KeyKind::Number), _, None, None) => wrong(
                "expected `below` or `above`, found neither".into(),
                "write it as {below: 1e-3}",
            ),
            (_, _, Some(above), Some(below)) if above >= below => wrong(
                format!("no number is above {above:?} and below {below:?}"),
                "",
            ),
            (_, _, above, below) => Ok(Wanted::Bounds { above, below }),
        }
    }
}

/// The key of a bound (`below`, `above` or `contains`), if it fits the kind.
fn bound(key: &str, seen: &mut u32, kind: Option<&KeyKind>) -> Result<&'static str, Refusal> {
    const KEYS: [&str; 3] = ["below", "above", "contains"];
    let known = KEYS[index_of(key, KEYS.into_iter(), seen)?];
    match kind {
        Some(KeyKind::Number) if known == "contains" => Refusal::because(
            "found `contains` on a number",
            "`contains` is for text: write `below` or `above`",
        ),
        Some(KeyKind::Text) if known != "contains" => Refusal::because(
            format!("found `{key}` on a text"),
            format!("`{key}` is for numbers: write `contains`"),
        ),
        _ => Ok(known),
    }
}

fn some_text(text: &str) -> Result<String, Refusal> {
    short(text)?;
    if text.trim().is_empty() {
        return Refusal::because("expected some text, found none", "");
    }
    Ok(text.to_owned())
}
