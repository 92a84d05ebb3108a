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

/// Free flight through a corner of two triangles, x <= 1 and y <= 1, each of which turns its component once.
fn corner(v: [f64; 2]) -> Laws {
    let scene = scene(
        "{pos: [0.5, 0.5, 0.2], mass: 1, radius: 0.01}",
        "colliders: [{restitution: 1, mesh: {vertices: [[1, -9, -9], [1, 9, -9], [1, 0, 9], [-9, 1, -9], [9, 1, -9], [0, 1, 9]], \
         triangles: [[0, 1, 2], [3, 4, 5]]}}]",
        0.0,
    );
    laws(&scene, |t| {
        // 0.49 m from where the ball of 0.01 m touches.
        let turned = |v: f64| match v * t {
            way if way < 0.49 => (0.5 + way, v),
            way => (1.48 - way, -v),
        };
        let [(x, vx), (y, vy)] = v.map(turned);
        (vec![x, y, 0.2], vec![vx, vy, 0.0])
    })
}

/// At 0.245 s and at 0.247 s it is one row, at 0.49 s another. Mutants: other triangles at the impact alone; at none.
#[test]
fn two_triangles_within_a_row_are_not_judged() {
    let both = corner([2.0, 1.98]);
    assert_eq!(both, Laws::default());
    let apart = corner([2.0, 1.0]);
    assert_eq!(judged(apart.separation).judged, 2);
    near(judged(apart.separation).off, 0.0, ROUNDED);
    near(judged(apart.impact_friction).off, 0.0, ROUNDED);
}

/// With a penalty a bounce has no restitution to judge, whatever the rows say.
#[test]
fn with_a_penalty_nothing_is_judged() {
    let scene = scene(
        "{pos: [0, 0, 1], mass: 2, radius: 0}",
        "colliders: [{plane: {normal: [0, 0, 1]}}]\ncontact: {penalty: {stiffness: 100}}",
        -G,
    );
    assert_eq!(laws(&scene, bounce(1.1, |_| -1.0)), Laws::default());
}

/// Our run of a scene, every step of 1 ms.
fn ours(id: &str, more: &str, duration: f64) -> Laws {
    let scene = parsed(&format!(
        "solver: {{type: {id}, timestep: 0.001}}\nduration: {duration}\n{more}\n"
    ));
    let choice = Choice {
        solvers: solvers::find(id).into_iter().collect(),
        prove: false,
        identify: false,
        ..Choice::default_for(&scene)
    };
    let report = Plan::new(&scene, &choice).execute(&Quiet);
    let report = report.expect("no files");
    report.outcomes()[0].contact.as_ref().expect("contact").laws
}

/// A rod at 53° that falls 0.3 m on its lower end, e = 0: the impulse V/K, K = (1 + cos² θ)/2 = 0.68 /kg (rigid body), gives
/// that end cos θ sin θ/2K V = 0.35 V across, V = 2.4 m/s: 0.36 J that the other end loses. Mutant: what is across counts.
#[test]
fn a_rod_turns_what_an_impact_takes_and_gains_nothing() {
    let rod = "particles: [{pos: [0, 0, 0.3], mass: 1, radius: 0}, {pos: [0.6, 0, 1.1], mass: 1, radius: 0}]\n\
               rods: [{particle_ids: [0, 1]}]\ncolliders: [{plane: {normal: [0, 0, 1]}}]";
    let laws = ours("rattle", rod, 0.26);
    assert_eq!(judged(laws.separation).judged, 1);
    assert!(!judged(laws.separation).broken());
    near(judged(laws.energy_gain).off, 0.0, 0.0);
}

/// The ends of two rods at right angles fall at once: each feels the impact of the other through the knee, which touches
/// nothing. Mutant: what one rod joins alone.
#[test]
fn what_rods_join_is_not_judged_where_several_meet_something() {
    let knee = "particles: [{pos: [0, 0, 0.3], mass: 1, radius: 0}, {pos: [1, 0, 1.3], mass: 1, radius: 0}, \
                {pos: [2, 0, 0.3], mass: 1, radius: 0}]\n\
                rods: [{particle_ids: [0, 1]}, {particle_ids: [1, 2]}]\ncolliders: [{plane: {normal: [0, 0, 1]}}]";
    assert_eq!(ours("rattle", knee, 0.26).separation, None);
}

/// On a belt of 2 m/s a block on a spring swings freely about µ m g/k with 0.2 m, w² = 50: friction is µ N throughout. The
/// trapezoid misses h² w² a/12 of the force where a = 10 m/s² turns, 4.2e-4 N: the accelerations at both rows are the same
/// there. Mutant: their difference alone as the bound.
#[test]
fn a_force_that_turns_between_two_rows_is_no_fault_of_friction() {
    let (w, amplitude) = (50.0_f64.sqrt(), 0.2);
    let scene = scene(
        "{pos: [0, 0, 0], mass: 1, radius: 0}, {pos: [0, 0, 0], fixed: true}",
        "springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]\n\
         colliders: [{plane: {normal: [0, 0, 1]}, friction: 0.2, driven: {velocity: [2, 0, 0]}}]",
        -G,
    );
    let laws = laws(&scene, |t| {
        let x = 0.2 * G / 50.0 + amplitude * (w * t).cos();
        let v = -amplitude * w * (w * t).sin();
        let still = [0.0; 5];
        ([&[x], &still[..]].concat(), [&[v], &still[..]].concat())
    });
    let sliding = judged(laws.sliding_friction);
    assert_eq!(sliding.judged, 100);
    assert!(!sliding.broken(), "{sliding:?}");
    let missed = H * H * 50.0 / 12.0 * 50.0 * amplitude / G;
    // cos and its series: (h w)²/20.
    near(sliding.off, missed, 1e-3 * missed);
    assert!(sliding.bound < 5.0 * sliding.off, "{sliding:?}");
}

/// A block lies still on a slope at the very angle of friction, 3 to 4: its velocity is 0, the rounding of its forces not.
#[test]
fn a_bound_is_no_smaller_than_rounding() {
    let slope = scene(
        "{pos: [0, 0, 0], mass: 1, radius: 0}",
        "colliders: [{plane: {normal: [-3, 0, 4]}, friction: 0.75}]",
        -G,
    );
    let sliding = laws(&slope, |_| (vec![0.0; 3], vec![0.0; 3])).sliding_friction;
    let sliding = judged(sliding);
    assert!(
        sliding.bound > f64::EPSILON && sliding.bound < 1e-12,
        "{sliding:?}"
    );
    assert!(!sliding.broken(), "{sliding:?}");
}
