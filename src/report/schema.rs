//! A JSON Schema (draft 2020-12) of a table of keys, for editors.

use crate::scene::keys::{Holds, Key, Keys};
use serde_json::{Map, Value, json};

/// The schema of a file whose top level is `keys`; every table below it is a definition.
pub fn keys_schema(keys: &'static Keys, title: &str) -> Value {
    let mut definitions = Map::new();
    let mut whole = of_table(keys, &mut definitions);
    whole["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    whole["title"] = json!(title);
    whole["$defs"] = Value::Object(definitions);
    whole
}

fn of_table(keys: &'static Keys, definitions: &mut Map<String, Value>) -> Value {
    let mut properties = Map::new();
    for key in keys.list {
        properties.insert(key.name.to_owned(), of_key(key, definitions));
    }
    let required = keys.list.iter().filter(|key| key.is_required);
    let required: Vec<&str> = required.map(|key| key.name).collect();
    let mut schema = json!({
        "type": "object",
        "properties": properties,
        "additionalProperties": false,
    });
    if !required.is_empty() {
        schema["required"] = json!(required);
    }
    if !keys.one_of.is_empty() {
        let alternatives = keys.one_of.iter().map(|name| json!({ "required": [name] }));
        schema["oneOf"] = alternatives.collect();
    }
    let needs = keys.list.iter().filter_map(|key| Some((key, key.needs?)));
    let needs: Map<String, Value> = needs
        .map(|(key, other)| (key.name.to_owned(), json!([other])))
        .collect();
    if !needs.is_empty() {
        schema["dependentRequired"] = Value::Object(needs);
    }
    let excludes = keys
        .list
        .iter()
        .filter_map(|key| Some((key, key.excludes?)));
    let excludes: Vec<Value> = excludes
        .map(|(key, other)| json!({ "not": { "required": [key.name, other] } }))
        .collect();
    if !excludes.is_empty() {
        schema["allOf"] = json!(excludes);
    }
    schema
}

fn of_key(key: &Key, definitions: &mut Map<String, Value>) -> Value {
    let mut schema = of_value(key.holds, definitions);
    schema["description"] = json!(key.says);
    if key.least > 0 {
        schema["minItems"] = json!(key.least);
    }
    schema
}

fn of_value(holds: Holds, definitions: &mut Map<String, Value>) -> Value {
    let formula = || json!({ "type": ["number", "string"] });
    match holds {
        Holds::Text | Holds::Chain => json!({ "type": "string" }),
        Holds::Word(words) => json!({ "enum": words }),
        Holds::Texts(count) => list_schema(json!({ "type": "string" }), count),
        Holds::Flag => json!({ "type": "boolean" }),
        Holds::Formula => formula(),
        Holds::Formulas(count) => list_schema(formula(), count),
        Holds::Rows(count) => list_schema(list_schema(formula(), count), 0),
        Holds::Colour => json!({ "type": "string", "pattern": "^#[0-9a-fA-F]{6}$" }),
        Holds::Table(keys) => definition_reference(keys, definitions),
        Holds::Tables(keys) => list_schema(definition_reference(keys, definitions), 0),
        // A name with a dot is a table of names in TOML.
        Holds::Named(values) => {
            let mut value = any_of(values, definitions);
            let is_formula = |holds: &Holds| matches!(holds, Holds::Formula | Holds::Chain);
            if values.iter().all(is_formula) {
                let dotted = json!({ "type": "object", "additionalProperties": value });
                value = json!({ "anyOf": [value, dotted] });
            }
            json!({ "type": "object", "additionalProperties": value })
        }
        Holds::Any(values) => any_of(values, definitions),
    }
}

fn any_of(values: &[Holds], definitions: &mut Map<String, Value>) -> Value {
    let mut all = values.iter().map(|holds| of_value(*holds, definitions));
    match (all.len(), all.next()) {
        (1, Some(one)) => one,
        (_, first) => json!({ "anyOf": first.into_iter().chain(all).collect::<Vec<_>>() }),
    }
}

/// A list of this many items; zero means any number.
fn list_schema(items: Value, count: usize) -> Value {
    match count {
        0 => json!({ "type": "array", "items": items }),
        _ => json!({ "type": "array", "items": items, "minItems": count, "maxItems": count }),
    }
}

fn definition_reference(keys: &'static Keys, definitions: &mut Map<String, Value>) -> Value {
    let name = keys.name.replace(' ', "_");
    if !definitions.contains_key(&name) {
        // A placeholder while the table is processed, so that none is processed twice.
        definitions.insert(name.clone(), Value::Null);
        let schema = of_table(keys, definitions);
        definitions.insert(name.clone(), schema);
    }
    json!({ "$ref": format!("#/$defs/{name}") })
}
