//! Methods of one kick and one drift a step, on modes that damping couples: when a symmetric matrix is
//! definite.
//!
//! For an eigenvector q of the one-step map, with k = q*Kq, c = q*Cq, the eigenvalue μ solves a real
//! quadratic. Its constant part never exceeds the leading one, so with K, C >= 0 it leaves the unit
//! circle through μ = -1 alone: the method is stable exactly while
//!
//! - textbook kicks: 4 - 2 h C - h² K >= 0;
//! - exact damping flows (Verlet, whose half kicks or half drifts merge): 2 h C coth(h C / 2) - h² K >= 0;
//! - linearly implicit Euler with K' for K in its matrix: 4 + 2 h C + h² (2 K' - K) >= 0.
//!
//! Each is a decreasing function of h but for a positive factor. What is unstable in truth (K < 0)
//! leaves through μ = 1 and does not matter here.

use super::Effort;
use super::assembly::Component;
use super::krylov::{self, Nodes};
use super::mode::Mode;
use crate::integrators::{DampingTreatment, Stage};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum OneKick {
    Explicit,
    ExactFlow,
    Material,
}

impl OneKick {
    /// None where there is more than one kick, after merging neighbours, the step's last stage being
    /// the next one's neighbour. Textbook kicks do not merge.
    pub(super) fn of(stages: &[Stage], damping: DampingTreatment) -> Option<Self> {
        let is_kick = |stage: &Stage| matches!(stage, Stage::Kick(_));
        let kicks = stages.iter().filter(|stage| is_kick(stage)).count();
        let changes = stages
            .iter()
            .zip(stages.iter().cycle().skip(1))
            .filter(|(one, next)| is_kick(one) != is_kick(next))
            .count();
        match damping {
            DampingTreatment::Explicit if kicks == 1 => Some(Self::Explicit),
            DampingTreatment::ExactFlow if changes == 2 => Some(Self::ExactFlow),
            _ => None,
        }
    }

    /// The limit of a mode damped by itself; None where there is none.
    pub(super) fn limit(self, mode: Mode) -> Option<f64> {
        self.root(mode.stiffness, 0.0, &[(mode.damping, 1.0)])
    }

    /// The h at which the form of a vector vanishes: of stiffness `k` and `material`, damped as the
    /// `nodes` (c, weight) say, the weights summing to 1.
    fn root(self, k: f64, material: f64, nodes: &[(f64, f64)]) -> Option<f64> {
        let c: f64 = nodes.iter().map(|(c, weight)| c * weight).sum();
        match self {
            Self::Explicit => {
                let sum = c + (c * c + 4.0 * k).max(0.0).sqrt();
                (sum > 0.0).then(|| 4.0 / sum)
            }
            Self::Material => {
                let across = k - 2.0 * material;
                (across > 0.0).then(|| (c + (c * c + 4.0 * across).sqrt()) / across)
            }
            Self::ExactFlow => {
                if k <= 0.0 {
                    return None;
                }
                let form = |h: f64| {
                    let flow: f64 = nodes.iter().map(|(c, weight)| weight * flow(h * c)).sum();
                    flow - h * h * k
                };
                // 4 <= flow(u) <= 4 + 2 u.
                let mut low = 2.0 / k.sqrt();
                let mut high = (c + (c * c + 4.0 * k).sqrt()) / k;
                loop {
                    let middle = 0.5 * (low + high);
                    if middle <= low || middle >= high {
                        return Some(low);
                    }
                    if form(middle) >= 0.0 {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
            }
        }
    }
}

/// 2 u coth(u/2): 4 without damping.
fn flow(u: f64) -> f64 {
    if u.abs() < 1e-4 {
        // coth cancels; the next term is u⁴/360.
        return 4.0 + u * u / 3.0;
    }
    2.0 * u / (0.5 * u).tanh()
}

/// Vectors an action of the damping's function takes at most.
const INNER: usize = 80;
/// Newton's iteration on the form squares its error.
const ITERATIONS: usize = 40;

/// Of a unit vector: its stiffness, its stiffness along springs, and nodes of its damping.
type Forms = (f64, f64, Vec<(f64, f64)>);

/// What a part allows.
pub(super) struct Found {
    /// Seconds; None where every step is stable.
    pub limit: Option<f64>,
    /// The mode that binds, by its forms.
    pub binding: Option<Mode>,
    /// The limit may be smaller.
    pub at_most: bool,
}

/// None where Lanczos does not converge. K, C and K' are taken for symmetric.
pub(super) fn limit(kind: OneKick, component: &Component, effort: &Effort) -> Option<Found> {
    let n = component.n();
    let Component {
        stiffness,
        damping,
        material,
    } = component;
    let damp = |x: &[f64], y: &mut [f64]| {
        y.fill(0.0);
        damping.add_product(1.0, x, y);
    };
    let forms = |q: &[f64]| -> Option<Forms> {
        let nodes = if kind == OneKick::ExactFlow && damping.norm() > 0.0 {
            let Nodes { nodes, weights, .. } = krylov::nodes(&damp, q, INNER)?;
            nodes.into_iter().zip(weights).collect()
        } else {
            vec![(damping.form(q), 1.0)]
        };
        Some((stiffness.form(q), material.form(q), nodes))
    };
    // A first vector: of the stiffness, or, where there is none, of the damping.
    let (largest, mut q) = krylov::top(
        n,
        &|x, y| {
            y.fill(0.0);
            stiffness.add_product(1.0, x, y);
            if kind == OneKick::Material {
                material.add_product(-2.0, x, y);
            }
        },
        effort,
    )?;
    let rounding = 1e-13 * (stiffness.norm() + material.norm());
    if largest <= rounding {
        if kind != OneKick::Explicit || damping.norm() == 0.0 {
            return Some(Found {
                limit: None,
                binding: None,
                at_most: false,
            });
        }
        q = krylov::top(n, &damp, effort)?.1;
    }
    let mut h = f64::INFINITY;
    let mut binding = None;
    let at_most = kind == OneKick::ExactFlow && damping.norm() > 0.0 && n > effort.flow;
    for _ in 0..ITERATIONS {
        let (k, m, nodes) = forms(&q)?;
        let Some(next) = kind.root(k, m, &nodes) else {
            break;
        };
        let done = next >= h * (1.0 - 1e-13);
        if next < h {
            h = next;
            binding = Some(Mode {
                stiffness: k,
                damping: damping.form(&q),
            });
        }
        if done || at_most {
            break;
        }
        let product = |x: &[f64], y: &mut [f64]| {
            y.fill(0.0);
            stiffness.add_product(h * h, x, y);
            match kind {
                OneKick::Explicit => damping.add_product(2.0 * h, x, y),
                OneKick::Material => {
                    material.add_product(-2.0 * h * h, x, y);
                    damping.add_product(-2.0 * h, x, y);
                }
                OneKick::ExactFlow if damping.norm() > 0.0 => {
                    if let Some(nodes) = krylov::nodes(&damp, x, INNER) {
                        nodes.action(-1.0, &|c| flow(h * c), y);
                    }
                    return;
                }
                OneKick::ExactFlow => {}
            }
            for (y, x) in y.iter_mut().zip(x) {
                *y -= 4.0 * x;
            }
        };
        q = krylov::top(n, &product, effort)?.1;
    }
    Some(Found {
        limit: h.is_finite().then_some(h),
        binding,
        at_most,
    })
}
