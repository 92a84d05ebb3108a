//! Names of particles in sentences: people read `particle sheet[3,4]` where the data say `particle 64`.

use crate::scene::object::{Body, called};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

/// What the user has named or types again; it stays as it is.
const NAMED: [&str; 4] = ["scene", "engine", "subject", "advice"];

/// The same data with names in all sentences; None where it cannot be read back.
pub fn in_sentences<T: Serialize + DeserializeOwned>(data: &T, bodies: &[Body]) -> Option<T> {
    let mut value = serde_json::to_value(data).ok()?;
    rename(&mut value, bodies);
    serde_json::from_value(value).ok()
}

fn rename(value: &mut Value, bodies: &[Body]) {
    match value {
        Value::String(text) => *text = sentence(text, bodies),
        Value::Array(list) => list.iter_mut().for_each(|value| rename(value, bodies)),
        Value::Object(map) => {
            let sentences = map
                .iter_mut()
                .filter(|(key, _)| !NAMED.contains(&key.as_str()));
            sentences.for_each(|(_, value)| rename(value, bodies));
        }
        _ => {}
    }
}

/// The sentence with names in the place of ids after `particle`, and of all in a list after `particles`.
pub fn sentence(text: &str, bodies: &[Body]) -> String {
    let mut named = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(PARTICLE) {
        named += &rest[..at + PARTICLE.len()];
        rest = &rest[at + PARTICLE.len()..];
        let separators: &[&str] = match rest.starts_with("s ") {
            true => &["s ", ", ", " and "],
            false => &[" "],
        };
        // The first separator stands once, before the list; then come the others.
        let mut next = &separators[..1];
        while let Some((separator, id, after)) = next.iter().find_map(|s| id_after(rest, s)) {
            named += separator;
            named += &called(bodies, id);
            rest = after;
            next = &separators[1..];
        }
    }
    named + rest
}

const PARTICLE: &str = "particle";

/// The separator, the id behind it, and what follows; None where there is no whole number.
fn id_after<'t, 's>(text: &'t str, separator: &'s str) -> Option<(&'s str, usize, &'t str)> {
    let rest = text.strip_prefix(separator)?;
    let end = rest.find(|c: char| !c.is_ascii_digit());
    let (digits, after) = rest.split_at(end.unwrap_or(rest.len()));
    let mut beyond = after.chars();
    let goes_on = match beyond.next() {
        Some('.') => beyond.next().is_some_and(|c| c.is_ascii_digit()),
        Some(c) => c.is_alphanumeric(),
        None => false,
    };
    let id = digits.parse().ok().filter(|_| !goes_on)?;
    Some((separator, id, after))
}

#[cfg(test)]
mod tests {
    use super::sentence;
    use crate::scene::object::Body;

    /// A report that is read may hold anything.
    #[test]
    fn bodies_that_hold_nothing_name_nothing() {
        for shape in [vec![], vec![0], vec![0, 3], vec![usize::MAX, 0]] {
            let name = "sheet".into();
            let body = Body {
                name,
                first: 2,
                shape,
            };
            assert_eq!(sentence("particle 7", &[body]), "particle 7");
        }
    }

    #[test]
    fn ids_become_names_and_other_numbers_stay() {
        let sheet = Body {
            name: "sheet".into(),
            first: 2,
            shape: vec![2, 3],
        };
        for (text, wanted) in [
            ("fastest at particle 7", "fastest at particle sheet[1,2]"),
            ("particle 2: 3 m", "particle sheet[0,0]: 3 m"),
            ("at particle 3.", "at particle sheet[0,1]."),
            (
                "spring 4 (particles 3 and 5)",
                "spring 4 (particles sheet[0,1] and sheet[1,0])",
            ),
            (
                "particles 1, 2 and 3",
                "particles 1, sheet[0,0] and sheet[0,1]",
            ),
            // One particle is no list, and what is no id has no name.
            (
                "particle 2 and 3 springs",
                "particle sheet[0,0] and 3 springs",
            ),
            ("particle 1, particle 8", "particle 1, particle 8"),
            ("all 3 particles leave", "all 3 particles leave"),
            ("particles: 3, springs: 4", "particles: 3, springs: 4"),
            ("particles 3.5 m and 3e5", "particles 3.5 m and 3e5"),
            ("particle", "particle"),
            (
                "particle 99999999999999999999",
                "particle 99999999999999999999",
            ),
        ] {
            assert_eq!(sentence(text, std::slice::from_ref(&sheet)), wanted);
            assert_eq!(sentence(text, &[]), text);
        }
    }
}
