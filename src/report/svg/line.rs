//! From points to the `d` attribute of a path: thinned, cut at the panel's edge, rounded.

use super::canvas::px;

/// At most about `budget` of the points' indices, both ends and, in each stretch of the series, the
/// smallest and largest of every coordinate: no peak is lost.
pub fn thinned<const N: usize>(points: &[[f64; N]], budget: usize) -> Vec<usize> {
    if points.len() <= budget.max(2) {
        return (0..points.len()).collect();
    }
    let stretches = (budget / (2 * N)).max(1);
    let mut kept = vec![0, points.len() - 1];
    for stretch in 0..stretches {
        let bounds = [stretch, stretch + 1].map(|s| s * points.len() / stretches);
        for axis in std::array::from_fn::<usize, N, _>(|axis| axis) {
            let by = |a: &usize, b: &usize| points[*a][axis].total_cmp(&points[*b][axis]);
            kept.extend((bounds[0]..bounds[1]).min_by(by));
            kept.extend((bounds[0]..bounds[1]).max_by(by));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
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
    pub fn holds(&self, [x, y]: [f64; 2]) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
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

/// The points up to the first that lies more than a window's size outside: what returns from there
/// would only cross the picture again and again.
pub fn until_far(mut points: Vec<[f64; 2]>, window: Window) -> Vec<[f64; 2]> {
    let (width, height) = (window.right - window.left, window.bottom - window.top);
    let near = Window {
        left: window.left - width,
        top: window.top - height,
        right: window.right + width,
        bottom: window.bottom + height,
    };
    if let Some(far) = points.iter().position(|p| !near.holds(*p)) {
        points.truncate(far + 1);
    }
    points
}

/// A drawn line: its path, and the last point of it inside the window.
pub struct Drawn {
    pub data: String,
    pub end: Option<[f64; 2]>,
}

/// The points, joined and cut at the window. Empty if none is inside.
pub fn draw(points: &[[f64; 2]], window: Window) -> Drawn {
    let mut data = String::new();
    // Where the pen is, as written.
    let mut pen: Option<[String; 2]> = None;
    let mut end = None;
    if let [only] = points
        && window.holds(*only)
    {
        let [x, y] = only.map(px);
        return Drawn {
            data: format!("M{x} {y}h0"),
            end: Some(*only),
        };
    }
    for pair in points.windows(2) {
        let Some([a, b]) = window.cut(pair[0], pair[1]) else {
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
    Drawn { data, end }
}
