//! The marks of a panel: lines, symbols, areas and texts, placed by two axes and cut at the panel's edge.

use super::axis::ChartAxis;
use super::canvas::{Canvas, Stroke, Symbol, px};
use super::key::LegendEntry;

/// One mark of a panel. All numbers are values on the panel's axes.
pub enum Mark {
    Line(Polyline),
    /// A symbol at each point that is inside.
    Symbols(Symbol, Vec<[f64; 2]>),
    /// Rectangles of one colour, each given by two opposite corners.
    Area(&'static str, Vec<[[f64; 2]; 2]>),
    /// Triangles of one colour.
    Triangles(&'static str, Vec<[[f64; 2]; 3]>),
    /// Lines from one point to another, in one path. Not to be confused with [`Mark::Line`], which is thinned.
    Segments(Stroke, Vec<[[f64; 2]; 2]>),
    /// Discs in one path, as wide as the stroke.
    Dots(Stroke, Vec<[f64; 2]>),
    /// A text above and to the right of a point.
    Text([f64; 2], String),
}

impl Mark {
    /// A calm line without a label.
    pub fn line(points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) -> Mark {
        Mark::Line(Polyline::new(points, stroke))
    }

    pub fn label(&self) -> Option<&LegendEntry> {
        match self {
            Mark::Line(line) => line.label.as_ref(),
            _ => None,
        }
    }
}

/// Points joined in their order.
pub struct Polyline {
    pub points: Vec<[f64; 2]>,
    pub stroke: Stroke,
    /// Whether the line ends where it first is more than a panel's size outside. A line that returned from
    /// there would only cross the panel again and again.
    pub wild: bool,
    /// The symbol at the last point, drawn if the line gets there and the point is inside.
    pub end: Option<Symbol>,
    /// The label beside the panel, at the height of the last point inside.
    pub label: Option<LegendEntry>,
    /// The engine it is about, by its id on a page.
    pub engine: Option<String>,
}

impl Polyline {
    /// A calm line without a label. Points that are not finite are left out.
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) -> Polyline {
        let points = points.into_iter();
        Polyline {
            points: points.filter(|p| p.iter().all(|c| c.is_finite())).collect(),
            stroke,
            wild: false,
            end: None,
            label: None,
            engine: None,
        }
    }
}

/// The cells for which `belongs` holds, as one area; neighbours along y become one rectangle. There are
/// `columns` cells along x and `rows` along y, the first row at the bottom; they fill the axes.
pub fn cells(
    colour: &'static str,
    [x, y]: [ChartAxis; 2],
    [columns, rows]: [usize; 2],
    belongs: impl Fn(usize, usize) -> bool,
) -> Mark {
    let corner = |i: usize, j: usize| {
        let part = |at, count| at as f64 / count as f64;
        [x.at(part(i, columns)), y.at(part(j, rows))]
    };
    let mut rectangles = Vec::new();
    for i in 0..columns {
        let column: Vec<usize> = (0..rows).filter(|j| belongs(i, *j)).collect();
        for run in column.chunk_by(|a, b| a + 1 == *b) {
            rectangles.push([corner(i, run[0]), corner(i + 1, run[0] + run.len())]);
        }
    }
    Mark::Area(colour, rectangles)
}

/// A rectangle in pixels.
#[derive(Debug, Clone, Copy)]
pub struct Window {
    pub left: f64,
    pub top: f64,
    pub right: f64,
    pub bottom: f64,
}

impl Window {
    pub fn holds(&self, point: [f64; 2]) -> bool {
        self.clamped(point) == point
    }

    /// Width and height.
    pub fn size(&self) -> [f64; 2] {
        [self.right - self.left, self.bottom - self.top]
    }

    /// The nearest point inside.
    fn clamped(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let x = x.clamp(self.left, self.right);
        [x, y.clamp(self.top, self.bottom)]
    }

    /// The part of a segment inside, if any (Liang-Barsky).
    fn cut(&self, a: [f64; 2], b: [f64; 2]) -> Option<[[f64; 2]; 2]> {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let edges = [
            (-dx, a[0] - self.left),
            (dx, self.right - a[0]),
            (-dy, a[1] - self.top),
            (dy, self.bottom - a[1]),
        ];
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (speed, room) in edges {
            if speed == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if speed < 0.0 {
                from = from.max(room / speed);
            } else {
                to = to.min(room / speed);
            }
        }
        let at = |s: f64| [a[0] + s * dx, a[1] + s * dy];
        let end = |s: f64, whole: f64, point| if s == whole { point } else { at(s) };
        (from <= to).then(|| [end(from, 0.0, a), end(to, 1.0, b)])
    }
}

/// The anchor of a line's label: its point sets the label's height.
#[derive(Debug, Clone, Copy)]
pub struct Anchor {
    pub point: [f64; 2],
    /// Whether a thin line leads from the point to the label.
    pub led: bool,
}

/// A window and the axes along it.
pub struct Frame {
    pub window: Window,
    pub axes: [ChartAxis; 2],
}

impl Frame {
    /// The place of a pair of values, pixels; it may lie outside the window.
    pub fn place(&self, values: [f64; 2]) -> [f64; 2] {
        let (w, [width, height]) = (self.window, self.window.size());
        let [x, y] = [0, 1].map(|a| self.axes[a].place(values[a]));
        [w.left + x * width, w.bottom - y * height]
    }

    /// Draws the part of a mark that is inside. A line is thinned to about `budget` points. Returns the anchor
    /// of a line's label; `None` for other marks and for lines without points.
    pub fn draw(&self, canvas: &mut Canvas, mark: &Mark, budget: usize) -> Option<Anchor> {
        match mark {
            Mark::Line(line) => return self.line(canvas, line, budget),
            Mark::Symbols(symbol, points) => {
                let pixels = points.iter().map(|point| self.place(*point));
                for pixel in pixels.filter(|pixel| self.window.holds(*pixel)) {
                    canvas.symbol(pixel, *symbol);
                }
            }
            Mark::Area(colour, rectangles) => {
                let rectangle = |corners: &[[f64; 2]; 2]| {
                    let corners = corners.map(|corner| self.window.clamped(self.place(corner)));
                    let [[left, bottom], [right, top]] = corners.map(|corner| corner.map(px));
                    format!("M{left} {bottom}H{right}V{top}H{left}Z")
                };
                let data: String = rectangles.iter().map(rectangle).collect();
                canvas.area(&data, colour);
            }
            Mark::Triangles(colour, triangles) => {
                let triangle = |corners: &[[f64; 2]; 3]| {
                    let corners = corners.map(|corner| self.window.clamped(self.place(corner)));
                    let [a, b, c] = corners.map(|corner| corner.map(px).join(" "));
                    format!("M{a}L{b}L{c}Z")
                };
                let data: String = triangles.iter().map(triangle).collect();
                canvas.area(&data, colour);
            }
            Mark::Segments(stroke, segments) => {
                let segments = segments.iter().map(|ends| ends.map(|end| self.place(end)));
                canvas.path(&path(segments, self.window).0, *stroke);
            }
            Mark::Dots(stroke, points) => {
                let pixels = points.iter().map(|point| self.place(*point));
                let inside = pixels.filter(|pixel| self.window.holds(*pixel));
                canvas.path(&inside.map(dot).collect::<String>(), *stroke);
            }
            Mark::Text(point, text) => {
                let pixel = self.place(*point);
                if self.window.holds(pixel) {
                    canvas.note(pixel, text);
                }
            }
        }
        None
    }

    fn line(&self, canvas: &mut Canvas, line: &Polyline, budget: usize) -> Option<Anchor> {
        let (w, [width, height]) = (self.window, self.window.size());
        let mut pixels: Vec<[f64; 2]> = line.points.iter().map(|p| self.place(*p)).collect();
        let last = *pixels.last()?;
        if line.wild {
            let far = |p: &[f64; 2]| {
                let [x, y] = w.clamped(*p);
                (p[0] - x).abs() > width || (p[1] - y).abs() > height
            };
            let far = pixels.iter().position(far);
            pixels.truncate(far.map_or(pixels.len(), |at| at + 1));
        }
        let (data, end) = match thinned(&pixels, budget)[..] {
            [only] if w.holds(only) => (dot(only), Some(only)),
            ref pixels => path(pixels.windows(2).map(|pair| [pair[0], pair[1]]), w),
        };
        canvas.open(line.engine.as_deref(), &line.points);
        canvas.path(&data, line.stroke);
        let arrives = end == Some(last);
        if let Some(symbol) = line.end.filter(|_| arrives) {
            canvas.symbol(last, symbol);
        }
        canvas.close(line.engine.as_deref());
        Some(Anchor {
            point: w.clamped(end.unwrap_or(last)),
            led: arrives || end.is_some_and(|[x, _]| x > w.right - 3.0),
        })
    }
}

/// About `budget` of the points at most: both ends and, in each stretch of the line, the smallest and the
/// largest of each coordinate, so that no peak is lost. Where x only grows, its extremes are not needed.
fn thinned(points: &[[f64; 2]], budget: usize) -> Vec<[f64; 2]> {
    if points.len() <= budget.max(2) {
        return points.to_vec();
    }
    let first = usize::from(points.is_sorted_by(|a, b| a[0] <= b[0]));
    let stretches = (budget / (2 * (2 - first))).max(1);
    let mut kept = vec![0, points.len() - 1];
    for stretch in 0..stretches {
        let bounds = [stretch, stretch + 1].map(|s| s * points.len() / stretches);
        for axis in first..2 {
            let by = |a: &usize, b: &usize| points[*a][axis].total_cmp(&points[*b][axis]);
            kept.extend((bounds[0]..bounds[1]).min_by(by));
            kept.extend((bounds[0]..bounds[1]).max_by(by));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept.into_iter().map(|at| points[at]).collect()
}

/// A disc as wide as the stroke, as the `d` attribute of a path.
fn dot(pixel: [f64; 2]) -> String {
    format!("M{}h0", pixel.map(px).join(" "))
}

/// The segments cut at the window, as the `d` attribute of a path, and the path's last point; empty where no part
/// is inside. The pen stays down where a segment begins at the end of the one before.
fn path(
    segments: impl Iterator<Item = [[f64; 2]; 2]>,
    window: Window,
) -> (String, Option<[f64; 2]>) {
    let mut data = String::new();
    // The position of the pen, as written.
    let mut pen: Option<[String; 2]> = None;
    let mut end = None;
    for [a, b] in segments {
        let Some([a, b]) = window.cut(a, b) else {
            continue;
        };
        end = Some(b);
        let [from, to] = [a.map(px), b.map(px)];
        if pen.as_ref() != Some(&from) {
            data += &format!("M{} {}", from[0], from[1]);
        } else if from == to {
            continue;
        }
        data += &format!("L{} {}", to[0], to[1]);
        pen = Some(to);
    }
    (data, end)
}
