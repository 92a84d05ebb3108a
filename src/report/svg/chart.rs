//! The layout of every figure: a chart is a title, a legend and panels in rows; a panel is two axes, marks,
//! and labels beside them. Figures give values; this file decides where they are drawn.

use super::WIDTH;
use super::axis::ChartAxis;
use super::canvas::{Align, Canvas, FAINT, INK, attribute};
use super::key::{LegendEntry, Look, SWATCH};
use super::marks::{Anchor, Frame, Mark, Window};

/// Pixels left of the first panel, for tick labels and the axis title.
const LEFT: f64 = 84.0;
/// Pixels below a panel, for tick labels and the axis title.
const BELOW: f64 = 46.0;
/// The most points of all lines of a chart together: the file stays below 300 kB.
const POINTS: usize = 20_000;
/// Pixels from one label's baseline to the next.
const PITCH: f64 = 16.0;
/// Pixels from a panel's edge to the labels beside it, crossed by the thin lines that lead there.
const LEADER: f64 = 16.0;
/// The smallest size of a panel with equal scales, pixels.
const MIN_SIZE: [f64; 2] = [240.0, 160.0];

/// A figure.
#[derive(Default)]
pub struct Chart {
    pub title: String,
    /// The entries below the title, in as many lines as they need. One whose line or area is in no panel is not drawn.
    pub legend: Vec<LegendEntry>,
    /// The titles of x and y: at each panel of a single column, else once for all panels.
    pub titles: [String; 2],
    /// The panels, in rows of [`Chart::columns`]. With more than one column, the panels of a column have the
    /// same x axis.
    pub panels: Vec<Panel>,
    pub columns: usize,
    /// Whether each panel of a row has a y axis of its own; else all have that of the first.
    pub own_y: bool,
    /// The text below everything; may be empty.
    pub note: String,
    /// Whether x is the time of all panels, which a page marks on the clock of its player.
    pub over_time: bool,
}

/// Marks on two axes.
pub struct Panel {
    /// May be empty.
    pub title: String,
    /// The largest width, pixels; infinite to take all the room.
    pub width: f64,
    /// The smallest height, pixels; it grows where the labels need more.
    pub height: f64,
    /// The axes along x and y.
    pub axes: [ChartAxis; 2],
    /// Whether a unit has the same length along both axes. The axes then grow, or the panel shrinks.
    pub equal_scales: bool,
    /// Whether the panel is placed close below the one before and has the same x axis.
    pub joined: bool,
    /// The marks, in the order they are painted.
    pub marks: Vec<Mark>,
    /// The entries beside the panel, from the top down. Not to be confused with the labels of lines, which
    /// are placed at their lines' ends.
    pub keys: Vec<LegendEntry>,
}

impl Chart {
    /// The SVG file.
    pub fn draw(self) -> String {
        self.drawn(false)
    }

    /// The same for a page whose script links engines and values.
    pub fn draw_linked(self) -> String {
        self.drawn(true)
    }

    fn drawn(mut self, linked: bool) -> String {
        self.legend
            .retain(|key| self.panels.iter().any(|panel| panel.shows(key)));
        for panel in &mut self.panels {
            let keys = std::mem::take(&mut panel.keys);
            panel.keys = keys.into_iter().filter(|key| panel.shows(key)).collect();
        }
        let mut canvas = Canvas::new(linked);
        canvas.text([LEFT, 24.0], Align::Start, 15.0, INK, &self.title);
        let mut top = self.legend(&mut canvas);
        let columns = self.columns.max(1);
        // The gap between panels of one row is larger where each has tick labels.
        let gap = if self.own_y { 56.0 } else { 18.0 };
        let labels = self
            .panels
            .iter()
            .flat_map(Panel::labels)
            .map(LegendEntry::width);
        let labels = labels.fold(0.0, |most, text| f64::max(most, LEADER + SWATCH + text));
        let gaps = gap * (columns - 1) as f64;
        let room = (WIDTH - LEFT - f64::max(12.0, labels) - gaps) / columns as f64;
        for panel in &mut self.panels {
            panel.fit(room);
        }
        let lines = self.panels.iter().flat_map(|panel| &panel.marks);
        let lines = lines.filter(|mark| matches!(mark, Mark::Line(_))).count();
        let budget = (POINTS / lines.max(1)).clamp(16, 1_000);

        let stacks: Vec<&[Panel]> = self.panels.chunk_by(|_, next| next.joined).collect();
        // The windows that have axis titles: each stack of a single column, or all panels together.
        let mut titled: Vec<Window> = Vec::new();
        for (row, in_row) in stacks.chunks(columns).enumerate() {
            if in_row.iter().any(|stack| !stack[0].title.is_empty()) {
                top += 16.0;
            }
            let (mut left, mut end) = (LEFT, top);
            for (column, stack) in in_row.iter().enumerate() {
                let (right, bottom) = (left, top);
                let mut w = Window {
                    left,
                    top,
                    right,
                    bottom,
                };
                for (at, panel) in stack.iter().enumerate() {
                    let start = if at == 0 { top } else { w.bottom + 8.0 };
                    (w.right, w.bottom) = (left + panel.width, start + panel.height);
                    let window = Window { top: start, ..w };
                    let has_below = (row + 1) * columns + column < stacks.len() && columns > 1;
                    let ticks = Ticks {
                        left: column == 0 || self.own_y,
                        below: !has_below && at + 1 == stack.len(),
                        overhang: gap / 3.0,
                    };
                    end = end.max(panel.draw(&mut canvas, window, ticks, budget) - BELOW);
                }
                end = end.max(w.bottom);
                left = w.right + gap;
                match titled.last_mut().filter(|_| columns > 1) {
                    Some(all) => (all.right, all.bottom) = (all.right.max(w.right), w.bottom),
                    None => titled.push(w),
                }
            }
            let is_last = (row + 1) * columns >= stacks.len();
            top = end + if columns == 1 || is_last { BELOW } else { 12.0 };
        }
        if linked && self.over_time {
            canvas.attributes = self.clock(&titled);
        }
        for w in titled {
            let [x, y] = [(w.left + w.right) / 2.0, (w.top + w.bottom) / 2.0];
            let (below, beside) = ([x, w.bottom + 34.0], [w.left - 66.0, y]);
            canvas.text(below, Align::Middle, 12.0, FAINT, &self.titles[0]);
            canvas.text(beside, Align::Upward, 12.0, FAINT, &self.titles[1]);
        }
        if !self.note.is_empty() {
            canvas.text([LEFT, top + 8.0], Align::Start, 11.0, FAINT, &self.note);
            top += 16.0;
        }
        canvas.finish(WIDTH, top + 2.0, &self.title)
    }

    /// Where the time is along x, for a page: nothing where panels differ in that.
    fn clock(&self, windows: &[Window]) -> String {
        let ([first, ..], [w, ..]) = (&self.panels[..], windows) else {
            return String::new();
        };
        let [from, to] = first.axes[0].range;
        if self
            .panels
            .iter()
            .any(|panel| panel.axes[0].range != [from, to])
        {
            return String::new();
        }
        let bottom = windows.iter().map(|w| w.bottom).fold(w.bottom, f64::max);
        format!(
            r#" data-time="{from},{to},{},{}" data-top="{}" data-bottom="{bottom}" data-value="{}""#,
            w.left,
            w.right,
            w.top,
            attribute(&self.titles[1])
        )
    }

    /// Draws the legend and returns the top of the panels, pixels.
    fn legend(&self, canvas: &mut Canvas) -> f64 {
        let (mut x, mut y) = (LEFT, 46.0);
        for key in &self.legend {
            let look = match key.look {
                Look::Line(_) | Look::Marked(..) => SWATCH,
                Look::Symbol(_) | Look::Fill(_) => 12.0,
                Look::Remark => 0.0,
            };
            if x > LEFT && x + look + key.width() > WIDTH {
                (x, y) = (LEFT, y + 20.0);
            }
            key.draw(canvas, [x, y], look);
            x += look + key.width() + 8.0;
        }
        y + if self.legend.is_empty() { -6.0 } else { 21.0 }
    }
}

/// The sides of a panel with tick labels, and how many pixels the labels below may reach past its edges.
struct Ticks {
    left: bool,
    below: bool,
    overhang: f64,
}

impl Panel {
    /// A panel as wide as there is room, without keys.
    pub fn new(title: String, height: f64, axes: [ChartAxis; 2], marks: Vec<Mark>) -> Panel {
        Panel {
            title,
            width: f64::INFINITY,
            height,
            axes,
            equal_scales: false,
            joined: false,
            marks,
            keys: Vec::new(),
        }
    }

    /// Whether it has a mark of this look. A symbol stands for marks of any colour: who names it has seen to it.
    fn shows(&self, key: &LegendEntry) -> bool {
        self.marks.iter().any(|mark| match (key.look, mark) {
            (Look::Remark | Look::Symbol(_), _) => true,
            (Look::Line(stroke) | Look::Marked(stroke, _), Mark::Line(line)) => {
                let alike = [line.stroke.colour, line.stroke.dash] == [stroke.colour, stroke.dash];
                alike && !line.points.is_empty()
            }
            (Look::Line(look), Mark::Segments(stroke, segments)) => {
                *stroke == look && !segments.is_empty()
            }
            (Look::Fill(colour), Mark::Area(of, areas)) => *of == colour && !areas.is_empty(),
            (Look::Fill(colour), Mark::Triangles(of, triangles)) => {
                *of == colour && !triangles.is_empty()
            }
            _ => false,
        })
    }

    /// All labels beside the panel.
    fn labels(&self) -> impl Iterator<Item = &LegendEntry> {
        let labels = self.marks.iter().filter_map(Mark::label);
        labels.chain(&self.keys)
    }

    /// Gives the panel its final size, at most `room` pixels wide.
    fn fit(&mut self, room: f64) {
        self.width = self.width.min(room);
        let lines = self.labels().count() - self.keys.len();
        self.height = self.height.max((lines as f64 + 0.5) * PITCH);
        if !self.equal_scales {
            return;
        }
        let (space, ranges) = ([self.width, self.height], self.axes.map(|axis| axis.range));
        let spans = ranges.map(|[lo, hi]| hi - lo);
        let scale = f64::min(space[0] / spans[0], space[1] / spans[1]);
        let size = [0, 1].map(|a| (spans[a] * scale).max(MIN_SIZE[a]).min(space[a]));
        let grown = |a: usize| {
            let ([lo, hi], half) = (ranges[a], size[a] / scale / 2.0);
            let middle = lo / 2.0 + hi / 2.0;
            ChartAxis::linear([middle - half, middle + half])
        };
        ([self.width, self.height], self.axes) = (size, [grown(0), grown(1)]);
    }

    /// Draws the panel and returns the bottom of its labels, pixels: below the window where not all fit.
    fn draw(&self, canvas: &mut Canvas, window: Window, ticks: Ticks, budget: usize) -> f64 {
        if !self.title.is_empty() {
            let size = if self.width < 300.0 { 11.0 } else { 12.0 };
            let at = [window.left, window.top - 7.0];
            canvas.text(at, Align::Start, size, INK, &self.title);
        }
        let axes = self.axes;
        let frame = Frame { window, axes };
        grid(canvas, &frame, ticks);
        let mut notes: Vec<(&LegendEntry, Option<Anchor>)> = Vec::new();
        for mark in &self.marks {
            let anchor = frame.draw(canvas, mark, budget);
            let label = mark.label().filter(|_| anchor.is_some());
            notes.extend(label.map(|key| (key, anchor)));
        }
        notes.extend(self.keys.iter().map(|key| (key, None)));
        let corner = [window.left, window.top];
        canvas.rectangle(corner, window.size(), "none", FAINT);
        beside(canvas, notes, window)
    }
}

/// Grid lines and ticks along both axes.
fn grid(canvas: &mut Canvas, frame: &Frame, ticks: Ticks) {
    let (w, [width, height]) = (frame.window, frame.window.size());
    let colour = |value| if value == 0.0 { "#b4b4b4" } else { "#e4e4e4" };
    // Small panels have their ticks closer together.
    let apart = (width / 8.0).clamp(42.0, 75.0);
    for (value, label) in frame.axes[0].ticks((width / apart) as usize) {
        let [x, _] = frame.place([value, 0.0]);
        canvas.line([x, w.top], [x, w.bottom], colour(value), 1.0);
        canvas.line([x, w.bottom], [x, w.bottom + 4.0], FAINT, 1.0);
        if ticks.below {
            // Labels are pushed inward at the edges, where the next panel's labels begin.
            let half = 3.3 * label.chars().count() as f64 - ticks.overhang;
            let x = x.max(w.left + half).min(w.right - half);
            canvas.text([x, w.bottom + 16.0], Align::Middle, 11.0, INK, &label);
        }
    }
    let apart = (height / 5.0).clamp(17.0, 32.0);
    for (value, label) in frame.axes[1].ticks((height / apart) as usize) {
        let [_, y] = frame.place([0.0, value]);
        canvas.line([w.left, y], [w.right, y], colour(value), 1.0);
        canvas.line([w.left - 4.0, y], [w.left, y], FAINT, 1.0);
        if ticks.left {
            canvas.text([w.left - 7.0, y + 4.0], Align::End, 11.0, INK, &label);
        }
    }
}

/// Draws labels right of a window, each as near to its point as the others allow, those without a point
/// from the top down. Returns their bottom, pixels: below the window where not all fit.
fn beside(canvas: &mut Canvas, mut notes: Vec<(&LegendEntry, Option<Anchor>)>, w: Window) -> f64 {
    let wish = |anchor: &Option<Anchor>| anchor.map_or(w.top, |anchor| anchor.point[1]);
    notes.sort_by(|(_, a), (_, b)| wish(a).total_cmp(&wish(b)));
    let wishes: Vec<f64> = notes.iter().map(|(_, anchor)| wish(anchor)).collect();
    let places = spread(&wishes, w.top + PITCH / 2.0, w.bottom - PITCH / 2.0);
    let start = w.right + LEADER;
    for ((key, anchor), place) in notes.iter().zip(&places) {
        if let Some(Anchor { point, .. }) = anchor.filter(|anchor| anchor.led) {
            let [x, y] = point;
            if x + 5.0 < w.right {
                canvas.line([x + 5.0, y], [w.right, y], FAINT, 0.3);
            }
            canvas.line([w.right + 1.0, y], [start, *place], FAINT, 0.6);
        }
        key.draw(canvas, [start, *place], SWATCH);
    }
    places.last().map_or(w.top, |last| last + PITCH)
}

/// Places near the sorted wishes, at least [`PITCH`] apart and within the bounds. One pass down and one pass
/// up move them. Where they do not fit, they run over the lower bound.
fn spread(wishes: &[f64], top: f64, bottom: f64) -> Vec<f64> {
    let mut places = wishes.to_vec();
    let mut limit = top;
    for place in &mut places {
        *place = place.max(limit);
        limit = *place + PITCH;
    }
    let mut limit = bottom.max(top + PITCH * wishes.len().saturating_sub(1) as f64);
    for place in places.iter_mut().rev() {
        *place = place.min(limit);
        limit = *place - PITCH;
    }
    places
}

#[cfg(test)]
mod tests {
    use super::super::canvas::Stroke;
    use super::*;

    #[test]
    fn a_legend_names_nothing_that_is_not_drawn() {
        let stroke = |colour| Stroke::new(colour, "", 1.5);
        let axes = [ChartAxis::linear([0.0, 1.0]); 2];
        let marks = vec![
            Mark::line([[0.0, 0.0], [1.0, 1.0]], stroke("#111111")),
            Mark::line([], stroke("#222222")),
            Mark::Area("#333333", vec![[[0.0, 0.0], [1.0, 1.0]]]),
            Mark::Area("#444444", Vec::new()),
        ];
        let lines = ["#111111", "#222222"].map(|c| LegendEntry::new(c, Look::Line(stroke(c))));
        let areas = ["#333333", "#444444"].map(|c| LegendEntry::new(c, Look::Fill(c)));
        let chart = Chart {
            legend: lines.into_iter().chain(areas).collect(),
            panels: vec![Panel::new(String::new(), 100.0, axes, marks)],
            ..Chart::default()
        };
        let svg = chart.draw();
        let named = |text: &str| svg.contains(&format!(">{text}<"));
        let shown = ["#111111", "#222222", "#333333", "#444444"].map(named);
        assert_eq!(shown, [true, false, true, false]);
    }
}
