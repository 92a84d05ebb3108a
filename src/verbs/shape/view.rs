//! The view of a scene: the two axes that show most of it, or all three on a slant.

use crate::report::svg::range;
use crate::report::words;
use crate::scene::Axis;

/// The titles of charts' axes, by the coordinate along them.
pub const AXIS_TITLES: [&str; 3] = ["x (m)", "y (m)", "z (m)"];

/// What lies along an axis is invisible if its extent is below this fraction of the others'.
const FLAT: f64 = 0.02;

/// How far a metre into the picture goes to the right and up: half a metre, at 30 degrees (cabinet projection). No
/// two points of a small grid coincide then, as they do in an isometric view.
const SLANT: [f64; 2] = [0.433, 0.25];

/// The two coordinates that show a motion or a shape of these extents, m, along x, y and z. `up` is vertical where
/// there is an extent along it, and the wider of the other two is horizontal; else they are those two.
pub fn plane(up: Axis, extents: [f64; 3]) -> [usize; 2] {
    let up = up.index();
    let [first, second] = match up {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    };
    if extents[up] < FLAT * extents[first].min(extents[second]) {
        [first, second]
    } else if extents[second] > extents[first] {
        [second, up]
    } else {
        [first, up]
    }
}

/// A parallel projection onto the picture.
pub struct View {
    /// The coordinates to the right and upward, true to scale.
    pub plane: [usize; 2],
    /// The coordinate into the picture; None where the points hardly differ in it.
    depth: Option<Depth>,
}

struct Depth {
    axis: usize,
    /// Its values at the front and at the back, m.
    ends: [f64; 2],
}

impl View {
    /// The view of these points, m.
    pub fn new(up: Axis, points: impl Iterator<Item = [f64; 3]> + Clone) -> Self {
        let ranges = [0, 1, 2].map(|axis| range(points.clone().map(|point| point[axis])));
        let ranges = ranges.map(Option::unwrap_or_default);
        let extents = ranges.map(|[low, high]| high - low);
        let plane = plane(up, extents);
        let axis = 3 - plane[0] - plane[1];
        let deep = extents[axis] > FLAT * extents[plane[0]].max(extents[plane[1]]);
        let depth = deep.then(|| {
            // Right, up and towards the reader are right-handed.
            let grows_to_front = (plane[0] + 1) % 3 == plane[1];
            let [low, high] = ranges[axis];
            let ends = if grows_to_front {
                [high, low]
            } else {
                [low, high]
            };
            Depth { axis, ends }
        });
        Self { plane, depth }
    }

    /// The place of a point, m: its own coordinates where the view is flat or the point is at the front.
    pub fn place(&self, point: [f64; 3]) -> [f64; 2] {
        let back = self.depth.as_ref().map_or(0.0, |depth| {
            (point[depth.axis] - depth.ends[0]) * (depth.ends[1] - depth.ends[0]).signum()
        });
        [0, 1].map(|along| point[self.plane[along]] + SLANT[along] * back)
    }

    /// What the axes do not show, in two sentences; empty for a flat view.
    pub fn sentences(&self) -> String {
        let Some(Depth { axis, ends }) = &self.depth else {
            return String::new();
        };
        let name = ["x", "y", "z"][*axis];
        // What is 0 but for rounding is 0.
        let size = f64::max(ends[0].abs(), ends[1].abs());
        let told = |end: f64| if end.abs() < 1e-9 * size { 0.0 } else { end };
        let [front, back] = ends.map(|end| words::short(told(end)));
        format!(
            "Oblique view: {name} goes from {front} m at the front to {back} m at the back, drawn at half its \
             length. The axes hold at the front."
        )
    }

    /// The edge into the picture on the lower right of the box around these points; None for a flat view.
    pub fn edge(&self, points: impl Iterator<Item = [f64; 3]> + Clone) -> Option<[[f64; 2]; 2]> {
        let depth = self.depth.as_ref()?;
        let along = |axis: usize| range(points.clone().map(|point| point[axis]));
        let [right, up] = self.plane.map(along);
        let mut corner = [0.0; 3];
        (corner[self.plane[0]], corner[self.plane[1]]) = (right?[1], up?[0]);
        Some(depth.ends.map(|end| {
            corner[depth.axis] = end;
            self.place(corner)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// Whatever is up and whatever is wide: right, up and towards the reader are right-handed, two axes are true to
    /// scale, and what is towards the reader is lower left.
    #[test]
    fn a_view_is_right_handed() {
        for up in [Axis::X, Axis::Y, Axis::Z] {
            for wide in 0..3 {
                let mut far = [1.0, 1.0, 1.0];
                far[wide] = 3.0;
                let view = View::new(up, [[0.0; 3], far].into_iter());
                let [right, upward] = view.plane;
                assert_eq!(upward, up.index());
                let unit = |axis| Vector3::ith(axis, 1.0);
                let towards = unit(right).cross(&unit(upward));
                let move_of = |step: Vector3<f64>| {
                    let [from, to] = [[0.0; 3], step.into()].map(|point| view.place(point));
                    [to[0] - from[0], to[1] - from[1]]
                };
                assert_eq!(move_of(unit(right)), [1.0, 0.0]);
                assert_eq!(move_of(unit(upward)), [0.0, 1.0]);
                let [x, y] = move_of(towards);
                assert!(x < 0.0 && y < 0.0, "{up:?} {wide}");
                // Half its length; SLANT has three digits.
                assert!((x.hypot(y) - 0.5).abs() < 5e-4);
                // A point at the front has its own coordinates.
                let front = if towards.sum() > 0.0 { far } else { [0.0; 3] };
                assert_eq!(view.place(front), view.plane.map(|axis| front[axis]));
            }
        }
    }

    /// What hardly extends along an axis is seen along that axis.
    #[test]
    fn what_is_flat_is_seen_from_its_side() {
        for (far, plane) in [
            ([1.0, 1.0, 0.01], [0, 1]),
            ([1.0, 0.01, 1.0], [0, 2]),
            ([0.01, 1.0, 1.0], [1, 2]),
            ([0.0, 1.0, 0.0], [1, 2]),
            ([0.0, 0.0, 1.0], [0, 2]),
            ([0.0, 0.0, 0.0], [0, 2]),
        ] {
            let view = View::new(Axis::Z, [[0.0; 3], far].into_iter());
            assert_eq!((view.plane, view.sentences()), (plane, String::new()));
            assert_eq!(view.place(far), plane.map(|axis| far[axis]));
        }
    }
}
