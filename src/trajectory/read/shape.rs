//! Shapes of arrays, and the coordinates they leave out.

use super::error::Wrong;
use super::expected::Expected;

const NONE: &str = "expected at least one instant, found none";

/// What one instant of an array holds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Shape {
    instants: usize,
    /// The coordinates given, in order: all, those of free particles, or the one on the free axis.
    coordinates: Vec<usize>,
}

impl Shape {
    /// Whether this array, of positions or velocities of this scene, can have this shape.
    pub fn new(name: &str, shape: &[usize], expected: &Expected) -> Result<Self, Wrong> {
        let of = |particles: &[usize]| -> Vec<usize> {
            particles
                .iter()
                .flat_map(|id| [3 * id, 3 * id + 1, 3 * id + 2])
                .collect()
        };
        let n = expected.particles();
        let all: Vec<usize> = (0..n).collect();
        let free = expected.free();
        let found = match (shape, expected.only(), expected.free_axis) {
            (&[t, k, 3], ..) if k == n => Some((t, of(&all))),
            (&[t, k, 3], ..) if k == free.len() => Some((t, of(&free))),
            (&[t, 3], Some(only), _) => Some((t, of(&[only]))),
            (&[t], _, Some(free)) => Some((t, vec![free.coordinate()])),
            _ => None,
        };
        match found {
            Some((0, _)) => Err(Wrong::new(NONE, "")),
            Some((instants, coordinates)) => Ok(Self {
                instants,
                coordinates,
            }),
            None => Err(Wrong::new(
                format!("expected the shape (T, {n}, 3), found {}", tuple(shape)),
                remedy(name, shape, n),
            )),
        }
    }

    /// Times are one number an instant.
    pub fn of_times(shape: &[usize]) -> Result<Self, Wrong> {
        match *shape {
            [0] => Err(Wrong::new(NONE, "")),
            [instants] => Ok(Self {
                instants,
                coordinates: vec![0],
            }),
            _ => Err(Wrong::new(
                format!("expected the shape (T,), found {}", tuple(shape)),
                "t.ravel() makes it so",
            )),
        }
    }

    pub fn instants(&self) -> usize {
        self.instants
    }

    /// Whole states from what is given, the rest as `state` has it.
    pub fn fill(&self, values: Vec<f64>, state: &[f64]) -> Vec<f64> {
        if self.coordinates.len() == state.len() {
            return values;
        }
        let mut whole = state.repeat(self.instants);
        let given = values.chunks_exact(self.coordinates.len());
        for (state, given) in whole.chunks_exact_mut(state.len()).zip(given) {
            for (at, value) in self.coordinates.iter().zip(given) {
                state[*at] = *value;
            }
        }
        whole
    }
}

/// As Python writes it.
pub(super) fn tuple(shape: &[usize]) -> String {
    match shape {
        [one] => format!("({one},)"),
        _ => {
            let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
            format!("({})", sizes.join(", "))
        }
    }
}

/// What the array probably is, in NumPy's words.
fn remedy(x: &str, shape: &[usize], n: usize) -> String {
    match *shape {
        [_, k] if k == 3 * n => format!("{x}.reshape(-1, {n}, 3) makes it so"),
        [a, 3, _] if a == n => format!("{x}.transpose(2, 0, 1) makes it so"),
        [3, b, _] if b == n => format!("{x}.transpose(2, 1, 0) makes it so"),
        [a, _, 3] if a == n => format!("{x}.transpose(1, 0, 2) makes it so"),
        [_, 3, b] if b == n => format!("{x}.transpose(0, 2, 1) makes it so"),
        _ => format!("instants, then the scene's {n} particles, then x, y, z"),
    }
}
