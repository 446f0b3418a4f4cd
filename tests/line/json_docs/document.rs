//! The schemas of docs/json.md, and what commands print to hold against them.

use arcfeed_tests::{Scratch, root, run};
use boon::{Compiler, SchemaIndex, Schemas};
use serde_json::{Value, json};

use super::CASE;

/// Old text and new one.
pub type Change<'a> = (&'a str, &'a str);

/// The schemas of docs/json.md, by their titles.
pub struct Documented {
    pub texts: Vec<Value>,
    pub compiled: Schemas,
    pub indices: Vec<(String, SchemaIndex)>,
}

impl Documented {
    pub fn read() -> Self {
        let document = file_text("docs/json.md");
        let blocks =
            document.split("```json-schema\n").skip(1).map(|rest| rest.split("```").next().unwrap_or_default());
        let texts: Vec<Value> = blocks.map(|text| serde_json::from_str(text).expect("schemas are JSON")).collect();
        let mut compiler = Compiler::new();
        let locations: Vec<String> = (0..texts.len()).map(|at| format!("https://arcfeed.invalid/block/{at}")).collect();
        for (location, text) in locations.iter().zip(&texts) {
            let location = text["$id"].as_str().unwrap_or(location);
            compiler.add_resource(location, text.clone()).expect("each schema has a place of its own");
        }
        let mut compiled = Schemas::new();
        let mut compile = |(location, text): (&String, &Value)| {
            let location = text["$id"].as_str().unwrap_or(location);
            let title = text["title"].as_str().expect("each schema has a title").to_owned();
            (title, compiler.compile(location, &mut compiled).expect("schemas obey JSON Schema"))
        };
        let indices = locations.iter().zip(&texts).map(&mut compile).collect();
        Documented { texts, compiled, indices }
    }

    pub fn validate(&self, title: &str, value: &Value) -> Result<(), String> {
        let (_, index) = self.indices.iter().find(|(other, _)| other == title).expect("a documented shape");
        self.compiled.validate(value, *index).map_err(|error| error.to_string())
    }

    /// It is valid, and no longer so when any field of it is damaged.
    pub fn assert_fits(&self, title: &str, value: &Value) {
        if let Err(error) = self.validate(title, value) {
            panic!("{title}: {error}\n{value}");
        }
        let damaged = damages(value);
        assert!(!damaged.is_empty());
        for (what, damaged) in damaged {
            assert!(self.validate(title, &damaged).is_err(), "{title} allows {what}");
        }
    }
}

pub fn file_text(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The JSON objects that a command prints, and its exit code.
pub fn objects(arguments: &[&str]) -> (Option<i32>, Vec<Value>) {
    let output = run(&[arguments, &["--json"]].concat());
    let text = String::from_utf8(output.stdout).expect("JSON is text");
    (output.status.code(), text.lines().map(|line| serde_json::from_str(line).expect("one object a line")).collect())
}

/// The one object of a command that must end with `code`.
pub fn object(arguments: &[&str], code: i32) -> Value {
    let (found, mut objects) = objects(arguments);
    assert_eq!((found, objects.len()), (Some(code), 1), "{arguments:?}");
    objects.remove(0)
}

/// The value with each object in it damaged in turn: a field too few, one too many, one of another type.
pub fn damages(value: &Value) -> Vec<(String, Value)> {
    let mut damaged = Vec::new();
    for pointer in objects_in(value, "") {
        let mut damage = |what: String, field: &str, new: Option<Value>| {
            let mut copy = value.clone();
            let object = copy.pointer_mut(&pointer).and_then(Value::as_object_mut).expect("it was just found");
            match new {
                Some(new) => object.insert(field.to_owned(), new),
                None => object.remove(field),
            };
            damaged.push((what, copy));
        };
        damage(format!("an unknown field in {pointer}/"), "surprise", Some(json!(1)));
        for field in value.pointer(&pointer).and_then(Value::as_object).expect("it was just found").keys() {
            damage(format!("no {pointer}/{field}"), field, None);
            damage(format!("an object as {pointer}/{field}"), field, Some(json!({ "surprise": 1 })));
        }
    }
    damaged
}

/// JSON pointers of all objects in a value.
pub fn objects_in(value: &Value, pointer: &str) -> Vec<String> {
    let children: Vec<(String, &Value)> = match value {
        Value::Object(object) => object.iter().map(|(name, child)| (format!("{pointer}/{name}"), child)).collect(),
        Value::Array(items) => items.iter().enumerate().map(|(at, child)| (format!("{pointer}/{at}"), child)).collect(),
        _ => return vec![],
    };
    let own = value.is_object().then(|| pointer.to_owned());
    own.into_iter().chain(children.into_iter().flat_map(|(pointer, child)| objects_in(child, &pointer))).collect()
}

/// A copy of a folder's job and program, both changed.
pub fn changed(scratch: &Scratch, folder: &str, job: &[Change<'_>], program: &[Change<'_>]) -> String {
    let change = |path: String, changes: &[Change<'_>]| {
        changes.iter().fold(file_text(&path), |text, (old, new)| {
            assert!(text.contains(old), "no {old} in {path}");
            text.replace(old, new)
        })
    };
    let name = if folder == CASE { "program.nc" } else { "ibr-slot.nc" };
    scratch.write(name, change(format!("{folder}/{name}"), program));
    scratch.write("job.toml", change(format!("{folder}/job.toml"), job))
}
