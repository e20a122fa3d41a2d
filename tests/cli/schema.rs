//! `volref schema`, and what the two schemas promise about the files they describe.

use crate::folder::{CURVE, Folder, MANIFEST, scene};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures")
}

fn schema(kind: &str) -> Value {
    Folder::new().volref(&["schema", kind]).json()
}

#[test]
fn the_committed_schemas_are_those_of_the_command() {
    for kind in ["scene", "case", "profile"] {
        let name = format!("{kind}.schema.json");
        let committed = std::fs::read_to_string(fixtures().join(&name)).unwrap_or_default();
        let run = Folder::new().volref(&["schema", kind]);
        assert!(
            committed.replace("\r\n", "\n") == run.stdout,
            "fixtures/{name} is out of date: cargo run -- schema {kind} > fixtures/{name}"
        );
    }
}

/// `volref compare` promises what a case does that says nothing.
#[test]
fn the_resolution_of_a_case_is_that_of_compare() {
    let default = &schema("case")["properties"]["mean_resolution"]["default"];
    assert_eq!(default.as_f64(), Some(volref::suite::MEAN_RESOLUTION));
}

#[test]
fn the_scene_is_the_default() {
    let folder = Folder::new();
    assert_eq!(
        folder.volref("schema").stdout,
        folder.volref("schema scene").stdout
    );
}

/// The files `fixtures/<folder>/*/*.toml`, as JSON.
fn tables_in(folder: &str) -> Vec<(String, Value)> {
    let files = crate::folder::tables_in(folder);
    assert!(files.len() >= 5, "only {} files in {folder}", files.len());
    let json = |path: PathBuf| {
        let table: toml::Table = std::fs::read_to_string(&path).unwrap().parse().unwrap();
        let json = serde_json::to_value(table).unwrap();
        (path.display().to_string(), json)
    };
    files.into_iter().map(json).collect()
}

#[test]
fn every_scene_and_manifest_is_valid() {
    for (kind, folder) in [("scene", "scenes"), ("case", "cases")] {
        let validator = jsonschema::validator_for(&schema(kind)).unwrap();
        for (path, table) in tables_in(folder) {
            let errors: Vec<_> = validator
                .iter_errors(&table)
                .map(|error| format!("{}: {error}", error.instance_path()))
                .collect();
            assert!(errors.is_empty(), "{path}: {}", errors.join("\n"));
        }
    }
}

/// A schema that accepts everything is valid for all scenes, too.
#[test]
fn what_the_reader_refuses_the_schema_refuses() {
    let validator = jsonschema::validator_for(&schema("scene")).unwrap();
    let folder = Folder::with_scenes();
    let valid = folder.text("scene.toml");
    let as_json = |text: &str| serde_json::to_value(text.parse::<toml::Table>().unwrap()).unwrap();
    assert!(validator.is_valid(&as_json(&valid)));
    for (old, new) in [
        ("width = 12", "width = 0"),
        ("width = 12", "width = 1.5"),
        ("width = 12", "widht = 12"),
        ("width = 12", "width = 16385"),
        ("\"0.2 voxels\"", "\"0.2 pixels\""),
        ("\"0.2 voxels\"", "0.0"),
        ("[classified]", "[classified]\ninterpolation = \"cubic\""),
        ("[classified]", "[classified]\nbackground = [0, 0]"),
        ("[classified]", "[classified]\nbackground = [0, 0, -1]"),
        ("[classified]", "[camera]\nvertical_fov = 180\n[classified]"),
        ("file = \"cloud.obj\"\n", ""),
        ("[film]", "[[film]]"),
    ] {
        let broken = valid.replacen(old, new, 1);
        assert_ne!(broken, valid);
        assert!(
            !validator.is_valid(&as_json(&broken)),
            "the schema accepts {new:?}"
        );
        folder.write("broken.toml", &broken);
        assert_eq!(
            folder.volref("plan broken.toml").code,
            2,
            "the reader accepts {new:?}"
        );
    }
}

/// A table of a schema: where it stands, and its properties.
fn tables<'s>(path: &str, schema: &'s Value, found: &mut Vec<(String, &'s Value)>) {
    // One table, where there may be several.
    let one = &schema["anyOf"][0];
    let schema = if one["properties"].is_object() {
        one
    } else {
        schema
    };
    if let Some(properties) = schema["properties"].as_object() {
        found.push((path.to_owned(), schema));
        for (name, property) in properties {
            let below = if path.is_empty() {
                name.clone()
            } else {
                format!("{path}.{name}")
            };
            tables(&below, property, found);
        }
    }
}

/// `text` with `key = value` put into the table at the dotted `path`.
fn with_key(text: &str, path: &str, key: &str, value: &Value) -> String {
    let mut root: toml::Table = text.parse().unwrap();
    let mut table = &mut root;
    for name in path.split('.').filter(|name| !name.is_empty()) {
        let below = table
            .entry(name)
            .or_insert_with(|| toml::Table::new().into());
        table = below.as_table_mut().unwrap();
    }
    table.insert(key.to_owned(), toml::Value::try_from(value).unwrap());
    toml::to_string(&root).unwrap()
}

/// A radiative scene of nothing. Entries of its lists are looked at by the library's own test.
const RADIATIVE: &str = "[camera]\neye = [0, 0, -4]\ntarget = [0, 0, 0]\n[radiative]\n";

/// The reader knows no key that the schema does not have, and takes every default that the
/// schema states, in every table.
#[test]
fn schema_and_reader_agree_on_keys_and_defaults() {
    let folder = Folder::with_suite();
    let shadow = "[classified.shadow]\nreference_step = 1\n";
    let volume = scene(shadow).replace("../../volumes", "fixtures/volumes");
    let window = volume.replace(shadow, "mode = \"maximum\"\n");
    let read_scene = |text: String| {
        folder.write("scene.toml", text);
        folder.volref("plan scene.toml")
    };
    let read_case = |text: String| {
        folder.write("fixtures/cases/smoke/plain.toml", text);
        folder.volref("list smoke/plain")
    };
    let mut checked = 0;
    for kind in ["scene", "case"] {
        let schema = schema(kind);
        let mut found = Vec::new();
        tables("", &schema, &mut found);
        for (path, table) in found {
            let base = match kind {
                "case" => MANIFEST,
                _ if path == "curve" => CURVE,
                _ if path == "sampling" || path.starts_with("radiative") => RADIATIVE,
                _ if path == "classified.window" => &window,
                _ => &volume,
            };
            let read = |key: &str, value: &Value| {
                let text = with_key(base, &path, key, value);
                // Keys of sampling belong to cases of sampled scenes.
                let sampled = matches!(key, "quick_samples" | "resolution" | "mean_resolution");
                if kind == "case" && sampled {
                    let deterministic = "class = \"deterministic\"";
                    assert!(text.contains(deterministic));
                    let stochastic = "class = \"stochastic\"\nconverged_samples = 64";
                    read_case(text.replace(deterministic, stochastic))
                } else if kind == "case" {
                    read_case(text)
                } else {
                    read_scene(text)
                }
            };
            read("no_such_key", &json!(1)).expect(2, "unknown key `no_such_key`");
            for (key, property) in table["properties"].as_object().unwrap() {
                if let Some(default) = property.get("default") {
                    let run = read(key, default);
                    assert_eq!(run.code, 0, "{path}.{key} = {default}: {}", run.stderr);
                    checked += 1;
                }
            }
        }
    }
    assert!(checked >= 15, "only {checked} defaults in the schemas");
}
