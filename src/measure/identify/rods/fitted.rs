//! Schemes with a number that no scene states, found from the rows: the compliance of XPBD, the stiffness of springs in
//! place of rods, Baumgarte's rate.

use super::schemes::{coupled, euler, times};
use crate::measure::identify::candidate::Candidate;
use crate::measure::identify::keeping::{Keeping, Kept, Moved};
use crate::measure::identify::replay::Replay;
use crate::measure::identify::transition::{Transition, spread};
use crate::measure::identify::treated::treated;
use crate::measure::identify::words::digits;
use crate::physics::{ParticleSystem, System};
use crate::scene::{Constraints, Scene, Spring, Stabilisation};
use rayon::prelude::*;

/// Transitions that a number is fitted to.
const FITTED: usize = 3;
/// Gauss and Newton's steps.
const STEPS: usize = 40;
/// Replays of a transition that a fit takes, about.
const REPLAYS: u64 = 60;
/// The step of their slopes, in the logarithm of the number.
const SLOPE: f64 = 1e-5;
/// Most digits of a number that a person would have written.
const PLAIN: usize = 6;
/// Iterations of XPBD, and its substeps with one iteration.
const ITERATIONS: [u32; 12] = [1, 2, 3, 4, 5, 6, 8, 10, 15, 20, 30, 50];
const SUBSTEPS: [u32; 9] = [2, 3, 4, 5, 8, 10, 15, 16, 20];

/// Schemes that differ in one positive number.
struct Family<'a> {
    of: Box<dyn Fn(f64) -> Option<Candidate> + Send + Sync + 'a>,
    /// The number where it matters most, and the powers of ten of it that are tried.
    scale: f64,
    decades: std::ops::RangeInclusive<i32>,
}

/// The candidates whose numbers these transitions tell, of the families that the budget holds.
pub(in super::super) fn fitted(
    scene: &Scene,
    system: &ParticleSystem,
    replay: &Replay,
    sample: &[Transition],
    mut budget: u64,
) -> Vec<Candidate> {
    if system.rods().is_none() {
        return Vec::new();
    }
    let at = spread(sample, FITTED);
    let mut families = families(scene, system, replay.rows.timestep);
    families.retain(|family| {
        let one = (family.of)(family.scale);
        let effort = one.map_or(0, |one| at.iter().map(|t| replay.effort(&one, t)).sum());
        let effort = REPLAYS.saturating_mul(effort);
        let holds = effort <= budget;
        budget -= if holds { effort } else { 0 };
        holds
    });
    let found = families.par_iter().map(|family| family.found(replay, &at));
    let found: Vec<Option<Candidate>> = found.collect();
    found.into_iter().flatten().collect()
}

/// One of each that is no mistake, with a number of 1.
pub(super) fn named(scene: &Scene, system: &ParticleSystem) -> Vec<Candidate> {
    let families = families(scene, system, 1.0);
    let all = families.iter().filter_map(|family| (family.of)(1.0));
    all.filter(|candidate| !candidate.mistake).collect()
}

fn families<'a>(scene: &'a Scene, system: &'a ParticleSystem, h: f64) -> Vec<Family<'a>> {
    let masses = scene.particles.iter().filter(|p| !p.fixed).map(|p| p.mass);
    let mass = masses.fold(0.0, f64::max);
    let iterations: &[u32] = if coupled(system) {
        &ITERATIONS
    } else {
        &ITERATIONS[..1]
    };
    let whole = iterations.iter().map(|n| (*n, 1));
    let finer = SUBSTEPS.iter().map(|k| (1, *k));
    let compliant = whole.chain(finer).map(|(sweeps, substeps)| Family {
        of: Box::new(move |compliance| {
            let kept = Kept::position_based(Moved::Compliant(sweeps, compliance));
            let says = format!(
                "extended position-based dynamics with a compliance of {} m/N and {}",
                digits(compliance, PLAIN),
                times(sweeps)
            );
            let candidate = euler(system, kept)?.in_substeps(substeps);
            Some(candidate.named(format!("xpbd({sweeps})"), says))
        }),
        scale: (h / f64::from(substeps)).powi(2) / mass,
        decades: -8..=6,
    });
    let free = system.clone().with_rods(|_| None);
    let methods = Candidate::plain(&free, 1).filter(|c| !c.solves());
    let sprung = methods.chain(treated(&free)).map(|method| Family {
        of: Box::new(move |stiffness| {
            let sprung = ParticleSystem::new(&with_springs(scene, stiffness));
            let says = format!(
                "springs of {} N/m stand in for rods: their lengths change, and stiffer ones need smaller steps",
                digits(stiffness, PLAIN)
            );
            let id = format!("springs_for_rods({})", method.id);
            Some(method.under(&sprung).named(id, says).mistaken())
        }),
        scale: mass / (h * h),
        decades: -9..=1,
    });
    let methods = Candidate::plain(system, 1).filter(|c| !c.keeps_rods());
    let pulled = methods.map(|method| Family {
        of: Box::new(move |rate| {
            let keeping = Keeping::Stabilised(Constraints {
                stabilisation: Stabilisation::Baumgarte,
                rate,
            });
            let says = format!(
                "Baumgarte's forces pull rods back at a rate of {} 1/s",
                digits(rate, PLAIN)
            );
            let id = format!("baumgarte({})", method.id);
            Some(method.clone().keeping(system, &keeping).named(id, says))
        }),
        scale: 1.0 / h,
        decades: -5..=0,
    });
    compliant.chain(sprung).chain(pulled).collect()
}

/// The scene with springs of this stiffness in place of rods.
fn with_springs(scene: &Scene, stiffness: f64) -> Scene {
    let mut wrong = scene.clone();
    let springs = wrong.rods.drain(..).map(|rod| Spring {
        ends: rod.ends,
        stiffness,
        rest_length: rod.length,
        ..Spring::default()
    });
    let springs: Vec<Spring> = springs.collect();
    wrong.springs.extend(springs);
    wrong.constraints = None;
    wrong
}

impl Family<'_> {
    /// The candidate with the plainest number that fits; None where no number does.
    fn found(&self, replay: &Replay, at: &[Transition]) -> Option<Candidate> {
        let number = self.number(replay, at)?;
        let plain = (1..=PLAIN).filter_map(|count| digits(number, count).parse().ok());
        let all = plain.chain([number]);
        let candidates = all.filter_map(|number: f64| (self.of)(number));
        let fits = |candidate: &Candidate| {
            let mut replayer = candidate.replayer(&replay.settings);
            at.iter().all(|t| replay.defect(&mut replayer, t).fits())
        };
        candidates.into_iter().find(fits)
    }

    /// The number that comes nearest: the best power of ten, and Gauss and Newton's steps from there.
    fn number(&self, replay: &Replay, at: &[Transition]) -> Option<f64> {
        let tried = self.decades.clone().filter_map(|decade| {
            let number = (self.scale * 10_f64.powi(decade)).ln();
            Some((norm(&self.residuals(replay, at, number)?), number))
        });
        let (mut least, mut number) = tried.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let mut here = self.residuals(replay, at, number)?;
        for _ in 0..STEPS {
            let ahead = self.residuals(replay, at, number + SLOPE)?;
            let slope: Vec<f64> = (ahead.iter().zip(&here))
                .map(|(a, b)| (a - b) / SLOPE)
                .collect();
            let product: f64 = slope.iter().zip(&here).map(|(s, r)| s * r).sum();
            let mut step = (product / norm(&slope).powi(2)).clamp(-1.0, 1.0);
            let mut next = None;
            for _ in 0..8 {
                next = self
                    .residuals(replay, at, number - step)
                    .filter(|r| norm(r) < least);
                if next.is_some() {
                    break;
                }
                step *= 0.5;
            }
            let Some(next) = next else { break };
            (least, number, here) = (norm(&next), number - step, next);
        }
        // Beyond those numbers it says nothing, or its rounding would explain anything.
        let largest = self.scale * 10_f64.powi(self.decades.end() + 1);
        Some(number.exp()).filter(|number| *number <= largest)
    }

    /// How far the candidate is off, as velocities, m/s.
    fn residuals(&self, replay: &Replay, at: &[Transition], number: f64) -> Option<Vec<f64>> {
        let candidate = (self.of)(number.exp())?;
        let mut replayer = candidate.replayer(&replay.settings);
        let dim = replay.rows.dim;
        let mut all = Vec::new();
        for t in at {
            let state = replay.predict(&mut replayer, t).ok()?;
            let seconds = t.span(replay.rows) as f64 * replay.rows.timestep;
            let mut units = vec![seconds; dim];
            units.resize(2 * dim, 1.0);
            all.extend(replay.off(t, &state, &units));
        }
        all.iter().all(|r| r.is_finite()).then_some(all)
    }
}

fn norm(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum::<f64>().sqrt()
}
