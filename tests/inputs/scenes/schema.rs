//! The schema of scene files, held against the reader: both follow from the table. Whether a value fits a schema is what
//! another program says, `jsonschema`.

use super::shipped;
use jsonschema::Validator;
use serde_json::{Value, json};
use springcheck::scene::limits::Bounds;
use springcheck::scene::model::{Absent, PARTS, Part, Row, ValueKind};
use springcheck::scene::{self, Scene};
use springcheck::verbs::{names, schema};

fn schema() -> Value {
    serde_json::from_str(&schema::scene_text()).expect("JSON")
}

fn validator() -> Validator {
    let schema = schema();
    jsonschema::draft7::meta::validate(&schema).expect("a schema");
    jsonschema::draft7::new(&schema).expect("a schema")
}

/// The scene of a JSON value, which is YAML too where its text is ASCII: YAML ends a line at more characters.
pub fn read(value: &Value) -> Result<Scene, scene::SceneError> {
    let mut text = String::new();
    for c in value.to_string().chars() {
        match c {
            c if c.is_ascii() => text.push(c),
            c => text += &format!("\\u{:04x}", u32::from(c)),
        }
    }
    scene::parse(text.as_bytes(), "test.yml", names())
}

/// A scene with a member of every part, and with text and expectations.
pub fn full() -> Value {
    json!({
        "name": "all",
        "solver": {"type": "rk4", "timestep": 0.1},
        "particles": [
            {"pos": [0, 0, 0], "mass": 1},
            {"pos": [1, 0, 0], "mass": 2, "fixed": true},
            {"pos": [0, 1, 0], "mass": 3},
            {"pos": [0, 2, 0], "mass": 3},
        ],
        "driven": [{"particle_id": 1, "sine": {"amplitude": [0.1, 0, 0], "omega": 5}}],
        "springs": [{"particle_ids": [0, 1], "stiffness": 20}],
        "strain_limit": {},
        "rods": [{"particle_ids": [2, 3]}],
        "constraints": {},
        "triangles": [{"particle_ids": [0, 1, 2], "air_drag": 1}],
        "air": {},
        "bending": [{"particle_ids": [0, 1, 2], "stiffness": 1}],
        "gravitational": [{"particle_ids": [0, 1], "G": 1}],
        "wind": {"direction": [1, 0, 0], "strength": 1},
        "magnetic": {"field": [0, 0, 1]},
        "plot": {"particle_id": 0, "dof": 2},
        "externals": ["mine"],
        "expect": {"mine": {"status": "completed"}},
    })
}

/// The mapping of a part in a scene.
fn member<'s>(scene: &'s mut Value, part: &Part) -> &'s mut Value {
    match part.key {
        "file" => scene,
        key if part.list => &mut scene[key][0],
        key => match part.inside() {
            Some((list, key)) => &mut scene[list][0][key],
            None => &mut scene[key],
        },
    }
}

/// The schema's properties of a part.
fn properties<'s>(schema: &'s Value, part: &Part) -> &'s Value {
    match part.key {
        "file" => &schema["properties"],
        key if part.list => &schema["properties"][key]["items"]["properties"],
        key => match part.inside() {
            Some((list, key)) => {
                &schema["properties"][list]["items"]["properties"][key]["properties"]
            }
            None => &schema["properties"][key]["properties"],
        },
    }
}

/// The keys of which a member has exactly one, which no schema says.
const ONE_OF: [&str; 3] = ["driven.sine", "driven.velocity", "driven.table"];

/// All parts but those of obstacles, of which each has one shape, and of contact: they have cases of their own.
fn parts() -> impl Iterator<Item = &'static Part> {
    PARTS
        .into_iter()
        .filter(|part| !part.key.starts_with("colliders") && !part.key.starts_with("contact"))
}

fn all_rows() -> impl Iterator<Item = (&'static Part, &'static Row)> {
    let rows = |part: &'static Part| part.rows.iter().map(move |row| (part, row));
    parts().flat_map(rows)
}

/// Values inside and outside of what a key takes. Those inside differ from one another where several values have to
/// fit together: lists of numbers ascend, ids are 0 and 1.
fn inside_and_outside(row: &Row) -> (Vec<Value>, Vec<Value>) {
    let beyond = |Bounds { low, high, .. }: &Bounds| {
        // A tenth more is outside, whatever the rounding.
        let below = if *low == 0.0 {
            -1e-300
        } else {
            low - 0.1 * low.abs()
        };
        vec![json!(below), json!(high * 1.1)]
    };
    let (mut inside, mut outside) = match &row.kind {
        ValueKind::Number(bounds) => {
            let times = ["timestep", "duration"].contains(&row.key);
            let least = if times { 0.5 } else { bounds.low };
            let most = if times { 5.0 } else { bounds.high };
            (vec![json!(least), json!(most)], beyond(bounds))
        }
        ValueKind::Numbers(count, bounds) => {
            let of = |x: &Value| json!(vec![x.clone(); *count]);
            let ascending: Vec<f64> = (0..*count)
                .map(|i| bounds.high * (i + 1) as f64 / *count as f64)
                .collect();
            let mut outside: Vec<Value> = beyond(bounds).iter().map(of).collect();
            outside.push(json!(vec![1.0; count + 1]));
            outside.push(json!(vec![1.0; count - 1]));
            (vec![json!(ascending)], outside)
        }
        ValueKind::Table(width, least, bounds) => {
            let row = |x: f64| vec![x; *width];
            // Ascending.
            let table = |rows: usize, x: f64| -> Value {
                let parts = (1..=rows).map(|i| row(x * i as f64 / rows as f64));
                json!(parts.collect::<Vec<_>>())
            };
            let mut outside = vec![
                table(least - 1, 1.0),
                json!(row(0.0)),
                json!([[0.0], [0.5], [1.0]]),
            ];
            outside.push(table(*least, 1.1 * bounds.high));
            (vec![table(*least, bounds.high)], outside)
        }
        ValueKind::Vectors(Bounds { high, .. }) => (
            vec![
                json!([0, 0, high]),
                json!([[0, 0, 1]]),
                json!([[0, 0, 1], [1, 2, 3]]),
            ],
            vec![
                json!([0, 0]),
                json!([0, 0, 0, 0]),
                json!([]),
                json!([0, 0, [1, 2, 3]]),
                json!([[0, 0]]),
                json!([[0, 0, 1.1 * high]]),
            ],
        ),
        ValueKind::Id => (vec![json!(0), json!(1)], vec![json!(-1), json!(0.5)]),
        ValueKind::Ids(count) => {
            let ids = |first: i32| json!((first..first + *count as i32).collect::<Vec<_>>());
            (vec![ids(0)], vec![json!([0]), json!([0, 1, 2, 3]), ids(-1)])
        }
        ValueKind::Coordinate => (vec![json!(0), json!(2)], vec![json!(3), json!(-1)]),
        ValueKind::Count(Bounds { low, high, .. }) => (
            vec![json!(*low as u64), json!(*high as u64)],
            vec![json!(0), json!(1.5), json!("3"), json!(2.0 * high)],
        ),
        ValueKind::Flag => (vec![json!(false)], vec![json!(0), json!("true")]),
        ValueKind::Word(words) => (
            words.iter().map(|word| json!(word)).collect(),
            vec![json!("other"), json!(1)],
        ),
        ValueKind::Method => {
            let known = names().methods.iter().map(|id| json!(id));
            let aliases = names().aliases.iter().map(|(short, _)| json!(short));
            (known.chain(aliases).collect(), vec![json!("rk5"), json!(4)])
        }
        ValueKind::Text(_) => (
            vec![json!("a"), json!("é".repeat(200)), json!("a b")],
            vec![json!("a\u{1b}b"), json!("a\u{85}b"), json!(1)],
        ),
        ValueKind::Names(_) => (
            vec![
                json!(["mine"]),
                json!(["mine", "é2", "1.0-a+b_c", "x".repeat(32)]),
            ],
            vec![
                json!([""]),
                json!(["-a"]),
                json!(["a b"]),
                json!(["x".repeat(33)]),
                json!("a"),
                json!(["a", "a"]),
            ],
        ),
        // A list that is required is not empty.
        ValueKind::Part(part) if part.list && matches!(row.absent, Absent::Required(_)) => {
            (vec![], vec![json!([])])
        }
        ValueKind::Part(_) if matches!(row.absent, Absent::Unless(..)) => (vec![], vec![]),
        ValueKind::Part(part) if part.list => (vec![json!([])], vec![]),
        ValueKind::Objects => {
            let string = json!({"from": [0, 0, 0], "to": [1, 0, 0], "particles": 3, "mass": 1, "stiffness": 3});
            let mut pinned = string.clone();
            pinned["pins"] = json!(["start", 1, [2]]);
            let mut misspelt = string.clone();
            misspelt["stifness"] = json!(3);
            (
                vec![
                    json!([]),
                    json!([{"string": string}]),
                    json!([{"chain": pinned}]),
                ],
                vec![
                    json!(3),
                    json!([{}]),
                    json!([{"rope": string}]),
                    json!([{"string": misspelt}]),
                    json!([{"string": string, "chain": string}]),
                ],
            )
        }
        ValueKind::Part(_) | ValueKind::Expect => (vec![], vec![]),
    };
    outside.push(json!("text that is nothing here".to_owned() + "\u{7}"));
    outside.push(json!({"unknown": 1}));
    // A key without a value is as good as absent. Whether a particle needs its mass, other keys say.
    match row.absent {
        _ if row.key == "mass" => {}
        Absent::Required(_) | Absent::Unless(..) => outside.push(Value::Null),
        Absent::Usual | Absent::Derived => inside.push(Value::Null),
    }
    (inside, outside)
}

#[test]
fn the_schema_takes_every_shipped_scene() {
    let validator = validator();
    for (path, bytes) in shipped() {
        let scene: Value = serde_yaml::from_slice(&bytes).expect("YAML");
        let errors: Vec<String> = validator
            .iter_errors(&scene)
            .map(|e| e.to_string())
            .collect();
        assert!(errors.is_empty(), "{}: {errors:?}", path.display());
    }
}

#[test]
fn the_schema_and_the_reader_agree_on_every_key() {
    let validator = validator();
    let agree = |scene: &Value, good: bool, title: &str| {
        let read = read(scene).map(|_| ());
        assert_eq!(read.is_ok(), good, "{title}: {read:?}");
        assert_eq!(validator.is_valid(scene), good, "{title}: the schema");
    };
    agree(&full(), true, "all");
    // Rods and limits have to be there for what says how they are kept.
    let leave_idle = |scene: &mut Value| {
        for (members, way) in [("rods", "constraints"), ("springs", "strain_limit")] {
            let none = scene[members].as_array().is_none_or(Vec::is_empty);
            if none || scene[members][0]["rest_length"] == json!(0.0) {
                scene[way] = Value::Null;
            }
        }
    };
    for (part, row) in all_rows() {
        let (mut inside, outside) = inside_and_outside(row);
        // A rod has the length of its start.
        if part.path(None, row.key) == "rods.length" {
            inside = vec![json!(1)];
        }
        let with = |value: &Value| {
            let mut scene = full();
            let own = member(&mut scene, part);
            own[row.key] = value.clone();
            let path = part.path(None, row.key);
            if ONE_OF.contains(&path.as_str()) && row.key != "sine" && !value.is_null() {
                own["sine"] = Value::Null;
            }
            if path == "constraints.rate" {
                own["stabilisation"] = json!("baumgarte");
            }
            leave_idle(&mut scene);
            // What is driven sets out along a rod to it.
            if path == "rods.particle_ids" {
                scene["driven"] = json!([]);
            }
            // What is driven is fixed, and something is not.
            if path == "driven.particle_id" && *value == json!(0) {
                for (at, fixed) in [true, false].into_iter().enumerate() {
                    scene["particles"][at]["fixed"] = json!(fixed);
                }
            }
            // The timestep has to fit the duration.
            if row.key == "duration" {
                scene["solver"]["timestep"] = json!(0.5);
            }
            scene
        };
        let path = part.path(None, row.key);
        for (values, good) in [(inside, true), (outside, false)] {
            for value in values {
                if path == "driven.sine" && value.is_null() {
                    continue;
                }
                // Without its `externals`, the file may not speak of `mine`.
                let mut scene = with(&value);
                if row.key == "externals" {
                    scene["expect"] = Value::Null;
                }
                agree(&scene, good, &format!("{path}: {value}"));
            }
        }
        let mut without = full();
        let members = member(&mut without, part)
            .as_object_mut()
            .expect("a mapping");
        members.remove(row.key);
        if row.key == "externals" {
            members.remove("expect");
        }
        leave_idle(&mut without);
        // Particles that attract each other need their mass: two keys, which no schema holds together.
        if path != "particles.mass" && path != "driven.sine" {
            let optional = !matches!(row.absent, Absent::Required(_) | Absent::Unless(..));
            agree(&without, optional, &format!("without {path}"));
        }
    }
    for part in parts() {
        for key in ["unknown", "Mass", "bending", "velocity"] {
            let mut scene = full();
            member(&mut scene, part)[key] = json!(1);
            agree(&scene, false, &format!("{}: {key}", part.key));
        }
    }
}

#[test]
fn the_schema_and_the_reader_agree_on_expectations() {
    let validator = validator();
    for (expect, good) in [
        (json!({"rk4": {"status": "completed"}}), true),
        (
            json!({"all": {"energy.class": ["bounded", "drifting"]}}),
            true,
        ),
        (
            json!({"rest": {"position_error_m.max": {"below": 0.01}}}),
            true,
        ),
        (
            json!({"rapier": {"deviation_m.rapier-forces.max": {"above": 0, "below": 1}}}),
            true,
        ),
        (json!({"mine": {"reason": {"contains": "exit code"}}}), true),
        (json!({"mine": {"identified.decisive": true}}), true),
        (
            json!({"linearized_implicit": {"identified.method": "linearized_implicit"}}),
            true,
        ),
        (json!({"skip": {"order": "forces jump here"}}), true),
        (json!({"skip": {"order": ""}}), false),
        (json!({"skip": {"ordre": "why"}}), false),
        (json!({"rk4": {}}), false),
        (json!({"rk4": null}), false),
        (json!({"rk4": {"status": "complete"}}), false),
        (json!({"rk4": {"status": []}}), false),
        (json!({"rk4": {"status": {"below": 1}}}), false),
        (json!({"rk4": {"stratus": "completed"}}), false),
        (json!({"rk4": {"position_error_m.max": 0.01}}), false),
        (json!({"rk4": {"position_error_m.max": {}}}), false),
        (
            json!({"rk4": {"position_error_m.max": {"contains": "1"}}}),
            false,
        ),
        (json!({"rk4": {"reason": "exit"}}), false),
        (json!({"rk4": {"work.wall_s": {"below": 1}}}), false),
        (json!({"a b": {"status": "completed"}}), false),
        (json!([{"rk4": {"status": "completed"}}]), false),
    ] {
        let mut scene = full();
        scene["expect"] = expect.clone();
        let read = read(&scene).map(|_| ());
        assert_eq!(read.is_ok(), good, "{expect}: {read:?}");
        assert_eq!(validator.is_valid(&scene), good, "{expect}: the schema");
    }
    // Every key that an outcome has for expectations.
    for key in &names().keys {
        for wanted in [
            json!("completed"),
            json!({"below": 1.5}),
            json!({"contains": "a"}),
        ] {
            let mut scene = full();
            scene["expect"] = json!({"rk4": {key.path.as_str(): wanted}});
            assert_eq!(
                validator.is_valid(&scene),
                read(&scene).is_ok(),
                "{}: {wanted}",
                key.path
            );
        }
    }
}

/// A description is what an editor shows: every key has one, and a number's has its unit.
#[test]
fn every_key_says_what_it_is() {
    let schema = schema();
    for (part, row) in all_rows() {
        let properties = properties(&schema, part);
        let says = properties[row.key]["description"]
            .as_str()
            .unwrap_or_default();
        let path = part.path(None, row.key);
        // A key of two rows says both.
        let at = says.find(row.summary.trim());
        let second = matches!(row.kind, ValueKind::Vectors(_));
        assert!(
            at.is_some_and(|at| second || at == 0) && says.len() > 5,
            "{path}: {says}"
        );
        if let ValueKind::Number(bounds)
        | ValueKind::Numbers(_, bounds)
        | ValueKind::Table(.., bounds)
        | ValueKind::Vectors(bounds) = &row.kind
        {
            assert!(
                says.ends_with(&format!("({}).", bounds.unit)),
                "{path}: {says}"
            );
        }
    }
}

/// What an absent key means, a schema's `default` says: written into a file, it changes nothing.
#[test]
fn defaults_are_those_of_the_reader() {
    let schema = schema();
    let original = read(&full()).expect("a scene");
    let mut some = 0;
    for (part, row) in all_rows() {
        let properties = properties(&schema, part);
        let second = matches!(row.kind, ValueKind::Vectors(_));
        if let Some(default) = properties[row.key].get("default").filter(|_| !second) {
            let mut scene = full();
            assert!(
                member(&mut scene, part)[row.key].is_null(),
                "the key is absent"
            );
            member(&mut scene, part)[row.key] = default.clone();
            assert_eq!(read(&scene).expect("a scene"), original, "{}", row.key);
            some += 1;
        }
    }
    // duration, up, damping_model; gravity; vel, fixed, radius, drag, quadratic_drag, charge; cubic, damping;
    // rest_angle, damping; velocity, density; phase; stabilisation, rate; ratio, iterations, also_compression.
    assert_eq!(some, 22);
}
