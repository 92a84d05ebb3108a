//! How programs keep rods: by forces, by moving particles after a step, or by both.

use super::altered::sign;
use crate::integrators::StepError;
use crate::physics::constraints::Rods;
use crate::physics::{ParticleSystem, State, System};
use crate::scene::{Constraints, Stabilisation};
use std::sync::Arc;

/// What a program does about rods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Kept {
    /// Whether their forces act; else they are left out.
    pub forces: bool,
    /// What is done about positions after a step.
    pub positions: Moved,
    /// What is done about velocities after that.
    pub velocities: Moved,
    /// Whether each end moves by its 1/m; else both by the same.
    pub masses: bool,
}

/// What moves positions or velocities onto rods.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Moved {
    /// Nothing does.
    Not,
    /// All rods at once to rounding, along their directions at each iteration.
    Solved,
    /// All rods at once to rounding, along their directions before it (Hairer, Lubich, Wanner, IV.4).
    Straight,
    /// One rod after the other in the scene's order, until all lengths hold.
    SweptOut,
    /// One rod after the other in the scene's order, so often.
    Swept(u32),
    /// As swept, with a compliance, m/N (Macklin, Müller, Chentanez 2016, Motion in Games).
    Compliant(u32, f64),
    /// Velocities alone: what a step moved, over its length (Müller et al. 2007, J. Vis. Commun. Image R. 18).
    Differences,
}

impl Moved {
    fn sweeps(self) -> u32 {
        match self {
            Self::Not | Self::Differences => 0,
            Self::Solved | Self::Straight => 4,
            Self::SweptOut => 30,
            Self::Swept(sweeps) | Self::Compliant(sweeps, _) => sweeps,
        }
    }
}

impl Kept {
    /// Forces and a projection of both.
    pub(super) const PROJECTED: Self = Self {
        forces: true,
        positions: Moved::Solved,
        velocities: Moved::Solved,
        masses: true,
    };

    /// Whether velocities are differences of positions.
    pub(super) fn differences(self) -> bool {
        self.velocities == Moved::Differences
    }

    /// Whether it leaves no velocity along rods.
    pub(super) fn stills(self) -> bool {
        !matches!(
            self.velocities,
            Moved::Not | Moved::Swept(_) | Moved::Compliant(..) | Moved::Differences
        )
    }

    /// Positions are moved, and velocities are what they moved by.
    pub(super) const fn position_based(positions: Moved) -> Self {
        Self {
            forces: false,
            positions,
            velocities: Moved::Differences,
            masses: true,
        }
    }
}

/// How a candidate keeps rods, where not as the scene says.
#[derive(Clone)]
pub(super) enum Keeping {
    /// By forces of rods, stabilised so.
    Stabilised(Constraints),
    /// In a way of its own, with the rods that it moves particles onto.
    By(Kept, Arc<Rods>),
}

impl Keeping {
    /// None where the system has no rods.
    pub(super) fn by(kept: Kept, system: &ParticleSystem) -> Option<Self> {
        let rods = system.rods()?;
        let rods = if kept.masses {
            rods.stabilised(&Constraints::default())
        } else {
            rods.with_unit_masses()
        };
        Some(Self::By(kept, Arc::new(rods)))
    }

    /// The same with the rods of a system; None where it has none to move particles onto.
    pub(super) fn on(&self, system: &ParticleSystem) -> Option<Self> {
        match self {
            Self::Stabilised(_) => Some(self.clone()),
            Self::By(kept, _) => Self::by(*kept, system),
        }
    }

    /// The forces that act.
    pub(super) fn forces(&self, system: ParticleSystem) -> ParticleSystem {
        system.with_rods(|rods| match self {
            Self::Stabilised(by) => Some(rods.stabilised(by)),
            Self::By(kept, _) => kept.forces.then(|| {
                rods.stabilised(&Constraints {
                    stabilisation: Stabilisation::None,
                    ..Constraints::default()
                })
            }),
        })
    }

    /// What a step costs besides its forces, in evaluations of them.
    pub(super) fn effort(&self) -> u64 {
        match self {
            Self::Stabilised(_) => 0,
            Self::By(kept, _) => u64::from(kept.positions.sweeps() + kept.velocities.sweeps()),
        }
    }
}

/// Moves a state onto rods after a step of `h` seconds from `start`, off by rounding in the direction of a pattern.
pub(super) fn keep(
    rods: &Rods,
    kept: Kept,
    h: f64,
    start: &State,
    state: &mut State,
    nudge: Option<(u64, u64)>,
) -> Result<(), StepError> {
    let (mut x, mut v) = (state.x.clone(), state.v.clone());
    match kept.positions {
        Moved::Solved => {
            rods.project(&mut x, &mut vec![0.0; v.len()])?;
        }
        Moved::Straight => rods.straighten(&mut x)?,
        moved => sweep(rods, moved, h, &mut x),
    }
    if let Some(nudge) = nudge.filter(|_| kept.positions != Moved::Not) {
        let mut still = vec![0.0; v.len()];
        rods.blur(&mut x, &mut still, |rod| sign(nudge, rod));
    }
    match kept.velocities {
        Moved::Solved | Moved::Straight | Moved::SweptOut => rods.still(&x, &mut v)?,
        Moved::Swept(sweeps) => (0..sweeps).for_each(|_| slow(rods, &x, &mut v)),
        Moved::Differences => {
            for (i, v) in v.iter_mut().enumerate() {
                if rods.weights()[i / 3] > 0.0 {
                    *v = (x[i] - start.x[i]) / h;
                }
            }
        }
        Moved::Not | Moved::Compliant(..) => {}
    }
    (state.x, state.v) = (x, v);
    Ok(())
}

/// Sweeps after which lengths that do not hold never will.
const MOST_SWEEPS: u32 = 10_000;
/// Relative errors of lengths that small are rounding where they fall no more.
const CLOSE: f64 = 1e-14;

/// Gauss and Seidel's sweeps over positions: each rod in turn is brought to its length.
fn sweep(rods: &Rods, moved: Moved, h: f64, x: &mut [f64]) {
    let (sweeps, compliance) = match moved {
        Moved::SweptOut => (MOST_SWEEPS, 0.0),
        Moved::Swept(sweeps) => (sweeps, 0.0),
        Moved::Compliant(sweeps, compliance) => (sweeps, compliance / (h * h)),
        _ => return,
    };
    let mut impulses = vec![0.0; rods.len()];
    let mut before = f64::INFINITY;
    for _ in 0..sweeps {
        let mut worst = 0.0_f64;
        for ((ends, length), sum) in rods.ends().iter().zip(rods.lengths()).zip(&mut impulses) {
            let [wi, wj] = ends.map(|end| rods.weights()[end]);
            let (n, far) = along(ends, x);
            let impulse = (length - far - compliance * *sum) / (wi + wj + compliance);
            *sum += impulse;
            worst = worst.max((length - far).abs() / length);
            push(rods, ends, n, impulse, x);
        }
        let arrived = worst <= f64::EPSILON || (worst < CLOSE && worst >= before);
        if moved == Moved::SweptOut && arrived {
            break;
        }
        before = worst;
    }
}

/// One sweep over velocities: each rod in turn loses the velocity along it.
fn slow(rods: &Rods, x: &[f64], v: &mut [f64]) {
    for ends in rods.ends() {
        let [wi, wj] = ends.map(|end| rods.weights()[end]);
        let (n, _) = along(ends, x);
        let parting: f64 = (0..3)
            .map(|c| n[c] * (v[3 * ends[1] + c] - v[3 * ends[0] + c]))
            .sum();
        push(rods, ends, n, -parting / (wi + wj), v);
    }
}

/// The direction and the distance from the first end to the second.
fn along([i, j]: &[usize; 2], x: &[f64]) -> ([f64; 3], f64) {
    let d = [0, 1, 2].map(|c| x[3 * j + c] - x[3 * i + c]);
    let far = d[0].hypot(d[1]).hypot(d[2]);
    (d.map(|d| d / far), far)
}

/// Moves both ends apart by an impulse along `n`, each by its 1/m.
fn push(rods: &Rods, [i, j]: &[usize; 2], n: [f64; 3], impulse: f64, y: &mut [f64]) {
    for c in 0..3 {
        y[3 * i + c] -= rods.weights()[*i] * impulse * n[c];
        y[3 * j + c] += rods.weights()[*j] * impulse * n[c];
    }
}
