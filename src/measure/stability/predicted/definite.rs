//! Methods of one kick and one drift a step, on modes that damping couples: when a symmetric matrix is
//! definite.
//!
//! For an eigenvector q of the one-step map, with k = q*Kq, c = q*Cq, the eigenvalue μ solves a real
//! quadratic. Its constant part never exceeds the leading one, so with K, C >= 0 it leaves the unit
//! circle through μ = -1 alone: the method is stable exactly while
//!
//! - textbook kicks: 4 - 2 h C - h² K >= 0;
//! - exact damping flows (Verlet, whose half kicks or half drifts merge): 2 h C coth(h C / 2) - h² K >= 0;
//! - kicks by the midpoint rule (Boris): 4 - h² K >= 0, whatever the damping;
//! - linearly implicit Euler with K' for K in its matrix: 4 + 2 h C + h² (2 K' - K) >= 0.
//!
//! Each is a decreasing function of h but for a positive factor. What is unstable in truth (K < 0)
//! leaves through μ = 1 and does not matter here.

use super::krylov;
use super::part::Part;
use super::prediction::Prediction;
use super::spectrum::Mode;
use super::{Effort, Limit};
use crate::integrators::{Amplification, DampingTreatment, Stage, bisect};

/// The kind of method whose matrix it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Definite {
    Explicit,
    ExactFlow,
    Midpoint,
    Material,
}

/// Most vectors for the action of the damping's function.
const INNER: usize = 80;
/// Newton's iteration on the form squares its error.
const ITERATIONS: usize = 40;

impl Definite {
    /// The kind of a method; None if it has more than one kick after neighbours are merged, where a
    /// step's last stage and the next step's first are neighbours. Textbook kicks do not merge.
    pub fn of(amplification: Amplification) -> Option<Self> {
        let (stages, damping) = match amplification {
            Amplification::Rational(_) => return None,
            Amplification::MaterialImplicit => return Some(Self::Material),
            Amplification::Composition(stages, damping) => (stages, damping),
        };
        let is_kick = |stage: &Stage| matches!(stage, Stage::Kick(_));
        let kicks = stages.iter().filter(|stage| is_kick(stage)).count();
        let neighbours = stages.iter().zip(stages.iter().cycle().skip(1));
        let changes = neighbours.filter(|(one, next)| is_kick(one) != is_kick(next));
        match damping {
            DampingTreatment::Explicit if kicks == 1 => Some(Self::Explicit),
            DampingTreatment::Explicit => None,
            _ if changes.count() != 2 => None,
            DampingTreatment::Boris if kicks == 1 => Some(Self::Midpoint),
            DampingTreatment::Boris => None,
            _ => Some(Self::ExactFlow),
        }
    }

    /// The limit of a mode damped by itself; None where there is none.
    pub fn limit_of(self, mode: Mode) -> Option<f64> {
        self.root(mode.stiffness, 0.0, &[(mode.damping, 1.0)])
    }

    /// The h at which the form of a vector of stiffness `k` and `material` vanishes. Its damping is
    /// given by the `nodes` (c, weight), whose weights sum to 1.
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
            Self::Midpoint => (k > 0.0).then(|| 2.0 / k.sqrt()),
            Self::ExactFlow => {
                if k <= 0.0 {
                    return None;
                }
                let form = |h: f64| {
                    let flow: f64 = nodes.iter().map(|(c, weight)| weight * flow(h * c)).sum();
                    flow - h * h * k
                };
                // 4 <= flow(u) <= 4 + 2 u.
                let (low, high) = (2.0 / k.sqrt(), (c + (c * c + 4.0 * k).sqrt()) / k);
                Some(bisect(low, high, 0.0, |h| form(h) >= 0.0))
            }
        }
    }

    /// The limit of a part, without growth: Newton's iteration on h, each time for the vector whose form is
    /// the first to vanish. None where Lanczos does not converge. K, C and K' are taken for symmetric.
    pub fn limit(self, part: &Part, effort: &Effort) -> Option<Prediction> {
        let n = part.n();
        let Part {
            stiffness,
            damping,
            material,
            ..
        } = part;
        let flows = self == Self::ExactFlow && damping.norm() > 0.0;
        let damp = |x: &[f64], y: &mut [f64]| damping.product(x, y);
        // A first vector: of the stiffness, or, where there is none, of the damping.
        let stiff = |x: &[f64], y: &mut [f64]| {
            stiffness.product(x, y);
            if self == Self::Material {
                material.add_product(-2.0, x, y);
            }
        };
        let (largest, mut q) = krylov::top(n, &stiff, effort)?;
        let rounding = 1e-13 * (stiffness.norm() + material.norm());
        let mut found = Prediction::only(Limit::Unconditional).within(krylov::error(n, effort));
        if largest <= rounding {
            if self != Self::Explicit || damping.norm() == 0.0 {
                return Some(found);
            }
            q = krylov::top(n, &damp, effort)?.1;
        }
        let at_most = flows && n > effort.flow;
        found.reason =
            at_most.then(|| "at most: damping couples too many modes to look at all".to_owned());
        let mut h = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let mode = Mode {
                stiffness: stiffness.form(&q),
                damping: damping.form(&q),
            };
            let nodes = if flows {
                krylov::nodes(&damp, &q, INNER)?.nodes
            } else {
                vec![(mode.damping, 1.0)]
            };
            let Some(next) = self.root(mode.stiffness, material.form(&q), &nodes) else {
                break;
            };
            let done = next >= h * (1.0 - 1e-13);
            if next < h {
                h = next;
                found.limit = Limit::At(h);
                found.binding = Some(mode);
            }
            if at_most {
                // Damping never lowers Verlet's limit.
                found = found.within(1.0 - 2.0 / (largest.sqrt() * h));
            }
            if done || at_most {
                break;
            }
            let product = |x: &[f64], y: &mut [f64]| {
                y.fill(0.0);
                stiffness.add_product(h * h, x, y);
                if flows {
                    if let Some(nodes) = krylov::nodes(&damp, x, INNER) {
                        nodes.action(-1.0, &|c| flow(h * c), y);
                    }
                    return;
                }
                match self {
                    Self::Explicit => damping.add_product(2.0 * h, x, y),
                    Self::Material => {
                        material.add_product(-2.0 * h * h, x, y);
                        damping.add_product(-2.0 * h, x, y);
                    }
                    Self::ExactFlow | Self::Midpoint => {}
                }
                for (y, x) in y.iter_mut().zip(x) {
                    *y -= 4.0 * x;
                }
            };
            q = krylov::top(n, &product, effort)?.1;
        }
        Some(found)
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
