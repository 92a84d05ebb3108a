//! "Did you mean": the nearest known word.

use strsim::damerau_levenshtein;

/// Keys other formats use, or that belong to another mapping of this one.
const ELSEWHERE: &[(&str, &str)] = &[
    ("k", "did you mean `stiffness`?"),
    ("c", "did you mean `damping`?"),
    ("length", "did you mean `rest_length`?"),
    ("position", "did you mean `pos`?"),
    ("velocity", "did you mean `vel`?"),
    ("dt", "did you mean `timestep`?"),
    ("h", "did you mean `timestep`?"),
    ("gravity", "`gravity` stands under `solver`"),
    ("timestep", "`timestep` stands under `solver`"),
    ("type", "`type` stands under `solver`"),
    ("tolerance", "`tolerance` stands under `solver`"),
    ("duration", "`duration` stands at the top of the file"),
    ("up", "`up` stands at the top of the file"),
    (
        "damping_model",
        "`damping_model` stands at the top of the file",
    ),
];

/// What to do about an unknown key, given those the mapping knows.
pub(super) fn key(found: &str, known: &[&str]) -> String {
    if let Some(near) = nearest(found, known) {
        return format!("did you mean `{near}`?");
    }
    // A hint is worth giving only where it does not name the mapping the key was found in.
    let hint = ELSEWHERE.iter().find(|(key, hint)| {
        *key == found && (hint.contains("stands") || known.iter().any(|k| hint.contains(k)))
    });
    let keys = format!("the keys here are {}", known.join(", "));
    hint.map_or(keys, |(_, hint)| (*hint).to_owned())
}

/// The known word a few letters away, if any.
pub(crate) fn nearest<'a>(found: &str, known: &[&'a str]) -> Option<&'a str> {
    // The distance is quadratic in length, and no known word is this long.
    if found.len() > 64 {
        return None;
    }
    let found = found.to_lowercase().replace('-', "_");
    let allowed = (found.chars().count() / 3).max(1);
    known
        .iter()
        .map(|word| (damerau_levenshtein(&found, &word.to_lowercase()), *word))
        .filter(|(distance, word)| *distance <= allowed && *distance < word.len())
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, word)| word)
}
