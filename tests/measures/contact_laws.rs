//! How far trajectories are off the laws of contact: closed forms with a known fault, and every method of the registry.

use crate::testkit::scenes::{parsed, shipped};
use springcheck::integrators;
use springcheck::measure::{Contact, Laws, Residual};
use springcheck::physics::{ParticleSystem, Work};
use springcheck::scene::Scene;
use springcheck::solvers;
use springcheck::trajectory::{Precision, Rows, Trajectory};
use springcheck::verbs::run::{Choice, Plan};
use springcheck::verbs::session::Quiet;

const G: f64 = 9.81;
const H: f64 = 0.01;

fn scene(particles: &str, rest: &str, gravity: f64) -> Scene {
    parsed(&format!(
        "solver: {{type: rk4, timestep: {H}, gravity: {gravity}}}\nduration: 1\nparticles: [{particles}]\n{rest}\n"
    ))
}

fn floor(surface: &str) -> Scene {
    scene(
        "{pos: [0, 0, 1], mass: 2, radius: 0}",
        &format!("colliders: [{{plane: {{normal: [0, 0, 1]}}, {surface}}}]"),
        -G,
    )
}

/// The laws of a run whose positions and velocities are given at every step of a second.
fn laws(scene: &Scene, at: impl Fn(f64) -> (Vec<f64>, Vec<f64>)) -> Laws {
    contact(scene, at).laws
}

fn contact(scene: &Scene, at: impl Fn(f64) -> (Vec<f64>, Vec<f64>)) -> Contact {
    let rows: Vec<_> = (0..=100_u32).map(|n| at(f64::from(n) * H)).collect();
    let rows = Rows {
        timestep: H,
        dim: rows[0].0.len(),
        steps: (0..=100).collect(),
        x: rows.iter().flat_map(|(x, _)| x.clone()).collect(),
        v: Some(rows.iter().flat_map(|(_, v)| v.clone()).collect()),
        precision: Precision::Double,
        precision_v: Precision::Double,
        cut: false,
    };
    let run = Trajectory::of_rows(&rows, &vec![Work::default(); rows.len()], 100, false);
    Contact::of(&ParticleSystem::new(scene), &run, None).expect("obstacles")
}

/// A fall from 1 m with 3 m/s along x, that comes up with e V and with `slower` m/s less along x.
fn bounce(e: f64, slower: impl Fn(f64) -> f64) -> impl Fn(f64) -> (Vec<f64>, Vec<f64>) {
    let speed = (2.0 * G).sqrt();
    let hits = speed / G;
    let after = 3.0 - slower(speed);
    move |t| {
        let since = t - hits;
        if since < 0.0 {
            let x = vec![3.0 * t, 0.0, 1.0 - 0.5 * G * t * t];
            return (x, vec![3.0, 0.0, -G * t]);
        }
        let z = since * (e * speed - 0.5 * G * since);
        let x = vec![3.0 * hits + after * since, 0.0, z];
        (x, vec![after, 0.0, e * speed - G * since])
    }
}

fn judged(law: Option<Residual>) -> Residual {
    law.expect("something to judge")
}

fn near(found: f64, right: f64, bound: f64) {
    assert!((found - right).abs() <= bound, "{found:e}, not {right:e}");
}

/// Rounding of z, 1e-16 m, and of v, 4e-16 m/s, over 4.4 m/s. Mutants: velocities of the rows as they are, without a θ
/// (0.03 and more).
const ROUNDED: f64 = 2e-15;

#[test]
fn a_right_bounce_is_off_by_rounding() {
    let scene = floor("restitution: 0.8, friction: 0.2");
    let laws = laws(&scene, bounce(0.8, |speed| 0.2 * 1.8 * speed));
    let separation = judged(laws.separation);
    assert_eq!((separation.judged, separation.particle), (1, 0));
    near(separation.off, 0.0, ROUNDED);
    near(separation.found, 0.8, ROUNDED);
    // The fall takes 0.4515 s.
    near(separation.t_s, 0.45, 1e-12);
    // (1 + e) g h/V.
    near(separation.bound, 1.8 * G * H / (2.0 * G).sqrt(), 1e-12);
    near(judged(laws.impact_friction).off, 0.0, ROUNDED);
    near(judged(laws.impact_friction).found, 0.2, ROUNDED);
    near(judged(laws.energy_gain).off, 0.0, 1e-14);
    assert_eq!(laws.sliding_friction, None);
}

#[test]
fn another_restitution_is_off_by_the_difference() {
    let scene = floor("restitution: 0.8");
    let separation = judged(laws(&scene, bounce(0.7, |_| 0.0)).separation);
    near(separation.off, 0.1, ROUNDED);
    assert!(separation.broken());
}

#[test]
fn friction_above_the_cone_is_off_by_what_is_above() {
    let scene = floor("restitution: 0.8, friction: 0.2");
    let of = |mu: f64| laws(&scene, bounce(0.8, move |speed| mu * 1.8 * speed)).impact_friction;
    near(judged(of(0.25)).off, 0.05, ROUNDED);
    near(judged(of(0.15)).off, 0.0, ROUNDED);
}

/// e = 1.1 gives m/2 (1.21 - 1) V² = 0.21 m g 1 m; friction that pushes 1 m/s faster m/2 (16 - 9).
#[test]
fn energy_put_in_is_counted() {
    let scene = floor("restitution: 0.8, friction: 0.2");
    let of = |e, faster: f64| judged(laws(&scene, bounce(e, move |_| -faster)).energy_gain).off;
    near(of(1.1, 0.0), 0.21 * 2.0 * G, 1e-13);
    near(of(0.8, 1.0), 7.0, 1e-13);
}

/// A block of 2 kg on a floor with 5 m/s that is slowed by µ' g. Velocities have 1e-15 m/s, so accelerations over h 1e-13.
#[test]
fn sliding_friction_is_mu_n_against_the_sliding() {
    let scene = floor("friction: 0.2");
    let slides = |mu: f64| {
        laws(&scene, move |t| {
            let x = vec![t * (5.0 - 0.5 * mu * G * t), 0.0, 0.0];
            (x, vec![5.0 - mu * G * t, 0.0, 0.0])
        })
    };
    let off = |mu: f64| judged(slides(mu).sliding_friction).off;
    near(off(0.2), 0.0, 1e-13);
    near(off(0.26), 0.06, 1e-13);
    near(off(0.1), 0.1, 1e-13);
    assert_eq!(judged(slides(0.2).sliding_friction).judged, 100);
    // Friction that pushes: 2 µ off, and in the last row it does m µ g (v h), v in its middle.
    let pushed = slides(-0.2);
    near(judged(pushed.sliding_friction).off, 0.4, 1e-13);
    let last = 2.0 * 0.2 * G * H * (5.0 + 0.2 * G * (1.0 - 0.5 * H));
    near(judged(pushed.energy_gain).off, last, 1e-12);
    near(judged(slides(0.2).energy_gain).off, 0.0, 0.0);
}

/// What lies still on a slope of 45° has friction N, where 0.3 N is all it may have.
#[test]
fn sticking_above_the_cone_is_seen() {
    let slope = scene(
        "{pos: [0, 0, 0], mass: 1, radius: 0}",
        "colliders: [{plane: {normal: [-1, 0, 1]}, friction: 0.2, static_friction: 0.3}]",
        -G,
    );
    let laws = laws(&slope, |_| (vec![0.0; 3], vec![0.0; 3]));
    near(judged(laws.sliding_friction).off, 0.7, 1e-13);
}

/// What lies on a slope of 30° with µ_s = 0.7 is held: friction is tan 30° N. If it slides, with µ = 0.3, that is off by
/// tan 30° - 0.3 where it begins; later it slides as it may. Its numbers are of up to 2.4 m and m/s, so accelerations over h
/// have 1e-13 of g.
#[test]
fn what_friction_holds_does_not_begin_to_slide() {
    let slope = scene(
        "{pos: [0, 0, 0], mass: 1, radius: 0}",
        "colliders: [{plane: {normal: [-0.5, 0, 0.8660254037844386]}, friction: 0.3, static_friction: 0.7}]",
        -G,
    );
    let lies = laws(&slope, |_| (vec![0.0; 3], vec![0.0; 3]));
    near(judged(lies.sliding_friction).off, 0.0, 1e-13);
    let tan = 3.0_f64.sqrt().recip();
    let a = G * (0.5 - 0.3 * 0.75_f64.sqrt());
    let slides = laws(&slope, move |t| {
        let along = |far: f64| vec![-0.75_f64.sqrt() * far, 0.0, -0.5 * far];
        (along(0.5 * a * t * t), along(a * t))
    });
    let off = judged(slides.sliding_friction);
    assert!(off.broken() && off.t_s == 0.0, "{off:?}");
    near(off.off, tan - 0.3, 1e-12);
    near(off.found, 0.3, 1e-12);
    near(off.asked, tan, 1e-12);
}

/// The contact of a penalty, half a swing of 4 rows, is no impact between two rows; and one of a tenth of a row is.
#[test]
fn a_penalty_is_not_judged_as_an_impulse() {
    let scene = scene(
        "{pos: [0, 0, 1], vel: [0, 0, -2], mass: 1, radius: 0}",
        "colliders: [{plane: {normal: [0, 0, 1]}, restitution: 0.5}]",
        0.0,
    );
    let swing = |lasts: f64| {
        laws(&scene, move |t| {
            let since = t - 0.503;
            let w = std::f64::consts::PI / lasts;
            let (z, v) = if since < 0.0 {
                (-2.0 * since, -2.0)
            } else if since < lasts {
                (-2.0 / w * (w * since).sin(), -2.0 * (w * since).cos())
            } else {
                (2.0 * (since - lasts), 2.0)
            };
            (vec![0.0, 0.0, z], vec![0.0, 0.0, v])
        })
    };
    assert_eq!(swing(4.0 * H).separation, None);
    near(judged(swing(0.1 * H).separation).off, 0.5, 1e-13);
}

/// The velocity is turned at the end of the step, inside the floor: what that is off, gravity within the step explains.
#[test]
fn a_flip_at_the_end_of_a_step_is_judged_within_its_bound() {
    let scene = floor("restitution: 0.8");
    let rows: Vec<_> = (0..=100)
        .scan((1.0_f64, 0.0_f64), |(z, v), n| {
            if n > 0 {
                *v -= H * G;
                *z += H * *v;
                if *z < 0.0 && *v < 0.0 {
                    *v *= -0.8;
                }
            }
            Some((vec![0.0, 0.0, *z], vec![0.0, 0.0, *v]))
        })
        .collect();
    let separation = judged(laws(&scene, |t| rows[(t / H).round() as usize].clone()).separation);
    assert!(
        separation.off > 1e-3 && !separation.broken(),
        "{separation:?}"
    );
}

/// Two balls of 1 and 3 kg meet with 2 m/s and part with e' of it, about their common centre.
#[test]
fn pairs_of_particles_are_judged() {
    let scene = scene(
        "{pos: [0, 0, 0], vel: [2, 0, 0], mass: 1, radius: 0.1}, {pos: [1, 0, 0], mass: 3, radius: 0.1}",
        "contact: {particles: true, restitution: 0.5}",
        0.0,
    );
    let pair = |e: f64| {
        contact(&scene, move |t| {
            let meets = 0.4_f64;
            let since = (t - meets).max(0.0);
            let (before, [one, other]) = (t.min(meets), [0.5 - 1.5 * e, 0.5 + 0.5 * e]);
            let v = if t < meets { [2.0, 0.0] } else { [one, other] };
            let x = [2.0 * before + one * since, 1.0 + other * since];
            let three = |c: [f64; 2]| vec![c[0], 0.0, 0.0, c[1], 0.0, 0.0];
            (three(x), three(v))
        })
    };
    near(judged(pair(0.5).laws.separation).off, 0.0, 1e-14);
    near(judged(pair(0.4).laws.separation).off, 0.1, 1e-14);
    // m1 m2/(m1 + m2)/2 (1.44 - 1) 4 m²/s².
    near(
        judged(pair(1.2).laws.energy_gain).off,
        0.375 * 0.44 * 4.0,
        1e-13,
    );
}

/// What is deeper than touching is inside, and said by name.
#[test]
fn what_is_inside_what_is_said() {
    let scene = floor("restitution: 0.8");
    let deep = |depth: f64| contact(&scene, move |_| (vec![0.0, 0.0, -depth], vec![0.0; 3]));
    // A billionth of the size, 1 m.
    let [rounding, real] = [deep(0.9e-9), deep(1.1e-9)];
    assert_eq!((rounding.deepest_m, rounding.inside), (0.0, None));
    assert_eq!(real.deepest_m, 1.1e-9);
    assert_eq!(real.inside.as_deref(), Some("collider 0 (plane)"));
}

/// Every method, rapier and its twin keep the laws as far as forces between two rows let tell. Sliding under constant forces
/// is right to rounding (measured: 3e-14). A bounce is found to 1e-12 of h: (1 + e) a h 1e-12/V = 6e-14, V = 2.8 m/s at the
/// third. Methods of order 1 have it up to a h²/2V apart: (1 + e) (a h/V)²/2 = 1.1e-3. rapier takes the velocity at the start
/// of a step: a h/V = 0.036.
#[test]
fn every_method_keeps_the_laws() {
    let scenes = [
        "belt",
        "bouncing",
        "corner",
        "coulomb",
        "drag",
        "incline",
        "off_a_ball",
    ];
    for name in scenes {
        let scene = shipped(&format!("contact/{name}.yml"));
        let others = ["rapier", "rapier_contact"]
            .into_iter()
            .filter_map(solvers::find);
        let choice = Choice {
            solvers: solvers::methods("rk4").into_iter().chain(others).collect(),
            prove: false,
            identify: false,
            ..Choice::default_for(&scene)
        };
        let report = Plan::new(&scene, &choice)
            .execute(&Quiet)
            .expect("no files");
        for outcome in report.outcomes() {
            let Some(contact) = &outcome.contact else {
                continue;
            };
            let laws = &contact.laws;
            let all = [
                laws.separation,
                laws.impact_friction,
                laws.sliding_friction,
                laws.energy_gain,
            ];
            let broken = all.iter().flatten().any(Residual::broken);
            assert!(!broken, "{name} {}: {all:#?}", outcome.engine);
            if matches!(name, "belt" | "incline") {
                assert!(
                    judged(laws.sliding_friction).off < 1e-13,
                    "{}",
                    outcome.engine
                );
            }
            if name == "bouncing" {
                let order = integrators::find(&outcome.engine).map(|method| method.order);
                let bound = match order {
                    Some(1) => 1.2e-3,
                    Some(_) => 1e-13,
                    None => 0.04,
                };
                let separation = judged(laws.separation);
                assert!(separation.off < bound, "{}: {separation:?}", outcome.engine);
                assert_eq!(separation.judged, 3);
                assert_eq!(judged(laws.impact_friction).off, 0.0);
            }
        }
    }
}
