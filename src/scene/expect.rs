//! Judges `expect`: engines, keys and words that exist, bounds that a number can meet.

use super::check::quantity;
use super::entries::{Entries, RawWanted, Word};
use super::expectation::{ALL, Expectation, REST, Wanted, Whom};
use super::limits::BOUND;
use super::locate::Problem;
use super::names::{KeyKind, Names};
use super::path::At;
use super::raw::RawBounds;
use super::shown::shorten;
use super::suggest;

/// Every expectation, in the order of the file.
pub(super) fn expectations(
    raw: Option<Entries<Entries<RawWanted>>>,
    names: &Names,
    at: At,
) -> Result<Vec<Expectation>, Problem> {
    let mut found = Vec::new();
    for (engine, Entries(keys)) in raw.map(|raw| raw.0).unwrap_or_default() {
        let whom = whom(&engine, names, at)?;
        let at = at.key(&engine);
        if keys.is_empty() {
            let help = "say what it must do, as {status: completed}";
            return Err(Problem::new(at, "expected at least one key", help));
        }
        for (key, raw) in keys {
            let known = names.keys.iter().find(|known| known.path == key);
            let Some(known) = known else {
                let paths: Vec<&str> = names.keys.iter().map(|known| known.path.as_str()).collect();
                let message = format!("unknown key `{}`", shorten(&key));
                return Err(Problem::new(
                    at.name(&key),
                    message,
                    suggest::key(&key, &paths),
                ));
            };
            let wanted = wanted(raw, &known.kind, at.key(&key))?;
            found.push(Expectation {
                whom: whom.clone(),
                key,
                wanted,
            });
        }
    }
    Ok(found)
}

fn whom(engine: &str, names: &Names, at: At) -> Result<Whom, Problem> {
    let mut known = [ALL, REST].to_vec();
    known.extend(names.methods.iter().chain(&names.engines));
    match engine {
        ALL => Ok(Whom::All),
        REST => Ok(Whom::Rest),
        id if known.contains(&id) => Ok(Whom::Engine(id.to_owned())),
        other => {
            let message = format!("unknown engine `{}`", shorten(other));
            let near = suggest::nearest(other, &known);
            let help = near.map_or_else(
                || format!("the engines here are {}", known.join(", ")),
                |near| format!("did you mean `{near}`?"),
            );
            Err(Problem::new(at.name(other), message, help))
        }
    }
}

fn wanted(raw: RawWanted, kind: &KeyKind, at: At) -> Result<Wanted, Problem> {
    match (kind, raw) {
        (KeyKind::Word(known), RawWanted::Word(word)) => {
            Ok(Wanted::Words(vec![one_of(word, known, at)?]))
        }
        (KeyKind::Word(known), RawWanted::Words(list)) => words(list, known, at),
        (KeyKind::Word(known), RawWanted::Bounds(_)) => {
            let message = format!("expected {}, found bounds", known.join(" or "));
            Err(Problem::new(at, message, "bounds are for numbers and text"))
        }
        (KeyKind::Number, RawWanted::Bounds(raw)) => bounds(raw, at),
        (KeyKind::Number, _) => {
            let message = "expected `below` or `above`, found no bounds";
            Err(Problem::new(at, message, "write it as {below: 1e-3}"))
        }
        (KeyKind::Text, RawWanted::Bounds(raw)) => text(raw, at),
        (KeyKind::Text, _) => {
            let message = "expected `contains`, found a word or words";
            Err(Problem::new(at, message, "write it as {contains: \"...\"}"))
        }
    }
}

fn words(list: Vec<Word>, known: &[&str], at: At) -> Result<Wanted, Problem> {
    let mut words: Vec<String> = Vec::new();
    for (i, word) in list.into_iter().enumerate() {
        let word = one_of(word, known, at.index(i))?;
        if words.contains(&word) {
            let message = format!("`{word}` is given twice");
            return Err(Problem::new(at.index(i), message, "keep one of them"));
        }
        words.push(word);
    }
    if words.is_empty() {
        let message = "expected at least one word, found an empty list";
        return Err(Problem::new(at, message, ""));
    }
    Ok(Wanted::Words(words))
}

fn one_of(Word(word): Word, known: &[&str], at: At) -> Result<String, Problem> {
    if known.contains(&word.as_str()) {
        return Ok(word);
    }
    let message = format!(
        "unknown word `{}`: expected one of {}",
        shorten(&word),
        known.join(", ")
    );
    let help = suggest::nearest(&word, known).map(|near| format!("did you mean `{near}`?"));
    Err(Problem::new(at, message, help.unwrap_or_default()))
}

fn bounds(raw: RawBounds, at: At) -> Result<Wanted, Problem> {
    if raw.contains.is_some() {
        let help = "`contains` is for text: write `below` or `above`";
        return Err(Problem::new(
            at.name("contains"),
            "found `contains` on a number",
            help,
        ));
    }
    let below = raw
        .below
        .map(|below| quantity(below, BOUND, at.key("below")))
        .transpose()?;
    let above = raw
        .above
        .map(|above| quantity(above, BOUND, at.key("above")))
        .transpose()?;
    match (above, below) {
        (None, None) => {
            let message = "expected `below` or `above`, found neither";
            Err(Problem::new(at, message, "write it as {below: 1e-3}"))
        }
        (Some(above), Some(below)) if above >= below => {
            let message = format!("no number is above {above:?} and below {below:?}");
            Err(Problem::new(at, message, ""))
        }
        (above, below) => Ok(Wanted::Bounds { above, below }),
    }
}

fn text(raw: RawBounds, at: At) -> Result<Wanted, Problem> {
    for (key, given) in [("below", raw.below), ("above", raw.above)] {
        if given.is_some() {
            let message = format!("found `{key}` on a text");
            let help = format!("`{key}` is for numbers: write `contains`");
            return Err(Problem::new(at.name(key), message, help));
        }
    }
    match raw.contains {
        Some(Word(text)) if !text.trim().is_empty() => Ok(Wanted::Contains(text)),
        Some(_) => Err(Problem::new(
            at.key("contains"),
            "expected some text, found none",
            "",
        )),
        None => Err(Problem::new(
            at,
            "expected `contains`, found nothing",
            "write it as {contains: \"...\"}",
        )),
    }
}
