//! Limits against the integrators themselves, which step the linearised scene: hard scenes and random networks.
//!
//! Left out on both sides is what is at rest: eigenvalues within 1e-4 of 1. Their pairs are split by the root
//! of rounding, 1e-8 times the size of the map. Limits below a tenth of the fastest time scale, of methods that are
//! unstable without damping, are judged from inside only: growth outside them is lost in rounding.

use super::*;
use crate::testkit::part;
use springcheck::measure::stability::Prediction;
use springcheck::physics::{Dampers, ForceKinds, Sweep, Triplets};
use springcheck::scene::Scene;

/// A system with constant derivatives: those of another about a state.
struct Linear<'a> {
    of: &'a dyn System,
    /// Where the dampers have their directions.
    x: Vec<f64>,
    exact: Jacobian,
    material: Jacobian,
}

impl<'a> Linear<'a> {
    fn new(of: &'a dyn System, state: &State) -> Self {
        let at = |linearization| {
            let mut jacobian = Jacobian::default();
            of.jacobian(0.0, &state.x, &state.v, linearization, &mut jacobian);
            jacobian
        };
        Self {
            of,
            x: state.x.clone(),
            exact: at(Linearization::Exact),
            material: at(Linearization::Material),
        }
    }

    fn add(&self, triplets: &Triplets, x: &[f64], a: &mut [f64]) {
        for &(row, column, value) in triplets {
            a[row] += self.of.inverse_mass()[row] * value * x[column];
        }
    }
}

impl System for Linear<'_> {
    fn inverse_mass(&self) -> &[f64] {
        self.of.inverse_mass()
    }
    fn kinds(&self) -> ForceKinds {
        self.of.kinds()
    }
    fn acceleration(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) -> Power {
        self.damping(t, x, v, a);
        self.add(&self.exact.position, x, a);
        Power::default()
    }
    fn damping(&self, _t: f64, _x: &[f64], w: &[f64], a: &mut [f64]) {
        a.fill(0.0);
        self.add(&self.exact.velocity, w, a);
    }
    fn dampers(&self) -> Dampers {
        self.of.dampers()
    }
    fn sweep(&self, sweep: &mut Sweep) {
        sweep.elsewhere(&self.x, |sweep| self.of.sweep(sweep));
    }
    fn potential(&self, _t: f64, _x: &[f64]) -> f64 {
        0.0
    }
    fn jacobian(&self, _: f64, _: &[f64], _: &[f64], kept: Linearization, out: &mut Jacobian) {
        *out = match kept {
            Linearization::Material => self.material.clone(),
            _ => self.exact.clone(),
        };
    }
}

/// Eigenvalues of a step's map over the free coordinates, made by running the integrator on basis vectors.
fn spectrum(system: &dyn System, build: Build, h: f64) -> Result<Vec<[f64; 2]>, String> {
    let n = system.dim();
    let free: Vec<usize> = (0..n).filter(|&i| system.inverse_mass()[i] > 0.0).collect();
    let m = free.len();
    let mut map = faer::Mat::<f64>::zeros(2 * m, 2 * m);
    for column in 0..2 * m {
        let mut state = State::new(vec![0.0; n], vec![0.0; n]);
        let at = free[column % m];
        // Velocities in units of x / h.
        let (vector, size) = match column < m {
            true => (&mut state.x, 1.0),
            false => (&mut state.v, 1.0 / h),
        };
        vector[at] = size;
        let step = build().step(system, h, &mut state);
        step.map_err(|error| error.to_string())?;
        for (row, &at) in free.iter().enumerate() {
            map[(row, column)] = state.x[at];
            map[(m + row, column)] = state.v[at] * h;
        }
    }
    let all = map.eigenvalues().map_err(|error| format!("{error:?}"))?;
    Ok(all.iter().map(|z| [z.re, z.im]).collect())
}

/// The growth a step of what grows fastest.
fn growth(multipliers: &[[f64; 2]]) -> f64 {
    let moving = multipliers
        .iter()
        .filter(|[re, im]| (re - 1.0).hypot(*im) > 1e-4);
    moving.map(|[re, im]| re.hypot(*im)).fold(0.0, f64::max) - 1.0
}

/// Eigenvalues of (x, v)' = (v, A x + B v): what grows in truth, 1/s.
fn truth(system: &Linear) -> Vec<[f64; 2]> {
    let weights = system.inverse_mass();
    let free: Vec<usize> = (0..weights.len()).filter(|&i| weights[i] > 0.0).collect();
    let m = free.len();
    let mut matrix = faer::Mat::<f64>::zeros(2 * m, 2 * m);
    for i in 0..m {
        matrix[(i, m + i)] = 1.0;
    }
    for (triplets, from) in [(&system.exact.position, 0), (&system.exact.velocity, m)] {
        for &(row, column, value) in triplets {
            let at = |i: usize| free.iter().position(|f| *f == i);
            if let (Some(i), Some(j)) = (at(row), at(column)) {
                matrix[(m + i, from + j)] += weights[row] * value;
            }
        }
    }
    let all = matrix.eigenvalues().expect("eigenvalues");
    all.iter().map(|z| [z.re, z.im]).collect()
}

/// Steps of one method: nothing grows just inside the limit and at smaller steps, something does just outside.
/// Says whether the limit is known. What grows in truth is no business of a limit: such scenes are left out.
fn judge(linear: &Linear, about: &Linearised, method: &'static Method) -> Result<bool, String> {
    let truth = truth(linear);
    let rate = truth.iter().map(|[re, im]| re.hypot(*im));
    let rate = rate.fold(0.0, f64::max);
    let grows = |[re, im]: &[f64; 2]| re.hypot(*im) > 1e-4 * rate && *re > 1e-10 * rate;
    if truth.iter().any(grows) {
        return Ok(true);
    }
    let Prediction { limit, error, .. } = about.predict(method, 0.01);
    let wrong = |h: f64, is: &str| Err(format!("{}: {limit:?}, but {h} s is {is}", method.id));
    let inside: Vec<f64> = match limit {
        Limit::At(limit) => [0.1, 0.3, 0.5, 0.7, 0.9, 0.999]
            .map(|part| part * limit * (1.0 - error))
            .to_vec(),
        Limit::Unconditional if rate > 0.0 => [0.1, 1.0, 10.0].map(|z| z / rate).to_vec(),
        _ => Vec::new(),
    };
    for h in inside {
        // Rounding of eigenvalues; a limit that is 0 is passed by 1e-6 or more at these steps.
        if growth(&spectrum(linear, &own(method), h)?) > 1e-9 {
            return wrong(h, "unstable");
        }
    }
    let outside = match limit {
        Limit::At(limit) if limit * rate > 0.1 => vec![1.001 * limit],
        Limit::Never => vec![0.3 / rate, 1.0 / rate],
        _ => Vec::new(),
    };
    for h in outside {
        // Midpoint's growth outside, 3 δ z⁴ / 8, is 4e-8 at z = 0.1, and 4e-12 for modes ten times slower.
        if growth(&spectrum(linear, &own(method), h)?) < 1e-12 {
            return wrong(h, "stable");
        }
    }
    Ok(!matches!(limit, Limit::Unknown(_)))
}

/// A chain, a tree or a net of 2 to 7 particles, turned at random; some of its springs are slack to rounding,
/// some stretched, some of rest length 0; dampers and drag on none, some or all; moving or at rest.
fn network(seed: u64) -> Scene {
    let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1);
    for _ in 0..8 {
        random.next();
    }
    let mut uniform = |low: f64, high: f64| low + (high - low) * 0.5 * (random.next() + 1.0);
    let n = uniform(2.0, 8.0) as usize;
    let anchors = uniform(0.0, 3.0) as usize;
    let shape = uniform(0.0, 4.0) as usize;
    let direction = [uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(0.5, 1.0)];
    let along = uniform(0.0, 2.0) < 1.0;
    let particles: Vec<Particle> = (0..n)
        .map(|i| {
            let place = match (shape, along) {
                (0 | 1, true) => [0.0, 0.0, -0.5 * i as f64],
                (0 | 1, false) => direction.map(|c| 0.5 * c * i as f64),
                _ => [0; 3].map(|_| uniform(-1.0, 1.0)),
            };
            particle(place, uniform(0.1, 2.0), i < anchors && i + 1 < n)
        })
        .collect();
    let mut scene = scene(
        particles,
        Vec::new(),
        match uniform(0.0, 2.0) < 1.0 {
            true => DampingModel::Axial,
            false => DampingModel::Isotropic,
        },
    );
    let mut pairs: Vec<[usize; 2]> = (1..n)
        .map(|i| match shape {
            0 | 1 => [i - 1, i],
            _ => [uniform(0.0, i as f64) as usize, i],
        })
        .collect();
    if shape == 3 {
        for i in 0..n {
            pairs.extend((0..i).map(|j| [j, i]).filter(|_| uniform(0.0, 1.0) < 0.5));
        }
        pairs.sort();
        pairs.dedup();
    }
    // None, some or all of it.
    let (damped, dragged, lengths) = (uniform(-0.5, 1.5), uniform(-1.0, 1.5), uniform(0.0, 4.0));
    let (k, c) = (uniform(1.0, 200.0), uniform(0.05, 2.0));
    let even = uniform(0.0, 2.0) < 1.0;
    for [a, b] in pairs {
        let ends = [a, b].map(|i| scene.particles[i].position);
        let far = (0..3).map(|i| (ends[0][i] - ends[1][i]).powi(2));
        let distance = far.sum::<f64>().sqrt();
        let rest_length = match lengths as usize {
            0 => distance,
            1 => uniform(0.5, 0.95) * distance,
            2 if uniform(0.0, 1.0) < 0.5 => distance,
            2 => 0.9 * distance,
            _ => 0.0,
        };
        let vary = if even { 1.0 } else { uniform(0.3, 3.0) };
        let damping = if uniform(0.0, 1.0) < damped {
            vary * c
        } else {
            0.0
        };
        scene
            .springs
            .push(spring(a, b, vary * k, damping, rest_length));
    }
    let moving = uniform(0.0, 2.0) < 1.0;
    for free in scene.particles.iter_mut().filter(|p| !p.fixed) {
        if uniform(0.0, 1.0) < dragged {
            free.drag = uniform(0.05, 1.0);
        }
        if moving {
            free.velocity = [0; 3].map(|_| uniform(-0.5, 0.5));
        }
    }
    scene
}

/// The faults of every method on a scene, and how many limits are not known: of a whole linearisation, and of
/// the brief one.
fn faults(name: &str, scene: &Scene, effort: Effort) -> (Vec<String>, usize) {
    let (system, state) = built(scene);
    let linear = Linear::new(&system, &state);
    let about = Linearised::new(&system, &state, effort);
    let (mut faults, mut unknown) = (Vec::new(), 0);
    for method in fixed() {
        match judge(&linear, &about, method) {
            Ok(known) => unknown += usize::from(!known),
            Err(fault) => faults.push(format!("{name}: {fault}")),
        }
    }
    (faults, unknown)
}

/// Holds scenes to the law, and the part of their limits that is not known to `most`.
fn law(scenes: &[(String, Scene)], effort: Effort, most: f64) {
    let judged = scenes
        .iter()
        .map(|(name, scene)| faults(name, scene, effort));
    let (wrong, unknown): (Vec<_>, Vec<_>) = judged.unzip();
    let wrong: Vec<String> = wrong.concat();
    assert!(wrong.is_empty(), "{}:\n{}", wrong.len(), wrong.join("\n"));
    let (unknown, asked) = (unknown.iter().sum::<usize>(), scenes.len() * fixed().len());
    eprintln!("{unknown} of {asked} limits are not known");
    assert!(
        unknown as f64 <= most * asked as f64,
        "{unknown} of {asked} are not known"
    );
}

#[test]
fn limits_of_random_networks_are_where_steps_of_the_linearised_scene_begin_to_grow() {
    let seeds: Vec<u64> = (1..=250).collect();
    let named = |seed: &&u64| (format!("network {seed}"), network(**seed));
    let scenes: Vec<_> = part(&seeds, 10, 3).iter().map(named).collect();
    // Measured 95 of 5,750: most are of methods whose steps are found by trying, on networks with many dampers.
    law(&scenes, Effort::FULL, 0.02);
    law(&scenes, Effort::BRIEF, 0.1);
}

#[test]
fn limits_of_hard_scenes_are_where_steps_of_the_linearised_scene_begin_to_grow() {
    let hard = crate::testkit::scenes::all_shipped(&["hard"]);
    // On rods the linear system is another one: see the tests of rods.
    let small = |scene: &Scene| scene.particles.len() <= 9 && scene.rods.is_empty();
    let named: Vec<_> = hard
        .into_iter()
        .filter(small)
        .map(|s| (s.name.clone(), s))
        .collect();
    let scenes: Vec<_> = part(&named, 4, 0).into_iter().cloned().collect();
    law(&scenes, Effort::FULL, 0.05);
}

/// A chain of `links` hanging from a fixed particle, 0.2 kg, 80 N/m and 0.15 N s/m each, at rest length and
/// moving sideways as one.
fn hanging(links: usize, axes: [usize; 3]) -> Scene {
    let turned = |place: [f64; 3]| axes.map(|axis| place[axis]);
    let mut particles: Vec<Particle> = (0..=links)
        .map(|i| particle(turned([0.0, 0.0, 2.0 - 0.5 * i as f64]), 0.2, i == 0))
        .collect();
    for free in particles.iter_mut().skip(1) {
        free.velocity = turned([0.3, 0.0, 0.0]);
    }
    let springs = (1..=links).map(|i| spring(i - 1, i, 80.0, 0.15, 0.5));
    scene(particles, springs.collect(), DampingModel::Axial)
}

#[test]
fn a_chain_at_rest_length_that_moves_sideways_has_the_limit_of_its_motion_along_itself() {
    for links in [2, 4, 8, 40] {
        // The fastest of its modes, free at one end: ω = 2 √(k/m) cos(π / (2 n + 1)); C = (c/k) K.
        let angle = std::f64::consts::PI / (2 * links + 1) as f64;
        let w = 2.0 * (80.0_f64 / 0.2).sqrt() * angle.cos();
        let zeta = 0.5 * w * 0.15 / 80.0;
        for axes in [[0, 1, 2], [2, 0, 1]] {
            let scene = hanging(links, axes);
            for effort in [Effort::FULL, Effort::BRIEF] {
                let (system, state) = built(&scene);
                let about = Linearised::new(&system, &state, effort);
                let wanted = 2.0 / w * ((1.0 + zeta * zeta).sqrt() - zeta);
                let limit = about.predict(method("symplectic_euler"), 0.01).limit;
                let Limit::At(found) = limit else {
                    panic!("{links}: {limit:?}");
                };
                // Eigenvalues of a matrix of 40 rows: n eps, and the speed's own rounding of the damping.
                assert!(
                    (found / wanted - 1.0).abs() < 1e-12,
                    "{links}: {found}, not {wanted}"
                );
                // All motion across it is at rest.
                let rests = format!("{} modes without restoring force", 2 * links);
                assert!(
                    about.excluded().iter().any(|e| e.starts_with(&rests)),
                    "{:?}",
                    about.excluded()
                );
            }
        }
    }
}

#[test]
fn two_masses_that_move_across_their_springs_limit_yoshida_as_their_map_does() {
    let (system, state) = built(&hanging(2, [0, 1, 2]));
    let about = Linearised::new(&system, &state, Effort::FULL);
    let limit = about.predict(method("yoshida4"), 0.01).limit;
    // An independent search on the one-step map with the exact flow of the dampers, in NumPy, gives 0.0486 to three
    // digits. Sweeps over dampers this weak change it by little: measured 7.5e-5.
    assert!(
        matches!(limit, Limit::At(h) if (h - 0.0486).abs() < 2e-4),
        "{limit:?}"
    );
}
