//! A method's facts, from its coefficients alone: order, symmetry, stability, energy.

use super::adaptive::Pair;
use super::amplification::{Rational, band, oscillator_limit};
use super::{
    Amplification, Coefficients, DampingTreatment, EnergyLaw, ImplicitScheme, Method,
    OscillatorFacts, PerStep, Stable, Stage, Tableau,
};
use crate::physics::Linearization;
use nalgebra::Complex;

/// The part of a method that its author writes. [`Method::new`] derives the rest.
///
/// ```
/// use springcheck::conformance::{Claims, check};
/// use springcheck::integrators::{Coefficients, Method, MethodRow, Settings, Stable, Tableau};
/// use springcheck::measure::CheckStatus;
///
/// let heun3 = Method::new(MethodRow {
///     id: "heun3",
///     name: "Heun's third-order method",
///     coefficients: Coefficients::Tableau(Tableau {
///         a: &[&[], &[1.0 / 3.0], &[0.0, 2.0 / 3.0]],
///         b: &[0.25, 0.0, 0.75],
///         c: &[0.0, 1.0 / 3.0, 2.0 / 3.0],
///     }),
///     energy: None,
///     source: "Heun 1900",
///     not: "heun, which is of second order; rk3",
/// });
/// assert_eq!(heun3.order, 3);
/// let Stable::Below(z) = heun3.oscillator.stable else {
///     panic!("stable up to the root of 3");
/// };
/// assert!((z - 3_f64.sqrt()).abs() < 1e-15);
///
/// // Its steps agree with the facts derived from its coefficients.
/// let build = || heun3.build(&Settings::default());
/// let findings = check(&build, &Claims::from(&heun3));
/// assert!(findings.iter().all(|finding| finding.status != CheckStatus::Fail));
/// ```
#[derive(Debug, Clone, Copy)]
pub struct MethodRow {
    /// The id scenes, reports and the command line use.
    pub id: &'static str,
    pub name: &'static str,
    pub coefficients: Coefficients,
    /// A formula in z = h w for the oscillator's energy, for readers: a factor, or a band in brackets.
    /// Without one, a factor is shown as |R(iz)|², and a composition's energy only as bounded.
    pub energy: Option<&'static str>,
    /// Paper or textbook.
    pub source: &'static str,
    /// What it must not be confused with.
    pub not: &'static str,
}

impl Method {
    /// Derives all facts. Call it once for a method: the facts live as long as the program.
    pub fn new(row: MethodRow) -> Self {
        match row.coefficients {
            Coefficients::Tableau(tableau) | Coefficients::Pair(Pair { tableau, .. }) => {
                let evaluations = PerStep::Exactly(tableau.b.len() as u32);
                of_tableau(row, &tableau, evaluations)
            }
            Coefficients::Implicit(scheme) => of_scheme(row, scheme),
            Coefficients::Composition(stages, damping) => of_composition(row, stages, damping),
            Coefficients::Rattle(_) => of_composition(row, Stage::VERLET, DampingTreatment::Sweeps),
        }
    }
}

/// The residual below which an order condition holds. Its sums have up to twelve terms, up to 44 in size,
/// with factors of many roundings: the measured residuals are at most 1.4e-14 where a condition holds, and
/// at least 1.3e-6 where it does not.
const ROUNDING: f64 = 4e-14;

fn is_zero(value: f64) -> bool {
    value.abs() < ROUNDING
}

/// Whether a method of this order is exact in free fall. Its errors are derivatives of the force, which
/// vanish for a constant one, except for the term h² a / 2 that order 1 lacks.
pub(crate) const fn is_exact(order: u32) -> bool {
    order > 1
}

fn of_tableau(row: MethodRow, tableau: &Tableau, evaluations: PerStep) -> Method {
    let order = tableau.order(tableau.b);
    let rational = Rational::of(tableau, order);
    let undamped = Complex::new(0.0, 1.0);
    Method {
        id: row.id,
        name: row.name,
        order,
        order_damped: order,
        symplectic: tableau.is_symplectic(),
        reversible: tableau.is_symmetric(),
        evaluations,
        oscillator: OscillatorFacts {
            stable: rational.reach(undamped),
            energy: EnergyLaw::Factor {
                factor: Box::leak(Box::new(move |z| 1.0 + rational.gain(undamped, z))),
                formula: row.energy.unwrap_or("|R(iz)|²"),
            },
        },
        coefficients: row.coefficients,
        amplification: Amplification::Rational(rational),
        exact: is_exact(order),
        source: row.source,
        not: row.not,
    }
}

fn of_scheme(row: MethodRow, scheme: ImplicitScheme) -> Method {
    let tableau = scheme.tableau();
    // Besides the iterations, each stage takes one evaluation: an implicit one to see that it has converged.
    let iterated = PerStep::PerIteration {
        plus: tableau.b.len() as u32,
    };
    let mut method = of_tableau(row, &tableau, iterated);
    if let ImplicitScheme::PredictedEuler | ImplicitScheme::LinearizedEuler(_) = scheme {
        method.evaluations = PerStep::Exactly(1);
    }
    if scheme == ImplicitScheme::LinearizedEuler(Linearization::Material) {
        method.amplification = Amplification::MaterialImplicit;
        // Without the stiffness across, a step kicks with the force at the start and then drifts.
        if let Stable::Below(across) = oscillator_limit(Stage::SYMPLECTIC_EULER) {
            method.oscillator.stable = Stable::AlwaysAlong { across };
        }
    }
    method
}

fn of_composition(row: MethodRow, stages: &'static [Stage], damping: DampingTreatment) -> Method {
    let order = order_of_kicks(stages);
    Method {
        id: row.id,
        name: row.name,
        order,
        order_damped: match damping {
            // Each kick has 1 - h b c for exp(-h b c). The product has order 2 only if the sum of all b² is 0.
            DampingTreatment::Explicit => order.min(1),
            DampingTreatment::ExactFlow => order_of_flows(stages, order),
            // The midpoint rule is symmetric, as a sweep each way is: the exact flow but for a term of (c h)³.
            DampingTreatment::Sweeps | DampingTreatment::Boris => {
                order_of_sweeps(stages, order_of_flows(stages, order))
            }
        },
        symplectic: true,
        reversible: stages.iter().eq(stages.iter().rev()),
        evaluations: PerStep::Exactly(evaluations(stages, damping)),
        oscillator: OscillatorFacts {
            stable: oscillator_limit(stages),
            energy: row
                .energy
                .map_or(EnergyLaw::Bounded, |formula| EnergyLaw::Band {
                    band: Box::leak(Box::new(|z| band(stages, z))),
                    formula,
                }),
        },
        coefficients: row.coefficients,
        amplification: Amplification::Composition(stages, damping),
        exact: is_exact(order),
        source: row.source,
        not: row.not,
    }
}

/// The facts of a composition whose kicks are all explicit.
pub(super) fn of_explicit_kicks(method: &Method, stages: &'static [Stage]) -> Method {
    let damping = DampingTreatment::Explicit;
    Method {
        order_damped: method.order.min(1),
        evaluations: PerStep::Exactly(evaluations(stages, damping)),
        amplification: Amplification::Composition(stages, damping),
        ..*method
    }
}

/// The force evaluations of a step: one for each kick, except for a first kick that reuses the force of the
/// last kick of the step before. An explicit kick depends on the velocity, so it reuses none.
fn evaluations(stages: &[Stage], damping: DampingTreatment) -> u32 {
    let kicks = stages
        .iter()
        .filter(|s| matches!(s, Stage::Kick(_)))
        .count() as u32;
    let same = matches!(stages, [Stage::Kick(_), .., Stage::Kick(_)]);
    kicks - u32::from(same && damping != DampingTreatment::Explicit)
}

impl Tableau {
    fn at(&self, row: usize, column: usize) -> f64 {
        let row = self.a.get(row);
        row.and_then(|row| row.get(column)).copied().unwrap_or(0.0)
    }

    /// The product A w.
    pub(super) fn through(&self, weights: &[f64]) -> Vec<f64> {
        let sum = |row: &&[f64]| row.iter().zip(weights).map(|(a, w)| a * w).sum();
        self.a.iter().map(sum).collect()
    }

    /// The order of the formula with these weights.
    pub fn order(&self, weights: &[f64]) -> u32 {
        highest_order(weights, Vec::new(), &|tree| Tree {
            weights: self.through(&tree.weights),
            ..*tree
        })
    }

    /// b_i a_ij + b_j a_ji = b_i b_j (Hairer, Lubich, Wanner, Geometric Numerical Integration, VI.4).
    fn is_symplectic(&self) -> bool {
        let count = self.b.len();
        (0..count).all(|i| {
            (0..count).all(|j| {
                let (b, d) = (self.b[i], self.b[j]);
                is_zero(b * self.at(i, j) + d * self.at(j, i) - b * d)
            })
        })
    }

    /// a_ij + a_(s-1-i, s-1-j) = b_j: the method is its own adjoint (the same, V.2).
    fn is_symmetric(&self) -> bool {
        let count = self.b.len();
        (0..count).all(|i| {
            (0..count).all(|j| {
                let mirrored = self.at(count - 1 - i, count - 1 - j);
                is_zero(self.at(i, j) + mirrored - self.b[j])
            })
        })
    }
}

/// The order of a composition where accelerations depend on positions alone. It is then a Nyström method
/// with a stage for each kick (Hairer, Nørsett, Wanner, Solving ODEs I, II.14).
fn order_of_kicks(stages: &[Stage]) -> u32 {
    let (mut weights, mut nodes) = (Vec::new(), Vec::new());
    let mut drifted = 0.0;
    for stage in stages {
        match stage {
            Stage::Drift(part) => drifted += part,
            Stage::Kick(part) => {
                weights.push(*part);
                nodes.push(drifted);
            }
        }
    }
    let drift = Tree {
        vertices: 1,
        weights: nodes.clone(),
        density: 1.0,
    };
    highest_order(&weights, vec![drift], &|tree| {
        let kick = |i: usize, j: usize| weights[j] * (nodes[i] - nodes[j]) * tree.weights[j];
        let vertices = tree.vertices + 1;
        Tree {
            vertices,
            weights: (0..nodes.len())
                .map(|i| (0..i).map(|j| kick(i, j)).sum())
                .collect(),
            density: tree.density * f64::from(vertices),
        }
    })
}

/// The highest order that is tested.
const HIGHEST_ORDER: u32 = 10;

/// A rooted tree, alone or as a branch of a larger one.
struct Tree {
    vertices: u32,
    /// Its elementary weight at each stage.
    weights: Vec<f64>,
    density: f64,
}

/// The order of the formula Σ b k: the number of vertices up to which Σ b w = 1/density holds for every tree,
/// a root with any multiset of branches (Butcher 1963; Hairer, Nørsett, Wanner, Solving ODEs I, II.2).
/// `branches` are the initial ones, and `turned` makes a branch from a tree.
fn highest_order(b: &[f64], mut branches: Vec<Tree>, turned: &dyn Fn(&Tree) -> Tree) -> u32 {
    for vertices in 1..=HIGHEST_ORDER {
        let mut trees = Vec::new();
        let root = Tree {
            vertices,
            weights: vec![1.0; b.len()],
            density: f64::from(vertices),
        };
        grow(root, vertices - 1, &branches, &mut trees);
        let holds = |tree: &Tree| {
            let sum: f64 = b.iter().zip(&tree.weights).map(|(b, w)| b * w).sum();
            is_zero(sum - 1.0 / tree.density)
        };
        if !trees.iter().all(holds) {
            return vertices - 1;
        }
        branches.extend(trees.iter().map(turned));
    }
    HIGHEST_ORDER
}

/// Adds this many vertices to a tree by branches, in every way, each multiset of branches once.
fn grow(tree: Tree, left: u32, branches: &[Tree], grown: &mut Vec<Tree>) {
    if left == 0 {
        grown.push(tree);
        return;
    }
    for (at, branch) in branches.iter().enumerate() {
        if branch.vertices <= left {
            let weights = tree.weights.iter().zip(&branch.weights);
            let larger = Tree {
                vertices: tree.vertices,
                weights: weights.map(|(a, b)| a * b).collect(),
                density: tree.density * branch.density,
            };
            grow(larger, left - branch.vertices, &branches[at..], grown);
        }
    }
}

/// The order of a composition of exact flows of any two vector fields: the length up to which the product of
/// their exponentials has, for each word of the two letters, the coefficient of exp(A + B), one over the
/// factorial of its length. It is at most `order`, the order where the second field depends on positions alone.
fn order_of_flows(stages: &[Stage], order: u32) -> u32 {
    // Coefficients by length, then by the word as a binary number.
    let mut words: Vec<Vec<f64>> = (0..=order).map(|l| vec![0.0; 1 << l]).collect();
    words[0][0] = 1.0;
    for stage in stages {
        let (letter, part) = match stage {
            Stage::Drift(part) => (0, part),
            Stage::Kick(part) => (1, part),
        };
        // The longest words come first, since they need the shorter ones of the stages before.
        for length in (1..words.len()).rev() {
            for word in 0..1 << length {
                let (mut coefficient, mut power) = (words[length][word], 1.0);
                for taken in 1..=length {
                    if (word >> (taken - 1)) & 1 != letter {
                        break;
                    }
                    power *= part / taken as f64;
                    coefficient += power * words[length - taken][word >> taken];
                }
                words[length][word] = coefficient;
            }
        }
    }
    let mut wanted = 1.0;
    for (length, found) in words.iter().enumerate().skip(1) {
        wanted /= length as f64;
        if !found.iter().all(|found| is_zero(found - wanted)) {
            return length as u32 - 1;
        }
    }
    order
}

/// The order of a composition that has `flows` with exact flows in its kicks, where these are sweeps.
///
/// A kick c with a sweep each way is symmetric: the exact flow but for a term of (c h)³, and higher odd powers.
/// The sum of all c³ decides on order 3, and a composition that reads the same backwards has no odd order. Half
/// kicks at both ends, with one sweep each, are of order 2.
fn order_of_sweeps(stages: &[Stage], flows: u32) -> u32 {
    let cubes: f64 = (stages.iter())
        .map(|stage| match stage {
            Stage::Drift(_) => 0.0,
            Stage::Kick(part) => part.powi(3),
        })
        .sum();
    let palindrome = stages.iter().eq(stages.iter().rev());
    if Stage::half_kicks_at_ends(stages) || !is_zero(cubes) {
        flows.min(2)
    } else if palindrome {
        flows.min(4)
    } else {
        flows.min(3)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_rooted_trees_are_grown_once() {
        let mut branches: Vec<Tree> = Vec::new();
        let mut counts = Vec::new();
        for vertices in 1..=8 {
            let tree = |vertices| Tree {
                vertices,
                weights: Vec::new(),
                density: 1.0,
            };
            let mut trees = Vec::new();
            grow(tree(vertices), vertices - 1, &branches, &mut trees);
            counts.push(trees.len());
            branches.extend(trees);
        }
        // OEIS A000081.
        assert_eq!(counts, [1, 1, 2, 4, 9, 20, 48, 115]);
    }
}
