//! Whatever the bytes, the answer is a sound scene or a located error, never a panic.

use super::shipped;
use proptest::prelude::*;
use springcheck::integrators;
use springcheck::scene::{self, Scene, Wanted};
use springcheck::verbs;

/// Pieces that mean something in YAML or in a scene.
const PIECES: &[&str] = &[
    "[",
    "]",
    "{",
    "}",
    ",",
    ":",
    ": ",
    "- ",
    "? ",
    "#",
    " #",
    "&a ",
    "*a",
    "!!str ",
    "!x ",
    "|\n",
    ">\n",
    "'",
    "\"",
    "\\",
    "\n",
    "\r",
    "\r\n",
    "\t",
    "  ",
    "---\n",
    "...\n",
    "%YAML 1.1\n",
    "<<: ",
    "~",
    "null",
    "true",
    ".nan",
    ".inf",
    "-",
    "-1",
    "0",
    "010",
    "1e308",
    "-1e-320",
    "1e999",
    "99999999999999999999",
    "0x",
    "pos",
    "mass",
    "stiffness: ",
    "expect: ",
    "rapier: ",
    "status: ",
    "completed",
    "below: ",
    "contains: ",
    "particle_ids: [0, 0]",
    "ä",
    "\u{feff}",
    "\u{2028}",
    "\u{85}",
    "\0",
];

/// Every key, small enough to be mutated often.
const RICH: &str = "name: a\ndescription: 'b'\nduration: 2\nup: x\ndamping_model: axial\n\
    solver: {type: rk4, timestep: 0.1, gravity: [[0, 0, 1], [1, 2, 3]], tolerance: 1e-9}\n\
    plot: {particle_id: 1, dof: 2, y_range: [0, 1]}\n\
    particles:\n- &p {pos: [0, 0, 0], fixed: true, mass: 1}\n- {pos: [1, 0, 0], vel: [0, 1, 0], mass: 1, radius: 1, drag: 1, quadratic_drag: 1}\n- *p\n- {pos: [0, 1, 0], mass: 1}\n\
    springs: [{particle_ids: [0, 1], stiffness: 1, cubic: 1, damping: 1, rest_length: 1}]\n\
    gravitational: [{particle_ids: [0, 1], G: 1}]\nwind: {direction: [1, 0, 0], strength: 1}\n\
    air: {velocity: [1, 0, 0], density: 1}\ntriangles: [{particle_ids: [0, 1, 3], air_drag: 1}]\n\
    rods: [{particle_ids: [0, 1], length: 1}]\nconstraints: {stabilisation: baumgarte, rate: 1}\n\
    expect:\n  all: &e {status: [completed, failed], energy.drift_per_s: {above: -1, below: 1}}\n  \
    rest: *e\n  rapier: {reason: {contains: particle 1}, energy.class: growing}\n";

fn seeds() -> Vec<Vec<u8>> {
    // The sheet is large, and holds nothing the others do not.
    let small = shipped()
        .into_iter()
        .map(|(_, bytes)| bytes)
        .filter(|bytes| bytes.len() < 5000);
    small.chain([RICH.as_bytes().to_vec()]).collect()
}

/// Every number finite, every id valid, nothing out of its range.
fn assert_sound(scene: &Scene) {
    let count = scene.particles.len();
    let mut numbers = vec![scene.duration, scene.solver.timestep, scene.solver.gravity];
    numbers.extend(scene.solver.gravities.0.iter().flatten());
    assert!(scene.solver.timestep > 0.0 && scene.solver.timestep <= scene.duration);
    assert!(integrators::find(&scene.solver.method).is_some());
    for p in &scene.particles {
        numbers.extend(p.position.iter().chain(&p.velocity).chain([
            &p.radius,
            &p.drag,
            &p.quadratic_drag,
        ]));
        assert!(p.mass > 0.0 && p.mass.is_finite() && p.radius >= 0.0 && p.drag >= 0.0);
        assert!(p.quadratic_drag >= 0.0);
    }
    for s in &scene.springs {
        numbers.extend([s.stiffness, s.cubic, s.damping, s.rest_length]);
        assert!(s.stiffness >= 0.0 && s.cubic >= 0.0 && s.damping >= 0.0 && s.rest_length >= 0.0);
        assert!(s.ends[0] != s.ends[1] && s.ends.iter().all(|id| *id < count));
    }
    for rod in &scene.rods {
        numbers.push(rod.length);
        let [a, b] = rod.ends;
        assert!(rod.length > 0.0 && a != b && a < count && b < count);
        assert!(!scene.particles[a].fixed || !scene.particles[b].fixed);
    }
    for t in &scene.triangles {
        numbers.push(t.air_drag);
        let [a, b, c] = t.corners;
        assert!(a != b && b != c && a != c && t.corners.iter().all(|id| *id < count));
    }
    let air = scene.air();
    numbers.extend(air.velocity.into_iter().chain([air.density]));
    assert!(air.density >= 0.0);
    for g in &scene.gravitational {
        numbers.push(g.g);
        assert!(g.ends[0] != g.ends[1] && g.ends.iter().all(|id| *id < count));
    }
    if let Some(wind) = &scene.wind {
        numbers.push(wind.strength);
        let length = wind.direction.iter().map(|d| d * d).sum::<f64>();
        assert!((length - 1.0).abs() < 1e-14, "{length}");
    }
    for expectation in &scene.expect {
        match &expectation.wanted {
            Wanted::Words(words) => assert!(!words.is_empty()),
            Wanted::Contains(text) => assert!(!text.is_empty()),
            Wanted::Bounds { above, below } => {
                assert!(above.is_some() || below.is_some());
                numbers.extend(above.iter().chain(below));
            }
        }
    }
    numbers.push(scene.size());
    assert!(numbers.iter().all(|x| x.is_finite()), "{scene:?}");
    assert!(scene.particles.iter().any(|p| !p.fixed));
}

#[test]
fn what_is_changed_was_sound() {
    for bytes in seeds() {
        assert_sound(&scene::parse(&bytes, "x.yml", verbs::names()).unwrap());
    }
}

fn answers(bytes: &[u8]) {
    match scene::parse(bytes, "x.yml", verbs::names()) {
        Ok(scene) => assert_sound(&scene),
        Err(error) => {
            assert!(error.line.is_some() && error.column.is_some(), "{error}");
            assert!(error.to_string().starts_with("x.yml:"), "{error}");
        }
    }
}

#[derive(Debug, Clone)]
enum Change {
    Insert(&'static str),
    Overwrite(u8),
    Remove(usize),
    Repeat(usize),
    Cut,
}

fn change() -> impl Strategy<Value = Change> {
    prop_oneof![
        6 => proptest::sample::select(PIECES).prop_map(Change::Insert),
        2 => any::<u8>().prop_map(Change::Overwrite),
        3 => (1_usize..12).prop_map(Change::Remove),
        2 => (1_usize..60).prop_map(Change::Repeat),
        1 => Just(Change::Cut),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 3000,
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn changed_scenes_are_answered(
        seed in proptest::sample::select(seeds()),
        changes in proptest::collection::vec((any::<proptest::sample::Index>(), change()), 1..6),
    ) {
        let mut bytes = seed;
        for (place, change) in changes {
            let at = place.index(bytes.len() + 1);
            let end = |length: usize| (at + length).min(bytes.len());
            match change {
                Change::Insert(piece) => drop(bytes.splice(at..at, piece.bytes())),
                Change::Overwrite(byte) => drop(bytes.splice(at..end(1), [byte])),
                Change::Remove(length) => drop(bytes.drain(at..end(length))),
                Change::Repeat(length) => {
                    let piece = bytes[at..end(length)].to_vec();
                    drop(bytes.splice(at..at, piece));
                }
                Change::Cut => bytes.truncate(at),
            }
        }
        answers(&bytes);
    }

    #[test]
    fn any_pieces_are_answered(
        pieces in proptest::collection::vec(proptest::sample::select(PIECES), 0..60),
    ) {
        answers(pieces.concat().as_bytes());
    }

    #[test]
    fn any_bytes_are_answered(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        answers(&bytes);
    }
}
