//! The tables of keys in `docs/scene-format.md` are written from the keys that the program reads.
//!
//! `MECHANIM_BLESS=1 cargo test --release --test suite key_tables::` writes them anew. A table stands between `<!-- keys of
//! NAME -->` and `<!-- end of keys -->`; tables without a place of their own are listed where they are used.

use mechanim::scene::keys::tables::SCENE;
use mechanim::scene::keys::{Holds, Key, Keys};
use std::collections::BTreeMap;

const PATH: &str = "docs/scene-format.md";
const BEGIN: &str = "<!-- keys of ";
const END: &str = "<!-- end of keys -->";

/// The tables that a value may be.
fn inner_tables(holds: Holds) -> Vec<&'static Keys> {
    match holds {
        Holds::Table(keys) | Holds::Tables(keys) => vec![keys],
        Holds::Named(all) | Holds::Any(all) => {
            all.iter().flat_map(|one| inner_tables(*one)).collect()
        }
        _ => Vec::new(),
    }
}

/// All tables below `keys`, by name.
fn reachable(keys: &'static Keys, found: &mut BTreeMap<&'static str, &'static Keys>) {
    if let Some(known) = found.insert(keys.name, keys) {
        assert!(std::ptr::eq(known, keys), "two tables named {}", keys.name);
        return;
    }
    let inner = keys.list.iter().flat_map(|key| inner_tables(key.holds));
    inner.for_each(|keys| reachable(keys, found));
}

/// What a key holds, in words.
fn value_words(holds: Holds) -> String {
    let any = |all: &[Holds]| {
        let all: Vec<String> = all.iter().map(|one| value_words(*one)).collect();
        all.join(" or ")
    };
    match holds {
        Holds::Text => "text".to_owned(),
        Holds::Word(words) => {
            let words: Vec<String> = words.iter().map(|word| format!("`\"{word}\"`")).collect();
            words.join(", ")
        }
        Holds::Texts(0) => "texts".to_owned(),
        Holds::Texts(count) => format!("{count} texts"),
        Holds::Flag => "true or false".to_owned(),
        Holds::Formula => "number".to_owned(),
        Holds::Formulas(0) => "numbers".to_owned(),
        Holds::Formulas(1) => "a list of one number".to_owned(),
        Holds::Formulas(count) => format!("{count} numbers"),
        Holds::Rows(count) => format!("list of {count} numbers each"),
        Holds::Chain => "chain".to_owned(),
        Holds::Colour => "`\"#rrggbb\"`".to_owned(),
        Holds::Table(_) => "table".to_owned(),
        Holds::Tables(_) => "list of tables".to_owned(),
        Holds::Named(all) => format!("names, each with a {}", any(all)),
        Holds::Any(all) => any(all),
    }
}

fn is_required(key: &Key) -> &'static str {
    match key.is_required {
        true => ", required",
        false => "",
    }
}

/// What a key means, with the keys of tables that have no place of their own.
fn meaning(key: &Key, is_placed: &dyn Fn(&str) -> bool) -> String {
    let mut text = key.says.to_owned();
    if let Some(other) = key.needs {
        text += &format!("; only beside `{other}`");
    }
    if let Some(other) = key.excludes {
        text += &format!("; not beside `{other}`");
    }
    let inner = inner_tables(key.holds).into_iter();
    for keys in inner.filter(|keys| !is_placed(keys.name) && !keys.list.is_empty()) {
        let list: Vec<String> = keys.list.iter().map(listed).collect();
        text += &format!(": {}", list.join(", "));
    }
    text
}

/// A key in a list of keys.
fn listed(key: &Key) -> String {
    let (value, required) = (value_words(key.holds), is_required(key));
    format!("`{}` ({value}{required}; {})", key.name, key.says)
}

/// The table of `keys`, and a sentence on those of which there is exactly one.
fn key_table(keys: &Keys, is_placed: &dyn Fn(&str) -> bool) -> String {
    let mut text = "| key | value | meaning |\n|---|---|---|\n".to_owned();
    for key in keys.list {
        let (value, meaning) = (value_words(key.holds), meaning(key, is_placed));
        let row = format!("{value}{} | {meaning}", is_required(key));
        text += &format!("| `{}` | {row} |\n", key.name);
    }
    if !keys.one_of.is_empty() {
        let names: Vec<String> = keys.one_of.iter().map(|name| format!("`{name}`")).collect();
        text += &format!("\nExactly one of {}.\n", names.join(", "));
    }
    text
}

/// The document with its tables as they must be, and the names of these.
fn written(text: &str, tables: &BTreeMap<&'static str, &'static Keys>) -> (String, Vec<String>) {
    let name = |part: &str| part.split(" -->").next().unwrap().to_owned();
    let placed: Vec<String> = text.split(BEGIN).skip(1).map(name).collect();
    let is_placed = |name: &str| placed.iter().any(|other| other == name);
    let mut parts = text.split(BEGIN);
    let mut whole = parts.next().unwrap().to_owned();
    for (part, name) in parts.zip(&placed) {
        let keys = tables
            .get(name.as_str())
            .unwrap_or_else(|| panic!("no keys of {name}"));
        let (_, rest) = part
            .split_once(END)
            .unwrap_or_else(|| panic!("the keys of {name} do not end"));
        let table = key_table(keys, &is_placed);
        whole += &format!("{BEGIN}{name} -->\n{table}{END}{rest}");
    }
    (whole, placed)
}

#[test]
fn tables_of_keys_are_those_of_the_program() {
    let mut tables = BTreeMap::new();
    reachable(&SCENE, &mut tables);
    let text = std::fs::read_to_string(PATH).unwrap();
    let (whole, placed) = written(&text, &tables);
    if std::env::var_os("MECHANIM_BLESS").is_some() {
        std::fs::write(PATH, &whole).unwrap();
    }
    assert_eq!(
        std::fs::read_to_string(PATH).unwrap(),
        whole,
        "MECHANIM_BLESS=1 cargo test --release --test suite key_tables"
    );
    // Every table has a place, or is listed in a table that has one.
    let is_placed = |name: &str| placed.iter().any(|other| other == name);
    let listed = tables.values().filter(|keys| is_placed(keys.name));
    let listed = listed.flat_map(|keys| keys.list);
    let listed: Vec<&str> = listed
        .flat_map(|key| inner_tables(key.holds))
        .map(|keys| keys.name)
        .collect();
    for name in tables.keys() {
        assert!(is_placed(name) || listed.contains(name), "{name}");
    }
    assert!(is_placed(SCENE.name) && tables.len() > 30, "{placed:?}");
}

#[test]
fn a_table_lists_what_has_no_place_of_its_own() {
    static INNER: Keys = Keys::new(
        "inner",
        &[Key::new("a", Holds::Flag, "what it is").required()],
    );
    static OUTER: Keys = Keys::with_one_of(
        "outer",
        &[
            Key::new("b", Holds::Table(&INNER), "a part"),
            Key::new("c", Holds::Rows(2), "places").beside("b"),
        ],
        &["b", "c"],
    );
    let tables = [("outer", &OUTER), ("inner", &INNER)].into();
    let text = format!("before\n{BEGIN}outer -->\nold\n{END}\nafter\n");
    let (whole, placed) = written(&text, &tables);
    let table = "| key | value | meaning |\n|---|---|---|\n\
        | `b` | table | a part: `a` (true or false, required; what it is) |\n\
        | `c` | list of 2 numbers each | places; only beside `b` |\n\nExactly one of `b`, `c`.\n";
    assert_eq!(
        whole,
        format!("before\n{BEGIN}outer -->\n{table}{END}\nafter\n")
    );
    assert_eq!(placed, ["outer"]);
}
