//! The schemas for editors: committed ones are those that the program prints, scenes fit them, faulty ones do not.

use mechanim::report::schema::keys_schema;
use mechanim::scene::keys::Keys;
use mechanim::scene::keys::tables::SCENE;
use mechanim::snapshot::keys::LIST;
use serde_json::Value;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// What is wrong with `value`, by the parts of JSON Schema that our schemas use.
fn faults(schema: &Value, whole: &Value, value: &Value, place: &str) -> Vec<String> {
    let schema = match schema["$ref"].as_str() {
        Some(name) => &whole["$defs"][name.strip_prefix("#/$defs/").unwrap()],
        None => schema,
    };
    let mut list = Vec::new();
    if !has_type(&schema["type"], value) {
        return vec![format!("{place}: not {}", schema["type"])];
    }
    if let Some(words) = schema["enum"].as_array().filter(|w| !w.contains(value)) {
        list.push(format!("{place}: none of {words:?}"));
    }
    if let (Some(_), Some(text)) = (schema["pattern"].as_str(), value.as_str()) {
        let digits = text.strip_prefix('#').unwrap_or("");
        if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            list.push(format!("{place}: no colour"));
        }
    }
    if let Some(items) = value.as_array() {
        let count = items.len() as u64;
        let is_short = schema["minItems"]
            .as_u64()
            .is_some_and(|least| count < least);
        if is_short || schema["maxItems"].as_u64().is_some_and(|most| count > most) {
            list.push(format!("{place}: {count} items"));
        }
        for (k, item) in items
            .iter()
            .enumerate()
            .filter(|_| schema["items"].is_object())
        {
            list.extend(faults(
                &schema["items"],
                whole,
                item,
                &format!("{place}[{k}]"),
            ));
        }
    }
    if let Some(table) = value.as_object() {
        for (key, inner) in table {
            let place = format!("{place}.{key}");
            match (&schema["properties"][key], &schema["additionalProperties"]) {
                (Value::Null, Value::Bool(false)) => list.push(format!("{place}: unknown")),
                (Value::Null, Value::Null) => {}
                (Value::Null, more) => list.extend(faults(more, whole, inner, &place)),
                (known, _) => list.extend(faults(known, whole, inner, &place)),
            }
        }
        let required = schema["required"].as_array().into_iter().flatten();
        let missing = required.filter(|key| !table.contains_key(key.as_str().unwrap()));
        list.extend(missing.map(|key| format!("{place}: lacks {key}")));
    }
    let fits = |schema: &&Value| faults(schema, whole, value, place).is_empty();
    let count = |key: &str| {
        schema[key]
            .as_array()
            .map(|all| all.iter().filter(fits).count())
    };
    // Where a list of alternatives is about keys, tables of other keys are not looked at.
    if count("anyOf").is_some_and(|n| n == 0) || count("oneOf").is_some_and(|n| n != 1) {
        list.push(format!(
            "{place}: fits {:?} alternatives",
            count("oneOf").or(count("anyOf"))
        ));
    }
    list
}

fn has_type(wanted: &Value, value: &Value) -> bool {
    let is = |name: &str| match name {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "number" => value.is_number(),
        "boolean" => value.is_boolean(),
        other => panic!("{other}"),
    };
    match wanted {
        Value::String(name) => is(name),
        Value::Array(names) => names.iter().any(|name| is(name.as_str().unwrap())),
        _ => true,
    }
}

/// A TOML file as JSON, read by the toml crate alone.
fn read(path: &Path) -> Option<Value> {
    let text = std::fs::read_to_string(path).ok()?;
    let table = toml::de::DeTable::parse(&text).ok()?;
    Some(json(&toml::de::DeValue::Table(table.into_inner())))
}

fn json(value: &toml::de::DeValue) -> Value {
    use toml::de::DeValue;
    match value {
        DeValue::String(text) => Value::from(text.as_ref()),
        DeValue::Integer(n) => {
            Value::from(n.as_str().replace('_', "").parse::<f64>().unwrap_or(0.0))
        }
        DeValue::Float(n) => Value::from(n.as_str().replace('_', "").parse::<f64>().unwrap_or(0.0)),
        DeValue::Boolean(b) => Value::from(*b),
        DeValue::Datetime(d) => Value::from(d.to_string()),
        DeValue::Array(items) => items.iter().map(|item| json(item.get_ref())).collect(),
        DeValue::Table(table) => {
            let entries = table.iter();
            let entries = entries.map(|(k, v)| (k.get_ref().to_string(), json(v.get_ref())));
            Value::Object(entries.collect())
        }
    }
}

fn files(folder: &str) -> Vec<PathBuf> {
    let mut list: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    list.sort();
    list
}

#[test]
fn committed_schemas_are_those_of_the_program() {
    let both: [(&str, &'static Keys, &str); 2] = [
        ("scene", &SCENE, "Scene of mechanim"),
        ("snapshots", &LIST, "List of golden pictures of mechanim"),
    ];
    for (name, keys, title) in both {
        let path = root().join(format!("docs/schema/{name}.json"));
        let printed = format!("{:#}\n", keys_schema(keys, title));
        if std::env::var_os("MECHANIM_BLESS").is_some() {
            std::fs::write(&path, &printed).unwrap();
        }
        let committed = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            committed, printed,
            "run `mechanim schema {name} > docs/schema/{name}.json`"
        );
    }
}

#[test]
fn all_scenes_fit_the_schema() {
    let schema = keys_schema(&SCENE, "Scene");
    let mut seen = 0;
    for folder in ["scenes", "tests/hard"] {
        for path in files(folder) {
            let scene = read(&path).expect("a scene");
            let found = faults(&schema, &schema, &scene, "");
            assert!(found.is_empty(), "{}: {found:#?}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 30, "{seen}");
    let goldens = read(&root().join("tests/golden/snapshots.toml")).expect("a list");
    let list = mechanim::report::schema::keys_schema(&LIST, "List");
    assert_eq!(faults(&list, &list, &goldens, ""), Vec::<String>::new());
}

/// A scene that the schema refuses is refused by the reader, too; and planted faults are refused by both.
#[test]
fn what_the_schema_refuses_the_reader_refuses() {
    let schema = keys_schema(&SCENE, "Scene");
    let mut refused = 0;
    for path in files("tests/bad") {
        let Some(scene) = read(&path) else { continue };
        refused += usize::from(!faults(&schema, &schema, &scene, "").is_empty());
    }
    assert!(refused > 5, "only {refused} of tests/bad");
    for planted in [
        "duration = true",
        "titel = \"a\"",
        "[units]\nangle = \"grad\"",
        "[[bodies]]\nshapes = []",
        "[[bodies]]\nname = \"a\"\ncolour = \"red\"",
        "[[bodies]]\nname = \"a\"\nshapes = [{ sphere = { radius = 1 }, box = { size = [1, 1, 1] } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ sphere = { radius = 1, size = 2 } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ box = { size = [1, 1] } }]",
        "[contacts.c]\nfirst = { plane = {} }",
        "[view]\nup = \"w\"",
    ] {
        let table = toml::de::DeTable::parse(planted).unwrap();
        let value = json(&toml::de::DeValue::Table(table.into_inner()));
        assert!(
            !faults(&schema, &schema, &value, "").is_empty(),
            "{planted}"
        );
        let whole =
            format!("duration = 1\n{planted}").replace("duration = 1\nduration", "duration");
        assert!(
            mechanim::Scene::parse("planted", &whole).is_err(),
            "{planted}"
        );
    }
}

/// Every key stands in the document of its file.
#[test]
fn every_key_is_documented() {
    fn walk(
        keys: &'static Keys,
        document: &str,
        missing: &mut Vec<String>,
        seen: &mut Vec<&'static str>,
    ) {
        use mechanim::scene::keys::Holds;
        if seen.contains(&keys.name) {
            return;
        }
        seen.push(keys.name);
        for key in keys.list {
            let forms = ["`{}`", "`[{}]`", "`[[{}]]`", "{} =", "{}`"];
            let is_there = forms
                .iter()
                .any(|form| document.contains(&form.replace("{}", key.name)));
            if !is_there {
                missing.push(format!("{} of {}", key.name, keys.name));
            }
            let inner: &[Holds] = match &key.holds {
                Holds::Named(values) | Holds::Any(values) => values,
                one => std::slice::from_ref(one),
            };
            for holds in inner {
                if let Holds::Table(inner) | Holds::Tables(inner) = holds {
                    walk(inner, document, missing, seen);
                }
            }
        }
    }
    let documents: [(&'static Keys, &str); 2] =
        [(&SCENE, "docs/scene-format.md"), (&LIST, "docs/formats.md")];
    for (keys, path) in documents {
        let document = std::fs::read_to_string(root().join(path)).unwrap();
        let (mut missing, mut seen) = (Vec::new(), Vec::new());
        walk(keys, &document, &mut missing, &mut seen);
        assert!(missing.is_empty(), "{path} lacks {missing:?}");
        assert!(!seen.is_empty());
    }
}
