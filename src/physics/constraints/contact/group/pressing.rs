//! Which contacts of a group press, which stick, and which slide.

use super::super::Obstacles;
use super::super::member::unit;
use super::links::{Kept, Link, Rows, Rubs, plain, pressed};
use nalgebra::DVector;

/// Forces below this part of the largest are none.
const NONE: f64 = 1e-12;

/// Of these links the rods, and the contacts that press while no other is pressed into; what sticks beyond its friction
/// slides. Contacts are taken and left one by one, the worst first.
pub(super) fn pressing(
    obstacles: &Obstacles,
    links: Vec<Link>,
    scales: &[f64],
    t: f64,
    a: &DVector<f64>,
) -> Vec<Link> {
    let mut links = links;
    let mut taken = vec![true; links.len()];
    for _ in 0..4 * links.len() + 8 {
        let set: Vec<usize> = (0..links.len()).filter(|at| taken[*at]).collect();
        let now: Vec<Link> = set.iter().map(|at| links[*at]).collect();
        if now.is_empty() {
            break;
        }
        let rows = Rows::new(&now, scales);
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
        if let Some((_, at)) = pulls {
            taken[set[at]] = false;
            continue;
        }
        let slips = contacts()
            .filter_map(|at| {
                let Kept::Contact(contact, Rubs::Sticks) = now[at].kept else {
                    return None;
                };
                let (normal, across) = pressed(&rows, &multipliers, at);
                let over = contact.friction[1] * normal - across;
                (over <= 0.0).then_some((over, at))
            })
            .fold(None, least);
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
    each.filter_map(|(link, taken)| taken.then_some(link))
        .collect()
}
