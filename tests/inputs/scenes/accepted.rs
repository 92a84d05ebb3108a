//! Odd but right: what a scene may look like, and what it then means.

use super::{complete, parse, shipped};
use springcheck::scene::{
    self, Axis, DampingModel, Expectation, Scene, Scope, Stabilisation, Wanted,
};
use springcheck::verbs;

fn accepted(text: &str) -> Scene {
    parse(&complete(text)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn a_small_scene_gets_its_defaults() {
    let scene = accepted("springs: [{particle_ids: [1, 0], stiffness: 20}]");
    assert_eq!(
        (scene.name.as_str(), scene.file.as_str()),
        ("test", "scenes/test.yml")
    );
    assert_eq!(
        (scene.solver.gravity, scene.duration, scene.solver.tolerance),
        (-9.81, 5.0, None)
    );
    assert_eq!(
        (scene.up, scene.damping_model),
        (Axis::Z, DampingModel::Axial)
    );
    assert!(scene.plot.is_none() && scene.wind.is_none() && scene.gravitational.is_empty());
    assert!(scene.air.is_none() && scene.triangles.is_empty());
    let air = scene.air();
    assert_eq!((air.velocity, air.density), ([0.0; 3], 1.2));
    let [fixed, free] = &scene.particles[..] else {
        panic!()
    };
    assert_eq!((fixed.fixed, fixed.mass), (true, 1.0));
    assert_eq!(
        (free.fixed, free.velocity, free.radius, free.drag),
        (false, [0.0; 3], 0.1, 0.0)
    );
    let spring = &scene.springs[0];
    assert_eq!(
        (spring.ends, spring.damping, spring.rest_length),
        ([1, 0], 0.0, 1.0)
    );
    assert_eq!(spring.cubic, 0.0);
}

/// A number along `up`; or vectors that add up, to which `up` does nothing.
#[test]
fn gravity_is_a_number_or_vectors() {
    let gravity = |text: &str| {
        let solver = format!("solver: {{type: rk4, timestep: 0.1, gravity: {text}}}\nup: x");
        accepted(&solver).gravity()
    };
    assert_eq!(gravity("-2"), [-2.0, 0.0, 0.0]);
    assert_eq!(gravity("[0, 0, -9.81]"), [0.0, 0.0, -9.81]);
    assert_eq!(
        gravity("[[0, 0, -9.81], [1, 2, 0.5]]"),
        [1.0, 2.0, -9.81 + 0.5]
    );
    assert_eq!(gravity(""), [-9.81, 0.0, 0.0]);
}

#[test]
fn every_key_is_read() {
    let scene = accepted(
        "name: All\ndescription: |\n  two\n  lines\nduration: 2\nup: y\ndamping_model: isotropic\n\
         solver: {type: rk4, timestep: 0.5, gravity: 1, tolerance: 1e-9}\n\
         plot: {particle_id: 1, dof: 2, y_range: [-1, 1]}\n\
         particles: [{pos: [1, 2, 3], vel: [4, 5, 6], fixed: false, mass: 7, radius: 8, drag: 9, quadratic_drag: 10},\n\
         {pos: [0, 0, 0], fixed: true, mass: 0.1}, {pos: [0, 0, 1], mass: 1}]\n\
         springs: [{particle_ids: [0, 1], stiffness: 0, cubic: 2, damping: 3, rest_length: 0}]\n\
         gravitational: [{particle_ids: [0, 1], G: -100.}]\nwind: {direction: [0, 3, 4], strength: -2}\n\
         air: {velocity: [1, 2, 3], density: 4}\ntriangles: [{particle_ids: [2, 1, 0], air_drag: 5}]\n\
         rods: [{particle_ids: [2, 1], length: 1}]\nconstraints: {stabilisation: baumgarte, rate: 3}",
    );
    assert_eq!(scene.description.as_deref(), Some("two\nlines\n"));
    assert_eq!((scene.duration, scene.up), (2.0, Axis::Y));
    assert_eq!(scene.damping_model, DampingModel::Isotropic);
    assert_eq!(
        (scene.solver.gravity, scene.solver.tolerance),
        (1.0, Some(1e-9))
    );
    let plot = scene.plot.as_ref().unwrap();
    assert_eq!(
        (plot.particle, plot.dof, plot.y_range),
        (1, 2, Some([-1.0, 1.0]))
    );
    let p = &scene.particles[0];
    assert_eq!((p.position, p.velocity), ([1.0, 2.0, 3.0], [4.0, 5.0, 6.0]));
    assert_eq!((p.mass, p.radius, p.drag), (7.0, 8.0, 9.0));
    assert_eq!(p.quadratic_drag, 10.0);
    let air = scene.air();
    assert_eq!((air.velocity, air.density), ([1.0, 2.0, 3.0], 4.0));
    let triangle = &scene.triangles[0];
    assert_eq!((triangle.corners, triangle.air_drag), ([2, 1, 0], 5.0));
    assert_eq!(
        (scene.springs[0].stiffness, scene.springs[0].rest_length),
        (0.0, 0.0)
    );
    assert_eq!(scene.springs[0].cubic, 2.0);
    assert_eq!((scene.rods[0].ends, scene.rods[0].length), ([2, 1], 1.0));
    let constraints = scene.constraints.as_ref().unwrap();
    assert_eq!(
        (constraints.stabilisation, constraints.rate),
        (Stabilisation::Baumgarte, 3.0)
    );
    assert_eq!(scene.gravitational[0].g, -100.0);
    let wind = scene.wind.unwrap();
    assert_eq!((wind.direction, wind.strength), ([0.0, 0.6, 0.8], -2.0));
}

#[test]
fn numbers_take_every_form_but_quotes() {
    for (written, value) in [
        ("20", 20.0),
        ("20.", 20.0),
        ("+2.5", 2.5),
        (".5", 0.5),
        ("2e1", 20.0),
        ("2.E+1", 20.0),
        ("0x14", 20.0),
        ("0o10", 8.0),
        ("0b11", 3.0),
        ("010.5", 10.5),
        ("0.010", 0.01),
        ("1e-400", 0.0),
        ("!!float 3", 3.0),
    ] {
        let text = format!("springs: [{{particle_ids: [0, 1], stiffness: {written}}}]");
        assert_eq!(accepted(&text).springs[0].stiffness, value, "{written}");
    }
}

#[test]
fn anchors_comments_and_line_ends_do_not_matter() {
    let block = "# A scene.\nsprings: # two alike\n  - &spring\n    particle_ids: &ends [0, 1] # both\n    \
                 stiffness: &k 20.\n  - *spring\n  - {particle_ids: *ends, stiffness: *k}\n";
    let flow = "springs: [{particle_ids: [0, 1], stiffness: 20}, {particle_ids: [0, 1], stiffness: \
                20}, {particle_ids: [0, 1], stiffness: 20}]";
    let expected = accepted(flow);
    let variants = [
        block.to_owned(),
        block.replace('\n', "\r\n"),
        format!("\u{feff}{block}"),
        format!("---\n{block}"),
        format!("\u{feff}---\n{block}"),
        format!("%YAML 1.1\n---\n{block}"),
    ];
    for text in variants {
        assert_eq!(accepted(&text), expected, "{text}");
    }
    assert_eq!(
        parse(&format!("{}\n...\n", complete(flow))).unwrap(),
        expected
    );
}

#[test]
fn brackets_in_prose_are_no_nesting() {
    let prose = "half-open: [0, 1) don't {";
    let many = |line: &str| format!("{line}\n").repeat(20);
    accepted(&many(&format!("# {prose}")));
    accepted(&format!("description: \"{}\"", many(prose)));
    accepted(&format!("description: |\n{}", many(&format!("  {prose}"))));
    accepted(&format!("description: it isn't {} \"", "[ { ".repeat(100)));
}

#[test]
fn a_key_without_a_value_is_as_good_as_absent() {
    let scene = accepted("springs:\ngravitational: ~\nwind:\nduration:\nname: null");
    assert_eq!((scene.springs.len(), scene.duration), (0, 5.0));
    assert!(scene.wind.is_none());
}

#[test]
fn expectations_are_read_in_order() {
    let scene = accepted(
        "expect:\n  all: {status: [completed, diverged], reason: {contains: particle 1}}\n  \
         rapier-forces: {energy.drift_per_s: {above: -1, below: 2e-3}}\n  rest:\n    \
         identified.decisive: true\n    deviation_m.rapier.max: {below: 1}\n  rk4: \
         {identified.method: rk4}",
    );
    let one = |scope, key: &str, wanted| Expectation {
        scope,
        key: key.to_owned(),
        wanted,
    };
    let words = |words: &[&str]| Wanted::Words(words.iter().map(|w| (*w).to_owned()).collect());
    let engine = |id: &str| Scope::Engine(id.to_owned());
    let bounds = |above, below| Wanted::Bounds { above, below };
    let expected = [
        one(Scope::All, "status", words(&["completed", "diverged"])),
        one(Scope::All, "reason", Wanted::Contains("particle 1".into())),
        one(
            engine("rapier-forces"),
            "energy.drift_per_s",
            bounds(Some(-1.0), Some(2e-3)),
        ),
        one(Scope::Rest, "identified.decisive", words(&["true"])),
        one(
            Scope::Rest,
            "deviation_m.rapier.max",
            bounds(None, Some(1.0)),
        ),
        one(engine("rk4"), "identified.method", words(&["rk4"])),
    ];
    assert_eq!(scene.expect, expected);
    for nothing in ["expect:", "expect: {}", ""] {
        assert!(accepted(nothing).expect.is_empty());
    }
}

#[test]
fn an_own_line_goes_before_rest_and_both_before_all() {
    let scene = accepted(
        "expect:\n  all: {status: completed, energy.class: bounded}\n  rk4: {status: diverged}\n  \
         rest: {energy.class: growing}\n  rapier: {status: failed}",
    );
    let of = |engine: &str, integrator| -> Vec<String> {
        let expected = scene.expected_of(engine, integrator);
        let said = expected.iter().map(|e| format!("{} {}", e.key, e.wanted));
        said.collect()
    };
    assert_eq!(of("rk4", true), ["status diverged", "energy.class bounded"]);
    assert_eq!(
        of("midpoint", true),
        ["energy.class growing", "status completed"]
    );
    // `all` and `rest` are integrators, never reference engines.
    assert_eq!(of("rapier", false), ["status failed"]);
    assert!(of("rapier-forces", false).is_empty());
}

#[test]
fn tiny_wind_directions_keep_their_direction() {
    let wind = accepted("wind: {direction: [3e-200, 0, 4e-200], strength: 1}")
        .wind
        .unwrap();
    // Two roundings of numbers of order one.
    assert!((wind.direction[0] - 0.6).abs() < 1e-15 && (wind.direction[2] - 0.8).abs() < 1e-15);
}

/// A short id means its row everywhere in a file, and a row is named once.
#[test]
fn short_ids_mean_their_rows() {
    for (short, id) in springcheck::integrators::ALIASES {
        let yaml = |more: &str| {
            format!(
                "solver: {{type: {short}, timestep: 0.01}}\n\
                 particles: [{{pos: [0, 0, 0], mass: 1}}]\n\
                 expect:\n  {short}: {{identified.method: {short}}}\n{more}"
            )
        };
        let read = |more: &str| scene::parse(yaml(more).as_bytes(), "x.yml", verbs::names());
        let scene = read("").unwrap();
        assert_eq!(scene.solver.method, *id);
        let expected = scene.expected_of(id, true);
        assert_eq!(expected.len(), 1);
        assert_eq!(expected[0].wanted, Wanted::Words(vec![(*id).to_owned()]));
        let twice = read(&format!("  {id}: {{status: completed}}\n")).unwrap_err();
        assert!(twice.to_string().contains("given twice"), "{twice}");
        // Nobody else has the short name.
        assert!(
            springcheck::integrators::REGISTRY
                .iter()
                .all(|row| row.id != *short)
        );
    }
}

#[test]
fn shipped_scenes_load() {
    let scenes: Vec<Scene> = shipped()
        .iter()
        .map(|(path, _)| {
            scene::read(path, verbs::names()).unwrap_or_else(|error| panic!("{error}"))
        })
        .collect();
    // The hard ones and those of effects, objects and constraints are counted by no one: there will be more.
    let open = [
        "/hard/",
        "/effects/",
        "/string/",
        "/hair/",
        "/cloth/",
        "/rods/",
        "/strain/",
        "/contact/",
    ];
    let open = |s: &&Scene| open.iter().any(|of| s.file.contains(of));
    assert_eq!(scenes.len() - scenes.iter().filter(open).count(), 21);
    for scene in &scenes {
        assert!(scene.description.is_some() && !scene.name.is_empty());
        assert!(scene.file.ends_with(".yml"));
    }
    let sheet = scenes
        .iter()
        .find(|s| s.file.ends_with("scene06.yml"))
        .unwrap();
    assert_eq!(
        (sheet.particles.len(), sheet.springs.len(), sheet.duration),
        (200, 370, 1.0)
    );
    assert_eq!(sheet.particles.iter().filter(|p| p.fixed).count(), 20);
    // Neighbours everywhere: no spring is longer than the spacing.
    assert!(
        sheet
            .springs
            .iter()
            .all(|s| (s.rest_length - 0.005).abs() < 1e-15)
    );
    assert!(
        scenes
            .iter()
            .all(|s| !s.file.contains("oscillator") || s.solver.gravity == 0.0)
    );
}
