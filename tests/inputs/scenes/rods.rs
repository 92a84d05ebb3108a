//! Rods in scene files: what they default to, and what is refused at its place.

use super::{Row, complete, parse};
use springcheck::scene::Stabilisation;

/// As the rows of `refused.rs`.
#[rustfmt::skip]
pub const REFUSED: &[Row] = &[
    ("rods, no list", "rods: »3", &["rods", "expected a list, found the number `3`"]),
    ("rod of two numbers", "rods: [»[0, 1]]", &["rods[0]", "expected a rod: a mapping with `particle_ids`, found a list"]),
    ("rod without ends", "rods: [»{length: 1}]", &["rods[0].particle_ids", "missing", "name the two ends"]),
    ("rod of three ends", "rods: [{particle_ids: »[0, 1, 0]}]", &["rods[0].particle_ids", "a list of 2 numbers, found 3"]),
    ("rod to nobody", "rods: [{particle_ids: [0, »2]}]", &["rods[0].particle_ids[1]", "a particle from 0 to 1, found 2", "count from 0"]),
    ("rod to a negative id", "rods: [{particle_ids: [»-1, 1]}]", &["rods[0].particle_ids[0]", "found -1"]),
    ("rod to half an id", "rods: [{particle_ids: [0, »0.5]}]", &["rods[0].particle_ids[1]", "found 0.5", "whole numbers"]),
    ("rod onto itself", "rods: [{particle_ids: »[1, 1]}]", &["rods[0].particle_ids", "two different particles, found 1 twice"]),
    ("rod with a stiffness", "rods: [{particle_ids: [0, 1], »stiffness: 3}]", &["rods[0]", "unknown key `stiffness`", "the keys here are particle_ids, length"]),
    ("rod, length misspelt", "rods: [{particle_ids: [0, 1], »lenght: 1}]", &["rods[0]", "unknown key `lenght`", "did you mean `length`?"]),
    ("rod of length 0", "rods: [{particle_ids: [0, 1], length: »0}]", &["rods[0].length", "expected a positive number (m), found 0"]),
    ("rod of negative length", "rods: [{particle_ids: [0, 1], length: »-1}]", &["rods[0].length", "expected a positive number (m), found -1"]),
    ("rod of length NaN", "rods: [{particle_ids: [0, 1], length: ».nan}]", &["rods[0].length", "expected a finite number (m), found NaN"]),
    ("rod of infinite length", "rods: [{particle_ids: [0, 1], length: ».inf}]", &["rods[0].length", "expected a finite number (m), found inf"]),
    ("rod longer than any", "rods: [{particle_ids: [0, 1], length: »1e13}]", &["rods[0].length", "at most 1e12 (m)"]),
    ("rod shorter than any", "rods: [{particle_ids: [0, 1], length: »1e-31}]", &["rods[0].length", "at least 1e-30 (m)"]),
    ("rod of a text", "rods: [{particle_ids: [0, 1], length: »long}]", &["rods[0].length", "expected a number, found the text `long`"]),
    ("rod of a length in quotes", "rods: [{particle_ids: [0, 1], length: »'1'}]", &["rods[0].length", "the text `1`", "remove the quotes"]),
    ("rod, off by 1e-8", "rods: [{particle_ids: [0, 1], length: »1.00000001}]", &["rods[0].length", "expected the distance at the start, 1.0 m between 0 and 1, found 1.00000001", "to 1e-9 of it"]),
    ("rods of two lengths", "rods:\n- {particle_ids: [0, 1], length: 1}\n- {particle_ids: [1, 0], length: »2}", &["rods[1].length", "1.0 m between 1 and 0, found 2.0"]),
    ("rod twice", "rods:\n- {particle_ids: [0, 1]}\n- »{particle_ids: [1, 0]}", &["rods[1]", "particles 1 and 0 have two rods, rods[0] and rods[1]", "remove one of them"]),
    ("rod between fixed ends", "particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [1, 0, 0], fixed: true}\n- {pos: [2, 0, 0], mass: 1}\nrods: [{particle_ids: »[0, 1]}]", &["rods[0].particle_ids", "expected a free end, found particles 0 and 1 fixed", "needs no rod"]),
    ("rod of no length", "particles:\n- {pos: [1, 2, 3], mass: 1}\n- {pos: [1, 2, 3], mass: 1}\nrods: [{particle_ids: »[0, 1]}]", &["rods[0].particle_ids", "found particles 0 and 1 in one place", "a rod needs a direction"]),
    ("rod of a length between ends in one place", "particles:\n- {pos: [1, 2, 3], mass: 1}\n- {pos: [1, 2, 3], mass: 1}\nrods: [{particle_ids: »[0, 1], length: 1}]", &["rods[0].particle_ids", "found particles 0 and 1 in one place"]),
    ("rod pulled apart", "particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [1, 0, 0], vel: [0.1, 5, 0], mass: 1}\nrods: [{particle_ids: »[0, 1]}]", &["rods[0].particle_ids", "expected no velocity along the rod", "0.1 m/s"]),
    ("rod pulled apart by 1e-8", "particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [1, 0, 0], vel: [1e-8, 1, 0], mass: 1}\nrods: [{particle_ids: »[0, 1]}]", &["rods[0].particle_ids", "expected no velocity along the rod", "1e-8 m/s"]),
    ("rod driven along itself", "driven: [{particle_id: 0, velocity: [1, 0, 0]}]\nrods: [{particle_ids: »[0, 1]}]", &["rods[0].particle_ids", "expected no velocity along the rod"]),
    ("rod to where its end is not at 0 s", "driven:\n- particle_id: 0\n  sine: {amplitude: [0, 0, 0.1], omega: 3, phase: 1}\nrods: [{particle_ids: [0, 1], length: »1}]", &["rods[0].length", "expected the distance at the start, 1.003"]),
    ("rods in line between fixed ends", "particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [1, 0, 0], mass: 1}\n- {pos: [2, 0, 0], mass: 1}\n- {pos: [3, 0, 0], fixed: true}\nrods:\n- {particle_ids: [0, 1]}\n- »{particle_ids: [1, 2]}\n- {particle_ids: [2, 3]}", &["rods[1]", "rods 0, 1, 2 hold each other", "let them sag"]),
    ("rods, one more than directions", "particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [1, 0, 0], fixed: true}\n- {pos: [0.5, 0, -1], mass: 1}\n- {pos: [0.5, 1, -1], fixed: true}\n- {pos: [1.5, 1, -1], fixed: true}\nrods:\n- {particle_ids: [0, 2]}\n- {particle_ids: [1, 2]}\n- {particle_ids: [3, 2]}\n- »{particle_ids: [4, 2]}", &["rods[3]", "rods 0, 1, 2, 3 hold each other"]),
    ("rods, a square with both diagonals", "particles:\n- {pos: [0, 0, 0], mass: 1}\n- {pos: [1, 0, 0], mass: 1}\n- {pos: [1, 1, 0], mass: 1}\n- {pos: [0, 1, 0], mass: 1}\nrods:\n- {particle_ids: [0, 1]}\n- {particle_ids: [1, 2]}\n- {particle_ids: [2, 3]}\n- »{particle_ids: [3, 0]}\n- {particle_ids: [0, 2]}\n- {particle_ids: [1, 3]}", &["rods[3]", "rods 0, 1, 2, 3, 4, 5 hold each other"]),
    ("rods parallel but for 5e-7", "particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [0, 5e-7, 0], fixed: true}\n- {pos: [1, 0, 0], mass: 1}\nrods:\n- {particle_ids: [0, 2]}\n- »{particle_ids: [1, 2]}", &["rods[1]", "rods 0, 1 hold each other"]),
    ("constraints, no mapping", "constraints: »[]", &["constraints", "expected a mapping with `stabilisation`, found a list"]),
    ("constraints, unknown key", "constraints: {»damping: 3}", &["constraints", "unknown key `damping`", "the keys here are stabilisation, rate"]),
    ("stabilisation, in American", "constraints: {»stabilization: project}", &["constraints", "did you mean `stabilisation`?"]),
    ("stabilisation, unknown", "constraints: {stabilisation: »projekt}", &["constraints.stabilisation", "unknown choice `projekt`", "project, baumgarte, none", "did you mean `project`?"]),
    ("stabilisation by a number", "constraints: {stabilisation: »3}", &["constraints.stabilisation", "expected text"]),
    ("rate of a projection", "rods: [{particle_ids: [0, 1]}]\nconstraints: {rate: »5}", &["constraints.rate", "expected `stabilisation: baumgarte`, which alone has a rate"]),
    ("constraints without rods", "constraints: »{stabilisation: none}", &["constraints", "expected rods to keep, found none"]),
    ("rate negative", "constraints: {stabilisation: baumgarte, rate: »-1}", &["constraints.rate", "at least 0 (1/s), found -1"]),
    ("rate NaN", "constraints: {stabilisation: baumgarte, rate: ».nan}", &["constraints.rate", "finite number (1/s)"]),
    ("rate infinite", "constraints: {stabilisation: baumgarte, rate: ».inf}", &["constraints.rate", "finite number (1/s)"]),
];

/// A rod has its distance at the start, to 1e-9 of it.
#[test]
fn rods_have_defaults() {
    let rod = |more: &str| {
        parse(&complete(&format!(
            "rods: [{{particle_ids: [1, 0]{more}}}]"
        )))
    };
    let scene = rod("").unwrap();
    assert_eq!((scene.rods[0].ends, scene.rods[0].length), ([1, 0], 1.0));
    assert_eq!(scene.constraints, None);
    assert!(rod(", length: 1.0000000009").is_ok() && rod(", length: 1.0000000011").is_err());
    assert!(parse(&complete("rods:")).unwrap().rods.is_empty());
    for (text, stabilisation) in [
        ("{}", Stabilisation::Project),
        ("{stabilisation: none}", Stabilisation::None),
    ] {
        let scene = format!("rods: [{{particle_ids: [0, 1]}}]\nconstraints: {text}");
        let scene = parse(&complete(&scene)).unwrap();
        let constraints = scene.constraints.unwrap();
        assert_eq!(
            (constraints.stabilisation, constraints.rate),
            (stabilisation, 10.0)
        );
    }
}

/// A drive that starts where it turns has a velocity of rounding alone, as 0.5 m/s times the cosine of π/2.
#[test]
fn a_drive_may_start_where_it_turns() {
    let phase = std::f64::consts::FRAC_PI_2;
    let driven = |phase: f64| {
        parse(&format!(
            "solver: {{type: rk4, timestep: 0.01}}\nparticles:\n- {{pos: [0, 0, 0], fixed: true}}\n\
             - {{pos: [0, 0, -1], mass: 1}}\nrods: [{{particle_ids: [0, 1]}}]\n\
             driven: [{{particle_id: 0, sine: {{amplitude: [0, 0, 0.1], omega: 5, phase: {phase}}}}}]\n"
        ))
    };
    for quarter in [1.0, -1.0, 3.0, 5.0] {
        driven(quarter * phase).unwrap_or_else(|error| panic!("{error}"));
    }
    // 1e-8 of its fastest is no rounding.
    assert!(driven(phase + 1e-8).is_err() && driven(0.0).is_err());
}
