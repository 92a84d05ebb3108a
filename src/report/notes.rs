//! Sentences and the engines they are about.

/// One sentence, and whom it is about.
pub struct Note {
    /// Such as `rapier` or `explicit_euler at h = 0.15`.
    pub subject: String,
    pub sentence: String,
}

/// Sentences with their subjects. Equal sentences stand once, with one text for all their subjects.
pub fn notes<W>(
    said: impl Iterator<Item = (W, String)>,
    subject: impl Fn(&[W]) -> String,
) -> Vec<Note> {
    let note = |(sentence, who): (String, Vec<W>)| Note {
        subject: subject(&who),
        sentence,
    };
    grouped(said).into_iter().map(note).collect()
}

/// Equal things once, in the order they first come, each with all that belong to it.
pub fn grouped<W, T: PartialEq>(pairs: impl Iterator<Item = (W, T)>) -> Vec<(T, Vec<W>)> {
    let mut groups: Vec<(T, Vec<W>)> = Vec::new();
    for (member, of) in pairs {
        match groups.iter_mut().find(|(known, _)| *known == of) {
            Some((_, members)) => members.push(member),
            None => groups.push((of, vec![member])),
        }
    }
    groups
}

/// `a`, `a and b`, `a, b and c`.
pub fn listed(texts: &[String]) -> String {
    match texts {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
