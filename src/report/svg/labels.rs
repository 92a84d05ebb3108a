//! Labels at the right edge, each beside the end of its line, none over another.

use super::canvas::{Anchor, Canvas, FAINT, INK, Mark, Stroke};

/// Pixels from one label's baseline to the next.
pub const PITCH: f64 = 16.0;
/// Length of the piece of line before a label.
const SWATCH: f64 = 22.0;
/// Pixels from the panel's edge to the swatch, crossed by the leader.
const LEADER: f64 = 16.0;
const SIZE: f64 = 12.0;

/// What stands beside one line.
pub struct Label {
    pub text: String,
    pub stroke: Stroke,
    /// Of the line's points, where they are marked.
    pub mark: Option<Mark>,
    /// Height at which the line reaches the panel's right edge; `None` if it ends before.
    pub exit: Option<f64>,
    /// Where the label would like to stand.
    pub wish: f64,
}

/// Pixels the labels need to the right of the panel.
pub fn margin<'a>(texts: impl IntoIterator<Item = &'a str>) -> f64 {
    let longest = texts
        .into_iter()
        .map(|t| t.chars().count())
        .max()
        .unwrap_or(0);
    LEADER + SWATCH + 6.0 + 6.9 * longest as f64 + 10.0
}

/// Draws the labels at `x`, within `top` to `bottom` as far as they fit.
pub fn draw(canvas: &mut Canvas, mut labels: Vec<Label>, x: f64, top: f64, bottom: f64) {
    labels.sort_by(|a, b| a.wish.total_cmp(&b.wish));
    let wishes: Vec<f64> = labels.iter().map(|l| l.wish).collect();
    let places = spread(&wishes, top + PITCH / 2.0, bottom - PITCH / 2.0);
    for (label, y) in labels.iter().zip(places) {
        if let Some(exit) = label.exit {
            canvas.line([x + 1.0, exit], [x + LEADER, y], FAINT, 0.6);
        }
        let [from, to] = [x + LEADER, x + LEADER + SWATCH];
        let data = format!("M{from:.1} {y:.1}L{to:.1} {y:.1}");
        canvas.path(&data, label.stroke);
        if let Some(mark) = label.mark {
            let colour = label.stroke.colour;
            canvas.mark([(from + to) / 2.0, y], mark, colour, colour);
        }
        canvas.text([to + 6.0, y + 4.0], Anchor::Start, SIZE, INK, &label.text);
    }
}

/// Sorted wishes, moved apart to at least [`PITCH`] and into the bounds, as little as a pass down
/// and a pass up manage. More than fit run over the lower bound.
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
