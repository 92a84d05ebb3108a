//! A closed form is the motion of its scene's system: it starts where the scene does, and Gauss's
//! method on the public system follows it. Forms of slightly other scenes do not.

use super::families::{self, between};
use super::{form, gauss};
use crate::testkit::{Random, built, distance};
use springcheck::scene::{DampingModel, Magnetic, Particle, Scene};
use springcheck::truth::Motion;

const UNTIL: f64 = 3.0;
const INSTANTS: usize = 6;

/// `motion` starts as the scene does, to the last bit, and obeys its system. The fastest rate of the
/// scene is `rate`.
fn obeys(scene: &Scene, motion: &dyn Motion, rate: f64) -> Result<(), String> {
    let (system, mut state) = built(scene);
    let times: Vec<f64> = (0..=INSTANTS)
        .map(|k| UNTIL * k as f64 / INSTANTS as f64)
        .collect();
    let found = motion.states(&times);
    let size = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let (x, v) = (size(&found.x).max(1.0), size(&found.v).max(rate));
    if found.x(0) != state.x || found.v(0) != state.v {
        return Err("does not start where the scene does".into());
    }
    if found.x.iter().chain(&found.v).any(|c| !c.is_finite()) {
        return Err("is not finite".into());
    }
    // At 0.02 radians a step the method is off by 5e-7 (w h)^6 = 3e-17 of a turn each; what is left
    // is rounding.
    let steps = (UNTIL / INSTANTS as f64 * rate / 0.02).ceil().max(20.0) as usize;
    for k in 1..=INSTANTS {
        gauss::advance(&system, &mut state, UNTIL / INSTANTS as f64, steps);
        let off = (distance(found.x(k), &state.x) / x).max(distance(found.v(k), &state.v) / v);
        // Its roundings, some eps / 2 of the largest number a step, add up like a walk. Measured 0.49
        // of the bound.
        let bound = 4.0 * f64::EPSILON * ((steps * k) as f64).sqrt();
        if off.is_nan() || off > bound {
            return Err(format!(
                "off by {off:e} of the largest at {}, bound {bound:e}",
                times[k]
            ));
        }
    }
    Ok(())
}

/// Scenes of every family with their fastest rates.
fn scenes() -> Vec<(&'static str, Scene, f64)> {
    let mut random = Random(20);
    let random = &mut random;
    let mut scenes = vec![("fall", families::fall(random, 0.0), 1.0)];
    for rate in [1e-3, 0.5, 20.0] {
        scenes.push(("drag", families::fall(random, rate), rate));
    }
    for zeta in [0.0, 0.01, 0.5, 0.999, 1.0, 1.001, 3.0, 10.0] {
        for _ in 0..3 {
            let w = between(random, 0.5, 12.0);
            let rate = w * (1.0 + 2.0 * zeta);
            scenes.push(("hanging", families::hanging(random, w, zeta), rate));
            scenes.push(("isotropic", families::isotropic(random, w, zeta), rate));
        }
    }
    for n in [1, 2, 5] {
        scenes.push(("chain", families::chain(random, n, 0.0), 40.0));
        scenes.push(("damped chain", families::chain(random, n, 0.02), 60.0));
        scenes.push(("network", families::network(random, n, 0.0, 0.0), 60.0));
        scenes.push((
            "damped network",
            families::network(random, n, 0.01, 0.3),
            60.0,
        ));
        scenes.push(("thrown", families::thrown(random, n, 0.0), 40.0));
        scenes.push(("thrown with drag", families::thrown(random, n, 0.4), 40.0));
    }
    scenes.push(("two", families::two(random), 10.0));
    scenes.push(("all", families::together(random), 40.0));
    for w in [1e-3, 0.3, 3.0, 20.0] {
        for rate in [0.0, 0.5] {
            let turned = f64::max(w + 2.0 * rate, 1.0);
            scenes.push(("charged", families::charged(random, w, rate), turned));
        }
    }
    scenes
}

#[test]
fn closed_forms_obey_the_system() {
    for (name, scene, rate) in scenes() {
        let found = form(&scene, UNTIL).unwrap_or_else(|| panic!("{name}: none"));
        if let Err(e) = obeys(&scene, found.motion().expect("a motion"), rate) {
            panic!("{name}: {e}");
        }
    }
}

/// One thing about the scene gets wrong; false where the scene does not have it.
type Wrong = fn(&mut Scene) -> bool;

const WRONG: &[(&str, Wrong)] = &[
    ("gravity's sign", |s| {
        s.solver.gravity *= -1.0;
        s.solver.gravity != 0.0
    }),
    ("wind's sign", |s| {
        s.wind.as_mut().is_some_and(|w| {
            w.strength *= -1.0;
            true
        })
    }),
    ("wind a millionth off", |s| {
        s.wind.as_mut().is_some_and(|w| {
            w.strength *= 1.000_001;
            true
        })
    }),
    ("drag forgotten", |s| {
        let any = s.particles.iter().any(|p| p.drag > 0.0 && !p.fixed);
        s.particles.iter_mut().for_each(|p| p.drag = 0.0);
        any
    }),
    ("charge's sign", |s| {
        s.particles.iter_mut().for_each(|p| p.charge *= -1.0);
        s.magnetic.is_some()
    }),
    ("field a millionth off", |s| {
        s.magnetic.as_mut().is_some_and(|m| {
            m.field = m.field.map(|b| 1.000_001 * b);
            true
        })
    }),
    ("damping forgotten", |s| {
        let any = s.springs.iter().any(|l| l.damping > 0.0);
        s.springs.iter_mut().for_each(|l| l.damping = 0.0);
        any
    }),
    ("damping halved", |s| {
        let any = s.springs.iter().any(|l| l.damping > 0.0);
        s.springs.iter_mut().for_each(|l| l.damping *= 0.5);
        any
    }),
    ("rest length a millionth off", |s| {
        let any = s.springs.iter().any(|l| l.rest_length > 0.0);
        s.springs
            .iter_mut()
            .for_each(|l| l.rest_length *= 1.000_001);
        any
    }),
    ("stiffness a millionth off", |s| {
        s.springs.iter_mut().for_each(|l| l.stiffness *= 1.000_001);
        !s.springs.is_empty()
    }),
    ("masses of a neighbour", |s| {
        let before: Vec<f64> = s.particles.iter().map(|p| p.mass).collect();
        let free = (0..before.len()).filter(|&i| !s.particles[i].fixed);
        let free: Vec<usize> = free.collect();
        free.iter()
            .zip(free.iter().cycle().skip(1))
            .for_each(|(&i, &j)| {
                s.particles[i].mass = before[j];
            });
        let wind = s.wind.is_some() && free.len() > 1;
        // Only where masses matter, and still on a line.
        let unlike = free.iter().any(|&i| before[i] != before[free[0]]);
        unlike && (!s.springs.is_empty() || wind)
    }),
];

#[test]
fn forms_of_other_scenes_do_not() {
    let mut killed = vec![0; WRONG.len()];
    for (name, scene, rate) in scenes() {
        for (k, (fault, wrong)) in WRONG.iter().enumerate() {
            let mut other = scene.clone();
            if !wrong(&mut other) {
                continue;
            }
            let Some(found) = form(&other, UNTIL) else {
                continue;
            };
            let verdict = obeys(&scene, found.motion().expect("a motion"), rate);
            assert!(verdict.is_err(), "{name}: {fault} passes");
            killed[k] += 1;
        }
    }
    for ((fault, _), killed) in WRONG.iter().zip(killed) {
        assert!(killed > 0, "{fault}: never tried");
    }
}

/// A motion that is right but for its velocities, or its clock.
struct Twisted<'a>(&'a dyn Motion, fn(f64) -> f64, f64);

impl Motion for Twisted<'_> {
    fn states(&self, times: &[f64]) -> springcheck::truth::States {
        let times: Vec<f64> = times.iter().map(|t| (self.1)(*t)).collect();
        let mut states = self.0.states(&times);
        states.v.iter_mut().for_each(|v| *v *= self.2);
        states
    }
    fn error_bar(&self, t: f64) -> f64 {
        self.0.error_bar(t)
    }
}

#[test]
fn a_wrong_clock_or_velocity_fails() {
    for (name, scene, rate) in scenes() {
        let found = form(&scene, UNTIL).expect(name);
        let motion = found.motion().expect("a motion");
        for (fault, twisted) in [
            ("late", Twisted(motion, |t| t * (1.0 - 1e-9), 1.0)),
            ("velocity", Twisted(motion, |t| t, 1.0 + 1e-9)),
        ] {
            assert!(
                obeys(&scene, &twisted, rate).is_err(),
                "{name}: {fault} passes"
            );
        }
    }
}

/// Hanging by a spring from its rest length, a particle swings by m g / k about m g / k below.
#[test]
fn hanging_swings_by_m_g_over_k() {
    let scene = crate::testkit::scenes::shipped("pa1/scene01.yml");
    let found = form(&scene, 5.0).expect("a form");
    assert_eq!(
        found.method.as_deref(),
        Some("oscillator in line, undamped")
    );
    let amplitude = 0.2 * 9.81 / 20.0;
    let period = 2.0 * std::f64::consts::PI * (0.2_f64 / 20.0).sqrt();
    let times = [0.0, 0.25, 0.5, 0.75, 1.0].map(|turn| turn * period);
    let states = found.motion().expect("a motion").states(&times);
    for (k, height) in [0.0, 1.0, 2.0, 1.0, 0.0].into_iter().enumerate() {
        let off = (states.x(k)[5] - (1.0 - height * amplitude)).abs();
        // One rounding of the position near 1.
        assert!(off <= 1.0 * f64::EPSILON, "{k}: {off:e}");
        assert_eq!(states.x(k)[..5], [0.0, 0.0, 2.0, 0.0, 0.0]);
    }
}

/// The damping models differ, and each is taken as the scene says.
#[test]
fn the_damping_model_counts() {
    let mut scene = families::isotropic(&mut Random(4), 3.0, 0.3);
    let truth = form(&scene, UNTIL).expect("a form");
    let motion = truth.motion().expect("a motion");
    scene.damping_model = DampingModel::Axial;
    assert!(form(&scene, UNTIL).is_none());
    assert!(obeys(&scene, motion, 4.0).is_err());
}

/// A charge of q/m = 1 in 3 T along z from (1, 0, 0.2) m/s, at 5 s, to 17 digits; and what its form says.
#[test]
fn a_charge_goes_round_a_helix() {
    let mut scene = families::empty();
    let start = families::free([0.0; 3], [1.0, 0.0, 0.2], 0.5);
    scene.particles = vec![Particle {
        charge: 0.5,
        ..start
    }];
    scene.magnetic = Some(Magnetic {
        field: [0.0, 0.0, 3.0],
    });
    let off = |scene: &Scene| {
        let found = form(scene, 5.0).expect("a form");
        let motion = found.motion().expect("a motion");
        let states = motion.states(&[5.0]);
        let golden = [0.216_762_613_385_705_62, -0.586_562_637_619_607_1, 1.0];
        distance(states.x(0), &golden) / motion.error_bar(5.0)
    };
    assert!(off(&scene) < 1.0);
    scene.particles[0].charge = -0.5;
    assert!(off(&scene) > 1e6);
    // Across gravity it drifts at m g/(q B) = 3.27 m/s, to the left where the field points at the reader.
    scene.particles[0].charge = 0.5;
    scene.particles[0].velocity = [0.0; 3];
    (scene.up, scene.solver.gravity) = (springcheck::scene::Axis::Y, -9.81);
    let found = form(&scene, 60.0).expect("a form");
    let turn = 2.0 * std::f64::consts::PI / 3.0;
    let after = found.motion().expect("a motion").states(&[28.0 * turn]);
    let drift = [-3.27 * 28.0 * turn, 0.0, 0.0];
    // 192 m in 176 radians: w t roundings of the circle, 1 m, and a few of the drift.
    assert!(distance(after.x(0), &drift) < 2e-12);
}
