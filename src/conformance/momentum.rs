//! Momentum: kept by every one-step method of sums, angular momentum by symplectic ones.

use super::finding::Verdict;
use super::subject::{Broken, Subject, advance};
use super::systems::free_triangle;
use super::{Law, SOLVED_TO};
use crate::physics::{ParticleSystem, State, System};
use crate::scene::DampingModel;

const STEPS: usize = 200;

/// 200 steps, each solved to 1e-12, on momenta of order 1.
const BOUND: f64 = STEPS as f64 * SOLVED_TO;

pub(super) const LAW: Law = Law {
    id: "momentum",
    summary: "with nothing fixed and no external force momentum is kept, and angular momentum too \
              by a symplectic method where dampers are axial; isotropic dampers brake a turning",
    derivation: "200 steps solved to 1e-12 on momenta of order 1; explicit ones leave 6e-15 of \
                 rounding",
    judge: |subject| {
        // A method that claims nothing of damping is met without.
        let damping = subject.claims.order_damped.map_or(0.0, |_| 0.8);
        let (linear, angular) = lost(subject, damping, DampingModel::Axial)?;
        let mut worst = Verdict::at_most(linear, BOUND, "momentum");
        if subject.claims.symplectic && angular > linear {
            worst = Verdict::at_most(angular, BOUND, "angular momentum");
        }
        if damping > 0.0 {
            let (linear, angular) = lost(subject, damping, DampingModel::Isotropic)?;
            let verdict = Verdict::at_most(linear, BOUND, "momentum under isotropic dampers");
            if verdict.measured > worst.measured {
                worst = verdict;
            }
            if angular < BRAKED {
                let message = "isotropic dampers do not brake the rotation: is damping left out?";
                return Ok(Verdict::fail(angular, BRAKED, message));
            }
        }
        Ok(worst)
    },
};

/// kg m²/s that isotropic dampers take within the run: every method of the registry loses 0.189 or
/// more.
const BRAKED: f64 = 0.07;

/// What is lost of momentum and of angular momentum.
fn lost(subject: &Subject, damping: f64, model: DampingModel) -> Result<(f64, f64), Broken> {
    let scene = free_triangle(damping, model);
    let (system, start) = (
        ParticleSystem::new(&scene),
        ParticleSystem::initial_state(&scene),
    );
    let mut state = start.clone();
    advance(subject.fresh().as_mut(), &system, 0.005, STEPS, &mut state)?;
    let (before, after) = (momenta(&system, &start), momenta(&system, &state));
    let difference = |i: usize| {
        let pairs = before[i].iter().zip(&after[i]);
        pairs.fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()))
    };
    Ok((difference(0), difference(1)))
}

/// Total momentum, kg m/s, and angular momentum about the origin, kg m²/s.
fn momenta(system: &ParticleSystem, state: &State) -> [[f64; 3]; 2] {
    let mut totals = [[0.0; 3]; 2];
    let particles = state.x.chunks_exact(3).zip(state.v.chunks_exact(3));
    for ((x, v), w) in particles.zip(system.inverse_mass().chunks_exact(3)) {
        for a in 0..3 {
            let (b, c) = ((a + 1) % 3, (a + 2) % 3);
            totals[0][a] += v[a] / w[a];
            totals[1][a] += (x[b] * v[c] - x[c] * v[b]) / w[a];
        }
    }
    totals
}
