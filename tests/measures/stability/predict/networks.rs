//! Several modes: a chain's frequencies, and dampers that couple modes, against one-step matrices.

use super::*;
use springcheck::integrators::DampingTreatment;
use springcheck::physics::ForceKinds;

/// N masses of 0.3 kg between fixed ends, springs of k = 40 and rest length 0.
fn chain(n: usize) -> Scene {
    let particles = (0..n + 2)
        .map(|i| particle([i as f64, 0.0, 0.0], 0.3, i == 0 || i == n + 1))
        .collect();
    let springs = (0..=n).map(|i| spring(i, i + 1, 40.0, 0.0, 0.0)).collect();
    scene(particles, springs, DampingModel::Isotropic)
}

fn chain_frequency(n: usize, j: usize) -> f64 {
    let angle = j as f64 * std::f64::consts::PI / (2.0 * (n + 1) as f64);
    2.0 * (40.0_f64 / 0.3).sqrt() * angle.sin()
}

fn chain_law(scene: &Scene, n: usize, tolerance: f64) -> Result<(), String> {
    let linearised = start(scene);
    let stiffest = chain_frequency(n, n);
    let omega = linearised.omega_max().ok_or("nothing oscillates")?;
    let Limit::At(h) = linearised.predict(method("velocity_verlet"), 0.01).limit else {
        return Err("no limit".into());
    };
    let off = (omega / stiffest - 1.0)
        .abs()
        .max((h * stiffest / 2.0 - 1.0).abs());
    if off < tolerance && linearised.excluded().iter().all(|e| e.starts_with("modes")) {
        Ok(())
    } else {
        Err(format!("{n}: {omega} for {stiffest}, h {h}: {off:e}"))
    }
}

#[test]
fn a_chain_has_the_frequencies_of_its_formula() {
    // n eps for a dense spectrum; Lanczos stops at the square of its residual over the gap.
    for (n, tolerance) in [(1, 1e-15), (7, 2e-15), (60, 1e-14), (700, 1e-13)] {
        let scene = chain(n);
        assert!(is_linear(&scene));
        chain_law(&scene, n, 4.0 * tolerance).unwrap();
    }
    // A mass forgotten, and a stiffness, are seen.
    let mut heavier = chain(7);
    heavier.particles[4].mass = 0.31;
    assert!(chain_law(&heavier, 7, 1e-4).is_err());
    let mut softer = chain(7);
    softer.springs[4].stiffness = 39.0;
    assert!(chain_law(&softer, 7, 1e-4).is_err());
}

/// A system seen wrongly.
struct Seen<'a, F>(&'a dyn System, F);

impl<F: Fn(&mut Jacobian)> System for Seen<'_, F> {
    fn dim(&self) -> usize {
        self.0.dim()
    }
    fn inverse_mass(&self) -> &[f64] {
        self.0.inverse_mass()
    }
    fn kinds(&self) -> ForceKinds {
        self.0.kinds()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.0.acceleration(t, x, v, a)
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        self.0.potential(t, x)
    }
    fn jacobian(&self, t: f64, x: &[f64], v: &[f64], l: Linearization, out: &mut Jacobian) {
        self.0.jacobian(t, x, v, l, out);
        (self.1)(out);
    }
}

/// The largest modulus of a step's map over all coordinates, made by running the integrator on basis
/// vectors: the scene is linear.
fn radius(system: &dyn System, build: Build, h: f64) -> f64 {
    let n = system.dim();
    let free: Vec<usize> = (0..n).filter(|&i| system.inverse_mass()[i] > 0.0).collect();
    let m = free.len();
    let mut map = faer::Mat::<f64>::zeros(2 * m, 2 * m);
    let origin = vec![0.0; n];
    for column in 0..2 * m {
        let mut state = State::new(origin.clone(), origin.clone());
        let at = free[column % m];
        // Velocities in units of x / h.
        if column < m {
            state.x[at] = 1.0;
        } else {
            state.v[at] = 1.0 / h;
        }
        build()
            .step(system, h, &mut state)
            .expect("a solvable step");
        for (row, &at) in free.iter().enumerate() {
            map[(row, column)] = state.x[at];
            map[(m + row, column)] = state.v[at] * h;
        }
    }
    let moduli = map.eigenvalues().expect("eigenvalues");
    moduli.iter().map(|z| z.re.hypot(z.im)).fold(0.0, f64::max)
}

/// Unequal masses and dampers that no combination of stiffness and mass makes.
fn unequal() -> Scene {
    let particles = vec![
        particle([0.0; 3], 1.0, true),
        particle([1.0, 0.0, 0.0], 0.4, false),
        particle([2.0, 0.0, 0.0], 1.7, false),
    ];
    let springs = vec![
        spring(0, 1, 90.0, 9.0, 0.0),
        spring(1, 2, 30.0, 0.2, 0.0),
        spring(0, 2, 5.0, 1.3, 0.0),
    ];
    scene(particles, springs, DampingModel::Isotropic)
}

/// Below the predicted limit no mode grows, just above one does.
fn radius_law(system: &dyn System, method: &Method, build: Build) -> Result<(), String> {
    let prediction = about(system, &vec![0.0; system.dim()]).predict(method, 0.01);
    match prediction.limit {
        Limit::At(limit) => {
            // 1e-6 beside it the radius is off 1 by about that; rounding is 1e-14 of it.
            let (below, above) = (1.0 - 1e-6, 1.0 + 1e-6);
            let (low, high) = (
                radius(system, build, limit * below),
                radius(system, build, limit * above),
            );
            if low > 1.0 + 1e-10 || high < 1.0 + 1e-8 {
                return Err(format!("{}: {limit}, {low}, {high}", method.id));
            }
            for part in [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9] {
                let inside = radius(system, build, part * limit);
                if inside > 1.0 + 1e-10 {
                    return Err(format!("{}: {part} of {limit}: {inside}", method.id));
                }
            }
        }
        Limit::Unconditional => {
            for h in [1e-3, 0.1, 1.0, 10.0] {
                let far = radius(system, build, h);
                if far > 1.0 + 1e-9 {
                    return Err(format!("{}: {far} at {h}", method.id));
                }
            }
        }
        // Sweeps over shared dampers that go backward have no theory.
        Limit::Unknown(_) if method.id == "yoshida4" => return Ok(()),
        other => return Err(format!("{}: {other:?}", method.id)),
    }
    let sweeps = [DampingTreatment::Sweeps, DampingTreatment::Boris];
    if matches!(method.amplification, Amplification::Composition(_, by) if sweeps.contains(&by)) {
        // Their limit is known here, and how fast they grow beyond it is not.
        return Ok(());
    }
    let h = 0.01;
    let growth = radius(system, build, h).ln() / h;
    let stated = prediction.growth_per_s.ok_or("no growth")?;
    // Rounding of the radius over h.
    if (growth - stated).abs() > 1e-10 {
        return Err(format!("{}: grows at {growth}, not {stated}", method.id));
    }
    Ok(())
}

#[test]
fn modes_coupled_by_damping_are_as_every_method_steps_them() {
    let (system, _) = built(&unequal());
    for method in fixed().iter() {
        // The linear implicit methods' own matrices are nearly singular nowhere: any h will do.
        if method.id == "linearized_implicit_material" {
            // At coincidence its springs have no direction; see the test on turning springs.
            continue;
        }
        radius_law(&system, method, &own(method)).unwrap();
    }
}

#[test]
fn wrong_matrices_are_seen() {
    let scene = unequal();
    let (system, _) = built(&scene);
    let rk4 = method("rk4");
    let fails = |seen: &dyn System| {
        let stepped = built(&scene).0;
        let prediction = about(seen, &[0.0; 9]).predict(rk4, 0.01);
        let Limit::At(limit) = prediction.limit else {
            return true;
        };
        let low = radius(&stepped, &own(rk4), limit * (1.0 - 1e-6));
        let high = radius(&stepped, &own(rk4), limit * (1.0 + 1e-6));
        low > 1.0 + 1e-10 || high < 1.0 + 1e-8
    };
    assert!(!fails(&system));
    // K with the other sign; masses not divided by; one triangle forgotten.
    assert!(fails(&Seen(&system, |out: &mut Jacobian| {
        for (_, _, value) in &mut out.position {
            *value = -*value;
        }
    })));
    assert!(fails(&system.with_unit_masses()));
    assert!(fails(&Seen(&system, |out: &mut Jacobian| {
        out.position.retain(|(row, column, _)| row >= column);
    })));
    assert!(fails(&Seen(&system, |out: &mut Jacobian| {
        out.velocity.clear();
    })));
    // And a step that is not the method's.
    let half = mutant(crate::testkit::mutants::symplectic_euler_at_half_the_step);
    assert!(radius_law(&system, method("symplectic_euler"), &half).is_err());
}
