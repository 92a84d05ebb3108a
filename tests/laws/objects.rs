//! What objects make, held to the closed forms of strings, nets and hair.

use crate::testkit::scenes::parsed as parse;
use nalgebra::{DMatrix, DVector};
use springcheck::physics::{Jacobian, Linearization, ParticleSystem, System};
use springcheck::scene::object::Scaling;
use springcheck::scene::{self, Scene};

fn with(objects: &str) -> Scene {
    parse(&format!(
        "solver: {{type: rk4, timestep: 0.001, gravity: 0}}\nobjects:\n{objects}\n"
    ))
}

/// The stiffness matrix of what is free, over the coordinates of these axes, and the masses there.
fn stiffness(scene: &Scene, axes: &[usize]) -> (DMatrix<f64>, Vec<f64>) {
    let system = ParticleSystem::new(scene);
    let state = ParticleSystem::initial_state(scene);
    let mut jacobian = Jacobian::default();
    system.jacobian(0.0, &state.x, &state.v, Linearization::Exact, &mut jacobian);
    let weights = system.inverse_mass();
    let free = (0..weights.len()).filter(|&i| weights[i] > 0.0 && axes.contains(&(i % 3)));
    let free: Vec<usize> = free.collect();
    let mut matrix = DMatrix::zeros(free.len(), free.len());
    for (row, column, value) in &jacobian.position {
        let place = |i| free.iter().position(|at| *at == i);
        if let (Some(row), Some(column)) = (place(*row), place(*column)) {
            matrix[(row, column)] -= value;
        }
    }
    (matrix, free.iter().map(|&i| 1.0 / weights[i]).collect())
}

/// The angular frequencies of small motion along these axes, rad/s, ascending.
fn frequencies(scene: &Scene, axes: &[usize]) -> Vec<f64> {
    let (mut matrix, masses) = stiffness(scene, axes);
    for (row, a) in masses.iter().enumerate() {
        for (column, b) in masses.iter().enumerate() {
            matrix[(row, column)] /= (a * b).sqrt();
        }
    }
    let mut found: Vec<f64> = matrix
        .symmetric_eigenvalues()
        .iter()
        .map(|w| w.max(0.0).sqrt())
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

fn near(found: f64, wanted: f64, within: f64) {
    assert!(
        (found / wanted - 1.0).abs() < within,
        "{found} for {wanted}"
    );
}

/// A string of 20 free masses between two walls: 2 sqrt(k/m) sin(pi/42) to 2 sqrt(k/m) sin(20 pi/42) along it.
#[test]
fn a_string_between_walls_sounds_as_its_closed_form() {
    let scene = with(
        "- string: {from: [0, 0, 0], to: [1, 0, 0], particles: 22, particle_mass: 0.05, stiffness: 1000, pins: [start, end]}",
    );
    let found = frequencies(&scene, &[0]);
    assert_eq!(found.len(), 20);
    // Eigenvalues to some roundings of the largest, over the smallest: (282/21)² eps 20 / 2.
    near(found[0], 21.136862373466365, 4e-13);
    near(found[19], 282.05182688471483, 4e-15);
}

/// Refined, it nears the continuum's pi sqrt(K/M), K and M of the whole string, as 1 - (pi/(2 n))²/6, n its links: the
/// sine's second term, and the next is (pi/(2 n))⁴/120.
#[test]
fn a_refined_string_keeps_its_lowest_frequency() {
    for refine in [1, 2, 4, 8] {
        let scene = with(&format!(
            "- string: {{from: [0, 0, 0], to: [1, 0, 0], particles: 6, mass: 2, stiffness: 500, pins: [start, end], refine: {refine}}}"
        ));
        let links = 5.0 * f64::from(refine);
        let mass: f64 = scene.particles.iter().map(|p| p.mass).sum();
        let compliance: f64 = scene.springs.iter().map(|s| 1.0 / s.stiffness).sum();
        near(mass, 2.0, 1e-14);
        near(compliance, 5.0 / 500.0, 1e-14);
        let continuum = std::f64::consts::PI * (100.0_f64 / 2.0).sqrt();
        let part = (std::f64::consts::FRAC_PI_2 / links).powi(2);
        let lowest = frequencies(&scene, &[0])[0];
        let missing = 1.0 - lowest / continuum;
        assert!(
            (missing - part / 6.0).abs() < part * part / 110.0,
            "{refine}: {missing}"
        );
    }
    // Unscaled, n times the links sound as a string n times as long.
    let plain = with(
        "- string: {from: [0, 0, 0], to: [1, 0, 0], particles: 6, particle_mass: 0.4, stiffness: 500, pins: [start, end], refine: 4, scaling: none}",
    );
    let wanted = 2.0 * (500.0_f64 / 0.4).sqrt() * (std::f64::consts::PI / 40.0).sin();
    near(frequencies(&plain, &[0])[0], wanted, 1e-12);
}

/// A string of N links that hangs from one end stretches by M g/(2 K) where its ends weigh half, as the continuum does at
/// every N, and by m g N (N + 1)/(2 k) where all N free masses are equal: 0.53955 m of ten.
#[test]
fn a_hanging_string_stretches_as_its_closed_form() {
    const G: f64 = 9.81;
    let sag = |scene: &Scene| {
        let (matrix, masses) = stiffness(scene, &[2]);
        let weight = DVector::from_iterator(masses.len(), masses.iter().map(|m| m * G));
        let down = matrix.lu().solve(&weight).expect("no mechanism");
        down[down.len() - 1]
    };
    // Sums of so many terms, each to a rounding or two.
    for refine in [1, 2, 5] {
        let scene = with(&format!(
            "- string: {{from: [0, 0, 3], to: [0, 0, 0], particles: 5, mass: 2, stiffness: 400, pins: [start], refine: {refine}}}"
        ));
        near(sag(&scene), 2.0 * G / (2.0 * 100.0), 1e-13);
    }
    let equal = with(
        "- chain: {from: [0, 0, 3], to: [0, 0, 0], particles: 11, particle_mass: 0.1, stiffness: 100, pins: [0]}",
    );
    near(sag(&equal), 0.53955, 1e-13);
}

/// A net of 9 x 9 free knots on springs without rest length: w² = (4 k/m) (sin²(i pi/20) + sin²(j pi/20)).
#[test]
fn a_net_sounds_as_its_closed_form() {
    let scene = with(
        "- net: {origin: [0, 0, 0], plane: xy, size: [1, 1], particles: [11, 11], particle_mass: 0.01, structural: {stiffness: 100}, rest_ratio: 0, pins: [rim]}",
    );
    let found = frequencies(&scene, &[2]);
    assert_eq!(found.len(), 81);
    near(found[0], 44.24634841649486, 1e-13);
    near(found[80], 279.3604493334841, 1e-13);
}

/// The tip of a clamped hair under a small load F across it: the hinges' angles F (L - x)/kb over their distances to the
/// tip are the trapezoidal rule of F L³/(3 EI), which is F (L³/3 + L l²/6)/EI. With kb at the root too it would be
/// F L² l/(2 EI) more.
#[test]
fn a_clamped_hair_bends_as_the_trapezoidal_rule() {
    const LENGTH: f64 = 2.0;
    const EI: f64 = 0.03;
    for refine in [1, 2, 4] {
        let scene = with(&format!(
            "- hair: {{from: [0, 0, 2], to: [0, 0, 0], particles: 5, mass: 0.01, structural: {{stiffness: 1000}}, bending: {{stiffness: {}}}, clamp: [0, 0, -3], refine: {refine}}}",
            EI / 0.5
        ));
        let link = 0.5 / f64::from(refine);
        let (matrix, _) = stiffness(&scene, &[0]);
        let n = matrix.nrows();
        assert_eq!(n as f64 * link, LENGTH);
        let mut load = DVector::zeros(n);
        load[n - 1] = 1.0;
        let tip = matrix.lu().solve(&load).expect("no mechanism")[n - 1];
        let wanted = (LENGTH.powi(3) / 3.0 + LENGTH * link * link / 6.0) / EI;
        // The condition of such a matrix is some n⁴.
        near(tip, wanted, 1e-15 * (n as f64).powi(4));
    }
}

/// A block pulled along one of its edges, in the middle of which no edge thread is: K = k (threads) / links, and refined
/// it has n² as many threads of n links of k/n each but for those at its sides.
#[test]
fn a_refined_block_keeps_its_mass_and_size() {
    for refine in [1, 3] {
        let scene = with(&format!(
            "- lattice: {{origin: [0, 0, 0], u: [1, 0, 0], v: [0, 2, 0], w: [0, 0, 3], particles: [2, 3, 4], mass: 6, structural: {{stiffness: 90}}, shear: {{stiffness: 9}}, diagonal: {{stiffness: 3}}, refine: {refine}}}"
        ));
        let r = refine;
        let [a, b, c] = [r, 2 * r, 3 * r];
        assert_eq!(scene.particles.len(), (a + 1) * (b + 1) * (c + 1));
        near(scene.particles.iter().map(|p| p.mass).sum(), 6.0, 1e-13);
        let along = a * (b + 1) * (c + 1) + (a + 1) * b * (c + 1) + (a + 1) * (b + 1) * c;
        let faces = a * b * (c + 1) + a * (b + 1) * c + (a + 1) * b * c;
        assert_eq!(scene.springs.len(), along + 2 * faces + 4 * a * b * c);
        for spring in &scene.springs {
            let per_link = spring.stiffness * refine as f64;
            assert!(
                [90.0, 9.0, 3.0]
                    .iter()
                    .any(|k| (per_link / k - 1.0).abs() < 1e-15)
            );
        }
    }
}

#[test]
fn particles_have_names() {
    let scene = parse(
        "solver: {type: rk4, timestep: 0.001}\nparticles: [{pos: [0, 0, 5], mass: 1}]\nobjects:\n\
         - cloth: {name: sheet, origin: [0, 0, 1], u: [1, 0, 0], v: [0, 1, 0], particles: [3, 4], mass: 1, structural: {stiffness: 5}, pins: [corner10, [1, 2], edge_v1], air_drag: 1}\n\
         - string: {from: [0, 0, 0], to: [1, 0, 0], particles: 5, mass: 0.1, stiffness: 10, pins: [3]}\n\
         springs: [{particle_ids: [\"sheet[2,3]\", \"string[4]\"], stiffness: 1}]\n\
         driven: [{particle_id: \"sheet[2, 0]\", velocity: [1, 0, 0]}]\n\
         plot: {particle_id: \"string[0]\", dof: 2}\n",
    );
    assert_eq!(scene.particles.len(), 1 + 12 + 5);
    assert_eq!(scene.springs[0].ends, [12, 17]);
    assert_eq!(scene.driven[0].particle, 9);
    assert_eq!(scene.plot.as_ref().map(|plot| plot.particle), Some(13));
    let fixed: Vec<usize> = (0..18).filter(|&i| scene.particles[i].fixed).collect();
    // [0,3], [1,2], [1,3], [2,0], [2,3] of three by four, and the fourth of the string.
    assert_eq!(fixed, [4, 7, 8, 9, 12, 16]);
    assert_eq!(scene.triangles.len(), 12);
    for id in 1..18 {
        let name = scene.particle_name(id).expect("an object's");
        assert_eq!(scene.particle_named(&name).ok(), Some(id), "{name}");
    }
    assert_eq!(scene.particle_name(0), None);
    assert_eq!(scene.particle_name(12).as_deref(), Some("sheet[2,3]"));
    // Written out, it is the same scene of plain members.
    let mut plain = parse(&scene::yaml(&scene));
    assert!(plain.bodies.is_empty());
    plain.bodies = scene.bodies.clone();
    let mut whole = scene;
    whole.written = None;
    assert_eq!(plain, whole);
}

/// Once links are cut, what is named is where it was, and what was given for one object is given for another.
#[test]
fn a_finer_scene_keeps_what_is_named() {
    let scene = parse(
        "solver: {type: rk4, timestep: 0.001}\nparticles: [{pos: [0, 0, 5], mass: 1}]\nobjects:\n\
         - string: {from: [0, 0, 0], to: [1, 0, 0], particles: 5, mass: 0.1, stiffness: 10, refine: 2}\n\
         - net: {origin: [0, 0, 1], plane: xy, size: [1, 1], particles: [3, 4], particle_mass: 1, \
           structural: {stiffness: 5}}\n\
         springs: [{particle_ids: [\"net[2,3]\", \"string[6]\"], stiffness: 1}, {particle_ids: [0, \"string[1]\"], stiffness: 1}]\n\
         plot: {particle_id: \"net[1,2]\", dof: 2}\n",
    );
    let at = |scene: &Scene, id: usize| scene.particles[id].position;
    for links in [1, 3] {
        let finer = scene.refined(links, Scaling::None).expect("a scene");
        let spring =
            |scene: &Scene, spring: usize| scene.springs[spring].ends.map(|end| at(scene, end));
        assert_eq!(
            [0, 1].map(|s| spring(&finer, s)),
            [0, 1].map(|s| spring(&scene, s))
        );
        let shown = |scene: &Scene| at(scene, scene.plot.as_ref().expect("a plot").particle);
        assert_eq!(shown(&finer), shown(&scene));
        for id in 0..scene.particles.len() {
            let there = scene
                .refined_id(&finer, id, links)
                .expect("the same particle");
            assert_eq!(at(&finer, there), at(&scene, id));
        }
        let springs = 2 + 8 * links + (2 * links) * (3 * links + 1) + (3 * links) * (2 * links + 1);
        assert_eq!(finer.springs.len() as u64, springs);
    }
    let none = scene.remade(|objects| objects.truncate(1));
    assert!(none.is_err(), "net[2,3] is no more");
}
