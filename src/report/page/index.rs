//! The index of the pages of several scenes.

use super::{Frame, frame};
use crate::report::json::Tool;
use maud::html;

/// One scene.
pub struct Entry {
    /// Its name.
    pub title: String,
    /// Its file.
    pub file: String,
    /// Its page, as a path from the index.
    pub link: String,
    /// What each verb says in one sentence, after the verb's title.
    pub said: Vec<(&'static str, String)>,
}

/// The page that links those of all scenes; a filter and sorting come with its script.
pub fn render(tool: &Tool, entries: &[Entry]) -> String {
    let heads = entries.first().map(|entry| &entry.said[..]);
    let body = html! {
        h1 { (entries.len()) " scenes" }
        div.scroll {
            table.sortable {
                caption { "What each scene shows; its name opens its page" }
                thead {
                    tr {
                        th { "scene" }
                        @for (title, _) in heads.unwrap_or_default() { th { (title) } }
                    }
                }
                tbody {
                    @for entry in entries {
                        tr {
                            th scope="row" {
                                a href=(linked(&entry.link)) { (entry.title) }
                                br;
                                small { (entry.file) }
                            }
                            @for (_, said) in &entry.said { td { (said) } }
                        }
                    }
                }
            }
        }
    };
    frame(&Frame {
        title: &format!("{} scenes", entries.len()),
        tool,
        motion: None,
        body,
    })
}

/// A path as a link: each part escaped.
fn linked(path: &str) -> String {
    let escaped = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'/' => {
            char::from(byte).to_string()
        }
        other => format!("%{other:02X}"),
    };
    path.bytes().map(escaped).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_with_anything_in_it_is_one_link() {
        assert_eq!(linked("a b/c?#\"ü.html"), "a%20b/c%3F%23%22%C3%BC.html");
    }
}
