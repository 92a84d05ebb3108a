//! Every effect's force, potential, power and Jacobian belong together: checked by differences
//! over the whole registry, on a scene that calls for all of them.

mod common;
use common::{Random, swinging_triangle};
use springcheck::effects::{self, Effect, EffectRow};
use springcheck::scene::{DampingModel, GravitationalPair, Scene, Wind};
use springcheck::system::{Jacobian, Linearization, ParticleSystem, Power, System};

/// A scene that calls for every effect of the registry.
fn everything(model: DampingModel) -> Scene {
    let mut scene = swinging_triangle(0.7, model);
    scene.particles[1].drag = 0.3;
    scene.particles[3].drag = 0.1;
    scene.wind = Some(Wind {
        direction: [0.6, 0.0, 0.8],
        strength: 1.5,
    });
    for ends in [[1, 2], [2, 3], [0, 3]] {
        scene.gravitational.push(GravitationalPair { ends, g: 2.0 });
    }
    scene
}

/// Random positions near the scene's and random velocities of order 1.
fn sample(scene: &Scene, random: &mut Random) -> (Vec<f64>, Vec<f64>) {
    let start = ParticleSystem::initial_state(scene);
    let x = start.x.iter().map(|x| x + 0.2 * random.next()).collect();
    let v = start.x.iter().map(|_| random.next()).collect();
    (x, v)
}

fn force(effect: &dyn Effect, x: &[f64], v: &[f64]) -> (Vec<f64>, Power) {
    let mut f = vec![0.0; x.len()];
    let power = effect.add_force(0.0, x, v, &mut f);
    (f, power)
}

fn close(what: &str, found: f64, wanted: f64, scale: f64, tolerance: f64) -> Result<(), String> {
    if (found - wanted).abs() <= tolerance * scale {
        Ok(())
    } else {
        Err(format!("{what}: {found} instead of {wanted}"))
    }
}

/// Central differences with this step on values of order 1: truncation of order step² = 1e-10
/// times third derivatives up to 1e2, rounding eps/step = 2e-11 times forces up to 1e2.
const STEP: f64 = 1e-5;
const TOLERANCE: f64 = 1e-8;

/// All promises of the trait, at one state.
fn effect_law(effect: &dyn Effect, x: &[f64], v: &[f64]) -> Result<(), String> {
    let n = x.len();
    let zero = vec![0.0; n];
    let (at_rest, _) = force(effect, x, &zero);
    let (moving, power) = force(effect, x, v);
    let scale = 1.0 + moving.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    let bumped = |base: &[f64], at: usize, by: f64| {
        let mut moved = base.to_vec();
        moved[at] += by;
        moved
    };

    // F = -grad U, unless the effect works outside any potential.
    for at in 0..n {
        let [low, high] = [-STEP, STEP].map(|by| effect.potential(0.0, &bumped(x, at, by)));
        let slope = (high - low) / (2.0 * STEP);
        if effect.is_driven() {
            close(
                "a driven effect has no potential",
                slope,
                0.0,
                scale,
                TOLERANCE,
            )?;
        } else {
            close(
                "force against -dU/dx",
                at_rest[at],
                -slope,
                scale,
                TOLERANCE,
            )?;
        }
    }

    // The velocity-dependent part is linear, is what add_damping says, and dissipates its power.
    let mut damping = vec![0.0; n];
    effect.add_damping(x, v, &mut damping);
    let (mut dissipated, mut injected) = (0.0, 0.0);
    let doubled: Vec<f64> = v.iter().map(|v| 2.0 * v).collect();
    let (twice, _) = force(effect, x, &doubled);
    let rounding = 64.0 * f64::EPSILON;
    for at in 0..n {
        let part = moving[at] - at_rest[at];
        close("add_damping", damping[at], part, scale, rounding)?;
        close(
            "linear in v",
            twice[at] - at_rest[at],
            2.0 * part,
            scale,
            rounding,
        )?;
        dissipated -= damping[at] * v[at];
        injected += at_rest[at] * v[at];
    }
    if damping.iter().any(|f| *f != 0.0) && !effect.is_damped() {
        return Err("depends on velocity but says it does not".into());
    }
    close(
        "dissipated power",
        power.dissipated,
        dissipated,
        scale,
        rounding,
    )?;
    if dissipated < 0.0 {
        return Err(format!("damping feeds {dissipated} W"));
    }
    let injected = if effect.is_driven() { injected } else { 0.0 };
    close("injected power", power.injected, injected, scale, rounding)?;
    close(
        "injected_power",
        effect.injected_power(0.0, v),
        injected,
        scale,
        rounding,
    )?;

    // Jacobian blocks.
    let mut jacobian = Jacobian::default();
    effect.add_jacobian(0.0, x, v, Linearization::Exact, &mut jacobian);
    for (triplets, by_position) in [(&jacobian.position, true), (&jacobian.velocity, false)] {
        let mut dense = vec![0.0; n * n];
        for &(row, column, value) in triplets {
            dense[row * n + column] += value;
        }
        for column in 0..n {
            let ends = [-STEP, STEP].map(|by| {
                if by_position {
                    force(effect, &bumped(x, column, by), v).0
                } else {
                    force(effect, x, &bumped(v, column, by)).0
                }
            });
            for row in 0..n {
                let slope = (ends[1][row] - ends[0][row]) / (2.0 * STEP);
                let what = if by_position { "df/dx" } else { "df/dv" };
                close(
                    what,
                    dense[row * n + column],
                    slope,
                    10.0 * scale,
                    TOLERANCE,
                )?;
            }
        }
    }
    Ok(())
}

#[test]
fn force_potential_power_and_jacobian_agree_for_every_effect() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = everything(model);
        let mut random = Random(7);
        for row in effects::REGISTRY {
            let effect = (row.build)(&scene).unwrap_or_else(|| panic!("{}: not built", row.id));
            for _ in 0..5 {
                let (x, v) = sample(&scene, &mut random);
                effect_law(effect.as_ref(), &x, &v).unwrap_or_else(|e| panic!("{}: {e}", row.id));
            }
        }
    }
}

/// What a faulty effect gets wrong.
#[derive(Clone, Copy, PartialEq, Debug)]
enum Fault {
    ForceSign,
    PotentialScale,
    DampingSign,
    PowerOfDamping,
    NoGeometricStiffness,
    JacobianSign,
    ForgetsItIsDamped,
}

/// The springs with one fault.
struct Faulty(Box<dyn Effect>, Fault);

impl Effect for Faulty {
    fn members(&self) -> usize {
        self.0.members()
    }
    fn add_force(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        let mut own = vec![0.0; x.len()];
        let mut power = self.0.add_force(t, x, v, &mut own);
        let sign = if self.1 == Fault::ForceSign {
            -1.0
        } else {
            1.0
        };
        for (f, own) in f.iter_mut().zip(&own) {
            *f += sign * own;
        }
        if self.1 == Fault::PowerOfDamping {
            power.dissipated *= 0.5;
        }
        power
    }
    fn potential(&self, t: f64, x: &[f64]) -> f64 {
        let scale = if self.1 == Fault::PotentialScale {
            2.0
        } else {
            1.0
        };
        scale * self.0.potential(t, x)
    }
    fn is_damped(&self) -> bool {
        self.1 != Fault::ForgetsItIsDamped && self.0.is_damped()
    }
    fn add_damping(&self, x: &[f64], w: &[f64], f: &mut [f64]) {
        let sign = if self.1 == Fault::DampingSign {
            -1.0
        } else {
            1.0
        };
        let w: Vec<f64> = w.iter().map(|w| sign * w).collect();
        self.0.add_damping(x, &w, f);
    }
    fn add_jacobian(&self, t: f64, x: &[f64], v: &[f64], _: Linearization, out: &mut Jacobian) {
        let linearization = if self.1 == Fault::NoGeometricStiffness {
            Linearization::Material
        } else {
            Linearization::Exact
        };
        self.0.add_jacobian(t, x, v, linearization, out);
        if self.1 == Fault::JacobianSign {
            for (_, _, value) in &mut out.position {
                *value = -*value;
            }
        }
    }
    fn keeps_momentum(&self) -> bool {
        true
    }
    fn keeps_angular_momentum(&self) -> bool {
        true
    }
}

#[test]
fn the_effect_law_kills_mutants() {
    let scene = everything(DampingModel::Axial);
    let row = |id: &str| -> &EffectRow {
        effects::REGISTRY
            .iter()
            .find(|row| row.id == id)
            .expect("a row")
    };
    let (x, v) = sample(&scene, &mut Random(3));
    for fault in [
        Fault::ForceSign,
        Fault::PotentialScale,
        Fault::DampingSign,
        Fault::PowerOfDamping,
        Fault::NoGeometricStiffness,
        Fault::JacobianSign,
        Fault::ForgetsItIsDamped,
    ] {
        let springs = (row("springs").build)(&scene).expect("springs");
        assert!(
            effect_law(&Faulty(springs, fault), &x, &v).is_err(),
            "{fault:?}"
        );
    }
}

#[test]
fn only_what_the_scene_calls_for_is_built() {
    let mut scene = everything(DampingModel::Axial);
    let ids = |scene: &Scene| -> Vec<&str> {
        ParticleSystem::new(scene)
            .effects()
            .iter()
            .map(|(row, _)| row.id)
            .collect()
    };
    assert_eq!(ids(&scene).len(), effects::REGISTRY.len());
    scene.solver.gravity = 0.0;
    scene.wind = None;
    scene.gravitational.clear();
    for particle in &mut scene.particles {
        particle.drag = 0.0;
    }
    assert_eq!(ids(&scene), ["springs"]);
    scene.springs.clear();
    assert!(ids(&scene).is_empty());
}

#[test]
fn momentum_is_kept_exactly_where_an_effect_says_so() {
    let scene = everything(DampingModel::Axial);
    let isotropic = everything(DampingModel::Isotropic);
    for (scene, row) in [&scene, &isotropic]
        .into_iter()
        .flat_map(|s| effects::REGISTRY.iter().map(move |r| (s, r)))
    {
        let effect = (row.build)(scene).expect("built");
        let (x, v) = sample(scene, &mut Random(11));
        let (f, _) = force(effect.as_ref(), &x, &v);
        let (mut total, mut torque) = ([0.0_f64; 3], [0.0_f64; 3]);
        for i in (0..x.len()).step_by(3) {
            for a in 0..3 {
                let (b, c) = ((a + 1) % 3, (a + 2) % 3);
                total[a] += f[i + a];
                torque[a] += x[i + b] * f[i + c] - x[i + c] * f[i + b];
            }
        }
        let norm = |u: [f64; 3]| u.iter().fold(0.0, |m: f64, c| m.max(c.abs()));
        // Sums of a dozen forces up to 1e2 cancel to their last bits.
        assert_eq!(norm(total) < 1e-13, effect.keeps_momentum(), "{}", row.id);
        assert_eq!(
            norm(torque) < 1e-13,
            effect.keeps_angular_momentum(),
            "{}",
            row.id
        );
    }
}

#[test]
fn coincident_ends_have_no_force_and_no_nan() {
    for (model, rest_length) in [
        (DampingModel::Axial, 0.0),
        (DampingModel::Axial, 0.8),
        (DampingModel::Isotropic, 0.0),
        (DampingModel::Isotropic, 0.8),
    ] {
        let mut scene = everything(model);
        scene.springs.truncate(1);
        scene.springs[0].ends = [1, 2];
        scene.springs[0].rest_length = rest_length;
        scene.gravitational.truncate(1);
        scene.particles[2].position = scene.particles[1].position;
        let start = ParticleSystem::initial_state(&scene);
        for row in effects::REGISTRY
            .iter()
            .filter(|row| ["springs", "gravitational"].contains(&row.id))
        {
            let effect = (row.build)(&scene).expect("built");
            let (at_rest, _) = force(effect.as_ref(), &start.x, &vec![0.0; start.x.len()]);
            assert!(at_rest.iter().all(|f| *f == 0.0), "{}: {at_rest:?}", row.id);
            let (moving, power) = force(effect.as_ref(), &start.x, &start.v);
            assert!(moving.iter().all(|f| f.is_finite()) && power.dissipated.is_finite());
            let acts = model == DampingModel::Isotropic && row.id == "springs";
            assert_eq!(moving.iter().any(|f| *f != 0.0), acts, "{}", row.id);
            let mut jacobian = Jacobian::default();
            effect.add_jacobian(0.0, &start.x, &start.v, Linearization::Exact, &mut jacobian);
            let values = jacobian.position.iter().chain(&jacobian.velocity);
            assert!(values.into_iter().all(|(_, _, value)| value.is_finite()));
            assert!(effect.potential(0.0, &start.x).is_finite());
        }
    }
}

#[test]
fn a_spring_without_rest_length_is_linear_through_its_anchor() {
    let mut scene = swinging_triangle(0.0, DampingModel::Axial);
    scene.solver.gravity = 0.0;
    scene.springs.truncate(1);
    scene.springs[0].rest_length = 0.0;
    let k = scene.springs[0].stiffness;
    let system = ParticleSystem::new(&scene);
    for offset in [1.0, 1e-3, 1e-100, 1e-200, 0.0, -1e-200, -0.5] {
        let mut state = ParticleSystem::initial_state(&scene);
        for a in 0..3 {
            state.x[3 + a] = state.x[a];
        }
        state.x[3] += offset;
        // Offsets below the position's last bit vanish; what is left is the true separation.
        let separation = state.x[3] - state.x[0];
        let mut f = vec![0.0; system.dim()];
        system.forces(0.0, &state.x, &state.v, &mut f);
        assert_eq!(f[3], -k * separation, "{offset}");
    }
}
