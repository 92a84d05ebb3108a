//! All treatments without a number.

use super::{
    Bounce, FRICTIONS, Friction, Lift, PARTNERS, PLACES, Partner, RESTITUTIONS, Restitution, Row,
    WAYS, Way,
};
use crate::physics::State;
use crate::physics::constraints::contact::{Hit, Obstacles};

/// Mistakes that are looked for at once.
const MOST: usize = 2;

/// The treatments without a number, those with fewer mistakes first, that differ for these obstacles in steps of `h`
/// seconds.
pub(in super::super) fn all(obstacles: &Obstacles, h: f64) -> Vec<Bounce> {
    let mut all = Vec::new();
    for way in WAYS
        .iter()
        .filter(|way| !matches!(way.does, Way::Force { .. }))
    {
        let hits = hits(obstacles, way, h);
        let (restitutions, frictions) = (
            different(RESTITUTIONS, |row| gains(row, &hits)),
            different(FRICTIONS, |row| slows(row, &hits)),
        );
        let (places, partners) = relevant(obstacles);
        for (place, partner) in places
            .iter()
            .flat_map(|place| partners.iter().map(move |partner| (place, partner)))
        {
            for restitution in &restitutions {
                for friction in &frictions {
                    let bounce = Bounce {
                        place,
                        partner,
                        restitution,
                        friction,
                        ..Bounce::new(way)
                    };
                    let most = if bounce.is_usual() { MOST } else { MOST - 1 };
                    if bounce.is_sensible() && bounce.mistakes().count() <= most {
                        all.push(bounce);
                    }
                }
            }
        }
    }
    all.sort_by_key(|bounce| bounce.mistakes().count());
    all
}

/// The places and partners that make a difference beside these obstacles.
pub(in super::super) fn relevant(
    obstacles: &Obstacles,
) -> (Vec<&'static Row<Lift>>, Vec<&'static Row<Partner>>) {
    let masses = obstacles
        .particles()
        .map(|one| obstacles.weight(one).to_bits());
    let mut masses: Vec<u64> = masses.collect();
    masses.sort_unstable();
    masses.dedup();
    let unequal = obstacles.among_particles() && masses.len() > 1;
    let slants = slants(obstacles);
    let place = |row: &&Row<Lift>| unequal || !row.does.halves;
    let partner = |row: &&Row<Partner>| match row.id {
        "by_mass" => true,
        "masses_ignored" => unequal,
        _ if row.does.speed != 1.0 => obstacles.any_moves(),
        _ if !row.does.slopes => slants,
        // Where there is nothing else, that is all obstacles forgotten.
        _ if !row.does.meets => obstacles.among_particles() && obstacles.pairs().next().is_some(),
        _ => obstacles.among_particles(),
    };
    (
        PLACES.iter().filter(place).collect(),
        PARTNERS.iter().filter(partner).collect(),
    )
}

/// Whether some obstacle has normals that are along no axis.
fn slants(obstacles: &Obstacles) -> bool {
    let numbers = obstacles.particles().max().map_or(0, |last| 3 * last + 3);
    let origin = State::new(vec![0.0; numbers], vec![0.0; numbers]);
    let first = obstacles.particles().next();
    let mut own = obstacles.pairs().filter(|(one, _)| Some(*one) == first);
    obstacles.bend()
        || own.any(|(particle, against)| {
            let normal = obstacles.beside(particle, against, &origin).normal;
            normal.iter().all(|c| c.abs() < 1.0 - 1e-9)
        })
}

/// Other mistakes that do the same beside these obstacles, in steps of `h` seconds.
pub(in super::super) fn same_here(obstacles: &Obstacles, h: f64, bounce: &Bounce) -> Vec<Bounce> {
    let hits = hits(obstacles, bounce.way, h);
    let (gained, slowed) = (
        gains(bounce.restitution, &hits),
        slows(bounce.friction, &hits),
    );
    let restitutions = RESTITUTIONS
        .iter()
        .filter(|row| row.mistake && gains(row, &hits) == gained);
    let frictions = FRICTIONS
        .iter()
        .filter(|row| row.mistake && slows(row, &hits) == slowed);
    let restitutions = restitutions.filter(|_| bounce.restitution.mistake);
    let restitutions = restitutions.map(|restitution| Bounce {
        restitution,
        ..*bounce
    });
    let frictions = frictions.filter(|_| bounce.friction.mistake);
    let frictions = frictions.map(|friction| Bounce {
        friction,
        ..*bounce
    });
    let all = restitutions.chain(frictions);
    all.filter(|other| other != bounce && other.is_sensible())
        .collect()
}

/// Some impacts on each of these obstacles.
fn hits(obstacles: &Obstacles, way: &Row<Way>, h: f64) -> Vec<Hit> {
    let h = if matches!(way.does, Way::Event) {
        0.0
    } else {
        h
    };
    let hits = obstacles.surfaces().flat_map(move |surface| {
        [[1.3, 0.7], [0.4, 2.1], [3.0, 1e-9]].map(|[approach, sliding]| Hit {
            approach,
            sliding,
            restitution: surface.restitution,
            friction: surface.friction[0],
            h,
        })
    });
    hits.collect()
}

/// What tells a row of a table from others.
fn gains(row: &Row<Restitution>, hits: &[Hit]) -> (bool, Vec<u64>) {
    let gains = hits.iter().map(|hit| (row.does.gains)(hit).to_bits());
    (row.does.leaving, gains.collect())
}

fn slows(row: &Row<Friction>, hits: &[Hit]) -> Vec<u64> {
    let slows = hits
        .iter()
        .map(|hit| (row.does)(hit, (1.0 + hit.restitution) * hit.approach));
    slows.map(f64::to_bits).collect()
}

/// The rows of a table that are not as one before.
fn different<T, K: PartialEq>(
    table: &'static [Row<T>],
    key: impl Fn(&Row<T>) -> K,
) -> Vec<&'static Row<T>> {
    let mut keys = Vec::new();
    let new = |row: &&Row<T>| {
        let key = key(row);
        let known = keys.contains(&key);
        keys.push(key);
        !known
    };
    table.iter().filter(new).collect()
}
