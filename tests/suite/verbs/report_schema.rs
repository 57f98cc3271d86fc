//! Every JSON report of a check is as its schema says; the validator knows the few words that the schema uses.

use crate::program::Workspace;
use mechanim::scene::builtin;
use serde_json::{Value, json};

fn schema() -> Value {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/docs/schema/mechanim-check-1.json"
    );
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn is_of(value: &Value, word: &str) -> bool {
    match word {
        "null" => value.is_null(),
        "boolean" => value.is_boolean(),
        "number" => value.is_number(),
        "integer" => value.is_i64() || value.is_u64(),
        "string" => value.is_string(),
        "array" => value.is_array(),
        "object" => value.is_object(),
        _ => panic!("{word}"),
    }
}

/// What is wrong with a value; words of the schema that are not known here are wrong, too.
fn faults(value: &Value, schema: &Value, place: &str, list: &mut Vec<String>) {
    for (word, want) in schema.as_object().unwrap() {
        let is_right = match word.as_str() {
            "$schema" | "title" | "description" => true,
            "type" => match want {
                Value::String(word) => is_of(value, word),
                words => words
                    .as_array()
                    .unwrap()
                    .iter()
                    .any(|w| is_of(value, w.as_str().unwrap())),
            },
            "enum" => want.as_array().unwrap().contains(value),
            "minimum" => value.as_f64().is_none_or(|v| v >= want.as_f64().unwrap()),
            "minItems" => value
                .as_array()
                .is_none_or(|v| v.len() as u64 >= want.as_u64().unwrap()),
            "maxItems" => value
                .as_array()
                .is_none_or(|v| v.len() as u64 <= want.as_u64().unwrap()),
            "required" => value.as_object().is_none_or(|o| {
                want.as_array()
                    .unwrap()
                    .iter()
                    .all(|key| o.contains_key(key.as_str().unwrap()))
            }),
            "additionalProperties" => {
                let is_named = |key: &str| schema["properties"].get(key).is_some();
                let others = value.as_object().into_iter().flatten();
                let mut others = others.filter(|(key, _)| !is_named(key));
                match want.is_object() {
                    true => {
                        others
                            .for_each(|(key, v)| faults(v, want, &format!("{place}.{key}"), list));
                        true
                    }
                    false => others.next().is_none(),
                }
            }
            "items" => {
                for (k, item) in value.as_array().into_iter().flatten().enumerate() {
                    faults(item, want, &format!("{place}[{k}]"), list);
                }
                true
            }
            "properties" => {
                for (key, want) in want.as_object().unwrap() {
                    if let Some(value) = value.get(key) {
                        faults(value, want, &format!("{place}.{key}"), list);
                    }
                }
                true
            }
            _ => false,
        };
        if !is_right {
            list.push(format!("{place}: {word} {want}, found {value:.200}"));
        }
    }
}

fn wrong(report: &Value) -> Vec<String> {
    let mut list = Vec::new();
    faults(report, &schema(), "", &mut list);
    list
}

/// A lift that cuts the floor, or jumps, or stands still; and more bodies than are looked at one by one.
fn scenes() -> Vec<(String, String)> {
    let lift = |height: &str| {
        format!(
            "title = \"lift\"\nduration = 2\nunits = {{ length = \"mm\", angle = \"rad\" }}\n[inputs]\nz = {height}\n\
             [[bodies]]\nname = \"floor\"\nshapes = [{{ half_space = {{ size = 9 }} }}]\n\
             [[bodies]]\nname = \"ball\"\nframe = \"Tz(z)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
             [clearance]\nminimum = 0.5\n"
        )
    };
    let heights = [
        "\"2 - t\"",
        "\"9 - 3*floor(2*t)\"",
        "\"2 + sqrt((t - 1)^2 - 0.01)\"",
        "\"30 - t\"",
    ];
    let mut list: Vec<(String, String)> = heights.map(|h| (h.to_owned(), lift(h))).into();
    // Bodies that must touch and part or cut, and half-spaces that overlap without end.
    for u in ["1 + 0.3*t", "1 - 0.3*t"] {
        let touching = lift(&format!("\"{u}\"")).replace(
            "minimum = 0.5",
            "touching = [{ pair = [\"floor\", \"ball\"] }]",
        );
        list.push((u.to_owned(), touching));
    }
    let endless = lift("\"t\"").replace(
        "frame = \"Tz(z)\"\nshapes = [{ sphere = { radius = 1 } }]",
        "frame = \"Tz(9) Rx(z)\"\nshapes = [{ half_space = { size = 9 } }]",
    );
    assert!(endless.contains("Rx(z)"));
    list.push(("endless".to_owned(), endless));
    let mut many = lift("\"30 - t\"");
    for k in 0..30 {
        let body = format!(
            "[[bodies]]\nname = \"b{k}\"\nframe = \"Tx({}*z) Tz(40)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n[clearance]",
            10 * (k / 2)
        );
        many = many.replace("[clearance]", &body);
    }
    list.push(("many".to_owned(), many));
    list
}

#[test]
fn reports_are_as_the_schema_says() {
    let w = Workspace::new();
    let mut runs: Vec<String> = builtin::ALL.iter().map(|s| s.name.to_owned()).collect();
    for (name, text) in scenes() {
        let file = format!("{}.toml", runs.len());
        assert!(!name.is_empty());
        w.write(&file, text);
        runs.push(file);
    }
    for scene in runs {
        for more in [
            &["--samples", "9"][..],
            &["--samples", "2", "--certify", "motion"],
        ] {
            let args = [
                &[
                    "check",
                    &scene,
                    "--json",
                    "r.json",
                    "--bound-tolerance",
                    "0.1",
                    "-q",
                ],
                more,
            ]
            .concat();
            let run = w.run(&args);
            assert!([0, 1, 4].contains(&run.code), "{scene}: {}", run.stderr);
            let report: Value =
                serde_json::from_slice(&std::fs::read(w.path("r.json")).unwrap()).unwrap();
            assert_eq!(wrong(&report), Vec::<String>::new(), "{scene} {more:?}");
        }
    }
}

/// The validator sees what is wrong.
#[test]
fn wrong_reports_are_refused() {
    let w = Workspace::new();
    w.run(&["check", "four-bar", "--json", "r.json", "-q"])
        .exits(0);
    let good: Value = serde_json::from_slice(&std::fs::read(w.path("r.json")).unwrap()).unwrap();
    assert!(wrong(&good).is_empty(), "{:?}", wrong(&good));
    let changes: [(&str, Value); 6] = [
        ("/result", json!("fine")),
        ("/samples", json!(-1)),
        ("/checks", json!([])),
        ("/clearance/passed", json!("yes")),
        ("/clearance/pairs/0/points", json!([[0, 0, 0]])),
        ("/clearance/pairs/0", json!({ "bodies": ["a", "b"] })),
    ];
    for (place, value) in changes {
        let mut bad = good.clone();
        *bad.pointer_mut(place).unwrap() = value;
        assert!(!wrong(&bad).is_empty(), "{place}");
    }
    let mut more = good;
    more.as_object_mut()
        .unwrap()
        .insert("extra".to_owned(), json!(1));
    assert!(!wrong(&more).is_empty());
}
