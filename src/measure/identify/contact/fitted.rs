//! Penalty contact, whose stiffness and damping no scene states: they are found from steps inside.

use super::super::bounce::{Bounce, FRICTIONS, Own, WAYS, Way, Wrong};
use super::super::candidate::Candidate;
use super::super::transition::Transition;
use super::super::transition::spread;
use super::super::words::digits;
use super::damped;
use super::search::{Search, Told};
use crate::physics::System;
use crate::physics::constraints::contact::Obstacles;
use rayon::prelude::*;

/// Replays of a treatment that a fit takes, about.
pub(super) const REPLAYS: usize = 60;
/// Steps that the numbers are fitted to.
const FITTED: usize = 6;
/// The fewest that are inside: two numbers explain two steps.
const FEWEST: usize = 4;
/// Gauss and Newton's steps.
const STEPS: usize = 30;
/// The step of their slopes, in parts of a number.
const SLOPE: f64 = 1e-6;
/// Powers of ten of m/h² that the stiffness is begun from.
const DECADES: std::ops::RangeInclusive<i32> = -7..=0;
/// Most digits of a number that a person would have written.
const PLAIN: usize = 6;

/// The penalty that explains all steps; None where none does.
pub(super) fn found(search: &Search, schemes: &[Candidate]) -> Option<Told> {
    let inside = inside(search);
    if inside.len() < FEWEST {
        return None;
    }
    let obstacles = search.question.system.obstacles();
    let penalty = obstacles.and_then(Obstacles::penalty);
    let forces = WAYS
        .iter()
        .filter(|way| matches!(way.does, Way::Force { whole, .. } if whole == penalty.is_some()));
    let mut bounces = Vec::new();
    for friction in FRICTIONS
        .iter()
        .filter(|row| row.says.is_empty() || (row.id == "friction_forgotten" && rubs(search)))
    {
        for way in forces.clone() {
            bounces.push(Bounce {
                friction,
                ..Bounce::new(way)
            });
        }
    }
    let explicit = schemes.iter().filter(|scheme| !scheme.solves());
    let mut explicit: Vec<Candidate> = explicit.cloned().collect();
    let pushing = bounces.first().map(|first| Bounce {
        force: [1.0, 1.0],
        ..*first
    });
    let damped = pushing.map_or_else(Vec::new, |bounce| damped(search.question, &bounce));
    let meant = |c: &Candidate| schemes.iter().any(|s| s.id == c.meant && s.substeps == 1);
    let new = |c: &Candidate| schemes.iter().all(|s| s.id != c.id);
    explicit.extend(damped.into_iter().filter(|c| meant(c) && new(c)));
    bounces.into_iter().find_map(|bounce| {
        let fits = explicit.par_iter().filter_map(|scheme| {
            let own = Fit {
                search,
                scheme,
                at: &inside,
            };
            own.found(bounce)
        });
        let fits: Vec<(Bounce, Vec<Candidate>)> = fits.collect();
        let (bounce, _) = fits.first()?.clone();
        let schemes = fits.into_iter().filter(|(other, _)| *other == bounce);
        let schemes = schemes.flat_map(|(_, schemes)| schemes).collect();
        Some(Told::new(bounce, schemes))
    })
}

fn rubs(search: &Search) -> bool {
    let obstacles = search.question.system.obstacles();
    obstacles.is_some_and(|all| all.surfaces().any(|one| one.friction[0] > 0.0))
}

/// The steps that begin inside, the deepest ones.
fn inside(search: &Search) -> Vec<Transition> {
    let rows = search.question.rows;
    let Some(obstacles) = search.question.system.obstacles() else {
        return Vec::new();
    };
    let depth = |t: &Transition| {
        let gaps = obstacles.pairs().map(|(particle, obstacle)| {
            let x = |particle| [0, 1, 2].map(|axis| rows.x(t.from)[3 * particle + axis]);
            obstacles.gap(particle, obstacle, rows.time(t.from), x)
        });
        gaps.fold(f64::INFINITY, f64::min)
    };
    let mut deep: Vec<(f64, Transition)> = search
        .apart
        .beside
        .iter()
        .map(|t| (depth(t), *t))
        .filter(|(gap, _)| *gap < 0.0)
        .collect();
    deep.sort_by(|a, b| a.0.total_cmp(&b.0));
    spread(&deep, FITTED).into_iter().map(|(_, t)| t).collect()
}

/// One scheme with a penalty of two unknown numbers.
struct Fit<'a> {
    search: &'a Search<'a>,
    scheme: &'a Candidate,
    at: &'a [Transition],
}

impl Fit<'_> {
    /// The scheme, or one that differs from it in its treatment of dampers, with the plainest numbers that fit.
    fn found(&self, bounce: Bounce) -> Option<(Bounce, Vec<Candidate>)> {
        let [stiffness, damping] = self.numbers(bounce)?;
        let scale = stiffness.abs() * self.search.question.rows.timestep;
        let short = |number: f64, count| digits(number, count).parse().unwrap_or(number);
        let plain = (1..=PLAIN).flat_map(|count| {
            let none = (damping.abs() < 1e-3 * scale).then_some([short(stiffness, count), 0.0]);
            none.into_iter()
                .chain([[short(stiffness, count), short(damping, count)]])
        });
        let [softest, hardest] = self.bounds();
        let obstacles = self.search.question.system.obstacles();
        let penalty = obstacles.and_then(Obstacles::penalty);
        // A damper that drives is a mistake, which a scene with one may see.
        let least = if penalty.is_some() { -hardest } else { 0.0 };
        let sensible = |[k, c]: &[f64; 2]| *k >= softest && (least..hardest).contains(c);
        let all = plain.chain([[stiffness, damping]]).filter(sensible);
        all.into_iter().find_map(|force| {
            let own = Own {
                penalty: penalty.map(|asked| {
                    [0, 1].map(|at| Wrong {
                        found: force[at],
                        asked: Some(asked[at]),
                    })
                }),
                ..Own::NONE
            };
            let bounce = Bounce {
                force,
                own,
                ..bounce
            };
            let schemes = self
                .search
                .fitting(std::slice::from_ref(self.scheme), &bounce);
            (!schemes.is_empty()).then_some((bounce, schemes))
        })
    }

    /// The heaviest particle over h², N/m.
    fn unit(&self) -> f64 {
        let h = self.search.question.rows.timestep;
        let particles = self.search.question.scene.particles.iter();
        let masses = particles.filter(|p| !p.fixed).map(|p| p.mass);
        masses.fold(0.0, f64::max) / (h * h)
    }

    /// A softer spring is none, and a damper that stops a particle in one step is an impulse.
    fn bounds(&self) -> [f64; 2] {
        let (unit, h) = (self.unit(), self.search.question.rows.timestep);
        [1e-8 * unit, unit * h]
    }

    /// Stiffness, N/m, and damping, N s/m, that come nearest, by Gauss and Newton from the best power of ten.
    fn numbers(&self, bounce: Bounce) -> Option<[f64; 2]> {
        let h = self.search.question.rows.timestep;
        let unit = self.unit();
        let off = |force: [f64; 2]| self.off(Bounce { force, ..bounce });
        let tried = DECADES.filter_map(|decade| {
            let number = [unit * 10_f64.powi(decade), 0.0];
            Some((norm(&off(number)?), number))
        });
        let (mut least, mut here) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
        for _ in 0..STEPS {
            let now = off(here)?;
            let by = [
                SLOPE * here[0].max(1e-9 * unit),
                SLOPE * here[0].max(1e-9 * unit) * h,
            ];
            let slopes: Vec<Vec<f64>> = (0..2)
                .map(|at| {
                    let mut ahead = here;
                    ahead[at] += by[at];
                    let ahead = off(ahead)?;
                    let pairs = ahead.iter().zip(&now);
                    Some(pairs.map(|(a, b)| (a - b) / by[at]).collect())
                })
                .collect::<Option<_>>()?;
            let mut step = solved(&slopes, &now)?;
            let mut better = None;
            for _ in 0..8 {
                let next = [here[0] - step[0], here[1] - step[1]];
                if let Some(left) = off(next).map(|off| norm(&off)).filter(|left| *left < least) {
                    better = Some((left, next));
                    break;
                }
                step = step.map(|s| 0.5 * s);
            }
            let Some((left, next)) = better else { break };
            (least, here) = (left, next);
        }
        Some(here)
    }

    fn off(&self, bounce: Bounce) -> Option<Vec<f64>> {
        self.search.off(self.scheme, &bounce, self.at)
    }
}

/// The least squares of two slopes; None where they are not independent.
pub(super) fn solved(slopes: &[Vec<f64>], off: &[f64]) -> Option<[f64; 2]> {
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (k, c) = (&slopes[0], &slopes[1]);
    let (kk, kc, cc) = (dot(k, k), dot(k, c), dot(c, c));
    let right = [dot(k, off), dot(c, off)];
    let det = kk * cc - kc * kc;
    if det > 1e-14 * kk * cc {
        return Some([
            (right[0] * cc - right[1] * kc) / det,
            (right[1] * kk - right[0] * kc) / det,
        ]);
    }
    if kk > 0.0 {
        return Some([right[0] / kk, 0.0]);
    }
    (cc > 0.0).then(|| [0.0, right[1] / cc])
}

pub(super) fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}
