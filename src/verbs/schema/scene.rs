//! The schema of scene files, from the [table](crate::scene::model) of parameters and the [`Names`] that a file may use.
//!
//! It says of one value at a time what reading says. What involves several values (that ids exist, that the
//! timestep fits the duration) only reading checks.

use crate::report::words::short;
use crate::scene::limits::{Bounds, EXPECTED, EXTERNAL, WORD_BYTES};
use crate::scene::model::{Absent, Part, Row, SCENE, ValueKind};
use crate::scene::object::{Object, PARTICLE_NAME};
use crate::scene::{ALL, KeyKind, Names, OutcomeKey, REST, SKIP, Scene, Value};
use serde_json::{Map, Value as Json, json};

/// The whole schema.
pub(super) fn schema(names: &Names) -> Json {
    let mut schema = part(&SCENE, names);
    schema["$schema"] = "http://json-schema.org/draft-07/schema#".into();
    schema["title"] = "A scene of springcheck".into();
    schema["definitions"] = json!({ LINE: line(names) });
    schema
}

/// The definition of what may be expected of one engine.
const LINE: &str = "expectations";

/// One mapping of a part.
fn part(part: &'static Part, names: &Names) -> Json {
    let mut properties: Map<String, Json> = Map::new();
    for row in part.rows {
        let schema = key(part, row, names);
        let schema = match properties.remove(row.key) {
            Some(number) => either(number, schema),
            None => schema,
        };
        properties.insert(row.key.to_owned(), schema);
    }
    let required = part.rows.iter().filter(|row| is_required(row));
    let required: Vec<&str> = required.map(|row| row.key).collect();
    let mut schema = mapping(properties);
    schema["required"] = required.into();
    let unless = part.rows.iter().filter_map(|row| match row.absent {
        Absent::Unless(other, _) => Some((row.key, other)),
        _ => None,
    });
    for (key, other) in unless {
        schema["anyOf"] = json!([{"required": [key]}, {"required": [other]}]);
    }
    schema
}

fn is_required(row: &Row) -> bool {
    matches!(row.absent, Absent::Required(_))
}

/// A mapping with these keys and no others.
fn mapping(properties: Map<String, Json>) -> Json {
    json!({"type": "object", "properties": properties, "additionalProperties": false})
}

/// The value of a key, with what it is and what an absent key means. A key without a value is as good as absent.
fn key(part: &'static Part, row: &'static Row, names: &Names) -> Json {
    let mut schema = value(row, names);
    let mut says = row.summary.trim().to_owned();
    if let ValueKind::Number(bounds)
    | ValueKind::Numbers(_, bounds)
    | ValueKind::Table(.., bounds)
    | ValueKind::Vectors(bounds)
    | ValueKind::Count(bounds) = &row.kind
    {
        let [low, high] = [bounds.low, bounds.high].map(short);
        says += &format!(" From {low} to {high} ({}).", bounds.unit);
    }
    schema["description"] = says.into();
    if let Some(default) = default(part, row) {
        schema["default"] = default;
    }
    if matches!(row.absent, Absent::Usual | Absent::Derived) {
        if let Some(Json::Array(words)) = schema.get_mut("enum") {
            words.push(Json::Null);
        }
        if let Some(kind) = schema.get("type").cloned() {
            schema["type"] = json!([kind, "null"]);
        }
    }
    schema
}

/// Of a key with two rows: what one of them takes.
fn either(mut first: Json, mut second: Json) -> Json {
    let mut take = |key: &str| [&mut first, &mut second].map(|of| of[key].take());
    let ([says, also], [default, _]) = (take("description"), take("default"));
    let says = [says, also].map(|says| says.as_str().unwrap_or_default().to_owned());
    for schema in [&mut first, &mut second] {
        if let Some(schema) = schema.as_object_mut() {
            schema.retain(|_, value| !value.is_null());
        }
    }
    json!({"anyOf": [first, second], "description": says.join(" "), "default": default})
}

/// The value that an absent key stands for, where it is the same in every scene.
fn default(part: &Part, row: &Row) -> Option<Json> {
    let usual = matches!(row.absent, Absent::Usual);
    let text = matches!(row.kind, ValueKind::Text(_));
    let mut scene = Scene::default();
    let mut rows = SCENE.rows;
    let absent = (part.count)(&scene) == 0;
    for key in part.key.split('.').filter(|_| absent) {
        let holder = rows.iter().find(|row| row.key == key)?;
        (holder.set)(&mut scene, 0, 0, Value::Flag(true));
        if let ValueKind::Part(of) = holder.kind {
            rows = of.rows;
        }
    }
    let values: Vec<Value> = row.values(&scene, 0).collect();
    match (&row.kind, &values[..]) {
        _ if !usual || text => None,
        (ValueKind::Numbers(..), [_, ..]) => Some(json!(values)),
        (_, [value]) => Some(json!(value)),
        _ => None,
    }
}

fn value(row: &Row, names: &Names) -> Json {
    match &row.kind {
        ValueKind::Number(bounds) => number(bounds),
        ValueKind::Numbers(count, bounds) => list(number(bounds), *count, *count),
        ValueKind::Table(width, least, bounds) => {
            let row = list(number(bounds), *width, *width);
            json!({"type": "array", "items": row, "minItems": least})
        }
        ValueKind::Vectors(bounds) => {
            let vector = || list(number(bounds), 3, 3);
            let several = json!({"type": "array", "items": vector(), "minItems": 1});
            json!({"anyOf": [vector(), several]})
        }
        ValueKind::Id => id(),
        ValueKind::Ids(count) => list(id(), *count, *count),
        ValueKind::Coordinate => json!({"enum": [0, 1, 2]}),
        ValueKind::Count(bounds) => {
            json!({"type": "integer", "minimum": bounds.low, "maximum": bounds.high})
        }
        ValueKind::Flag => json!({"type": "boolean"}),
        ValueKind::Word(words) => json!({"enum": words}),
        ValueKind::Method => json!({"enum": with_aliases(&names.methods, names)}),
        ValueKind::Text(form) => json!({"type": "string", "pattern": form.pattern}),
        ValueKind::Names(form) => {
            let mut names = list(
                json!({"type": "string", "pattern": form.pattern}),
                0,
                EXPECTED,
            );
            names["uniqueItems"] = true.into();
            names
        }
        ValueKind::Part(of) if of.list => {
            let least = usize::from(is_required(row));
            json!({"type": "array", "items": part(of, names), "minItems": least})
        }
        ValueKind::Part(of) => part(of, names),
        ValueKind::Expect => expect(names),
        ValueKind::Objects => objects(),
    }
}

/// A list of objects.
fn objects() -> Json {
    let settings = schemars::generate::SchemaSettings::draft07();
    let schema = settings.with(|s| s.inline_subschemas = true);
    let mut schema = schema
        .into_generator()
        .into_root_schema_for::<Vec<Object>>();
    schema.remove("$schema");
    schema.remove("title");
    schema.to_value()
}

fn number(Bounds { low, high, .. }: &Bounds) -> Json {
    json!({"type": "number", "minimum": low, "maximum": high})
}

fn id() -> Json {
    json!({"type": ["integer", "string"], "minimum": 0, "pattern": PARTICLE_NAME})
}

fn list(items: Json, least: usize, most: usize) -> Json {
    json!({"type": "array", "items": items, "minItems": least, "maxItems": most})
}

/// The words, and the short ones that mean one of them.
fn with_aliases<'n>(words: &[&'n str], names: &Names) -> Vec<&'n str> {
    let short = names.aliases.iter().filter(|(_, id)| words.contains(id));
    words
        .iter()
        .copied()
        .chain(short.map(|(short, _)| *short))
        .collect()
}

/// A line for each engine. Which other programs there are is for the command line to say: any name is one.
fn expect(names: &Names) -> Json {
    let line = || json!({"$ref": format!("#/definitions/{LINE}")});
    let mut scopes = vec![ALL, REST];
    scopes.extend(with_aliases(&names.methods, names));
    scopes.extend(&names.engines);
    let mut keys: Map<String, Json> = scopes
        .into_iter()
        .map(|scope| (scope.to_owned(), line()))
        .collect();
    let reasons = names.checks.iter();
    let reasons = reasons.map(|id| ((*id).to_owned(), text("Why it is not made.")));
    let mut skip = mapping(reasons.collect());
    skip["description"] = "Checks that are not made, each with the reason.".into();
    keys.insert(SKIP.to_owned(), skip);
    let mut schema = mapping(keys);
    schema["additionalProperties"] = line();
    schema["propertyNames"] = json!({"pattern": EXTERNAL.pattern});
    schema["maxProperties"] = EXPECTED.into();
    schema
}

/// Text with something in it.
fn text(says: &str) -> Json {
    json!({"type": "string", "pattern": r"\S", "maxLength": WORD_BYTES, "description": says})
}

/// What may be expected of one engine.
fn line(names: &Names) -> Json {
    let keys = names.keys.iter();
    let keys = keys.map(|key| (key.path.clone(), expectation(key, names)));
    let mut schema = mapping(keys.collect());
    schema["description"] = "What the outcome of an engine must be.".into();
    schema["minProperties"] = 1.into();
    schema["maxProperties"] = EXPECTED.into();
    schema
}

/// The expectation of one key.
fn expectation(key: &OutcomeKey, names: &Names) -> Json {
    let path = &key.path;
    let mut schema = match &key.kind {
        KeyKind::Number => {
            let bound = |says: &str| json!({"type": "number", "description": says});
            let mut bounds = Map::new();
            bounds.insert("below".into(), bound("The value must be smaller."));
            bounds.insert("above".into(), bound("The value must be larger."));
            let mut bounds = mapping(bounds);
            bounds["minProperties"] = 1.into();
            bounds
        }
        KeyKind::Text => {
            let mut contains = Map::new();
            contains.insert("contains".into(), text("The text must have this in it."));
            let mut contains = mapping(contains);
            contains["required"] = json!(["contains"]);
            contains
        }
        KeyKind::Word(words) => {
            let words = with_aliases(words, names);
            let flags = words.iter().filter_map(|word| word.parse::<bool>().ok());
            let one: Vec<Json> = words.iter().map(|word| json!(word)).collect();
            let single: Vec<Json> = one.iter().cloned().chain(flags.map(Json::from)).collect();
            let mut several = list(json!({ "enum": one }), 1, EXPECTED);
            several["uniqueItems"] = true.into();
            json!({"anyOf": [{ "enum": single }, several]})
        }
    };
    schema["description"] = format!("What `{path}` of the outcome must be.").into();
    schema
}
