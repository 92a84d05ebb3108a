//! The schema of reports against what the verbs print.

use crate::testkit::program::{output, word};
use jsonschema::Validator;
use serde_json::{Value, json};

fn schema() -> Value {
    let (code, out, err) = output(&["schema", "report"]);
    assert_eq!(code, 0, "{err}");
    serde_json::from_str(&out).expect("JSON")
}

fn validator(schema: &Value) -> Validator {
    jsonschema::draft7::meta::validate(schema).expect("a schema");
    jsonschema::draft7::new(schema).expect("a schema")
}

/// The schema without the freedom of later versions: a key that it does not know is refused. Reports themselves are
/// their header and one of several bodies, so theirs stay open.
fn closed(mut schema: Value) -> Value {
    let definitions = schema["definitions"].as_object_mut().expect("definitions");
    for (name, definition) in definitions {
        if definition.get("properties").is_some() && name != "Report" {
            definition["additionalProperties"] = false.into();
        }
    }
    schema["additionalProperties"] = false.into();
    schema
}

/// What each verb says of a small scene.
fn documents() -> Vec<(&'static str, Value)> {
    let folder = tempfile::tempdir().expect("a folder");
    let scene = folder.path().join("scene.yml");
    let yaml = "solver: {type: symplectic_euler, timestep: 0.05, gravity: 0}\nduration: 2\n\
                particles:\n- {pos: [0, 0, 0], fixed: true}\n- {pos: [0.5, 0, 0], mass: 1}\n\
                springs: [{particle_ids: [0, 1], stiffness: 20, rest_length: 0, damping: 0.1}]\n\
                expect: {rk4: {status: diverged}}\n";
    std::fs::write(&scene, yaml).expect("written");
    let scene = word(&scene).to_owned();
    let pair = folder.path().join("pair.yml");
    let yaml = "solver: {type: explicit_euler, timestep: 0.05, gravity: 0}\nduration: 1\n\
                particles: [{pos: [0, 0, 0], mass: 1}, {pos: [1.5, 0, 0], mass: 1}]\n\
                springs: [{particle_ids: [0, 1], stiffness: 20, rest_length: 1}]\n";
    std::fs::write(&pair, yaml).expect("written");
    // A trajectory that stands still: no scheme's.
    let rows: String = (0..=40)
        .map(|n| format!("{},0.5,0,0,0,0,0\n", f64::from(n) * 0.05))
        .collect();
    let still = folder.path().join("still.csv");
    std::fs::write(&still, format!("t,x,y,z,vx,vy,vz\n{rows}")).expect("written");
    let calls: [(&str, Vec<&str>); 6] = [
        (
            "run",
            vec![
                &scene,
                "--integrators",
                "rk4,explicit_euler",
                "--timestep",
                "0.05,0.025",
            ],
        ),
        ("compare", vec![word(&still), "--scene", &scene]),
        ("check", vec![&scene]),
        (
            "rest",
            vec!["scenes/string/hanging.yml", "--refine", "1,2,4"],
        ),
        (
            "stability",
            vec![
                word(&pair),
                "--integrators",
                "explicit_euler,rk4",
                "--vary",
                "springs.stiffness=1..10:2",
                "--steps",
                "0.01..1:2",
                "--largest",
                "springs.stiffness",
                "--admissible",
                "20",
            ],
        ),
        (
            "cost",
            vec![
                &scene,
                "--integrators",
                "rk4",
                "--steps",
                "3",
                "--budget",
                "100ms",
            ],
        ),
    ];
    calls
        .into_iter()
        .map(|(verb, args)| {
            let (_, out, err) = output(&[&[verb][..], &args, &["--format", "json"]].concat());
            let document = serde_json::from_str(&out);
            (verb, document.unwrap_or_else(|_| panic!("{verb}: {err}")))
        })
        .collect()
}

/// The paths of all values below one.
fn paths(value: &Value, path: &str, found: &mut Vec<String>) {
    let mut below = |key: &str, value: &Value| {
        let path = format!("{path}/{}", key.replace('~', "~0").replace('/', "~1"));
        found.push(path.clone());
        paths(value, &path, found);
    };
    match value {
        Value::Object(object) => object.iter().for_each(|(key, value)| below(key, value)),
        // A list's first two members stand for all.
        Value::Array(list) => {
            let members = list.iter().take(2).enumerate();
            members.for_each(|(at, value)| below(&at.to_string(), value));
        }
        _ => {}
    }
}

#[test]
fn every_verb_s_report_is_valid_and_no_damaged_one_is() {
    let schema = schema();
    let (open, closed) = (validator(&schema), validator(&closed(schema.clone())));
    for (verb, document) in documents() {
        for validator in [&open, &closed] {
            let errors: Vec<String> = validator
                .iter_errors(&document)
                .map(|e| e.to_string())
                .collect();
            assert!(errors.is_empty(), "{verb}: {errors:?}");
        }
        let mut later = document.clone();
        later["reports"][0]["scene"]["later"] = json!(1);
        assert!(open.is_valid(&later), "keys of later versions are allowed");
        let mut all = Vec::new();
        paths(&document, "", &mut all);
        assert!(all.len() > 60, "{verb}: {}", all.len());
        for path in all {
            let mut wrong = document.clone();
            *wrong.pointer_mut(&path).expect("a value") = json!({"wrong": "text"});
            assert!(!open.is_valid(&wrong), "{verb}: {path} is something else");
            let (above, key) = path.rsplit_once('/').expect("a path");
            let mut less = document.clone();
            let Some(Value::Object(mapping)) = less.pointer_mut(above) else {
                continue;
            };
            mapping.remove(key);
            // Engines and effects are as many as there are; of a check, these are absent where there is nothing to say; what
            // pulls is a spring or a rod.
            let free = ["/deviation_m", "/potential_final_j", "/potential_j"]
                .iter()
                .any(|map| above.ends_with(map));
            let absent = ["first_s", "cause", "key", "objects", "spring", "rod"].contains(&key);
            assert_eq!(
                open.is_valid(&less),
                free || absent,
                "{verb}: without {path}"
            );
        }
    }
}

#[test]
fn every_key_of_a_report_is_described() {
    fn look(schema: &Value, path: &str) {
        let Some(object) = schema.as_object() else {
            return;
        };
        if let Some(properties) = object.get("properties").and_then(Value::as_object) {
            for (key, property) in properties {
                let says = property["description"].as_str().unwrap_or_default();
                // The verb says itself which body it is.
                let named = key == "verb" && property.get("const").is_some();
                assert!(
                    named || says.ends_with('.') || says.ends_with('`'),
                    "{path}.{key}: {says}"
                );
                // Links of the source lead nowhere here.
                assert!(
                    !says.contains("](") && !says.contains("[`"),
                    "{path}.{key}: {says}"
                );
            }
        }
        for (key, below) in object {
            look(below, &format!("{path}.{key}"));
        }
    }
    look(&schema(), "report");
}
