//! Which contacts of a group press, which stick, and which slide.

use super::super::Obstacles;
use super::super::member::unit;
use super::links::{Kept, Link, Rows, Rubs, plain, pressed};
use nalgebra::{DVector, Vector3};

/// Forces below this part of the largest are none.
const NONE: f64 = 1e-12;

/// Reflections on the way to forces that hold.
const REFLECTIONS: usize = 2_000;
/// By which part forces that hold keep from their limits.
const INSIDE: f64 = 1e-3;

/// Of these links the rods, and the contacts that press while no other is pressed into; what sticks beyond its friction
/// slides. Contacts are taken and left one by one, the worst first, unless forces are found that hold all. With them their
/// rows.
pub(super) fn pressing(
    obstacles: &Obstacles,
    links: Vec<Link>,
    scales: &[f64],
    t: f64,
    a: &DVector<f64>,
) -> (Vec<Link>, Rows) {
    let mut links = links;
    let mut taken = vec![true; links.len()];
    for _ in 0..4 * links.len() + 8 {
        let set: Vec<usize> = (0..links.len()).filter(|at| taken[*at]).collect();
        let now: Vec<Link> = set.iter().map(|at| links[*at]).collect();
        if now.is_empty() {
            break;
        }
        let mut rows = Rows::new(&now, scales);
        let multipliers = rows.multipliers(obstacles, &now, t, a);
        let least = |worst: Option<(f64, usize)>, (value, at): (f64, usize)| match worst {
            Some((least, _)) if least <= value => worst,
            _ => Some((value, at)),
        };
        let contact = |at: &usize| matches!(now[*at].kept, Kept::Contact(..));
        let contacts = || (0..now.len()).filter(contact);
        let pulls = contacts()
            .map(|at| (pressed(&rows, &multipliers, at).0, at))
            .filter(|(pressed, _)| *pressed <= NONE * a.amax())
            .fold(None, least);
        let slipping = |at: usize| {
            let Kept::Contact(contact, Rubs::Sticks) = now[at].kept else {
                return None;
            };
            let (normal, across) = pressed(&rows, &multipliers, at);
            let over = contact.friction[1] * normal - across;
            (over <= 0.0).then_some((over, at))
        };
        let slips = contacts().filter_map(slipping).fold(None, least);
        if (pulls.is_some() || slips.is_some())
            && let Some(about) = holding(
                &rows,
                &now,
                &(rows.right(obstacles, &now, t) - &rows.kept * a),
            )
        {
            rows.about = about;
            return (now, rows);
        }
        if let Some((_, at)) = pulls {
            taken[set[at]] = false;
            continue;
        }
        if let Some((_, at)) = slips {
            // Friction acts against the direction that it would slide in.
            let force = rows
                .of
                .iter()
                .zip(&multipliers)
                .skip_while(|(row, _)| row.link != at);
            let mut across = [0.0; 3];
            for (row, multiplier) in force.skip(1).take(2) {
                for axis in 0..3 {
                    across[axis] -= multiplier * row.direction[axis];
                }
            }
            if let Kept::Contact(contact, rubs) = &mut links[set[at]].kept {
                *rubs = match unit(across) {
                    Some(forward) if contact.friction[0] > 0.0 => Rubs::Slides(forward),
                    _ => Rubs::Not,
                };
            }
            continue;
        }
        let moved = a + (&rows.kept + &rows.rubs).tr_mul(&multipliers);
        let into = (0..links.len())
            .filter(|at| !taken[*at])
            .map(|at| {
                let one = Rows::new(&plain(&links[at..=at]), scales);
                let right = one.right(obstacles, &links[at..=at], t);
                let opening = (&one.kept * &moved)[0] - right[0];
                (opening, at)
            })
            .filter(|(opening, _)| *opening < -NONE * a.amax())
            .fold(None, least);
        let Some((_, at)) = into else { break };
        taken[at] = true;
    }
    let each = links.into_iter().zip(taken);
    let left: Vec<Link> = each
        .filter_map(|(link, taken)| taken.then_some(link))
        .collect();
    let rows = Rows::new(&left, scales);
    (left, rows)
}

/// Multipliers that give these accelerations along rows that depend on each other, so that every contact presses and what
/// sticks is within its friction: a point of a plane and of cones, found by reflections in both (Douglas and Rachford 1956;
/// Lions and Mercier 1979). None where rows are independent, or none is found.
fn holding(rows: &Rows, links: &[Link], along: &DVector<f64>) -> Option<DVector<f64>> {
    let count = rows.of.len();
    let determined = (&rows.inverse * &rows.matrix).trace();
    if determined > count as f64 - 0.5 {
        return None;
    }
    let size = (&rows.inverse * along).amax();
    let mut at = DVector::zeros(count);
    for _ in 0..REFLECTIONS {
        let on_plane = rows.nearest(&at, along);
        let inside = within(rows, links, &(2.0 * &on_plane - &at), INSIDE, size);
        let off = &inside - &on_plane;
        if off.amax() <= 0.1 * INSIDE * size {
            let balanced = (&rows.matrix * &on_plane - along).amax() <= NONE.sqrt() * along.amax();
            return balanced.then_some(on_plane);
        }
        at += off;
    }
    None
}

/// The nearest multipliers within the cones of friction, which keep from their limits by a part.
fn within(rows: &Rows, links: &[Link], at: &DVector<f64>, part: f64, size: f64) -> DVector<f64> {
    let mut found = at.clone();
    let mut row = 0;
    while row < rows.of.len() {
        let link = &links[rows.of[row].link];
        match link.kept {
            Kept::Rod(_) => row += 1,
            Kept::Contact(contact, Rubs::Sticks) => {
                let force = Vector3::new(at[row], at[row + 1], at[row + 2]);
                let cone = onto_cone(force, (1.0 - part) * contact.friction[1]);
                found.rows_mut(row, 3).copy_from(&cone);
                found[row] = found[row].max(part * size);
                row += 3;
            }
            Kept::Contact(..) => {
                found[row] = at[row].max(part * size);
                row += 1;
            }
        }
    }
    found
}

/// The force nearest to one, normal and across, in the cone |across| <= µ normal.
fn onto_cone(force: Vector3<f64>, friction: f64) -> Vector3<f64> {
    let (normal, across) = (force[0], force.yz().norm());
    if across <= friction * normal {
        return force;
    }
    if friction * across <= -normal {
        return Vector3::zeros();
    }
    let on = (normal + friction * across) / (1.0 + friction * friction);
    let scale = friction * on / across;
    Vector3::new(on, scale * force[1], scale * force[2])
}
