//! Sentences and the engines they are about.

/// One sentence, and whom it is about.
pub struct Note {
    /// Such as `rapier` or `explicit_euler at h = 0.15`.
    pub subject: String,
    pub sentence: String,
}

/// Sentences in the order they are first said, and who says them; equal ones once.
pub fn said_once<W>(said: impl IntoIterator<Item = (W, String)>) -> Vec<(Vec<W>, String)> {
    let mut once: Vec<(Vec<W>, String)> = Vec::new();
    for (who, sentence) in said {
        match once.iter_mut().find(|(_, known)| *known == sentence) {
            Some((all, _)) => all.push(who),
            None => once.push((vec![who], sentence)),
        }
    }
    once
}

/// `a`, `a and b`, `a, b and c`.
pub fn listed(texts: &[String]) -> String {
    match texts {
        [] => String::new(),
        [only] => only.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
