//! One particle among planes: closed forms joined at impacts, landings and turns.

use super::form;
use crate::testkit::Random;
use crate::testkit::scenes::parsed;
use springcheck::physics::ParticleSystem;
use springcheck::scene::Scene;
use springcheck::truth::converged;
use springcheck::truth::{Motion, NoStore, Truth};

/// A particle of 1 kg without extent, and planes; `more` are keys of the scene.
fn lone(particle: &str, colliders: &str, more: &str) -> Scene {
    let (gravity, more) = match more.strip_prefix(WEIGHTLESS) {
        Some(more) => (0.0, more),
        None => (-9.81, more),
    };
    parsed(&format!(
        "solver: {{type: rk4, timestep: 0.01, gravity: {gravity}}}\nduration: 10\n\
         particles: [{{mass: 1, radius: 0, {particle}}}, {{pos: [0, 0, 0], fixed: true}}]\n\
         colliders: [{colliders}]\n{more}\n"
    ))
}

fn known(scene: &Scene, until: f64) -> Truth {
    form(scene, until).expect("a closed form")
}

/// Position and velocity at `t`, and the bar.
fn at(truth: &Truth, t: f64) -> ([f64; 3], [f64; 3], f64) {
    let motion = truth.motion().expect("a motion");
    let states = motion.states(&[t]);
    let three = |of: &[f64]| [of[0], of[1], of[2]];
    (three(states.x(0)), three(states.v(0)), motion.error_bar(t))
}

/// Before other keys.
const WEIGHTLESS: &str = "weightless ";
const FLOOR: &str = "{plane: {normal: [0, 0, 1]}, restitution: 0.8}";
const ROUGH: &str = "{plane: {normal: [0, 0, 1]}, friction: 0.2}";
const INCLINE: &str = "{plane: {normal: [-0.5, 0, 0.8660254037844386]}, friction: 0.2}";

/// What it is, particle, planes, more, time, position.
type Place = (
    &'static str,
    &'static str,
    &'static str,
    &'static str,
    f64,
    [f64; 3],
);

/// From mpmath at 40 digits: parabolas and exponentials with roots found
/// by bisection, or the formula beside it.
#[rustfmt::skip]
const PLACES: [Place; 14] = [
    ("parabola in pieces", "pos: [0, 0, 1]", FLOOR, "", 1.0, [0.0, 0.0, 0.4680044525260363]),
    ("parabola in pieces", "pos: [0, 0, 1]", FLOOR, "", 2.0, [0.0, 0.0, 0.2607417283270572]),
    // After t1 (1 + e)/(1 - e) = 4.06 s.
    ("parabola in pieces", "pos: [0, 0, 1]", FLOOR, "", 5.0, [0.0; 3]),
    ("parabola in pieces", "pos: [0.1, 0.2, 1], vel: [0.5, -0.3, 0]",
        "{plane: {normal: [1, 2, 3]}, restitution: 0.7, friction: 0.1}", "", 1.5,
        [2.609317396422643, 3.5940491466543536, -3.0289298359098]),
    ("parabola in pieces", "pos: [0.5, 0, 1], vel: [-2, 0.4, 0]",
        "{plane: {normal: [1, 0, 0]}, restitution: 0.6}, {plane: {normal: [0, 0, 1]}, restitution: 0.9, friction: 0.05}", "",
        2.0, [1.2161267432177558, 0.5053755810725853, 0.013684362285067739]),
    ("fall with linear drag in pieces", "pos: [0, 0, 1], vel: [1, 0, 0], drag: 0.4", FLOOR, "", 2.0,
        [1.376677589706946, 0.0, 0.04270753388748748]),
    ("oscillator in pieces", "pos: [1, 0, 0]", "{plane: {normal: [1, 0, 0], offset: -0.3}, restitution: 0.8}",
        "weightless springs: [{particle_ids: [0, 1], stiffness: 50, damping: 1, rest_length: 0}]", 3.0,
        [0.1444672506136332, 0.0, 0.0]),
    // a t²/2 with a = g (sin 30° - µ cos 30°); up from 3 m/s for .4542603826009345 s and down again for .651989958274 s.
    ("parabola in pieces", "pos: [0, 0, 0]", INCLINE, "", 1.0,
        [-1.6029290788874657 * 0.8660254037844386, 0.0, -1.6029290788874657 * 0.5]),
    ("parabola in pieces", "pos: [0, 0, 0], vel: [2.598076211353316, 0, 1.5]", INCLINE, "",
        0.4542603826009345 + 0.651989958274038, [0.0; 3]),
    // Stops after v²/(2 µ g), and stays.
    ("parabola in pieces", "pos: [0, 0, 0], vel: [2, 0, 0]", "{plane: {normal: [0, 0, 1]}, friction: 0.5}", "", 1.0,
        [0.40774719673802245, 0.0, 0.0]),
    // The first turning point, and where it sticks.
    ("oscillator in pieces", "pos: [1, 0, 0]", ROUGH,
        "springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]", 0.4442882938158366, [-0.92152, 0.0, 0.0]),
    ("oscillator in pieces", "pos: [1, 0, 0]", ROUGH,
        "springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]", 7.0, [0.02024, 0.0, 0.0]),
    // A belt at 1 m/s takes what lies on it along after 1/(µ g) s: 2 - 1/(2 µ g).
    ("parabola in pieces", "pos: [0, 0, 0]", "{plane: {normal: [0, 0, 1]}, friction: 0.2, driven: {velocity: [1, 0, 0]}}",
        "", 2.0, [2.0 - 1.0 / (2.0 * 0.2 * 9.81), 0.0, 0.0]),
    // A wall at 1 m/s against a ball at -5 m/s, e = .8: 5.8 m/s from x = 1/6 at t = 1/6 s on.
    ("parabola in pieces", "pos: [1, 0, 0], vel: [-5, 0, 0]",
        "{plane: {normal: [1, 0, 0]}, restitution: 0.8, driven: {velocity: [1, 0, 0]}}", WEIGHTLESS, 1.0,
        [5.0, 0.0, 0.0]),
];

#[test]
fn golden_places() {
    for (method, particle, colliders, more, t, right) in PLACES {
        let what = format!("{particle} {colliders}");
        let truth = form(&lone(particle, colliders, more), t.max(1.0));
        let truth = truth.unwrap_or_else(|| panic!("{what}: none"));
        assert_eq!(truth.method.as_deref(), Some(method), "{what}");
        let (x, _, bar) = at(&truth, t);
        let off = (0..3).fold(0.0, |most: f64, c| most.max((x[c] - right[c]).abs()));
        // Numbers of the table have 16 digits.
        assert!(off <= bar + 4e-16, "{what}: {off:e}, bar {bar:e}");
        assert!(bar < 2e-12, "{what}: {bar:e}");
    }
}

#[test]
fn the_oscillator_turns_thirteen_times() {
    let spring = "springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]";
    let truth = known(&lone("pos: [1, 0, 0]", ROUGH, spring), 7.0);
    assert_eq!(
        truth.reason,
        "one particle among planes: closed forms joined at 13 turns"
    );
    // Every half swing is 2 µ m g/k shorter.
    for n in 0..=13 {
        let (x, v, bar) = at(
            &truth,
            f64::from(n) * std::f64::consts::PI / 50.0_f64.sqrt(),
        );
        let right = (1.0 - f64::from(n) * 0.07848) * f64::from(1 - 2 * (n % 2));
        assert!((x[0] - right).abs() <= bar, "{n}: {} {right}", x[0]);
        // The time is right to a rounding, and the acceleration is 50 m/s² at most.
        assert!(
            v[0].abs() <= 50.0 * 5.8 * 4.0 * f64::EPSILON,
            "{n}: {}",
            v[0]
        );
    }
}

/// What is not one particle among planes, or is undecidable, has none.
#[test]
fn what_rounding_decides_has_no_closed_form() {
    let spring = "springs: [{particle_ids: [0, 1], stiffness: 50, rest_length: 0}]";
    for (why, particle, colliders, more) in [
        (
            "two at a time",
            "pos: [1, 0, 1], vel: [-1, 0, -1]",
            "{plane: {normal: [1, 0, 0]}}, {plane: {normal: [0, 0, 1]}}",
            WEIGHTLESS,
        ),
        (
            "grazes at the top",
            "pos: [0, 0, 0.5], vel: [0, 0, 3.132091952673165]",
            "{plane: {normal: [0, 0, -1], offset: -1}, restitution: 1}",
            "",
        ),
        (
            "stick at the angle of friction itself",
            "pos: [0, 0, 0]",
            "{plane: {normal: [-0.5, 0, 0.8660254037844386]}, friction: 0.5773502691896257}",
            "",
        ),
        (
            "slides on a curve",
            "pos: [0, 0, 0], vel: [0, 1, 0]",
            INCLINE,
            "",
        ),
        (
            "a spring from a belt",
            "pos: [1, 0, 0]",
            "{plane: {normal: [0, 0, 1]}, friction: 0.2, driven: {velocity: [1, 0, 0]}}",
            spring,
        ),
        (
            "a ball",
            "pos: [0, 0, 3]",
            "{ball: {center: [0, 0, 0], radius: 1}}",
            "",
        ),
        (
            "driven",
            "pos: [0, 0, 1]",
            "{plane: {normal: [0, 0, 1]}, driven: {sine: {amplitude: [0, 0, 0.1], omega: 3}}}",
            "",
        ),
        (
            "squared drag",
            "pos: [0, 0, 1], quadratic_drag: 0.1",
            FLOOR,
            "",
        ),
        (
            "penalty",
            "pos: [0, 0, 1]",
            "{plane: {normal: [0, 0, 1]}}",
            "contact: {penalty: {stiffness: 1.0e4}}",
        ),
    ] {
        assert!(
            form(&lone(particle, colliders, more), 5.0).is_none(),
            "{why}"
        );
    }
}

/// The reference that is cut at events knows none of these formulas: both are right within their bars, for particles thrown
/// into a tilted room, with friction and drag. Returns the largest part of the bars that was needed.
fn agree(scene: &Scene, until: f64) -> Result<f64, String> {
    let system = ParticleSystem::new(scene);
    let truth = known(scene, until);
    let other = converged::find(scene, &system, until, &NoStore).map_err(|e| e.to_string())?;
    let until = other.facts.horizon.min(truth.horizon);
    let motion = truth.motion().expect("a motion");
    let mut needed = 0.0_f64;
    for k in 0..=200 {
        let t = until * f64::from(k) / 200.0;
        let (a, b) = (motion.states(&[t]), other.motion.states(&[t]));
        let off = (0..3)
            .map(|c| (a.x(0)[c] - b.x(0)[c]).powi(2))
            .sum::<f64>()
            .sqrt();
        let bars = motion.error_bar(t) + other.motion.error_bar(t);
        if off > bars {
            return Err(format!("{off:e} > {bars:e} at {t}"));
        }
        needed = needed.max(off / bars);
    }
    Ok(needed)
}

#[test]
fn the_reference_agrees_in_random_rooms() {
    let mut random = Random(11);
    let mut found = 0;
    for k in 0..12 {
        let mut number = |from: f64, to: f64| from + (to - from) * 0.5 * (1.0 + random.next());
        let [e, mu, drag] = [number(0.0, 1.0), number(0.0, 0.5), number(0.0, 0.5)];
        let walls: String = [
            [1.0, 0.0, 0.2],
            [-1.0, 0.1, 0.2],
            [0.0, 1.0, 0.1],
            [0.1, -1.0, 0.2],
            [0.05, 0.1, 1.0],
        ]
        .iter()
        .map(|n| {
            let n: Vec<f64> = n.iter().map(|c| c + number(-0.1, 0.1)).collect();
            format!("{{plane: {{normal: {n:?}, offset: -1}}, restitution: {e}, friction: {mu}}}, ")
        })
        .collect();
        let v = [number(-3.0, 3.0), number(-3.0, 3.0), number(-3.0, 3.0)];
        let particle = format!("pos: [0, 0, 0.2], vel: {v:?}, drag: {drag}");
        let scene = lone(&particle, walls.trim_end_matches(", "), "");
        // Where it comes to slide on a curve there is none.
        if form(&scene, 1.2).is_some() {
            found += 1;
            if let Err(off) = agree(&scene, 1.2) {
                panic!("room {k}: {off}");
            }
        }
    }
    assert!(found > 4, "{found}");
}
