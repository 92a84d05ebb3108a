//! What a group keeps: contacts that press, and rods, as rows over its scaled coordinates.

use super::super::Obstacles;
use super::super::member::{Contact, unit};
use crate::physics::State;
use crate::physics::constraints::Rods;
use crate::shape::Bend;
use crate::space::{cross, dot, minus, norm, three};
use nalgebra::{DMatrix, DVector};

/// Rows that depend on others to this part add no direction.
pub(super) const DEPENDENT: f64 = 1e-9;

/// A contact that presses, or a rod.
#[derive(Debug, Clone, Copy)]
pub(super) struct Link {
    /// Places in the group; one where the other is an obstacle, or does not move.
    pub(super) ends: [Option<usize>; 2],
    /// From the second to the first, a unit vector.
    pub(super) normal: [f64; 3],
    /// What turning adds to the acceleration along the normal, m/s².
    pub(super) turning: f64,
    pub(super) kept: Kept,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Kept {
    Contact(Contact, Rubs),
    Rod(usize),
}

/// How a contact rubs.
#[derive(Debug, Clone, Copy)]
pub(super) enum Rubs {
    Not,
    /// In this direction.
    Slides([f64; 3]),
    Sticks,
}

/// What links keep, as rows over scaled coordinates, and what that takes.
pub(super) struct Rows {
    /// Normals, and two directions across for each that sticks.
    pub(super) kept: DMatrix<f64>,
    /// For each row its friction, in multiples of its multiplier.
    pub(super) rubs: DMatrix<f64>,
    /// The accelerations along rows by a multiplier of 1 each.
    pub(super) matrix: DMatrix<f64>,
    /// Its inverse.
    pub(super) inverse: DMatrix<f64>,
    /// Where rows depend on each other, and multipliers are not determined, those nearest to these are taken.
    pub(super) about: DVector<f64>,
    pub(super) of: Vec<Row>,
}

/// What a row is of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    /// Its link.
    pub(super) link: usize,
    pub(super) direction: [f64; 3],
    /// Whether that is the normal.
    pub(super) normal: bool,
}

impl Rows {
    pub(super) fn new(links: &[Link], scales: &[f64]) -> Self {
        let size = 3 * scales.len();
        let mut of = Vec::new();
        for (at, link) in links.iter().enumerate() {
            let mut row = |direction, normal| {
                of.push(Row {
                    link: at,
                    direction,
                    normal,
                });
            };
            row(link.normal, true);
            if let Kept::Contact(_, Rubs::Sticks) = link.kept {
                let across = unit(smallest_across(link.normal)).unwrap_or([0.0; 3]);
                row(across, false);
                row(cross(link.normal, across), false);
            }
        }
        let mut kept = DMatrix::zeros(of.len(), size);
        let mut rubs = DMatrix::zeros(of.len(), size);
        for (at, row) in of.iter().enumerate() {
            let link = &links[row.link];
            put(&mut kept, at, link, row.direction, scales);
            // What slides has its normal alone.
            if let Kept::Contact(contact, Rubs::Slides(forward)) = link.kept {
                let against = forward.map(|c| -contact.friction[0] * c);
                put(&mut rubs, at, link, against, scales);
            }
        }
        let matrix = &kept * (&kept + &rubs).transpose();
        Self {
            about: DVector::zeros(of.len()),
            inverse: inverse(matrix.clone()),
            matrix,
            kept,
            rubs,
            of,
        }
    }

    /// The multipliers, m/s² of the first particle's mass, at a scaled acceleration without them.
    pub(super) fn multipliers(
        &self,
        obstacles: &Obstacles,
        links: &[Link],
        t: f64,
        a: &DVector<f64>,
    ) -> DVector<f64> {
        self.nearest(
            &self.about,
            &(self.right(obstacles, links, t) - &self.kept * a),
        )
    }

    /// The multipliers nearest to `about` that give these accelerations along the rows.
    pub(super) fn nearest(&self, about: &DVector<f64>, along: &DVector<f64>) -> DVector<f64> {
        about + &self.inverse * (along - &self.matrix * about)
    }

    /// The accelerations along the rows that are kept.
    pub(super) fn right(&self, obstacles: &Obstacles, links: &[Link], t: f64) -> DVector<f64> {
        let each = self.of.iter().map(|row| {
            let link = &links[row.link];
            let pushed = match link.kept {
                Kept::Contact(contact, _) => obstacles.moved(contact.beside.against, t)[2],
                Kept::Rod(_) => [0.0; 3],
            };
            dot(row.direction, pushed) + if row.normal { link.turning } else { 0.0 }
        });
        DVector::from_iterator(self.of.len(), each)
    }
}

/// The inverse of a matrix; where rows depend on each other, the smallest multipliers.
pub(super) fn inverse(matrix: DMatrix<f64>) -> DMatrix<f64> {
    let (size, largest) = (matrix.nrows(), matrix.amax());
    let zeros = DMatrix::zeros(size, size);
    // An empty matrix has no singular values.
    if largest > 0.0 {
        matrix.pseudo_inverse(DEPENDENT * largest).unwrap_or(zeros)
    } else {
        zeros
    }
}

/// A row: a direction at the first end, and against it at the second.
fn put(rows: &mut DMatrix<f64>, row: usize, link: &Link, direction: [f64; 3], scales: &[f64]) {
    for (end, sign) in link.ends.iter().zip([1.0, -1.0]) {
        if let Some(end) = *end {
            for axis in 0..3 {
                rows[(row, 3 * end + axis)] += sign * direction[axis] / scales[end];
            }
        }
    }
}

/// A vector across another.
fn smallest_across(n: [f64; 3]) -> [f64; 3] {
    let least = |best: usize, c: usize| if n[c].abs() < n[best].abs() { c } else { best };
    let mut other = [0.0; 3];
    other[(0..3).fold(0, least)] = 1.0;
    cross(n, other)
}

/// The same links without friction: normals alone.
pub(super) fn plain(links: &[Link]) -> Vec<Link> {
    let each = links.iter().map(|link| Link {
        kept: match link.kept {
            Kept::Contact(contact, _) => Kept::Contact(contact, Rubs::Not),
            rod @ Kept::Rod(_) => rod,
        },
        ..*link
    });
    each.collect()
}

/// A rod at a state; None where it has no direction.
pub(super) fn rod_now(
    rods: &Rods,
    rod: usize,
    ends: [Option<usize>; 2],
    state: &State,
) -> Option<Link> {
    let [i, j] = rods.ends()[rod];
    let away = minus(three(&state.x, i), three(&state.x, j));
    let velocity = minus(three(&state.v, i), three(&state.v, j));
    let normal = unit(away)?;
    let bend = Bend::Point(norm(away));
    Some(Link {
        ends,
        normal,
        turning: bend.turning(normal, velocity),
        kept: Kept::Rod(rod),
    })
}

/// The multiplier along the normal of a link, and the size of those across.
pub(super) fn pressed(rows: &Rows, multipliers: &DVector<f64>, link: usize) -> (f64, f64) {
    let own: Vec<f64> = rows
        .of
        .iter()
        .zip(multipliers)
        .filter(|(row, _)| row.link == link)
        .map(|(_, multiplier)| *multiplier)
        .collect();
    let across = own[1..].iter().fold(0.0_f64, |sum, c| sum.hypot(*c));
    (own[0], across)
}
