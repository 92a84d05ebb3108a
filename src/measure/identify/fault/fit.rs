//! Changes with one free number: another stiffness, mass or step, fitted to the fault.

use super::super::candidate::Candidate;
use super::guesses::{Guess, Way, in_scene, springs_at};
use super::spot::Spot;
use super::words::{short, spring_name};
use crate::scene::Scene;

/// Most Gauss-Newton steps.
const STEPS: usize = 8;

/// A number of the scene that may be wrong.
struct Knob<'a> {
    name: String,
    unit: &'static str,
    value: f64,
    /// Size of a change that has an effect.
    scale: f64,
    build: Box<dyn Fn(f64) -> Candidate + 'a>,
}

/// Puts a value into a scene.
type Set = Box<dyn Fn(&mut Scene, f64)>;

/// For each number that may be wrong, the value that comes nearest.
pub(super) fn guesses(spot: &Spot) -> Vec<Guess> {
    let fitted = |knob: &Knob| {
        let value = fit(spot, knob)?;
        let (found, right) = (short(value), short(knob.value));
        (found != right).then(|| Guess {
            says: format!("{} is {found} {}, not {right}", knob.name, knob.unit),
            way: Way::Scheme((knob.build)(value)),
        })
    };
    knobs(spot).iter().filter_map(fitted).collect()
}

fn knobs<'a>(spot: &'a Spot<'a>) -> Vec<Knob<'a>> {
    let scene = spot.question.scene;
    let mut knobs = Vec::new();
    let mut add = |name: String, unit, value: f64, scale: f64, set: Set| {
        knobs.push(Knob {
            name,
            unit,
            value,
            scale,
            build: Box::new(move |p| in_scene(spot, |scene| set(scene, p))),
        });
    };
    for id in springs_at(spot) {
        let spring = &scene.springs[id];
        let name = |what: &str| format!("the {what} of {}", spring_name(id, spring));
        let k = spring.stiffness;
        let set = Box::new(move |s: &mut Scene, p| s.springs[id].stiffness = p);
        add(name("stiffness"), "N/m", k, k.max(1.0), set);
        let q = spring.cubic;
        if q != 0.0 {
            let set = Box::new(move |s: &mut Scene, p| s.springs[id].cubic = p);
            add(name("cubic stiffness"), "N/m³", q, q, set);
        }
        let (l, size) = (spring.rest_length, scene.size());
        let set = Box::new(move |s: &mut Scene, p| s.springs[id].rest_length = p);
        add(name("rest length"), "m", l, l.max(1e-3 * size), set);
        let c = spring.damping;
        let set = Box::new(move |s: &mut Scene, p| s.springs[id].damping = p);
        add(name("damping"), "N s/m", c, c.max(0.1), set);
    }
    let g = scene.solver.gravity;
    let set = Box::new(|s: &mut Scene, p| s.solver.gravity = p);
    add("gravity".to_owned(), "m/s²", g, g.abs().max(1.0), set);
    let i = spot.worst;
    if let Some(particle) = scene.particles.get(i) {
        let m = particle.mass;
        let set = Box::new(move |s: &mut Scene, p| s.particles[i].mass = p);
        add(format!("the mass of particle {i}"), "kg", m, m, set);
        let b = particle.drag;
        let set = Box::new(move |s: &mut Scene, p| s.particles[i].drag = p);
        add(
            format!("the drag of particle {i}"),
            "N s/m",
            b,
            b.max(0.1),
            set,
        );
    }
    if let Some(wind) = &scene.wind {
        let w = wind.strength;
        let set = Box::new(|s: &mut Scene, p| {
            if let Some(wind) = &mut s.wind {
                wind.strength = p;
            }
        });
        add(
            "the strength of the wind".to_owned(),
            "N",
            w,
            w.abs().max(1.0),
            set,
        );
    }
    let h = spot.replay.rows.timestep;
    knobs.push(Knob {
        name: "the timestep".to_owned(),
        unit: "s",
        value: h,
        scale: h,
        build: Box::new(move |p| spot.followed.stretched(p / h)),
    });
    knobs
}

/// The value whose differences from the row, in units, have the least sum of squares.
fn fit(spot: &Spot, knob: &Knob) -> Option<f64> {
    let residuals = |p: f64| -> Option<Vec<f64>> {
        let state = spot.arrive(spot.followed, &(knob.build)(p), spot.span())?;
        let numbers = state.x.iter().chain(&state.v);
        let recorded = spot.replay.recorded(&spot.at).zip(&spot.units);
        let off = numbers
            .zip(recorded)
            .map(|(state, (recorded, unit))| match state - recorded {
                0.0 => 0.0,
                off => off / unit,
            });
        Some(off.collect())
    };
    let mut p = knob.value;
    let mut here = residuals(p)?;
    let mut nudge = 1e-3 * knob.scale;
    for _ in 0..STEPS {
        let there = residuals(p + nudge)?;
        let slope = here.iter().zip(&there).map(|(a, b)| (b - a) / nudge);
        let (mut along, mut steep) = (0.0, 0.0);
        for (slope, off) in slope.zip(&here) {
            along += slope * off;
            steep += slope * slope;
        }
        let step = -along / steep;
        if !step.is_finite() {
            return None;
        }
        p += step;
        here = residuals(p)?;
        if step.abs() <= 1e-12 * knob.scale.max(p.abs()) {
            break;
        }
        nudge = (0.1 * step).abs().max(1e-7 * knob.scale);
    }
    Some(p)
}
