//! What a scene is made of: particles, springs, pairs, the wind, and the curve to plot.

use super::check::{ends, particle, quantities, quantity, quantity_or, required};
use super::leaf::Items;
use super::limits;
use super::locate::Problem;
use super::model::{GravitationalPair, Particle, Plot, Spring, Wind};
use super::path::At;
use super::raw::{RawPair, RawParticle, RawPlot, RawSpring, RawWind};

/// At least one particle, and at least one that can move; beside them, which ones state their mass.
pub(super) fn particles(
    raw: Option<Items<RawParticle>>,
) -> Result<(Vec<Particle>, Vec<bool>), Problem> {
    let at = At::Root.key("particles");
    let help = "add a particle: `- {pos: [0, 0, 1], mass: 0.1}`";
    let raw = required(raw, at, help)?.0;
    if raw.is_empty() {
        let message = "expected at least one particle, found none";
        return Err(Problem::new(at, message, help));
    }
    let weighed = raw.iter().map(|raw| raw.mass.is_some()).collect();
    let judged = raw
        .into_iter()
        .enumerate()
        .map(|(i, raw)| one_particle(raw, at.index(i)));
    let particles = judged.collect::<Result<Vec<_>, _>>()?;
    if particles.iter().all(|p| p.fixed) {
        let message = "expected at least one free particle, found all of them fixed";
        let help = "nothing can move: remove `fixed: true` from one";
        return Err(Problem::new(at, message, help));
    }
    Ok((particles, weighed))
}

fn one_particle(raw: RawParticle, at: At) -> Result<Particle, Problem> {
    let position = required(
        raw.position,
        at.key("pos"),
        "give its position: `pos: [x, y, z]`",
    )?;
    let position = quantities(position, limits::POSITION, at.key("pos"))?;
    let velocity = raw
        .velocity
        .map(|v| quantities(v, limits::VELOCITY, at.key("vel")));
    let velocity = velocity.transpose()?.unwrap_or_default();
    let fixed = raw.fixed.is_some_and(|fixed| fixed.0);
    if fixed && velocity != [0.0; 3] {
        let message = format!("expected no velocity on a fixed particle, found {velocity:?}");
        return Err(Problem::new(
            at.key("vel"),
            message,
            "remove `vel`, or `fixed: true`",
        ));
    }
    let mass = match raw.mass {
        // Of what acts on a particle that cannot move, only attraction depends on its mass.
        None if fixed => 1.0,
        mass => {
            let mass = required(mass, at.key("mass"), "a free particle needs its mass in kg")?;
            quantity(mass, limits::MASS, at.key("mass"))?
        }
    };
    Ok(Particle {
        position,
        velocity,
        fixed,
        mass,
        radius: quantity_or(raw.radius, 0.1, limits::RADIUS, at.key("radius"))?,
        drag: quantity_or(raw.drag, 0.0, limits::DRAG, at.key("drag"))?,
    })
}

pub(super) fn spring(raw: RawSpring, particles: &[Particle], at: At) -> Result<Spring, Problem> {
    let ids = at.key("particle_ids");
    let ends = required(raw.ends, ids, "name the two ends: `particle_ids: [0, 1]`")
        .and_then(|numbers| ends(numbers, particles.len(), ids))?;
    let stiffness = at.key("stiffness");
    Ok(Spring {
        ends,
        stiffness: required(
            raw.stiffness,
            stiffness,
            "a spring needs its stiffness in N/m",
        )
        .and_then(|k| quantity(k, limits::STIFFNESS, stiffness))?,
        cubic: quantity_or(raw.cubic, 0.0, limits::CUBIC, at.key("cubic"))?,
        damping: quantity_or(raw.damping, 0.0, limits::DAMPING, at.key("damping"))?,
        rest_length: match raw.rest_length {
            Some(length) => quantity(length, limits::REST_LENGTH, at.key("rest_length"))?,
            None => distance(particles, ends),
        },
    })
}

pub(super) fn pair(
    raw: RawPair,
    particles: &[Particle],
    weighed: &[bool],
    at: At,
) -> Result<GravitationalPair, Problem> {
    let ids = at.key("particle_ids");
    let ends = required(
        raw.ends,
        ids,
        "name the two particles: `particle_ids: [0, 1]`",
    )
    .and_then(|numbers| ends(numbers, particles.len(), ids))?;
    let g = required(
        raw.g,
        at.key("G"),
        "give the constant of attraction in N m²/kg²",
    )?;
    let g = quantity(g, limits::G, at.key("G"))?;
    if let Some(id) = ends.into_iter().find(|&id| !weighed[id]) {
        let message = format!("expected particles with a mass, found that {id} states none");
        return Err(Problem::new(
            ids,
            message,
            "the attraction depends on it: add `mass`",
        ));
    }
    let apart = distance(particles, ends);
    if apart < limits::ATTRACTION_DISTANCE {
        let message =
            format!("expected two particles apart, found them {apart:?} m from each other");
        return Err(Problem::new(
            ids,
            message,
            "the attraction is infinite at distance 0",
        ));
    }
    Ok(GravitationalPair { ends, g })
}

pub(super) fn wind(raw: RawWind, at: At) -> Result<Wind, Problem> {
    let key = at.key("direction");
    let direction = required(
        raw.direction,
        key,
        "say where it blows: `direction: [1, 0, 0]`",
    )?;
    let direction = quantities(direction, limits::DIRECTION, key)?;
    // Scaled first, so that the squares of tiny components do not vanish.
    let largest = direction.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
    if largest == 0.0 {
        return Err(Problem::new(
            key,
            "expected a direction, found a vector of length 0",
            "",
        ));
    }
    let scaled = direction.map(|d| d / largest);
    let length = scaled.iter().map(|d| d * d).sum::<f64>().sqrt();
    let strength = required(
        raw.strength,
        at.key("strength"),
        "give its force in newtons",
    )?;
    Ok(Wind {
        direction: scaled.map(|d| d / length),
        strength: quantity(strength, limits::WIND, at.key("strength"))?,
    })
}

pub(super) fn plot(raw: RawPlot, count: usize, at: At) -> Result<Plot, Problem> {
    let key = at.key("particle_id");
    let id = required(raw.particle, key, "say which particle's curve to show")?;
    let id = particle(id, count, key)?;
    let key = at.key("dof");
    let axis = required(raw.dof, key, "say which coordinate to show: 0, 1 or 2")?;
    let dof = match axis.whole() {
        Some(dof @ 0..=2) => dof,
        _ => {
            let message = format!("expected a coordinate, 0, 1 or 2, found {axis}");
            return Err(Problem::new(key, message, "0 is x, 1 is y, 2 is z"));
        }
    };
    let key = at.key("y_range");
    let y_range = raw
        .y_range
        .map(|r| quantities(r, limits::POSITION, key))
        .transpose()?;
    if let Some([low, high]) = y_range
        && low >= high
    {
        let message = format!("expected [lower, upper], found [{low:?}, {high:?}]");
        return Err(Problem::new(
            key,
            message,
            "the first number is the smaller one",
        ));
    }
    Ok(Plot {
        particle: id,
        dof,
        y_range,
    })
}

/// Initial distance of two particles, in metres.
fn distance(particles: &[Particle], [a, b]: [usize; 2]) -> f64 {
    let (a, b) = (particles[a].position, particles[b].position);
    // hypot neither overflows nor loses tiny distances.
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}
