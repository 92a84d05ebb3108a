//! Every effect's force, potential, power and Jacobian belong together: checked by differences
//! over the whole registry, on a scene that calls for all of them.

use crate::testkit::{Random, all_effects, everything, force, pressed, sample};
use springcheck::physics::effects::{self, Effect, EffectRow};
use springcheck::physics::{ForceKinds, Jacobian, Linearization, ParticleSystem, Power};
use springcheck::scene::{DampingModel, Scene, Vectors};

fn close(what: &str, found: f64, wanted: f64, scale: f64, tolerance: f64) -> Result<(), String> {
    if (found - wanted).abs() <= tolerance * scale {
        Ok(())
    } else {
        Err(format!("{what}: {found} instead of {wanted}"))
    }
}

/// Central differences with this step on values of order 1: rounding eps / step = 2e-11 and
/// truncation of order step² = 1e-10, both times values of the force's own size, which errors are
/// relative to. Measured 4.2e-11 for the slope of the potential, 1.6e-11 for the stiffness; the force
/// is linear in v and leaves rounding alone, 1.1e-12.
const STEP: f64 = 1e-5;
const SLOPE_OF_POTENTIAL: f64 = 1.2e-10;
const SLOPE_BY_POSITION: f64 = 5e-11;
const SLOPE_BY_VELOCITY: f64 = 3e-12;
/// Other forces are truncated by velocity too.
const SLOPE_OF_NON_LINEAR: f64 = SLOPE_BY_POSITION;

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
        if effect.kinds().has(ForceKinds::DRIVEN) {
            close(
                "a driven effect has no potential",
                slope,
                0.0,
                scale,
                SLOPE_OF_POTENTIAL,
            )?;
        } else {
            close(
                "force against -dU/dx",
                at_rest[at],
                -slope,
                scale,
                SLOPE_OF_POTENTIAL,
            )?;
        }
    }

    // The velocity-dependent part dissipates its power; where it is linear, it is what add_damping says.
    let linear = !effect.kinds().has(ForceKinds::NON_LINEAR);
    let mut damping: Vec<f64> = moving.iter().zip(&at_rest).map(|(a, b)| a - b).collect();
    if linear {
        damping.fill(0.0);
        effect.add_damping(x, v, &mut damping);
    }
    let (mut dissipated, mut injected) = (0.0, 0.0);
    let doubled: Vec<f64> = v.iter().map(|v| 2.0 * v).collect();
    let (twice, _) = force(effect, x, &doubled);
    // A dozen terms of the force's size, half a last bit each: measured 1.6 eps.
    let rounding = 5.0 * f64::EPSILON;
    for at in 0..n {
        let part = moving[at] - at_rest[at];
        close("add_damping", damping[at], part, scale, rounding)?;
        if linear {
            let doubled = twice[at] - at_rest[at];
            close("linear in v", doubled, 2.0 * part, scale, rounding)?;
        }
        dissipated -= damping[at] * v[at];
        injected += at_rest[at] * v[at];
    }
    if damping.iter().any(|f| *f != 0.0) && !effect.kinds().depends_on_velocity() {
        return Err("depends on velocity but says it does not".into());
    }
    close(
        "dissipated power",
        power.dissipated,
        dissipated,
        scale,
        rounding,
    )?;
    // A magnetic field leaves the rounding of a sum that is 0.
    if dissipated < -rounding * scale {
        return Err(format!("damping feeds {dissipated} W"));
    }
    let injected = if effect.kinds().has(ForceKinds::DRIVEN) {
        injected
    } else {
        0.0
    };
    close("injected power", power.injected, injected, scale, rounding)?;
    if linear {
        let said = effect.injected_power(0.0, v);
        close("injected_power", said, injected, scale, rounding)?;
    }

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
                let (what, tolerance) = if by_position {
                    ("df/dx", SLOPE_BY_POSITION)
                } else if linear {
                    ("df/dv", SLOPE_BY_VELOCITY)
                } else {
                    ("df/dv", SLOPE_OF_NON_LINEAR)
                };
                close(
                    what,
                    dense[row * n + column],
                    slope,
                    10.0 * scale,
                    tolerance,
                )?;
            }
        }
    }
    Ok(())
}

#[test]
fn force_potential_power_and_jacobian_agree_for_every_effect() {
    for model in [DampingModel::Axial, DampingModel::Isotropic] {
        let scene = pressed(model);
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
    MaterialIsExact,
    JacobianSign,
    VelocityJacobianSign,
    PowerOfWind,
    WindAlongDisplacement,
    ForgetsItIsDamped,
}

/// An effect with one fault.
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
        if self.1 == Fault::PowerOfWind {
            power.injected *= 0.5;
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
    fn kinds(&self) -> ForceKinds {
        if self.1 == Fault::ForgetsItIsDamped {
            ForceKinds::NONE
        } else {
            self.0.kinds()
        }
    }
    fn injected_power(&self, t: f64, v: &[f64]) -> f64 {
        let faulty = self.1 == Fault::WindAlongDisplacement;
        self.0.injected_power(t, v) * if faulty { -1.0 } else { 1.0 }
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
    fn add_jacobian(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        linearization: Linearization,
        out: &mut Jacobian,
    ) {
        let linearization = match self.1 {
            Fault::NoGeometricStiffness => Linearization::Material,
            Fault::MaterialIsExact => Linearization::Exact,
            _ => linearization,
        };
        self.0.add_jacobian(t, x, v, linearization, out);
        if self.1 == Fault::JacobianSign {
            for (_, _, value) in &mut out.position {
                *value = -*value;
            }
        }
        if self.1 == Fault::VelocityJacobianSign {
            for (_, _, value) in &mut out.velocity {
                *value = -*value;
            }
        }
    }
    fn keeps_momentum(&self) -> bool {
        self.0.keeps_momentum()
    }
    fn keeps_angular_momentum(&self) -> bool {
        self.0.keeps_angular_momentum()
    }
}

#[test]
fn the_effect_law_kills_mutants() {
    let scene = all_effects(DampingModel::Axial);
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
        Fault::VelocityJacobianSign,
        Fault::ForgetsItIsDamped,
    ] {
        let springs = (row("springs").build)(&scene).expect("springs");
        assert!(
            effect_law(&Faulty(springs, fault), &x, &v).is_err(),
            "{fault:?}"
        );
    }
    for fault in [
        Fault::ForceSign,
        Fault::PotentialScale,
        Fault::NoGeometricStiffness,
        Fault::JacobianSign,
    ] {
        let cubic = (row("cubic_springs").build)(&scene).expect("cubic springs");
        assert!(
            effect_law(&Faulty(cubic, fault), &x, &v).is_err(),
            "{fault:?}"
        );
    }
    for fault in [
        Fault::ForceSign,
        Fault::PotentialScale,
        Fault::DampingSign,
        Fault::PowerOfDamping,
        Fault::NoGeometricStiffness,
        Fault::JacobianSign,
        Fault::VelocityJacobianSign,
        Fault::ForgetsItIsDamped,
    ] {
        let bending = (row("bending").build)(&scene).expect("bending");
        assert!(
            effect_law(&Faulty(bending, fault), &x, &v).is_err(),
            "{fault:?}"
        );
    }
    for fault in [Fault::PowerOfWind, Fault::WindAlongDisplacement] {
        let wind = (row("wind").build)(&scene).expect("wind");
        assert!(
            effect_law(&Faulty(wind, fault), &x, &v).is_err(),
            "{fault:?}"
        );
    }
    let of_air = [
        Fault::ForceSign,
        Fault::PowerOfDamping,
        Fault::PowerOfWind,
        Fault::VelocityJacobianSign,
        Fault::ForgetsItIsDamped,
    ];
    for id in ["drag", "quadratic_drag", "air_drag"] {
        let turns = Some(Fault::JacobianSign).filter(|_| id == "air_drag");
        for fault in of_air.into_iter().chain(turns) {
            let drag = (row(id).build)(&scene).expect(id);
            assert!(
                effect_law(&Faulty(drag, fault), &x, &v).is_err(),
                "{id}: {fault:?}"
            );
        }
    }
    // Quadratic drag dissipates what it should and passes for itself: only linearity is broken.
    let law = effect_law(&QuadraticDrag, &x, &v);
    assert!(law.is_err_and(|error| error.starts_with("linear in v")));
}

/// What `Material` keeps of a spring at rest: the exact block along it, nothing across.
fn material_law(effect: &dyn Effect, scene: &Scene, x: &[f64]) -> Result<(), String> {
    let [i, j] = scene.springs[0].ends;
    let d = [0, 1, 2].map(|axis| x[3 * j + axis] - x[3 * i + axis]);
    let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
    let n = d.map(|d| d / length);
    let block = |linearization| {
        let mut out = Jacobian::default();
        effect.add_jacobian(0.0, x, &vec![0.0; x.len()], linearization, &mut out);
        let mut block = [[0.0; 3]; 3];
        for (row, column, value) in out.position {
            if row / 3 == i && column / 3 == j {
                block[row % 3][column % 3] += value;
            }
        }
        block
    };
    let (exact, material) = (block(Linearization::Exact), block(Linearization::Material));
    let along = |block: &[[f64; 3]; 3]| -> f64 {
        let row = |(r, b): (&f64, &[f64; 3])| r * b.iter().zip(&n).map(|(b, n)| b * n).sum::<f64>();
        n.iter().zip(block).map(row).sum()
    };
    let k = along(&exact);
    for (r, row) in material.iter().enumerate() {
        for (c, value) in row.iter().enumerate() {
            // A dozen roundings of half a last bit.
            close(
                "k n nᵀ",
                *value,
                k * n[r] * n[c],
                k.abs(),
                6.0 * f64::EPSILON,
            )?;
        }
    }
    Ok(())
}

#[test]
fn the_material_stiffness_is_what_acts_along_the_spring() {
    let mut scene = everything(DampingModel::Axial);
    scene.springs.truncate(1);
    scene.springs[0].cubic = 7.0;
    let mut random = Random(5);
    let along = |row: &&EffectRow| ["springs", "cubic_springs"].contains(&row.id);
    for row in effects::REGISTRY.iter().filter(along) {
        let build = || (row.build)(&scene).expect("built");
        for _ in 0..5 {
            let (x, _) = sample(&scene, &mut random);
            material_law(build().as_ref(), &scene, &x).unwrap();
            let mixed = Faulty(build(), Fault::MaterialIsExact);
            assert!(material_law(&mixed, &scene, &x).is_err(), "{}", row.id);
        }
    }
}

/// f = -|v| v by coordinate: everything right but that it is not linear.
struct QuadraticDrag;

impl Effect for QuadraticDrag {
    fn members(&self) -> usize {
        1
    }
    fn add_force(&self, _: f64, x: &[f64], v: &[f64], f: &mut [f64]) -> Power {
        self.add_damping(x, v, f);
        Power {
            dissipated: v.iter().map(|v| v.abs() * v * v).sum(),
            injected: 0.0,
        }
    }
    fn kinds(&self) -> ForceKinds {
        ForceKinds::DISSIPATIVE
    }
    fn add_damping(&self, _: &[f64], w: &[f64], f: &mut [f64]) {
        for (f, w) in f.iter_mut().zip(w) {
            *f -= w.abs() * w;
        }
    }
    fn add_jacobian(&self, _: f64, _: &[f64], v: &[f64], _: Linearization, out: &mut Jacobian) {
        let slopes = v.iter().enumerate().map(|(i, v)| (i, i, -2.0 * v.abs()));
        out.velocity.extend(slopes);
    }
    fn keeps_momentum(&self) -> bool {
        false
    }
    fn keeps_angular_momentum(&self) -> bool {
        false
    }
}

#[test]
fn only_what_the_scene_calls_for_is_built() {
    let mut scene = pressed(DampingModel::Axial);
    let ids = |scene: &Scene| -> Vec<&str> {
        ParticleSystem::new(scene)
            .effects()
            .iter()
            .map(|(row, _)| row.id)
            .collect()
    };
    assert_eq!(ids(&scene).len(), effects::REGISTRY.len());
    scene.solver.gravity = 0.0;
    // Vectors that add up to nothing are no gravity.
    scene.solver.gravities = Vectors(vec![[0.0, 2.0, 0.0], [0.0, -2.0, 0.0]]);
    scene.wind = None;
    scene.gravitational.clear();
    scene.driven.clear();
    scene.magnetic = None;
    scene.contact = None;
    scene.bending.clear();
    for particle in &mut scene.particles {
        particle.drag = 0.0;
        particle.quadratic_drag = 0.0;
    }
    // Triangles without a coefficient, or in air without a density, and air that drags at nothing.
    let density = |scene: &mut Scene, kg: f64| {
        if let Some(air) = &mut scene.air {
            air.density = kg;
        }
    };
    density(&mut scene, 0.0);
    assert_eq!(ids(&scene), ["springs", "cubic_springs"]);
    density(&mut scene, 1.2);
    assert_eq!(ids(&scene), ["springs", "cubic_springs", "air_drag"]);
    for triangle in &mut scene.triangles {
        triangle.air_drag = 0.0;
    }
    assert_eq!(ids(&scene), ["springs", "cubic_springs"]);
    // A spring that is all cubic is not a linear one of stiffness 0; one of nothing stays in the list.
    for spring in &mut scene.springs {
        (spring.stiffness, spring.damping) = (0.0, 0.0);
    }
    scene.springs.retain(|spring| spring.cubic > 0.0);
    assert_eq!(ids(&scene), ["cubic_springs"]);
    for spring in &mut scene.springs {
        spring.cubic = 0.0;
    }
    assert_eq!(ids(&scene), ["springs"]);
    scene.springs.clear();
    assert!(ids(&scene).is_empty());
}

#[test]
fn every_effect_has_its_section_in_the_documents() {
    let document = include_str!("../../docs/effects.md");
    let titles: Vec<&str> = document
        .lines()
        .filter_map(|line| line.strip_prefix("## "))
        .collect();
    let ids: Vec<&str> = effects::REGISTRY.iter().map(|row| row.id).collect();
    assert_eq!(titles, ids);
}
