//! Text from a file, made safe to print, and the nearest known word for "did you mean".

use strsim::damerau_levenshtein;

/// Whether a terminal would act on the character instead of showing it: it moves the cursor, changes colours or
/// turns the direction of the line. Variation selectors belong to these, since the layout uses them as its marks.
pub(crate) fn acts(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{61c}'
                | '\u{200e}'
                | '\u{200f}'
                | '\u{202a}'..='\u{202e}'
                | '\u{2066}'..='\u{2069}'
                | '\u{e0100}'..='\u{e01ef}'
        )
}

/// The character, or a stand-in for one that a terminal would act on. Everything that people read passes here before
/// it is printed.
pub(crate) fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        c if acts(c) => '\u{fffd}',
        c => c,
    }
}

/// Text on one line in which every character is [`printable`], such as a path: its line ends are not those of a message.
pub(crate) fn in_line(text: &str) -> String {
    text.chars().map(printable).collect()
}

/// Text of several lines in which every other character is [`printable`].
pub(crate) fn visible(text: &str) -> String {
    let shown = |c| if c == '\n' { c } else { printable(c) };
    text.chars().map(shown).collect()
}

/// The first 60 characters, so that a message stays a line.
pub(crate) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(60).map(printable).collect();
    if text.chars().nth(60).is_some() {
        short.push('…');
    }
    short
}

/// The known word that is only a few letters away, if there is one.
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

/// ` (did you mean ...?)` for the middle of a message; empty where no known word is near.
pub(crate) fn aside(found: &str, known: &[&str]) -> String {
    did_you_mean(found, known).map_or_else(String::new, |asked| format!(" ({asked})"))
}

/// `did you mean ...?`, where a known word is near.
pub(super) fn did_you_mean(found: &str, known: &[&str]) -> Option<String> {
    nearest(found, known).map(|near| format!("did you mean `{near}`?"))
}

/// Keys that other formats use, or that belong to another mapping of this format.
const ELSEWHERE: &[(&str, &str)] = &[
    ("k", "did you mean `stiffness`?"),
    ("c", "did you mean `damping`?"),
    ("length", "did you mean `rest_length`?"),
    ("position", "did you mean `pos`?"),
    ("velocity", "did you mean `vel`?"),
    ("dt", "did you mean `timestep`?"),
    ("h", "did you mean `timestep`?"),
    ("velocity", "`velocity` stands under `air`"),
    ("density", "`density` stands under `air`"),
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

/// Advice on an unknown key, given the keys the mapping knows.
pub(super) fn about_key(found: &str, known: &[&str]) -> String {
    did_you_mean(found, known).unwrap_or_else(|| {
        // A hint is worth giving only where it does not name the mapping the key was found in.
        let hint = ELSEWHERE.iter().find(|(key, hint)| {
            *key == found && (hint.contains("stands") || known.iter().any(|k| hint.contains(k)))
        });
        let keys = || format!("the keys here are {}", known.join(", "));
        hint.map_or_else(keys, |(_, hint)| (*hint).to_owned())
    })
}
