//! The table of parameters: every row is read within its bounds and refused beyond them, and what a row
//! says reaches the truth's key, the flat arrays and `--vary`.

use super::{NAMES, parse};
use crate::testkit::all_effects;
use springcheck::physics::ParticleSystem;
use springcheck::scene::model::{self, Absent, PARTS, Part, Row, SCENE, ValueKind};
use springcheck::scene::{
    Collider, Constraints, Contact, DampingModel, Driven, Plot, Rod, Scene, Sine, StrainLimit,
    Table, Value,
};
use springcheck::solvers::external::{Flat, Task};
use springcheck::truth::converged::key;
use springcheck::verbs::stability::Vary;

/// Each row that holds values itself, with its part.
fn rows() -> impl Iterator<Item = (&'static Part, &'static Row)> {
    let of = |part: &'static Part| part.rows.iter().map(move |row| (part, row));
    let holds = |(_, row): &(_, &Row)| {
        !matches!(
            row.kind,
            ValueKind::Part(_) | ValueKind::Expect | ValueKind::Objects
        )
    };
    PARTS.into_iter().flat_map(of).filter(holds)
}

fn components(row: &Row) -> usize {
    match row.kind {
        ValueKind::Numbers(count, _) => count,
        ValueKind::Table(width, ..) => width,
        ValueKind::Ids(count) => count,
        ValueKind::Vectors(_) => 3,
        _ => 1,
    }
}

/// A scene with a member of every part.
fn full() -> Scene {
    let mut scene = all_effects(DampingModel::Axial);
    scene.plot = Some(Plot::default());
    // No file may have all three.
    scene.driven.push(Driven {
        sine: Some(Sine::default()),
        velocity: Some([0.0; 3]),
        table: Some(Table(vec![[0.0; 4], [1.0; 4]])),
        ..Driven::default()
    });
    // No obstacle may have two shapes.
    let corners = Table(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
    scene.colliders.push(Collider {
        plane: Some(model::Plane::default()),
        ball: Some(model::Ball::default()),
        block: Some(model::Block::default()),
        capsule: Some(model::Capsule::default()),
        mesh: Some(model::Mesh {
            vertices: corners,
            triangles: Table(vec![[0.0, 1.0, 2.0]]),
        }),
        driven: Some(model::Motion {
            sine: Some(Sine::default()),
            velocity: Some([0.0; 3]),
            table: Some(Table(vec![[0.0; 4], [1.0; 4]])),
        }),
        ..Collider::default()
    });
    scene.contact = Some(Contact {
        penalty: Some(model::Penalty::default()),
        ..Contact::default()
    });
    scene.rods.push(Rod::default());
    scene.strain_limit = Some(StrainLimit::default());
    scene.constraints = Some(Constraints::default());
    for part in PARTS {
        assert!((part.count)(&scene) > 0, "{}: no member", part.key);
    }
    scene
}

/// Obstacles and contact have cases of their own.
fn apart(part: &Part) -> bool {
    ["colliders", "contact"]
        .iter()
        .any(|key| part.key.starts_with(key))
}

fn flat(scene: &Scene) -> serde_json::Value {
    // The effects in force are those of the unchanged scene: what differs is the row's own.
    let system = ParticleSystem::new(&full());
    let task = Task {
        scene,
        system: &system,
        timestep: 0.1,
        steps: 1,
    };
    let mut flat = serde_json::to_value(Flat(&task)).unwrap();
    // Not of the table: the run's own.
    flat["duration"] = 0.into();
    flat
}

/// The keys under which two flat scenes differ, those of a mapping as `springs.stiffness`.
fn differences(a: &serde_json::Value, b: &serde_json::Value) -> Vec<String> {
    let mut found = Vec::new();
    for (key, value) in a.as_object().unwrap() {
        match value.as_object() {
            Some(_) => {
                let below = differences(value, &b[key]);
                found.extend(below.into_iter().map(|below| format!("{key}.{below}")));
            }
            None if *value != b[key] => found.push(key.clone()),
            None => {}
        }
    }
    found
}

#[test]
fn every_part_of_the_file_is_in_the_table() {
    let all = || PARTS.into_iter().flat_map(|part| part.rows);
    let below = |part: &&Part| {
        let is = |row: &&Row| matches!(row.kind, ValueKind::Part(of) if of.key == part.key);
        all().filter(is).count()
    };
    for part in PARTS.iter().filter(|part| part.key != SCENE.key) {
        assert_eq!(below(part), 1, "{}", part.key);
    }
    let parts = all().filter(|row| matches!(row.kind, ValueKind::Part(_)));
    assert_eq!(parts.count(), PARTS.len() - 1);
}

#[test]
fn a_change_is_seen_by_whatever_depends_on_it() {
    let original = full();
    for (part, row) in rows() {
        for component in 0..components(row) {
            let at = (part.count)(&original) - 1;
            let title = part.path(Some(at), row.key);
            let before = (row.get)(&original, at, component);
            let changed = match (before, &row.kind) {
                (Some(Value::Number(x)), _) => Value::Number(0.5 * x + 0.25),
                (Some(Value::Id(id)), _) => Value::Id(id + 1),
                (Some(Value::Flag(flag)), _) => Value::Flag(!flag),
                (Some(Value::Text(_)), ValueKind::Word(words)) => Value::Text(words[1]),
                (None, ValueKind::Number(_) | ValueKind::Numbers(..) | ValueKind::Vectors(_)) => {
                    Value::Number(0.25)
                }
                _ => Value::Text("other"),
            };
            let mut scene = original.clone();
            (row.set)(&mut scene, at, component, changed);
            assert_eq!((row.get)(&scene, at, component), Some(changed), "{title}");
            assert_ne!(scene, original, "{title}");

            // Among obstacles radii matter, and programs get them there.
            let radius = (part.key, row.key) == ("particles", "radius");
            let moves = row.flat.is_some() || radius;
            assert_eq!(key(&scene, 5.0) != key(&original, 5.0), moves, "{title}");
            let name = row.flat.map(|name| match part.key {
                "springs" | "rods" | "bending" | "gravitational" | "triangles" => {
                    format!("{}.{name}", part.key)
                }
                "driven" | "driven.sine" => format!("driven.{name}"),
                "colliders.driven.sine" => format!("colliders.driven.{name}"),
                key if apart(part) => format!("{key}.{name}"),
                _ => name.to_owned(),
            });
            // Programs get it though no truth depends on it.
            let limit = (part.key == "strain_limit").then_some(title.clone());
            let names: Vec<String> = if radius {
                vec!["colliders.radii".into(), "contact.radii".into()]
            } else {
                Vec::from_iter(name.or(limit))
            };
            let mut found = differences(&flat(&scene), &flat(&original));
            found.sort_unstable();
            assert_eq!(found, names, "{title}");

            // Nothing else has changed.
            if let Some(before) = before {
                (row.set)(&mut scene, at, component, before);
                assert_eq!(scene, original, "{title}");
            }
        }
    }
}

#[test]
fn every_number_that_moves_something_can_be_varied() {
    let scene = full();
    // Where a number has vectors beside it, the number is what varies.
    for (part, row) in rows().filter(|(_, row)| !matches!(row.kind, ValueKind::Vectors(_))) {
        let id = part.path(None, row.key);
        let vary = Vary::parse(&format!("{id}=0.25..0.5:2"), &scene);
        // A rod has the length of its start.
        let number =
            matches!(row.kind, ValueKind::Number(_)) && row.flat.is_some() && part.key != "rods";
        assert_eq!(vary.is_ok(), number, "{id}");
        if let Ok(vary) = vary {
            let varied = vary.apply(&scene, 0.5).expect(&id);
            let last = (part.count)(&scene) - 1;
            assert_eq!(
                (row.get)(&varied, last, 0),
                Some(Value::Number(0.5)),
                "{id}"
            );
        }
    }
}

/// The keys a scene has to have, with one member of every part, in the order of [`PARTS`].
const REQUIRED: [(&str, &[(&str, &str)]); 26] = [
    ("springs", &[("particle_ids", "[0, 1]"), ("stiffness", "1")]),
    ("rods", &[("particle_ids", "[0, 1]")]),
    ("constraints", &[]),
    ("strain_limit", &[]),
    (
        "bending",
        &[("particle_ids", "[0, 1, 2]"), ("stiffness", "1")],
    ),
    ("particles", &[("pos", "[1, 0, 0]"), ("mass", "1")]),
    (
        "triangles",
        &[("particle_ids", "[0, 1, 2]"), ("air_drag", "1")],
    ),
    ("gravitational", &[("particle_ids", "[0, 1]"), ("G", "1")]),
    ("driven", &[("particle_id", "0")]),
    (
        "driven.sine",
        &[("amplitude", "[0.1, 0, 0]"), ("omega", "5")],
    ),
    // What an obstacle has depends on its shape: see the tests of colliders.
    ("colliders", &[]),
    ("colliders.plane", &[]),
    ("colliders.ball", &[]),
    ("colliders.box", &[]),
    ("colliders.capsule", &[]),
    ("colliders.mesh", &[]),
    ("colliders.driven", &[]),
    ("colliders.driven.sine", &[]),
    // Nor is there contact without what collides.
    ("contact", &[]),
    ("contact.penalty", &[]),
    ("wind", &[("direction", "[1, 0, 0]"), ("strength", "1")]),
    ("air", &[]),
    ("magnetic", &[("field", "[0, 0, 1]")]),
    ("solver", &[("type", "midpoint"), ("timestep", "0.01")]),
    ("plot", &[("particle_id", "0"), ("dof", "0")]),
    ("file", &[]),
];

/// That scene; one row has this value.
fn written(changed: Option<(&Part, &Row, &str)>) -> String {
    let mut text = String::new();
    let mut driven = String::new();
    for ((key, required), part) in REQUIRED.iter().zip(PARTS) {
        assert_eq!(
            *key, part.key,
            "the keys of a new part belong into REQUIRED"
        );
        let mut entries: Vec<(&str, &str)> = required.to_vec();
        if let Some((_, row, value)) = changed.filter(|(of, ..)| of.key == *key) {
            entries.retain(|(key, _)| *key != row.key);
            entries.push((row.key, value));
        }
        // Baumgarte's way alone has a rate, and a limit needs springs with a rest length.
        let of = changed.map(|(of, row, _)| (of.key, row.key));
        if *key == "constraints" && of == Some(("constraints", "rate")) {
            entries.push(("stabilisation", "baumgarte"));
        }
        if *key == "strain_limit" && of.is_some_and(|(of, _)| of == "springs") {
            continue;
        }
        let lines = entries.iter().map(|(key, value)| format!("{key}: {value}"));
        let lines: Vec<String> = lines.collect();
        text += &match *key {
            "file" => lines.join("\n"),
            _ if apart(part) => String::new(),
            "particles" => format!(
                "particles: [{{pos: [0, 0, 1], mass: 1, fixed: true}}, {{pos: [0, 1, 0], mass: 1}}, {{{}}}]\n",
                lines.join(", ")
            ),
            // What is driven may set out along it.
            "rods" | "constraints"
                if changed.is_some_and(|(of, ..)| of.key.starts_with("driven")) =>
            {
                String::new()
            }
            "driven" => {
                driven = lines.join(", ");
                continue;
            }
            // Another motion takes the place of the sine.
            "driven.sine" if driven.contains("velocity") || driven.contains("table") => {
                format!("driven: [{{{driven}}}]\n")
            }
            "driven.sine" => format!("driven: [{{{driven}, sine: {{{}}}}}]\n", lines.join(", ")),
            _ if part.list => format!("{key}: [{{{}}}]\n", lines.join(", ")),
            _ => format!("{key}: {{{}}}\n", lines.join(", ")),
        };
    }
    text
}

/// The numbers as one value of the row.
fn yaml(row: &Row, numbers: &[f64]) -> String {
    let list: Vec<String> = numbers.iter().map(|x| format!("{x:e}")).collect();
    let list = list.join(", ").replace("NaN", ".nan");
    match row.kind {
        ValueKind::Numbers(..) => format!("[{list}]"),
        _ => list,
    }
}

#[test]
fn numbers_are_read_at_their_bounds_and_refused_beyond() {
    for (part, row) in rows() {
        let (ValueKind::Number(quantity) | ValueKind::Numbers(_, quantity)) = row.kind else {
            continue;
        };
        // A rod has the length of its start, and an obstacle lets no particle start inside.
        if part.key == "rods" || apart(part) {
            continue;
        }
        let springcheck::scene::limits::Bounds { low, high, unit } = quantity;
        // What a list has besides: y_range must rise, a direction has a length.
        let rest = [low, high, 0.0];
        let count = components(row);
        for value in [low, high] {
            let mut numbers = rest[..count].to_vec();
            if count == 1 {
                numbers[0] = value;
            }
            let value = yaml(row, &numbers);
            let mut text = written(Some((part, row, &value)));
            // One step is as long as the run.
            match row.key {
                "timestep" => text += &format!("\nduration: {value}"),
                "duration" => text = text.replace("0.01", &value),
                _ => {}
            }
            let scene = parse(&text).unwrap_or_else(|e| panic!("{e}"));
            let at = (part.count)(&scene) - 1;
            let read: Vec<_> = row.values(&scene, at).collect();
            let wanted: Vec<_> = numbers.iter().map(|x| Value::Number(*x)).collect();
            // A direction is read as a unit vector.
            assert!(read == wanted || row.key == "direction", "{text}{read:?}");
        }
        // As people write it.
        let most = match high {
            high if high < 1e4 => format!("{}", (high * 1e5).round() / 1e5),
            _ => format!("{high:e}"),
        };
        let mut beyond = vec![(2.0 * high, format!("at most {most} ({unit})"))];
        beyond.push((f64::NAN, format!("a finite number ({unit})")));
        if low < 0.0 {
            beyond.push((2.0 * low, format!("at least {low:e} ({unit})")));
        } else if low == 0.0 {
            beyond.push((-1.0, format!("a number of at least 0 ({unit})")));
        } else {
            beyond.push((0.5 * low, format!("at least {low:e} ({unit})")));
            beyond.push((0.0, format!("a positive number ({unit})")));
        }
        for (value, expected) in beyond {
            let mut numbers = vec![0.5; count];
            numbers[count - 1] = value;
            let text = written(Some((part, row, &yaml(row, &numbers))));
            let error = parse(&text).expect_err(&text);
            // The third particle, else the first member.
            let mut path = part.path(Some(2 * usize::from(part.key == "particles")), row.key);
            if let ValueKind::Numbers(..) = row.kind {
                path += &format!("[{}]", count - 1);
            }
            let said = format!(": {path}: expected {expected}, found ");
            assert!(error.to_string().contains(&said), "{said}\n{error}");
        }
    }
}

#[test]
fn a_key_left_out_means_the_default_or_is_missed() {
    let scene = parse(&written(None)).unwrap_or_else(|e| panic!("{e}"));
    let mut defaults = Scene::default();
    // A member of each part, and then of what is inside of one.
    let all = PARTS.into_iter().rev().flat_map(|part| part.rows);
    for row in all.filter(|row| matches!(row.kind, ValueKind::Part(_))) {
        (row.set)(&mut defaults, 0, 0, Value::Flag(true));
    }
    for (part, row) in rows().filter(|(part, _)| !apart(part)) {
        let at = (part.count)(&scene) - 1;
        let title = part.path(Some(at), row.key);
        match row.absent {
            // The name is the file's.
            Absent::Usual if row.key != "name" => {
                let read: Vec<_> = row.values(&scene, at).collect();
                let default: Vec<_> = row.values(&defaults, 0).collect();
                assert_eq!(read, default, "{title}");
            }
            Absent::Required(help) | Absent::Unless(_, help) => {
                // A key without a value counts as absent.
                let error = parse(&written(Some((part, row, "")))).expect_err(&title);
                assert_eq!(error.refusal.message, "missing", "{title}");
                assert_eq!(error.refusal.help, help, "{title}");
            }
            _ => {}
        }
    }
    assert_eq!(scene.springs[0].rest_length, 2.0_f64.sqrt());
    assert!(
        NAMES
            .methods
            .contains(&Scene::default().solver.method.as_str())
    );
}
