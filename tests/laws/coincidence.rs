//! Springs and attractions where their ends meet: no direction, so no force along it, and no NaN.

use crate::testkit::swinging_triangle;
use springcheck::physics::effects::{self, Effect};
use springcheck::physics::{ForceKinds, Jacobian, Linearization, ParticleSystem, Power};
use springcheck::scene::{DampingModel, GravitationalPair, Scene};

/// One spring and one attraction between two particles at the same place.
fn coincident(model: DampingModel, rest_length: f64) -> Scene {
    let mut scene = swinging_triangle(0.7, model);
    scene.springs.truncate(1);
    scene.springs[0].ends = [1, 2];
    scene.springs[0].rest_length = rest_length;
    scene.springs[0].cubic = 3.0;
    scene.gravitational = vec![GravitationalPair {
        ends: [1, 2],
        g: 2.0,
    }];
    scene.particles[2].position = scene.particles[1].position;
    scene
}

fn effect(id: &str, scene: &Scene) -> Box<dyn Effect> {
    let row = effects::REGISTRY.iter().find(|row| row.id == id);
    (row.expect("a row").build)(scene).expect("built")
}

fn force(effect: &dyn Effect, x: &[f64], v: &[f64]) -> (Vec<f64>, Power) {
    let mut f = vec![0.0; x.len()];
    let power = effect.add_force(0.0, x, v, &mut f);
    (f, power)
}

/// No force at rest; with velocity one from isotropic dampers only; everything finite.
fn coincidence_law(effect: &dyn Effect, scene: &Scene, acts: bool) -> Result<(), String> {
    let start = ParticleSystem::initial_state(scene);
    let (at_rest, _) = force(effect, &start.x, &vec![0.0; start.x.len()]);
    if at_rest.iter().any(|f| *f != 0.0) {
        return Err(format!("a force at rest: {at_rest:?}"));
    }
    let (moving, power) = force(effect, &start.x, &start.v);
    let mut jacobian = Jacobian::default();
    effect.add_jacobian(0.0, &start.x, &start.v, Linearization::Exact, &mut jacobian);
    let slopes = jacobian.position.iter().chain(&jacobian.velocity);
    let finite = moving.iter().all(|f| f.is_finite())
        && power.dissipated.is_finite()
        && effect.potential(0.0, &start.x).is_finite()
        && slopes.into_iter().all(|(_, _, value)| value.is_finite());
    if !finite {
        return Err(format!("not finite: {moving:?}, {jacobian:?}"));
    }
    if moving.iter().any(|f| *f != 0.0) != acts {
        return Err(format!("the damper: {moving:?}"));
    }
    Ok(())
}

const CASES: [(DampingModel, f64); 4] = [
    (DampingModel::Axial, 0.0),
    (DampingModel::Axial, 0.8),
    (DampingModel::Isotropic, 0.0),
    (DampingModel::Isotropic, 0.8),
];

#[test]
fn coincident_ends_have_no_force_and_no_nan() {
    for (model, rest_length) in CASES {
        let scene = coincident(model, rest_length);
        for id in ["springs", "cubic_springs", "gravitational"] {
            let acts = model == DampingModel::Isotropic && id == "springs";
            coincidence_law(effect(id, &scene).as_ref(), &scene, acts)
                .unwrap_or_else(|error| panic!("{id}: {error}"));
        }
    }
}

/// k (l - L) d / l without a guard, or with one that picks a direction.
struct Unguarded {
    direction: Option<[f64; 3]>,
    rest_length: f64,
}

impl Effect for Unguarded {
    fn members(&self) -> usize {
        1
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::NONE
    }
    fn add_force(&self, _: f64, x: &[f64], _: &[f64], f: &mut [f64]) -> Power {
        let d = [x[6] - x[3], x[7] - x[4], x[8] - x[5]];
        let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
        for a in 0..3 {
            let n = self.direction.map_or(d[a] / length, |n| n[a]);
            f[3 + a] += (length - self.rest_length) * n;
            f[6 + a] -= (length - self.rest_length) * n;
        }
        Power::default()
    }
    fn keeps_momentum(&self) -> bool {
        true
    }
    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}

#[test]
fn the_coincidence_law_kills_mutants() {
    let scene = coincident(DampingModel::Axial, 0.8);
    for direction in [None, Some([1.0, 0.0, 0.0])] {
        let spring = Unguarded {
            direction,
            rest_length: 0.8,
        };
        assert!(coincidence_law(&spring, &scene, false).is_err());
    }
    // An isotropic damper that does not act, and an axial one that does.
    let isotropic = coincident(DampingModel::Isotropic, 0.8);
    let [axial, full] = [&scene, &isotropic].map(|scene| effect("springs", scene));
    assert!(coincidence_law(axial.as_ref(), &isotropic, true).is_err());
    assert!(coincidence_law(full.as_ref(), &scene, false).is_err());
}

/// Without rest length the force is k d on both sides of the point, and the stiffness there its slope:
/// no geometry, so the differences are exact but for the rounding of the step.
fn stiffness_law(scene: &Scene, jacobian: &Jacobian) -> Result<(), String> {
    let start = ParticleSystem::initial_state(scene);
    let springs = effect("springs", scene);
    let n = start.x.len();
    let mut dense = vec![0.0; n * n];
    for &(row, column, value) in &jacobian.position {
        dense[row * n + column] += value;
    }
    for column in 0..n {
        let at = |by: f64| {
            let mut x = start.x.clone();
            x[column] += by;
            (x[column], force(springs.as_ref(), &x, &vec![0.0; n]).0)
        };
        let ((low, f_low), (high, f_high)) = (at(-0.125), at(0.125));
        for row in 0..n {
            let slope = (f_high[row] - f_low[row]) / (high - low);
            let found = dense[row * n + column];
            // One last bit of k = 40; measured none.
            if (found - slope).abs() > 7.2e-15 {
                return Err(format!("({row}, {column}): {found} instead of {slope}"));
            }
        }
    }
    Ok(())
}

#[test]
fn the_stiffness_of_a_spring_without_rest_length_holds_through_the_point() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = coincident(model, 0.0);
        let start = ParticleSystem::initial_state(&scene);
        let jacobian = |linearization| {
            let mut out = Jacobian::default();
            effect("springs", &scene).add_jacobian(
                0.0,
                &start.x,
                &vec![0.0; start.v.len()],
                linearization,
                &mut out,
            );
            out
        };
        stiffness_law(&scene, &jacobian(Linearization::Exact)).unwrap();
        // k n nᵀ has no direction there: zero, and caught.
        assert!(stiffness_law(&scene, &jacobian(Linearization::Material)).is_err());
    }
}

/// f = -k d along the whole line through the anchor, to the last bit.
fn linear_law(rest_length: f64) -> Result<(), String> {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.solver.gravity = 0.0;
    scene.springs.truncate(1);
    scene.springs[0].rest_length = rest_length;
    // At the origin, so that no offset is lost in the anchor's coordinate.
    scene.particles[0].position = [0.0; 3];
    let k = scene.springs[0].stiffness;
    let system = ParticleSystem::new(&scene);
    for offset in [1.0, 1e-3, 1e-100, 0.0, -1e-100, -0.5] {
        let mut state = ParticleSystem::initial_state(&scene);
        state.x[3..6].copy_from_slice(&[offset, 0.0, 0.0]);
        let mut f = vec![0.0; state.x.len()];
        system.forces(0.0, &state.x, &state.v, &mut f);
        if f[3] != -k * offset {
            return Err(format!("{offset:e}: {:e}", f[3]));
        }
    }
    Ok(())
}

#[test]
fn a_spring_without_rest_length_is_linear_through_its_anchor() {
    linear_law(0.0).unwrap();
    // The least rest length that shows beside the shortest offset.
    assert!(linear_law(1e-110).is_err());
}
