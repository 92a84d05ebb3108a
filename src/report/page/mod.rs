//! One self-contained HTML file: the Markdown pages of reports, with their figures in them, and a script that plays the
//! motion and links figures, tables and engines. It asks for nothing over a network, and says so to the browser.
//!
//! All that is said can be read without the script, which `script/` documents.

pub mod index;
pub mod playback;

use super::json::Tool;
use base64::{Engine as _, engine::general_purpose::STANDARD};
use maud::{DOCTYPE, Markup, PreEscaped, html};
use playback::{Playback, Shown};
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd};
use sha2::{Digest, Sha256};

const STYLE: &str = include_str!("script/page.css");
const SCRIPT: &str = include_str!("script/page.js");

/// One report on a page.
pub struct Article {
    /// Its scene's name.
    pub title: String,
    /// What was done with the scene, such as `Run`.
    pub part: &'static str,
    /// What it says, with links to its figures.
    pub markdown: String,
    /// Its figures: the names that are linked, and their SVG.
    pub figures: Vec<(&'static str, String)>,
    /// The rows of its tables that are about one engine: the texts they begin with, and the engine's id.
    pub engines: Vec<(Vec<String>, String)>,
    /// What it plays.
    pub motion: Option<Playback<Shown>>,
}

/// A page around its body.
struct Frame<'a> {
    title: &'a str,
    tool: &'a Tool,
    motion: Option<&'a Playback<Shown>>,
    body: Markup,
}

/// The page of these reports, with a table of contents where there are several. It plays the motion of the first that
/// has one.
pub fn render(tool: &Tool, articles: &[Article]) -> String {
    let alone = articles
        .windows(2)
        .all(|pair| pair[0].title == pair[1].title);
    let title = match articles {
        [one, ..] if alone => one.title.clone(),
        _ => format!("{} reports", articles.len()),
    };
    let playing = articles.iter().position(|article| article.motion.is_some());
    let several = articles.len() > 1;
    let body = html! {
        @if several {
            nav aria-label="reports" {
                @for (at, article) in articles.iter().enumerate() {
                    a href={ "#report-" (at) } {
                        (article.part) @if !alone { ": " (article.title) }
                    }
                }
            }
        }
        @for (at, article) in articles.iter().enumerate() {
            article id={ "report-" (at) } {
                @if several { p.part { (article.part) } }
                (PreEscaped(body(article, playing == Some(at))))
            }
        }
    };
    frame(&Frame {
        title: &title,
        tool,
        motion: playing.and_then(|at| articles[at].motion.as_ref()),
        body,
    })
}

fn frame(frame: &Frame) -> String {
    let Frame {
        title, tool, body, ..
    } = frame;
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(allowed());
                title { (title) }
                link rel="icon" href="data:,";
                style { (PreEscaped(STYLE)) }
            }
            body {
                main { (body) }
                footer {
                    p.faint {
                        "Made by " (tool.name) " " (tool.version) " on " (tool.platform)
                        ", in doubles, beside rapier3d-f64 " (rapier3d::VERSION) "."
                    }
                }
                @if let Some(motion) = frame.motion {
                    script id="playback" type="application/json" { (PreEscaped(data(motion))) }
                }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    page.into_string()
}

/// What a page may load and run: nothing but what is in it.
fn allowed() -> String {
    let hash = STANDARD.encode(Sha256::digest(SCRIPT));
    format!(
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:; script-src 'sha256-{hash}'"
    )
}

/// JSON that ends no script.
fn data(motion: &Playback<Shown>) -> String {
    let json = serde_json::to_string(motion).unwrap_or_default();
    json.replace('<', "\\u003c")
}

/// What a report says, as HTML. Figures stand where they are linked; HTML within the text is text.
fn body(article: &Article, plays: bool) -> String {
    let mut figure: Option<(CowStr, String)> = None;
    let mut events = Vec::new();
    let mut player = plays.then(|| player(article.motion.as_ref()));
    for event in Parser::new_ext(&article.markdown, Options::ENABLE_TABLES) {
        match event {
            Event::Start(Tag::Image { dest_url, .. }) => {
                figure = Some((dest_url, String::new()));
            }
            Event::Text(text) if figure.is_some() => {
                if let Some((_, title)) = &mut figure {
                    *title += &text;
                }
            }
            Event::End(TagEnd::Image) => {
                let drawn = figure.take().and_then(|(name, title)| {
                    let (_, svg) = article.figures.iter().find(|(own, _)| **own == *name)?;
                    Some(drawn(svg, &title))
                });
                let above = drawn.is_some().then(|| player.take()).flatten();
                let html = above.into_iter().chain(drawn);
                events.extend(html.map(|html| Event::Html(html.into())));
            }
            // A figure is no part of a paragraph.
            Event::End(TagEnd::Paragraph) if matches!(events.last(), Some(Event::Html(_))) => {
                let begins = |event: &Event| *event == Event::Start(Tag::Paragraph);
                if let Some(at) = events.iter().rposition(begins) {
                    events.remove(at);
                }
            }
            Event::Html(text) | Event::InlineHtml(text) => events.push(Event::Text(text)),
            // Tables may be wider than a narrow page.
            Event::Start(Tag::Table(columns)) => {
                events.push(Event::Html(r#"<div class="scroll">"#.into()));
                events.push(Event::Start(Tag::Table(columns)));
            }
            Event::End(TagEnd::Table) => {
                events.push(Event::End(TagEnd::Table));
                events.push(Event::Html("</div>".into()));
            }
            Event::End(TagEnd::TableRow) => {
                events.push(Event::End(TagEnd::TableRow));
                link_row(&mut events, &article.engines);
            }
            event => events.push(event),
        }
    }
    let mut text = String::new();
    pulldown_cmark::html::push_html(&mut text, events.into_iter());
    // No text has these: its own angles are escaped.
    text.replace("<table>", r#"<table class="sortable">"#)
        .replace(
            "<p><strong>Verdict:",
            r#"<p class="verdict"><strong>Verdict:"#,
        )
}

/// Says of the last row of a table which engine it is about, if it is about one.
fn link_row(events: &mut [Event], engines: &[(Vec<String>, String)]) {
    let begins = |event: &Event| *event == Event::Start(Tag::TableRow);
    let Some(at) = events.iter().rposition(begins) else {
        return;
    };
    let mut cells: Vec<String> = Vec::new();
    for event in &events[at..] {
        match event {
            Event::Start(Tag::TableCell) => cells.push(String::new()),
            Event::Text(text) | Event::Code(text) => {
                if let Some(cell) = cells.last_mut() {
                    *cell += text;
                }
            }
            _ => {}
        }
    }
    if let Some((_, id)) = engines.iter().find(|(begin, _)| cells.starts_with(begin)) {
        let row = html! { (PreEscaped("<tr data-engine=\"")) (id) (PreEscaped("\">")) };
        events[at] = Event::Html(row.into_string().into());
    }
}

/// The place of the player.
fn player(motion: Option<&Playback<Shown>>) -> String {
    let said = motion.map(Playback::said);
    html! {
        h2 { "Motion" }
        div id="player" { p { "The motion is played by the script of this page, where a browser runs it." } }
        @if let Some(said) = said { p.faint { (said) } }
    }
    .into_string()
}

fn drawn(svg: &str, title: &str) -> String {
    html! { figure { (PreEscaped(svg)) figcaption { (title) } } }.into_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(title: &str) -> String {
        let article = Article {
            title: title.into(),
            part: "Run",
            markdown: format!(
                "# {}\n\nSaid.\n\n![energy](energy.svg)\n\n| a |\n|---|\n| 1 |\n",
                crate::report::words::escape(title)
            ),
            figures: vec![("energy.svg", "<svg><title>E</title></svg>".into())],
            engines: Vec::new(),
            motion: None,
        };
        render(&Tool::this(), &[article])
    }

    #[test]
    fn a_page_has_its_figures_and_tables_in_it() {
        let page = page("Circle");
        let figure = "<figure><svg><title>E</title></svg><figcaption>energy</figcaption></figure>";
        for part in ["<h1>Circle</h1>", "<p>Said.</p>", figure, "<td>1</td>"] {
            assert!(page.contains(part), "{part} is not in {page}");
        }
        assert!(!page.contains("<p><figure>") && !page.contains("energy.svg"));
    }

    #[test]
    fn a_name_is_never_markup() {
        for name in [
            "<script>alert(1)</script>",
            "</title><b>",
            "&lt;i>",
            "![x](http://y)",
        ] {
            let page = page(name);
            // One script, the page's own, ends it.
            let (said, script) = page.split_once("<script>").expect("the page's script");
            assert!(script.starts_with(SCRIPT));
            for bad in ["<script", "<b>", "<i>", "http://y\""] {
                assert!(!said.contains(bad), "{bad}: {said}");
            }
        }
    }
}
