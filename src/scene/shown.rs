//! Text from a file, made fit to show: it may be long, and steer a terminal.

/// The character, or a stand-in for one that moves the cursor or reverses the line.
pub(crate) fn printable(c: char) -> char {
    match c {
        '\t' => ' ',
        '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => '\u{fffd}',
        c if c.is_control() => '\u{fffd}',
        c => c,
    }
}

/// The first 60 characters, so that a message stays a line.
pub(crate) fn shorten(text: &str) -> String {
    let mut short: String = text.chars().take(60).map(printable).collect();
    if text.chars().nth(60).is_some() {
        short.push('…');
    }
    short
}
