//! A scene written out, as `expand` prints it, reads back to the same scene.

use super::schema::{full, read};
use super::shipped;
use crate::testkit::scenes::parsed;
use serde_json::json;
use springcheck::scene::{self, Scene};
use springcheck::verbs::names;

#[test]
fn a_scene_written_out_is_the_same_scene() {
    let same = |scene: &Scene| {
        let text = scene::yaml(scene);
        let again = scene::parse(text.as_bytes(), &scene.file, names());
        let again = again.unwrap_or_else(|error| panic!("{error}\n{text}"));
        // Names of particles are not written out.
        let plain = Scene {
            bodies: Vec::new(),
            written: None,
            ..scene.clone()
        };
        assert_eq!(again, plain, "{text}");
        // Nothing is left to fill in.
        assert_eq!(scene::yaml(&again), text);
    };
    for (path, bytes) in shipped() {
        let file = path.display().to_string();
        same(&scene::parse(&bytes, &file, names()).expect("a scene"));
    }
    same(&read(&full()).expect("a scene"));
    // Words that YAML would take for something else, line ends of its own, numbers at both ends of a double's range,
    // and a direction whose length rounds.
    let mut odd = full();
    odd["name"] = json!("yes");
    odd["description"] = json!("a: b # c\n\tsecond \u{2028}line\u{2029} \u{feff} \"'\\ [x, {y}] é");
    odd["particles"][0]["pos"] = json!([1e-300, -1e12, 0.1 + 0.2]);
    odd["springs"][0]["stiffness"] = json!(1e18);
    odd["wind"]["direction"] = json!([2, 3, 7]);
    odd["solver"]["gravity"] = json!([[0.1, 1e-300, -9.81], [1, 2, 3]]);
    odd["externals"] = json!(["mine", "1e3", "true", "null"]);
    odd["expect"] = json!({
        "1e3": {"identified.decisive": true, "reason": {"contains": "]: ,"}},
        "true": {"identified.decisive": ["true", "false"]},
        "null": {"energy.final_j": {"above": -1e300, "below": 5e-324}},
        "skip": {"order": "- no"},
    });
    same(&read(&odd).expect("a scene"));
    odd["solver"]["gravity"] = json!([[0, 0, -9.81]]);
    same(&read(&odd).expect("a scene"));
}

/// The file says what the scene left unsaid, as `docs/contract.md` has it.
#[test]
fn what_is_written_out_has_every_default() {
    let scene = parsed(
        "solver: {type: rk4, timestep: 1e-5}\nduration: 0.5\n\
         particles: [{pos: [0, 0, 2], fixed: true}, {pos: [0, 0, 1], mass: 2}]\n\
         springs: [{particle_ids: [0, 1], stiffness: 20}]\nexpect: {rk4: {status: completed}}\n",
    );
    assert_eq!(
        scene::yaml(&scene),
        "name: test\n\
         solver: {type: rk4, timestep: 1.0e-5, gravity: -9.81}\n\
         duration: 0.5\n\
         up: z\n\
         damping_model: axial\n\
         particles:\n\
         \x20 - {pos: [0.0, 0.0, 2.0], vel: [0.0, 0.0, 0.0], fixed: true, mass: 1.0, radius: 0.1, drag: 0.0, quadratic_drag: 0.0, charge: 0.0}\n\
         \x20 - {pos: [0.0, 0.0, 1.0], vel: [0.0, 0.0, 0.0], fixed: false, mass: 2.0, radius: 0.1, drag: 0.0, quadratic_drag: 0.0, charge: 0.0}\n\
         springs:\n\
         \x20 - {particle_ids: [0, 1], stiffness: 20.0, cubic: 0.0, damping: 0.0, rest_length: 1.0}\n\
         expect:\n\
         \x20 rk4: {status: completed}\n"
    );
}
