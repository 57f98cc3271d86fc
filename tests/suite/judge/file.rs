//! The sections of a scene file as texts. Numbers keep their digits.

use super::chain::{self, Chains, Item};
use super::contact::{Shape, Side};
use super::formula::{self, Node};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A scene, parsed; names and units are not looked at.
pub struct File {
    pub is_in_degrees: bool,
    /// In the order of the file.
    pub parameters: Vec<(String, Node)>,
    pub inputs: Vec<(String, Vec<Node>)>,
    pub guess: Vec<(String, Node)>,
    pub chains: Chains,
    pub loops: Vec<Vec<Item>>,
    pub equations: Vec<Node>,
    /// Chains to both ends, and the length.
    pub bars: Vec<([Vec<Item>; 2], Node)>,
    pub contacts: Vec<(String, [Side; 2])>,
    /// Frames of bodies and formulas of outputs: they may tell what a name measures.
    pub frames: Vec<Vec<Item>>,
    pub outputs: Vec<(String, Node)>,
    /// Name, chain of the body, and point.
    pub traces: Vec<(String, Vec<Item>, [Node; 3])>,
}

impl File {
    pub fn parse(text: &str) -> Self {
        let table = DeTable::parse(text).unwrap();
        let table = table.get_ref();
        let units = table.get("units").and_then(|u| u.get_ref().as_table());
        let angle = units
            .and_then(|u| u.get("angle"))
            .and_then(|a| a.get_ref().as_str());
        let formulas = |key: &str| {
            section(table, key)
                .into_iter()
                .map(|(n, v)| (n, formula_of(v)))
        };
        let chain_of = |value: &DeValue| chain::parse(value.as_str().unwrap());
        let chains = |key: &str| {
            section(table, key)
                .into_iter()
                .map(|(n, v)| (n, chain_of(v)))
        };
        let bodies = table.get("bodies").and_then(|b| b.get_ref().as_array());
        let bodies = bodies.into_iter().flat_map(|b| b.iter());
        let bodies: Vec<&DeTable> = bodies.filter_map(|b| b.get_ref().as_table()).collect();
        let frames = bodies.iter().filter_map(|b| b.get("frame"));
        Self {
            is_in_degrees: angle == Some("deg"),
            parameters: formulas("parameters").collect(),
            inputs: section(table, "inputs")
                .into_iter()
                .map(|(n, v)| (n, drive_of(v)))
                .collect(),
            guess: formulas("guess").collect(),
            chains: chains("chains").collect(),
            loops: chains("loops").map(|(_, items)| items).collect(),
            equations: formulas("equations").map(|(_, node)| node).collect(),
            bars: bars(table, &traces(table, &bodies)),
            contacts: contacts(table),
            frames: frames.map(|f| chain_of(f.get_ref())).collect(),
            outputs: formulas("outputs").collect(),
            traces: traces(table, &bodies),
        }
    }
}

/// Traced points with the chains of their bodies.
fn traces(table: &DeTable, bodies: &[&DeTable]) -> Vec<(String, Vec<Item>, [Node; 3])> {
    let text = |table: &DeTable, key: &str| Some(table.get(key)?.get_ref().as_str()?.to_owned());
    let list = table.get("traces").and_then(|t| t.get_ref().as_array());
    let list = list.into_iter().flat_map(|l| l.iter());
    list.map(|trace| {
        let trace = trace.get_ref().as_table().unwrap();
        let name = text(trace, "body");
        let body = bodies.iter().find(|b| text(b, "name") == name).unwrap();
        let frame = text(body, "frame").map_or(Vec::new(), |f| chain::parse(&f));
        let point = trace.get("point").map(|p| p.get_ref().as_array().unwrap());
        let part = |k: usize| {
            let zero = || Node::Number("0".to_owned());
            point.map_or_else(zero, |p| formula_of(p[k].get_ref()))
        };
        (text(trace, "name").unwrap(), frame, [0, 1, 2].map(part))
    })
    .collect()
}

/// The entries of a section in the order of the file, dotted names in one piece.
fn section<'a>(table: &'a DeTable<'a>, key: &str) -> Vec<(String, &'a DeValue<'a>)> {
    let Some(inner) = table.get(key).and_then(|s| s.get_ref().as_table()) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    entries(inner, "", key == "guess", &mut all);
    all.sort_by_key(|(_, value)| value.span().start);
    all.into_iter()
        .map(|(name, value)| (name, value.get_ref()))
        .collect()
}

fn entries<'a>(
    table: &'a DeTable<'a>,
    before: &str,
    opens_tables: bool,
    all: &mut Vec<(String, &'a Spanned<DeValue<'a>>)>,
) {
    for (name, value) in table.iter() {
        let name = format!("{before}{}", name.get_ref());
        match value.get_ref().as_table().filter(|_| opens_tables) {
            Some(inner) => entries(inner, &format!("{name}."), true, all),
            None => all.push((name, value)),
        }
    }
}

fn formula_of(value: &DeValue) -> Node {
    let signed = |digits: &str| match digits.strip_prefix('-') {
        Some(digits) => Node::Negative(Box::new(Node::Number(digits.to_owned()))),
        None => Node::Number(digits.to_owned()),
    };
    match value {
        DeValue::Integer(whole) => signed(whole.as_str()),
        DeValue::Float(number) => signed(number.as_str()),
        _ => formula::parse(value.as_str().unwrap()),
    }
}

/// Every formula of a drive's values.
fn drive_of(value: &DeValue) -> Vec<Node> {
    let Some(table) = value.as_table() else {
        return vec![formula_of(value)];
    };
    let keys = table.get("keys").and_then(|k| k.get_ref().as_array());
    let values = keys.into_iter().flat_map(|k| k.iter());
    let values = values.map(|pair| formula_of(pair.get_ref().as_array().unwrap()[1].get_ref()));
    let formula = table.get("formula").map(|f| formula_of(f.get_ref()));
    values.chain(formula).collect()
}

fn bars(table: &DeTable, traces: &[(String, Vec<Item>, [Node; 3])]) -> Vec<([Vec<Item>; 2], Node)> {
    let shifts = |nodes: Vec<Node>| {
        let nodes = nodes.into_iter().enumerate();
        nodes.map(|(axis, node)| Item::Part(chain::Part::Shift(axis, node)))
    };
    let end = |value: &DeValue| match value.as_array() {
        Some(point) => shifts(point.iter().map(|c| formula_of(c.get_ref())).collect()).collect(),
        None => {
            let text = value.as_str().unwrap();
            match traces.iter().find(|(name, ..)| name == text) {
                Some((_, frame, point)) => {
                    let shifts = shifts(point.to_vec());
                    frame.iter().cloned().chain(shifts).collect()
                }
                None => chain::parse(text),
            }
        }
    };
    let all = section(table, "bars").into_iter();
    all.map(|(_, value)| {
        let bar = value.as_table().unwrap();
        let ends = ["from", "to"].map(|key| end(bar[key].get_ref()));
        (ends, formula_of(bar["length"].get_ref()))
    })
    .collect()
}

fn contacts(table: &DeTable) -> Vec<(String, [Side; 2])> {
    let all = section(table, "contacts").into_iter();
    all.map(|(name, value)| {
        let value = value.as_table().unwrap();
        (
            name,
            ["first", "second"].map(|side| side_of(value[side].get_ref().as_table().unwrap())),
        )
    })
    .collect()
}

fn side_of(table: &DeTable) -> Side {
    let size = |surface: &str, key: &str| {
        let surface = table.get(surface)?.get_ref().as_table()?;
        surface.get(key).map(|v| formula_of(v.get_ref()))
    };
    let frame = table.get("frame").and_then(|f| f.get_ref().as_str());
    let shape = if let (Some(ring), Some(tube)) = (size("torus", "ring"), size("torus", "tube")) {
        Shape::Torus { ring, tube }
    } else if let Some(radius) = size("sphere", "radius") {
        Shape::Sphere { radius }
    } else if let Some(radius) = size("cylinder", "radius") {
        Shape::Cylinder { radius }
    } else {
        assert!(table.contains_key("plane"));
        Shape::Plane
    };
    Side {
        shape,
        frame: frame.map(chain::parse).unwrap_or_default(),
    }
}
