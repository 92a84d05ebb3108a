//! Closed forms, chosen by what a scene contains.
//!
//! Particles that springs join form a group; a scene has a closed form if every group has one. A
//! group has one where its forces stay linear: without springs, with springs of rest length 0, or
//! moving on one line with lengths proven to stay above 0. Its modes are then decoupled, and each is
//! one scalar equation. A particle by itself among planes has a form on every piece of its motion. With quadratic drag a particle without springs has one on a line; in a magnetic field it goes
//! round a helix; on a rod to a fixed point it is a pendulum. Forces here are read off the scene, not off the effects' code, so that
//! either would show a fault in the other.

mod elliptic;
mod fall;
mod forced;
mod group;
mod helix;
mod hung;
mod lengths;
mod line;
mod mode;
mod modes;
mod part;
mod pendulum;
mod pieces;
mod vector;
mod words;

pub use pendulum::Pendulum;

use super::converged::HORIZON;
use super::{Motion, States, Truth, TruthKind, farthest};
use crate::physics::ParticleSystem;
use crate::scene::{Drive, Scene};
use fall::Fall;
use group::{Body, Group, groups};
use helix::Helix;
use hung::Hung;
use nalgebra::Vector3;
use part::GroupMotion;
use pieces::{Pieces, Wall, walls};

/// Ids of the effects the forms account for. Any other effect in a scene means no closed form.
const KNOWN: &[&str] = &[
    "gravity",
    "springs",
    "drag",
    "quadratic_drag",
    "wind",
    "driven",
    "magnetic",
];

/// The form that holds for this scene up to `until` seconds, if one does: what it is, such as
/// `parabola`, and why it applies.
pub fn find(scene: &Scene, system: &ParticleSystem, until: f64) -> Option<Truth> {
    let known = system
        .effects()
        .iter()
        .all(|(row, _)| KNOWN.contains(&row.id));
    let forward = until.is_finite() && until >= 0.0;
    if !(known && forward) {
        return None;
    }
    let start = ParticleSystem::initial_state(scene);
    let groups = groups(scene, &start, until);
    if !groups.iter().all(Group::is_plain) {
        return None;
    }
    let walls = walls(scene)?;
    let parts = groups.iter().map(|group| Part::of(group, &walls));
    let parts: Vec<Part> = parts.collect::<Option<_>>()?;
    let words: Vec<[&str; 2]> = parts.iter().map(Part::words).collect();
    let mut methods = each_once(words.iter().map(|words| words[0]));
    let mut reasons = each_once(words.iter().map(|words| words[1]));
    if parts.is_empty() {
        methods.push("rest");
        reasons.push("nothing is free to move");
    }
    let (method, mut reason) = (methods.join(" and "), reasons.join("; "));
    let motion = Apart {
        largest: start.x.iter().fold(0.0, |m, x| m.max(x.abs())),
        x: start.x,
        v: start.v,
        drives: scene.drives(),
        parts,
    };
    let part = |k: u32| until * f64::from(k) / 8.0;
    let way = motion.states(&[1, 2, 3, 4, 5, 6, 7, 8].map(part));
    // A product on the way to the end may be too large for a double.
    let finite = way.x(7).iter().chain(way.v(7)).all(|c| c.is_finite());
    if !(finite && motion.error_bar(until).is_finite()) {
        return None;
    }
    let ways = (0..8).map(|k| farthest(way.x(k), &motion.x));
    let size = ways.fold(scene.size(), f64::max);
    let horizon = horizon(&motion, until, HORIZON * size)?;
    if horizon < until {
        reason += "; beyond it a rounding of the start has grown too large";
    }
    Some(Truth {
        kind: TruthKind::ClosedForm,
        method: Some(method),
        reason,
        horizon,
        error_bound: motion.error_bar(horizon),
        motion: Some(Box::new(motion)),
    })
}

/// The last time up to `until`, s, at which the error bar is at most `limit`, m; None where it is above from the start.
fn horizon(motion: &Apart, until: f64, limit: f64) -> Option<f64> {
    let within = |t: &f64| motion.error_bar(*t) <= limit;
    if within(&until) {
        return Some(until);
    }
    let (mut below, mut above) = (0.0, until);
    // Bars never fall; twelve digits of the time are enough.
    for _ in 0..40 {
        let middle = 0.5 * (below + above);
        if within(&middle) {
            below = middle;
        } else {
            above = middle;
        }
    }
    (below > 0.0).then_some(below)
}

/// Each text once, in order of first appearance; `others` stands for those after three.
fn each_once<'a>(texts: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found: Vec<&str> = Vec::new();
    for text in texts {
        if found.len() == 3 && !found.contains(&text) {
            found.push("others");
            break;
        }
        if !found.contains(&text) {
            found.push(text);
        }
    }
    found
}

/// The motion of one group.
enum Part {
    Modes(Box<GroupMotion>),
    Fall(Fall),
    Helix(Helix),
    Hung(Box<Hung>),
    Pieces(Pieces),
}

impl Part {
    /// The group's motion, if it has a closed form.
    fn of(group: &Group, walls: &[Wall]) -> Option<Self> {
        if !walls.is_empty() {
            return Pieces::of(group, walls).map(Self::Pieces);
        }
        if !group.rods.is_empty() {
            return Hung::of(group).map(Box::new).map(Self::Hung);
        }
        let squared = group.bodies.iter().any(|body| body.quadratic != 0.0);
        let turned = |body: &Body| body.turning != Vector3::zeros();
        match (squared, group.bodies.iter().any(turned)) {
            (true, true) => None,
            (true, false) => Fall::of(group).map(Self::Fall),
            (false, true) => Helix::of(group).map(Self::Helix),
            (false, false) => GroupMotion::of(group).map(Box::new).map(Self::Modes),
        }
    }

    /// Method and reason.
    fn words(&self) -> [&str; 2] {
        match self {
            Self::Modes(motion) => [&motion.method, &motion.reason],
            Self::Fall(_) => [fall::METHOD, fall::REASON],
            Self::Helix(helix) => helix.words(),
            Self::Hung(_) => [hung::METHOD, hung::REASON],
            Self::Pieces(pieces) => [&pieces.method, &pieces.reason],
        }
    }

    fn add(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        match self {
            Self::Modes(motion) => motion.add(t, x, v),
            Self::Fall(fall) => fall.add(t, x, v),
            Self::Helix(helix) => helix.add(t, x, v),
            Self::Hung(hung) => hung.put(t, x, v),
            Self::Pieces(pieces) => pieces.put(t, x, v),
        }
    }

    fn error_bar(&self, t: f64) -> f64 {
        match self {
            Self::Modes(motion) => motion.error_bar(t),
            Self::Fall(fall) => fall.error_bar(t),
            Self::Helix(helix) => helix.error_bar(t),
            Self::Hung(hung) => hung.error_bar(t),
            Self::Pieces(pieces) => pieces.error_bar(t),
        }
    }
}

/// The motions of all groups around the start.
struct Apart {
    x: Vec<f64>,
    v: Vec<f64>,
    /// Largest coordinate, m.
    largest: f64,
    drives: Vec<Drive>,
    parts: Vec<Part>,
}

impl Motion for Apart {
    fn states(&self, times: &[f64]) -> States {
        let dim = self.x.len();
        let mut states = States {
            dim,
            x: self.x.repeat(times.len()),
            v: self.v.repeat(times.len()),
        };
        for (k, &t) in times.iter().enumerate() {
            let at = k * dim..(k + 1) * dim;
            let (x, v) = (&mut states.x[at.clone()], &mut states.v[at]);
            for part in &self.parts {
                part.add(t, x, v);
            }
            for drive in &self.drives {
                let [position, velocity, _] = drive.at(t);
                let own = 3 * drive.particle..3 * drive.particle + 3;
                x[own.clone()].copy_from_slice(&position);
                v[own].copy_from_slice(&velocity);
            }
        }
        states
    }

    fn error_bar(&self, t: f64) -> f64 {
        // A rounding of the time, and a few of the position itself.
        let speeds = self.drives.iter().map(|drive| drive.speed_bound(t));
        let late = speeds.fold(0.0, |most, speed| f64::max(most, speed * t)) * 4.0 * f64::EPSILON;
        let bars = self.parts.iter().map(|p| p.error_bar(t)).chain([late]);
        // A position is a sum with the start, which may lie far from the origin.
        bars.fold(0.0, f64::max) + f64::EPSILON * self.largest
    }
}
