//! Tests of private parts: descent, the three linear algorithms, and the choice between them.

use super::solver::Algorithm;
use super::*;
use crate::conformance::systems::swinging_triangle;
use crate::integrators::axpy;
use crate::physics::ParticleSystem;
use crate::scene::{DampingModel, Particle, Scene, Spring};

fn particle(position: [f64; 3], fixed: bool, mass: f64) -> Particle {
    Particle {
        position,
        fixed,
        mass,
        ..Particle::default()
    }
}

fn scene(particles: Vec<Particle>, springs: Vec<Spring>) -> Scene {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.particles = particles;
    scene.springs = springs;
    scene
}

fn spring(ends: [usize; 2], stiffness: f64, rest_length: f64) -> Spring {
    Spring {
        ends,
        stiffness,
        rest_length,
        ..Spring::default()
    }
}

/// A chain of three links of length 1 and rest length `rest`, hung from a fixed end, slightly bent.
fn chain(rest: f64, stiffness: f64) -> Scene {
    let bent = [0.0, 4e-4, -7e-4, 2e-4];
    let particles = (0..4).map(|i| particle([i as f64, bent[i], -0.5 * bent[i]], i == 0, 1.0));
    let springs = (0..3).map(|i| spring([i, i + 1], stiffness, rest));
    scene(particles.collect(), springs.collect())
}

/// A cloth of n by n, structural, shear and flexion springs, hung by two corners, rippled.
fn cloth(n: usize, stiffness: f64, mass: f64) -> Scene {
    let particles = (0..n * n).map(|p| {
        let (row, column) = (p / n, p % n);
        let ripple = 1e-3 * (1.3 * row as f64).sin() * (0.7 * column as f64).cos();
        let at = [0.1 * row as f64, 0.1 * column as f64, 2.0 + ripple];
        particle(at, p == 0 || p == n - 1, mass)
    });
    let mut springs = Vec::new();
    for (row, column) in (0..n * n).map(|p| (p / n, p % n)) {
        for (down, right) in [(0, 1), (1, 0), (1, 1), (1, -1), (0, 2), (2, 0)] {
            let (to_row, to) = (row + down, column as isize + right);
            if to_row < n && (0..n as isize).contains(&to) {
                let length = 0.1 * f64::from((down * down) as u32 + (right * right) as u32).sqrt();
                let ends = [row * n + column, to_row * n + to as usize];
                springs.push(spring(ends, stiffness, length));
            }
        }
    }
    scene(particles.collect(), springs)
}

/// Calls `act` with the equation of an implicit Euler step from the scene's start.
fn with_stage<T>(scene: &Scene, h: f64, act: impl FnOnce(&StageEquation, &State) -> T) -> T {
    let system = ParticleSystem::new(scene);
    let start = ParticleSystem::initial_state(scene);
    let stage = StageEquation {
        system: &system,
        t: h,
        gamma: h,
        b: &start.v,
        y: &start.x,
    };
    act(&stage, &start)
}

/// Φ at an iterate, J.
fn incremental_potential(stage: &StageEquation, at: &Trial) -> f64 {
    let mut twice = 0.0;
    for (i, w) in stage.system.inverse_mass().iter().enumerate() {
        if *w > 0.0 {
            twice += (at.u[i] - stage.b[i]).powi(2) / w;
        }
    }
    0.5 * twice + stage.system.potential(stage.t, &at.x)
}

/// The rule of the iteration, right or spoiled.
#[derive(Clone, Copy, PartialEq)]
enum Rule {
    Ours,
    /// Every step is a full step.
    NoSearch,
    /// Newton's direction is taken even where the matrix is indefinite.
    NotRegularised,
}

/// Φ at every iterate up to convergence, or the reason there was none.
fn descent(scene: &Scene, h: f64, rule: Rule) -> Result<Vec<f64>, String> {
    with_stage(scene, h, |stage, start| {
        let mut newton = Newton::new(Settings::default());
        let mut seen = Vec::new();
        if rule == Rule::Ours {
            newton
                .iterate(stage, &start.v, |at| {
                    seen.push(incremental_potential(stage, at))
                })
                .map_err(|e| e.to_string())?;
            seen.push(incremental_potential(stage, &newton.at));
            return Ok(seen);
        }
        fit(&mut newton.d, start.v.len());
        newton.at.u.extend_from_slice(&start.v);
        for _ in 0..Settings::default().iterations {
            newton.at.evaluate(stage);
            seen.push(incremental_potential(stage, &newton.at));
            if newton.at.relative <= 1e-12 {
                return Ok(seen);
            }
            match rule {
                Rule::NotRegularised => {
                    newton.assemble(stage, Linearization::Exact);
                    newton.matrix.gather(&newton.at.residual, &mut newton.z);
                    let (solver, matrix) = (&mut newton.solver, &newton.matrix);
                    solver
                        .solve_lu(matrix, &mut newton.z)
                        .map_err(|e| e.to_string())?;
                    newton.matrix.scatter(&newton.z, &mut newton.d);
                }
                _ => {
                    let definite = newton
                        .direction(stage, Linearization::Exact, 1e-3)
                        .map_err(|e| e.to_string())?;
                    if !definite {
                        newton.descend(stage, 1e-3).map_err(|e| e.to_string())?;
                    }
                }
            }
            axpy(&mut newton.at.u, 1.0, &newton.d);
        }
        Err("not converged".to_owned())
    })
}

/// Φ never rises from iterate to iterate, and the last is below the first.
fn descent_law(scene: &Scene, h: f64, rule: Rule) -> Result<(), String> {
    let seen = descent(scene, h, rule)?;
    let size = seen.iter().fold(0.0_f64, |m, e| m.max(e.abs()));
    for (at, pair) in seen.windows(2).enumerate() {
        // The energies are sums of a dozen numbers, whose rounding exceeds the change of the last steps.
        if pair[1] - pair[0] > 16.0 * f64::EPSILON * size || pair[1].is_nan() {
            return Err(format!(
                "rises from {} to {} in step {at}",
                pair[0], pair[1]
            ));
        }
    }
    match (seen.first(), seen.last()) {
        (Some(first), Some(last)) if last < first => Ok(()),
        ends => Err(format!("from {:?} to {:?}", ends.0, ends.1)),
    }
}

#[test]
fn the_incremental_potential_never_rises() {
    let rules = [Rule::NoSearch, Rule::NotRegularised];
    let mut uphill = Vec::new();
    for (rest, stiffness) in [(10.0, 1e3), (0.001, 1e3), (0.9, 1e6), (3.0, 50.0)] {
        for h in [1e-3, 1e-2, 1.0 / 60.0, 0.1] {
            let scene = chain(rest, stiffness);
            descent_law(&scene, h, Rule::Ours)
                .unwrap_or_else(|error| panic!("rest {rest}, k {stiffness}, h {h}: {error}"));
            for (at, &rule) in rules.iter().enumerate() {
                if descent_law(&scene, h, rule).is_err() {
                    uphill.push((at, rest, stiffness, h));
                }
            }
        }
    }
    // Links compressed to a tenth, h = 1/60: full steps overshoot, and Newton's own direction does not
    // descend.
    let named = (10.0, 1e3, 1.0 / 60.0);
    for at in 0..rules.len() {
        assert!(
            uphill.contains(&(at, named.0, named.1, named.2)),
            "{uphill:?}"
        );
    }
}

/// The velocities and iterations of a solve of the equation with a given linear algorithm.
fn solved_by(scene: &Scene, h: f64, kind: Option<Algorithm>) -> Result<(Vec<f64>, u64), StepError> {
    with_stage(scene, h, |stage, start| {
        let mut newton = Newton::new(Settings::default());
        newton.solver.forced = kind;
        newton.iterate(stage, &start.v, |_| {})?;
        Ok((newton.at.u.clone(), newton.solves))
    })
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    let apart: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    largest(&apart) / largest(a)
}

const ALL: [Algorithm; 3] = [Algorithm::Dense, Algorithm::Sparse, Algorithm::Conjugate];

#[test]
fn every_linear_solver_leads_to_the_same_solution() {
    let damped = |mut scene: Scene, damping: f64| {
        for spring in &mut scene.springs {
            spring.damping = damping;
        }
        scene.particles[7].velocity = [3.0, -2.0, 1.0];
        scene
    };
    for scene in [cloth(6, 100.0, 0.01), damped(cloth(6, 100.0, 0.01), 0.3)] {
        let (dense, _) = solved_by(&scene, 5e-3, Some(Algorithm::Dense)).unwrap();
        for kind in ALL {
            let (u, solves) = solved_by(&scene, 5e-3, Some(kind)).unwrap();
            let found = off(&dense, &u);
            // Residuals of 1e-12 of both parts, condition number 1 + (h ω)² = 7; measured 2.3e-13.
            assert!(found < 7e-13, "{kind:?}: off by {found:e}");
            assert!(solves <= 6, "{kind:?}: {solves} iterations");
        }
    }
}

#[test]
fn a_hundred_thousand_unknowns_are_solved_either_way() {
    // 183² particles, two of them fixed: 100,461 unknowns.
    let scene = cloth(183, 1e3, 0.01);
    let mut found = Vec::new();
    for kind in [Algorithm::Sparse, Algorithm::Conjugate] {
        let (u, solves) = solved_by(&scene, 5e-3, Some(kind)).unwrap();
        assert!(solves <= 6, "{kind:?}: {solves} iterations");
        found.push(u);
    }
    // Residuals of 1e-12 of both parts, and a condition number 1 + (h ω)² of 61: up to 6e-11 each;
    // measured 1.4e-11.
    let found = off(&found[0], &found[1]);
    assert!(found < 4e-11, "{found:e}");
}

/// A cloth's matrix at rest, k in N/m, masses of 10 g, h = 5 ms.
fn matrix_of(n: usize, stiffness: f64) -> (Matrix, Vec<f64>) {
    with_stage(&cloth(n, stiffness, 0.01), 5e-3, |stage, start| {
        let mut newton = Newton::new(Settings::default());
        newton.at.u.extend_from_slice(&start.v);
        newton.at.evaluate(stage);
        newton.assemble(stage, Linearization::Exact);
        (newton.matrix, stage.system.inverse_mass().to_vec())
    })
}

#[test]
fn the_solver_follows_size_and_stiffness() {
    let kind = |n: usize, stiffness: f64| {
        let (matrix, inverse_mass) = matrix_of(n, stiffness);
        let mut solver = LinearSolver::default();
        let mut z = vec![1.0; matrix.size()];
        let solved = solver.solve(&matrix, &inverse_mass, 1e-3, &mut z).unwrap();
        assert!(solved);
        solver.kind(&matrix, &inverse_mass, 1e-3).unwrap()
    };
    assert_eq!(kind(4, 100.0), Algorithm::Dense);
    assert_eq!(kind(12, 100.0), Algorithm::Conjugate);
    assert_eq!(kind(12, 1e8), Algorithm::Sparse);
    assert_eq!(kind(100, 100.0), Algorithm::Conjugate);
    assert_eq!(kind(60, 1e8), Algorithm::Sparse);
}

/// Whether conjugate gradients that solve to `tolerance` reach `bound`: |r - A z| <= bound |r|.
fn reaches(tolerance: f64, bound: f64) -> bool {
    let (matrix, inverse_mass) = matrix_of(12, 1e4);
    let right: Vec<f64> = (0..matrix.size()).map(|i| (i as f64).sin()).collect();
    let mut z = right.clone();
    let mut solver = LinearSolver::default();
    solver.forced = Some(Algorithm::Conjugate);
    solver
        .solve(&matrix, &inverse_mass, tolerance, &mut z)
        .unwrap();
    let mut left = vec![0.0; z.len()];
    matrix.product(&z, &mut left);
    let squares = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>();
    for (left, right) in left.iter_mut().zip(&right) {
        *left -= right;
    }
    squares(&left) <= bound * bound * squares(&right)
}

#[test]
fn conjugate_gradients_keep_their_tolerance() {
    for tolerance in [1e-3, 1e-6, 1e-10] {
        // Their residual is updated, not computed, and so has a rounding error of 1e-14.
        assert!(reaches(tolerance, 1.001 * tolerance));
        // A tolerance ten times looser is not enough.
        assert!(!reaches(10.0 * tolerance, tolerance));
    }
}

#[test]
fn an_indefinite_matrix_is_refused() {
    let scene = chain(10.0, 1e3);
    for kind in ALL {
        with_stage(&scene, 0.1, |stage, start| {
            let mut newton = Newton::new(Settings::default());
            newton.at.u.extend_from_slice(&start.v);
            newton.at.evaluate(stage);
            newton.solver.forced = Some(kind);
            let inverse_mass = stage.system.inverse_mass();
            for (kept, wanted) in [
                (Linearization::Exact, false),
                (Linearization::Definite, true),
            ] {
                newton.assemble(stage, kept);
                newton.matrix.gather(&newton.at.residual, &mut newton.z);
                let (solver, matrix) = (&mut newton.solver, &newton.matrix);
                let solved = solver.solve(matrix, inverse_mass, 1e-3, &mut newton.z);
                assert_eq!(solved, Ok(wanted), "{kind:?} {kept:?}");
            }
        });
    }
}

/// A step of the trapezoidal rule that lands on the ring around an anchor where a spring is a little
/// too short: the matrix is barely indefinite there, the potential falls along the ring for a radian,
/// and regularised steps are 2 mm long.
#[test]
fn a_flat_ridge_is_left_in_few_iterations() {
    let mut scene = scene(
        vec![
            particle([0.0, 0.0, 2.0], true, 1.0),
            particle(
                [0.9823654679585555, 0.6408988051042973, 2.9961200539510298],
                false,
                0.2,
            ),
        ],
        vec![spring([0, 1], 20.0, 1.0)],
    );
    scene.particles[1].velocity = [2.27701569441589, 1.4855348104251491, 4.735581948222126];
    let system = ParticleSystem::new(&scene);
    let mut state = ParticleSystem::initial_state(&scene);
    let method = super::super::find("trapezoidal").expect("a method");
    let mut integrator = method.build(&Default::default());
    integrator
        .step(&system, 0.4953, &mut state)
        .expect("a solution");
    // Measured 81; full steps alone do not get there within the cap.
    let solves = integrator.linear_solves();
    assert!(solves < 160, "{solves}");
}
