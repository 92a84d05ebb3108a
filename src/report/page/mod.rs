//! One self-contained HTML file: the Markdown pages of reports, with their figures in them. It asks for nothing over a
//! network, and says so to the browser.

use maud::{DOCTYPE, PreEscaped, html};
use pulldown_cmark::{CowStr, Event, Options, Parser, Tag, TagEnd};

const STYLE: &str = include_str!("page.css");

/// What a page may load: nothing but what is in it.
const ALLOWED: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:";

/// One report on a page.
pub struct Article {
    /// Its scene's name.
    pub title: String,
    /// What it says, with links to its figures.
    pub markdown: String,
    /// Its figures: the names that are linked, and their SVG.
    pub figures: Vec<(&'static str, String)>,
}

/// The page of these reports, with a table of contents where there are several.
pub fn render(articles: &[Article]) -> String {
    let title = match articles {
        [one] => one.title.clone(),
        _ => format!("{} reports", articles.len()),
    };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta http-equiv="Content-Security-Policy" content=(ALLOWED);
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                @if articles.len() > 1 {
                    nav aria-label="reports" {
                        ol {
                            @for (at, article) in articles.iter().enumerate() {
                                li { a href={ "#report-" (at) } { (article.title) } }
                            }
                        }
                    }
                }
                main {
                    @for (at, article) in articles.iter().enumerate() {
                        article id={ "report-" (at) } { (PreEscaped(body(article))) }
                    }
                }
            }
        }
    };
    page.into_string()
}

/// What a report says, as HTML. Figures stand where they are linked; HTML within the text is text.
fn body(article: &Article) -> String {
    let mut figure: Option<(CowStr, String)> = None;
    let mut events = Vec::new();
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
                events.extend(drawn.map(|html| Event::Html(html.into())));
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
                events.push(Event::Html(r#"<div class="wide" tabindex="0">"#.into()));
                events.push(Event::Start(Tag::Table(columns)));
            }
            Event::End(TagEnd::Table) => {
                events.push(Event::End(TagEnd::Table));
                events.push(Event::Html("</div>".into()));
            }
            event => events.push(event),
        }
    }
    let mut text = String::new();
    pulldown_cmark::html::push_html(&mut text, events.into_iter());
    text
}

fn drawn(svg: &str, title: &str) -> String {
    html! { figure { (PreEscaped(svg)) figcaption { (title) } } }.into_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(title: &str) -> String {
        render(&[Article {
            title: title.into(),
            markdown: format!(
                "# {}\n\nSaid.\n\n![energy](energy.svg)\n\n| a |\n|---|\n| 1 |\n",
                crate::report::words::escape(title)
            ),
            figures: vec![("energy.svg", "<svg><title>E</title></svg>".into())],
        }])
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
            let body = page.split("</style>").nth(1).expect("a body");
            for bad in ["<script", "<b>", "<i>", "http://y\""] {
                assert!(!page.contains(bad) && !body.contains(bad), "{bad}: {body}");
            }
        }
    }
}
