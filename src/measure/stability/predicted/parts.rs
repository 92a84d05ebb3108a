//! x'' = -K x - C v of a scene about a state, mass-normalised, and the parts of it that do not couple.

use super::part::{Matrix, Part, SYMMETRIC};
use super::rods::{OnRods, Row, along, on_rods, stabilised};
use crate::joined::least_joined;
use crate::physics::{Jacobian, Linearization, State, System, Triplets};

/// A scene in parts.
pub(super) struct Parts {
    /// Largest first, equal ones together.
    pub all: Vec<Part>,
    /// Whether rods couple more coordinates than were asked for; those are in no part.
    pub left_out: bool,
    /// Whether damping multiplies all velocities alike.
    pub uniform: bool,
}

/// The scene's parts about a state; None where a derivative is not finite. Rods that couple more than `most`
/// coordinates are left out.
pub(super) fn parts<S: System + ?Sized>(system: &S, state: &State, most: usize) -> Option<Parts> {
    let State { t, x, v, .. } = state;
    let inverse_mass = system.inverse_mass();
    let n = system.dim();
    let (exact, rows) = derivatives(system, state, x)?;
    let mut material = Jacobian::default();
    system.jacobian(*t, x, v, Linearization::Material, &mut material);
    let scaled = |triplets: &Triplets| scaled(n, inverse_mass, triplets);
    let whole = [
        scaled(&exact.position)?,
        scaled(&exact.velocity)?,
        scaled(&material.position)?,
    ];
    // The same one rounding away, in directions that stretch what lies along an axis.
    let signs = [2.0, -2.0, 2.0, -2.0, 2.0, -2.0, -2.0].into_iter().cycle();
    let away = x.iter().zip(signs);
    let away: Vec<f64> = away.map(|(x, sign)| x + sign * f64::EPSILON * x).collect();
    let (there, _) = derivatives(system, state, &away)?;
    let moved = whole[0].combined(1.0, &scaled(&there.position)?, -1.0);
    let uniform = is_uniform(&whole[1], inverse_mass);
    let separated = separate(&driven(whole, &rows), &moved, inverse_mass, &rows);
    let mut left_out = false;
    let mut all = Vec::new();
    for (part, rows) in separated {
        if rows.is_empty() {
            all.push(part);
        } else if part.n() > most {
            left_out = true;
        } else {
            all.extend(along(&part, &rows));
        }
    }
    all.extend(system.rods().and_then(stabilised));
    all.sort_by(Part::order);
    all.dedup_by(|next, kept| {
        let same = next.matrices() == kept.matrices();
        kept.copies += usize::from(same);
        same
    });
    Some(Parts {
        all,
        left_out,
        uniform,
    })
}

/// Whether a damping, mass-normalised, is a multiple of 1 on the free coordinates.
fn is_uniform(damping: &Matrix, inverse_mass: &[f64]) -> bool {
    let mut free = (0..damping.n()).filter(|&i| inverse_mass[i] > 0.0);
    let rate = free.clone().next().map_or(0.0, |i| damping.at(i, i));
    let near = |value: f64, wanted: f64| (value - wanted).abs() <= SYMMETRIC * rate.abs();
    free.all(|i| near(damping.at(i, i), rate))
        && damping
            .entries()
            .all(|(i, j, value)| i == j || near(value, 0.0))
}

/// ∂f/∂x and ∂f/∂v at `x`, with what tensions of rods do to the first, and the rods' rows.
fn derivatives<S: System + ?Sized>(
    system: &S,
    State { t, v, .. }: &State,
    x: &[f64],
) -> Option<(Jacobian, Vec<Row>)> {
    let mut exact = Jacobian::default();
    system.jacobian(*t, x, v, Linearization::Exact, &mut exact);
    let Some(rods) = system.rods() else {
        return Some((exact, Vec::new()));
    };
    let OnRods { rows, turning } = on_rods(system, rods, *t, x)?;
    exact.position.extend(turning);
    Some((exact, rows))
}

/// -M^(-1/2) D M^(-1/2) over the free coordinates, without what is only a rounding of its
/// neighbours: directions such as cos(π/2) would couple axes that do not couple.
fn scaled(n: usize, inverse_mass: &[f64], triplets: &Triplets) -> Option<Matrix> {
    let mut entries = Vec::new();
    for &(row, column, value) in triplets {
        let weight = inverse_mass[row] * inverse_mass[column];
        if weight > 0.0 {
            let value = -value * weight.sqrt();
            if !value.is_finite() {
                return None;
            }
            entries.push((row, column, value));
        }
    }
    let matrix = Matrix::new(n, entries);
    // The largest of a particle's three.
    let size = |i: usize| {
        let own = 3 * (i / 3)..(3 * (i / 3) + 3).min(n);
        own.map(|i| matrix.at(i, i).abs()).fold(0.0, f64::max)
    };
    let sizes: Vec<f64> = (0..n).map(size).collect();
    let kept = matrix
        .entries()
        .filter(|&(i, j, v)| v.abs() > f64::EPSILON * (sizes[i] * sizes[j]).sqrt());
    Some(Matrix::new(n, kept))
}

/// A time, s, no longer than the shortest time scale of the forces about a state: from the row sums of the
/// Jacobians (Gershgorin). None where no force depends on the state.
///
/// Entries are scaled once they are summed, unlike those of [`parts`]: a search starts from this time, and
/// what a chaotic scene does at a step depends on its last bit.
pub(in crate::measure::stability) fn shortest<S: System + ?Sized>(
    system: &S,
    state: &State,
) -> Option<f64> {
    let (jacobian, _) = derivatives(system, state, &state.x)?;
    let weights = system.inverse_mass();
    let largest = |triplets: &Triplets| {
        let mut matrix = Matrix::new(system.dim(), triplets.iter().copied());
        for (row, entries) in matrix.rows.iter_mut().enumerate() {
            for (column, value) in entries {
                *value *= (weights[row] * weights[*column]).sqrt();
            }
        }
        matrix.norm()
    };
    let rate = largest(&jacobian.position)
        .sqrt()
        .max(largest(&jacobian.velocity));
    (rate > 0.0 && rate.is_finite()).then(|| 1.0 / rate)
}

/// The matrices without the columns of coordinates that no force moves, those of rods included: such a one drives
/// others and nothing drives it, so eigenvalues are those of the rest.
fn driven(mut whole: [Matrix; 3], rows: &[Row]) -> [Matrix; 3] {
    let mut held = vec![false; whole[0].n()];
    for (at, _) in rows.iter().flatten() {
        held[*at] = true;
    }
    loop {
        let moved = |i: usize| held[i] || whole.iter().any(|matrix| !matrix.rows[i].is_empty());
        let moved: Vec<bool> = (0..whole[0].n()).map(moved).collect();
        let count = |whole: &[Matrix; 3]| whole.iter().flat_map(Matrix::entries).count();
        let before = count(&whole);
        whole = whole.map(|matrix| {
            let kept = matrix.entries().filter(|(_, column, _)| moved[*column]);
            Matrix::new(matrix.n(), kept)
        });
        if count(&whole) == before {
            return whole;
        }
    }
}

/// Splits by what is coupled, each part with its rods; fixed coordinates are in no part. `moved` is what rounding
/// moves K by.
fn separate(
    whole: &[Matrix; 3],
    moved: &Matrix,
    inverse_mass: &[f64],
    rows: &[Row],
) -> Vec<(Part, Vec<Row>)> {
    let n = inverse_mass.len();
    let forces = whole.iter().flat_map(Matrix::entries);
    let forces = forces.map(|(row, column, _)| [row, column]);
    let rods = rows
        .iter()
        .flat_map(|row| row.windows(2).map(|two| [two[0].0, two[1].0]));
    let least = least_joined(n, forces.chain(rods));
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); n];
    let mut place = vec![0; n];
    for i in (0..n).filter(|&i| inverse_mass[i] > 0.0) {
        let at = least[i];
        place[i] = members[at].len();
        members[at].push(i);
    }
    // The rods of each part.
    let mut held: Vec<Vec<Row>> = vec![Vec::new(); n];
    for row in rows {
        if let Some((first, _)) = row.first() {
            let of = |&(at, entry): &(usize, f64)| (place[at], entry);
            held[least[*first]].push(row.iter().map(of).collect());
        }
    }
    let part = |(coordinates, rows): (&Vec<usize>, Vec<Row>)| {
        let of = |matrix: &Matrix| matrix.part(coordinates, &place);
        (
            Part::new(whole.each_ref().map(of), of(moved).norm(), 1),
            rows,
        )
    };
    let each = members.iter().zip(held);
    let each = each.filter(|(coordinates, _)| !coordinates.is_empty());
    each.map(part).collect()
}
