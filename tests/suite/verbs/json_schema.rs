//! A validator for the part of JSON Schema that the schemas for editors use, and TOML as its values.

use serde_json::Value;
use std::path::Path;

/// What is wrong with `value`: `place: what`, places as `.bodies[0].name`.
pub fn faults(schema: &Value, whole: &Value, value: &Value, place: &str) -> Vec<String> {
    let schema = match schema["$ref"].as_str() {
        Some(name) => &whole["$defs"][name.strip_prefix("#/$defs/").unwrap()],
        None => schema,
    };
    if !has_type(&schema["type"], value) {
        let wanted = schema["type"].to_string().replace('"', "");
        return vec![format!("{place}: not {wanted}")];
    }
    let mut list = Vec::new();
    if let Some(words) = schema["enum"].as_array().filter(|w| !w.contains(value)) {
        list.push(format!("{place}: none of {} words", words.len()));
    }
    if let (Some(_), Some(text)) = (schema["pattern"].as_str(), value.as_str()) {
        let digits = text.strip_prefix('#').unwrap_or("");
        if digits.len() != 6 || !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            list.push(format!("{place}: no colour"));
        }
    }
    if let Some(items) = value.as_array() {
        list.extend(faults_of_items(schema, whole, items, place));
    }
    if let Some(table) = value.as_object() {
        list.extend(faults_of_keys(schema, whole, table, place));
    }
    for (word, is_right) in [
        ("anyOf", (|n| n > 0) as fn(usize) -> bool),
        ("oneOf", |n| n == 1),
    ] {
        let Some(all) = schema[word].as_array() else {
            continue;
        };
        let fits = |schema: &&Value| faults(schema, whole, value, place).is_empty();
        let count = all.iter().filter(fits).count();
        if !is_right(count) {
            list.push(format!(
                "{place}: fits {count} of {} alternatives",
                all.len()
            ));
        }
    }
    for one in schema["allOf"].as_array().into_iter().flatten() {
        list.extend(faults(one, whole, value, place));
    }
    if schema["not"].is_object() && faults(&schema["not"], whole, value, place).is_empty() {
        let keys = &schema["not"]["required"];
        list.push(format!("{place}: both {} and {}", keys[0], keys[1]).replace('"', "`"));
    }
    list
}

fn faults_of_items(schema: &Value, whole: &Value, items: &[Value], place: &str) -> Vec<String> {
    let mut list = Vec::new();
    let count = items.len() as u64;
    let least = schema["minItems"].as_u64().unwrap_or(0);
    let most = schema["maxItems"].as_u64().unwrap_or(u64::MAX);
    if !(least..=most).contains(&count) {
        list.push(format!("{place}: {count} items"));
    }
    if schema["items"].is_object() {
        for (k, item) in items.iter().enumerate() {
            let place = format!("{place}[{k}]");
            list.extend(faults(&schema["items"], whole, item, &place));
        }
    }
    list
}

fn faults_of_keys(
    schema: &Value,
    whole: &Value,
    table: &serde_json::Map<String, Value>,
    place: &str,
) -> Vec<String> {
    let mut list = Vec::new();
    for (key, inner) in table {
        let place = format!("{place}.{key}");
        match (&schema["properties"][key], &schema["additionalProperties"]) {
            (Value::Null, Value::Bool(false)) => list.push(format!("{place}: unknown")),
            (Value::Null, Value::Null) => {}
            (Value::Null, more) => list.extend(faults(more, whole, inner, &place)),
            (known, _) => list.extend(faults(known, whole, inner, &place)),
        }
    }
    let lacks = |key: &&str| !table.contains_key(*key);
    let required = schema["required"].as_array().into_iter().flatten();
    let missing = required.filter_map(Value::as_str).filter(lacks);
    list.extend(missing.map(|key| format!("{place}: lacks `{key}`")));
    for (key, others) in schema["dependentRequired"]
        .as_object()
        .into_iter()
        .flatten()
    {
        let others = others.as_array().into_iter().flatten();
        let missing = others.filter_map(Value::as_str).filter(lacks);
        let is_there = table.contains_key(key);
        let missing = missing.filter(|_| is_there);
        list.extend(missing.map(|other| format!("{place}: `{key}` without `{other}`")));
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

/// A TOML file as JSON, read by the toml crate alone; `None` where it is no TOML.
pub fn read(path: &Path) -> Option<Value> {
    parse(&std::fs::read_to_string(path).ok()?)
}

/// The same for a text.
pub fn parse(text: &str) -> Option<Value> {
    let table = toml::de::DeTable::parse(text).ok()?;
    Some(json(&toml::de::DeValue::Table(table.into_inner())))
}

fn json(value: &toml::de::DeValue) -> Value {
    use toml::de::DeValue;
    // JSON has no infinite numbers; that a number is finite is no matter of a schema.
    let number = |text: &str| {
        let number = text.replace('_', "").parse::<f64>().unwrap_or(0.0);
        Value::from(if number.is_finite() { number } else { 0.0 })
    };
    match value {
        DeValue::String(text) => Value::from(text.as_ref()),
        DeValue::Integer(n) => number(n.as_str()),
        DeValue::Float(n) => number(n.as_str()),
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
