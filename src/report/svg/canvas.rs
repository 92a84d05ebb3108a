//! SVG text, written element by element. Numbers have at most one decimal, so equal input gives
//! equal bytes; there are no ids, so several figures can be inline on one page.

use crate::report::words::in_xml;

/// The look of a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    pub colour: &'static str,
    /// The value of `stroke-dasharray`; empty for a solid line.
    pub dash: &'static str,
    /// The width, pixels.
    pub width: f64,
}

impl Stroke {
    pub const fn new(colour: &'static str, dash: &'static str, width: f64) -> Stroke {
        Stroke {
            colour,
            dash,
            width,
        }
    }
}

/// The place of a text relative to its point.
#[derive(Debug, Clone, Copy)]
pub enum Align {
    Start,
    Middle,
    End,
    /// The text reads from bottom to top, its middle at the point.
    Upward,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SymbolShape {
    Disc,
    Square,
    Diamond,
    Triangle,
    /// Two diagonals, without a filling.
    Cross,
}

/// A point's look, about 7 pixels wide.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Symbol {
    pub shape: SymbolShape,
    pub fill: &'static str,
    pub outline: &'static str,
}

impl Symbol {
    pub const fn new(shape: SymbolShape, fill: &'static str, outline: &'static str) -> Symbol {
        Symbol {
            shape,
            fill,
            outline,
        }
    }

    /// The mark of a run that ended early.
    pub const fn cross(colour: &'static str) -> Symbol {
        Symbol::new(SymbolShape::Cross, colour, colour)
    }
}

pub const WHITE: &str = "#ffffff";
/// The dark grey of text.
pub const INK: &str = "#222222";
/// The lighter grey of axes and notes.
pub const FAINT: &str = "#6b6b6b";

/// An unfinished drawing, in pixels with y downward.
#[derive(Default)]
pub struct Canvas {
    body: String,
    /// For a page, whose script links what stands for one engine and reads the values of lines.
    linked: bool,
    /// Attributes of the whole drawing.
    pub attributes: String,
}

/// The values of a line that a page shows, at most.
const VALUES: usize = 240;

impl Canvas {
    /// Empty; `linked` is for a page.
    pub fn new(linked: bool) -> Self {
        Self {
            linked,
            ..Self::default()
        }
    }

    /// Begins what stands for this engine, with the values it shows.
    pub fn open(&mut self, engine: Option<&str>, values: &[[f64; 2]]) {
        let Some(engine) = engine.filter(|_| self.linked) else {
            return;
        };
        let stride = values.len().div_ceil(VALUES).max(1);
        let mut kept: Vec<String> = values
            .iter()
            .step_by(stride)
            .map(|[x, y]| format!("{x:.5e} {y:.5e}"))
            .collect();
        if let Some([x, y]) = values.last().filter(|_| values.len() % stride != 1) {
            kept.push(format!("{x:.5e} {y:.5e}"));
        }
        let values = match &kept[..] {
            [] => String::new(),
            kept => format!(r#" data-values="{}""#, kept.join(",")),
        };
        self.push(&format!(
            r#"<g data-engine="{}"{values}>"#,
            attribute(engine)
        ));
    }

    /// Ends what [`open`](Self::open) began.
    pub fn close(&mut self, engine: Option<&str>) {
        if self.linked && engine.is_some() {
            self.push("</g>");
        }
    }

    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], colour: &str, width: f64) {
        let [x1, y1] = from.map(px);
        let [x2, y2] = to.map(px);
        self.push(&format!(
            r#"<path d="M{x1} {y1}L{x2} {y2}" stroke="{colour}" stroke-width="{}" fill="none"/>"#,
            px(width)
        ));
    }

    /// Draws a path; `data` is its `d` attribute. Empty `data` draws nothing.
    pub fn path(&mut self, data: &str, stroke: Stroke) {
        if data.is_empty() {
            return;
        }
        // Dashes with round caps would close their own gaps.
        let (cap, dash) = match stroke.dash {
            "" => ("round", String::new()),
            dash => ("butt", format!(r#" stroke-dasharray="{dash}""#)),
        };
        self.push(&format!(
            r#"<path d="{data}" fill="none" stroke="{}" stroke-width="{}" stroke-linejoin="round" stroke-linecap="{cap}"{dash}/>"#,
            stroke.colour,
            px(stroke.width),
        ));
    }

    /// Fills a closed area. Its edges are hard, so that neighbours leave no seam. Empty `data` draws nothing.
    pub fn area(&mut self, data: &str, colour: &str) {
        if !data.is_empty() {
            self.push(&format!(
                r#"<path d="{data}" fill="{colour}" shape-rendering="crispEdges"/>"#
            ));
        }
    }

    pub fn rectangle(&mut self, corner: [f64; 2], size: [f64; 2], fill: &str, outline: &str) {
        let ([x, y], [w, h]) = (corner.map(px), size.map(px));
        self.push(&format!(
            r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="{fill}" stroke="{outline}"/>"#
        ));
    }

    pub fn symbol(&mut self, centre: [f64; 2], symbol: Symbol) {
        let ([x, y], fill, outline) = (centre, symbol.fill, symbol.outline);
        let corners: &[[f64; 2]] = match symbol.shape {
            SymbolShape::Disc => {
                let [x, y] = centre.map(px);
                return self.push(&format!(
                    r#"<circle cx="{x}" cy="{y}" r="3.3" fill="{fill}" stroke="{outline}"/>"#
                ));
            }
            SymbolShape::Cross => {
                self.line([x - 3.8, y - 3.8], [x + 3.8, y + 3.8], outline, 2.0);
                return self.line([x - 3.8, y + 3.8], [x + 3.8, y - 3.8], outline, 2.0);
            }
            SymbolShape::Square => &[[-3.0, -3.0], [3.0, -3.0], [3.0, 3.0], [-3.0, 3.0]],
            SymbolShape::Diamond => &[[0.0, -4.3], [4.3, 0.0], [0.0, 4.3], [-4.3, 0.0]],
            SymbolShape::Triangle => &[[0.0, -4.0], [3.8, 2.8], [-3.8, 2.8]],
        };
        let corner = |[dx, dy]: &[f64; 2]| format!("{} {}", px(x + dx), px(y + dy));
        let corners: Vec<String> = corners.iter().map(corner).collect();
        let data = corners.join("L");
        self.push(&format!(
            r#"<path d="M{data}Z" fill="{fill}" stroke="{outline}"/>"#
        ));
    }

    /// `size` in pixels.
    pub fn text(&mut self, at: [f64; 2], align: Align, size: f64, fill: &str, text: &str) {
        let [x, y] = at.map(px);
        let place = match align {
            Align::Start => format!(r#"x="{x}" y="{y}" text-anchor="start""#),
            Align::Middle => format!(r#"x="{x}" y="{y}" text-anchor="middle""#),
            Align::End => format!(r#"x="{x}" y="{y}" text-anchor="end""#),
            Align::Upward => {
                format!(r#"transform="translate({x} {y}) rotate(-90)" text-anchor="middle""#)
            }
        };
        let (size, text) = (px(size), escape(text));
        self.push(&format!(
            r#"<text {place} font-size="{size}" fill="{fill}">{text}</text>"#
        ));
    }

    /// A small note right of a point, on a white ground that sets it off from lines below it.
    pub fn note(&mut self, [x, y]: [f64; 2], text: &str) {
        let [x, y] = [x + 5.0, y - 4.0];
        // Digits and letters are about so wide at this size.
        let width = 5.8 * text.chars().count() as f64;
        self.rectangle([x - 1.0, y - 9.0], [width + 2.0, 12.0], WHITE, WHITE);
        self.text([x, y], Align::Start, 10.0, FAINT, text);
    }

    fn push(&mut self, element: &str) {
        self.body.push_str(element);
        self.body.push('\n');
    }

    /// The whole file. Its background is white, so that it shows on dark pages too.
    pub fn finish(self, width: f64, height: f64, title: &str) -> String {
        let (width, height) = (px(width.ceil()), px(height.ceil()));
        let (title, body, more) = (escape(title), self.body, self.attributes);
        format!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="img" font-family="Helvetica, Arial, sans-serif"{more}>
<title>{title}</title>
<rect width="{width}" height="{height}" fill="{WHITE}"/>
{body}</svg>
"#
        )
    }
}

/// A coordinate with at most one decimal, never `-0`.
pub fn px(value: f64) -> String {
    // Adding 0 turns -0 into 0.
    ((10.0 * value).round() / 10.0 + 0.0).to_string()
}

/// Text escaped for an attribute.
pub fn attribute(text: &str) -> String {
    escape(text).replace('"', "&quot;")
}

/// Text escaped for XML.
fn escape(text: &str) -> String {
    let text = in_xml(text).replace('&', "&amp;");
    text.replace('<', "&lt;").replace('>', "&gt;")
}
