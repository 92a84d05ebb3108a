//! All treatments without a number.

use super::{Bounce, FRICTIONS, Friction, PLACES, RESTITUTIONS, Restitution, Row, WAYS, Way};
use crate::physics::constraints::contact::{Hit, Obstacles};

/// Mistakes that are looked for at once.
const MOST: usize = 2;

/// The treatments without a number, those with fewer mistakes first, that differ for these obstacles in steps of `h`
/// seconds.
pub(in super::super) fn all(obstacles: &Obstacles, h: f64) -> Vec<Bounce> {
    let hits = |h: f64| {
        let hits = obstacles.surfaces().flat_map(move |surface| {
            [[1.3, 0.7], [0.4, 2.1], [3.0, 1e-9]].map(|[approach, sliding]| Hit {
                approach,
                sliding,
                restitution: surface.restitution,
                friction: surface.friction[0],
                h,
            })
        });
        hits.collect::<Vec<Hit>>()
    };
    let mut all = Vec::new();
    for way in WAYS
        .iter()
        .filter(|way| !matches!(way.does, Way::Force { .. }))
    {
        let hits = hits(if is_event(way) { 0.0 } else { h });
        let gains = |row: &Row<Restitution>| {
            let gains = hits.iter().map(|hit| (row.does.gains)(hit).to_bits());
            (row.does.leaving, gains.collect::<Vec<u64>>())
        };
        let slows = |row: &Row<Friction>| {
            let slows = hits
                .iter()
                .map(|hit| (row.does)(hit, (1.0 + hit.restitution) * hit.approach));
            slows.map(f64::to_bits).collect::<Vec<u64>>()
        };
        for place in PLACES {
            for restitution in &different(RESTITUTIONS, gains) {
                for friction in &different(FRICTIONS, slows) {
                    let bounce = Bounce {
                        place,
                        restitution,
                        friction,
                        ..Bounce::new(way)
                    };
                    if bounce.is_sensible() && bounce.mistakes().count() <= MOST {
                        all.push(bounce);
                    }
                }
            }
        }
    }
    all.sort_by_key(|bounce| bounce.mistakes().count());
    all
}

fn is_event(way: &Row<Way>) -> bool {
    matches!(way.does, Way::Event)
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
