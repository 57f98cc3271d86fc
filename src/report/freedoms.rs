//! The mobility report in words and as JSON, for `check` and `solve`.

use super::sentences::counted_things;
use crate::kinematics::freedoms::count::{JointCount, LoopSpace};
use crate::kinematics::freedoms::mobility::{Mobility, RowName};
use crate::kinematics::structure::block::HeldFreedom;
use crate::kinematics::structure::loop_part::component_name;
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};

/// Most loops whose dimensions are listed one by one.
const MAX_LOOPS: usize = 6;

/// Most redundant equations that are listed one by one.
const MAX_EQUATIONS: usize = 6;

/// Lines of the report, each with its heading; lines without one continue the previous one.
pub fn freedoms_lines(mechanism: &Mechanism, mobility: &Mobility) -> Vec<(&'static str, String)> {
    let mut lines = vec![("mobility", mobility_sentence(mobility))];
    let count = &mobility.count;
    if let Some(dependents) = count.planar_dependents() {
        let (k, s1) = (count.closing().count(), count.equations);
        let all = count.freedoms() + dependents as i64;
        lines.push((
            "",
            format!("planar, as vector loops d = 2k + s1 = 2*{k} + {s1} = {dependents} dependent of {all} coordinates"),
        ));
    }
    if !mobility.redundant.is_empty() {
        lines.push(("redundant", redundant_sentence(mechanism, mobility)));
    }
    for name in &mobility.conditions {
        let text = format!(
            "`{name}` has more equations than unknowns: it closes only if the inputs are consistent"
        );
        lines.push(("condition", text));
    }
    lines.extend(
        mobility
            .idle
            .iter()
            .map(|held| ("idle", idle_sentence(mechanism, held))),
    );
    lines
}

/// The terms of the count.
fn count_terms(count: &JointCount) -> String {
    let joints = match count.is_by_coordinates {
        true => format!(
            "{} coordinates, some shared by several joints",
            count.joints
        ),
        false => counted_things(count.joints, "joint freedom"),
    };
    let free = counted_things(count.free, "coordinate");
    let mut text = match (count.joints, count.free) {
        (_, 0) => joints,
        (0, _) => format!("{free} of equations"),
        (_, _) => format!("{joints} + {free} of equations"),
    };
    let closing: Vec<&LoopSpace> = count.closing().collect();
    let mut cost: Vec<String> = if closing.len() > MAX_LOOPS {
        let total: usize = closing.iter().map(|l| l.dimension).sum();
        vec![format!("{total} of {} loops", closing.len())]
    } else {
        let loops = closing.iter();
        loops
            .map(|l| format!("{} of loop {}", l.dimension, l.name))
            .collect()
    };
    if count.equations > 0 {
        cost.push(format!("{} of equations", count.equations));
    }
    if count.shared > 0 {
        cost.push(format!("{} of shared coordinates", count.shared));
    }
    for term in cost {
        text.push_str(" - ");
        text.push_str(&term);
    }
    text
}

/// The count, the numeric mobility, and the number of inputs.
fn mobility_sentence(mobility: &Mobility) -> String {
    let count = &mobility.count;
    if count.loops.is_empty() && count.equations == 0 {
        let freedoms = counted_things(count.freedoms().unsigned_abs() as usize, "freedom");
        return format!("open chain: {freedoms}, {} driven", mobility.inputs);
    }
    let mut text = format!("{} by count ({})", count.freedoms(), count_terms(count));
    match (mobility.generic, mobility.at_start) {
        (None, _) => text.push_str("; no closed pose at which to determine the rank"),
        (Some(generic), start) => {
            let used = mobility.coordinates;
            text.push_str(&format!(
                ", {} by the rank {} of {used} coordinates",
                generic.mobility, generic.rank
            ));
            if let Some(start) = start.filter(|s| *s != generic) {
                text.push_str(&format!(
                    ", {} at the start, which is singular",
                    start.mobility
                ));
            }
        }
    }
    text.push_str(&format!("; {}", counted_things(mobility.inputs, "input")));
    if !mobility.idle.is_empty() {
        text.push_str(&format!(
            ", {}",
            counted_things(mobility.idle.len(), "idle freedom")
        ));
    }
    text
}

fn redundant_sentence(mechanism: &Mechanism, mobility: &Mobility) -> String {
    let all = &mobility.redundant;
    let named = all.iter().take(MAX_EQUATIONS).map(|row| match *row {
        RowName::Loop(index, component) => format!(
            "{} of loop {}",
            component_name(component),
            mechanism.loops[index].name
        ),
        RowName::Equation(index) => {
            let name = &mechanism.equations[index].name;
            let is_bar = mechanism.bars.iter().any(|bar| bar.name == *name);
            format!("{} {name}", if is_bar { "bar" } else { "equation" })
        }
    });
    let list = named.collect::<Vec<_>>().join(", ");
    let more = all.len().saturating_sub(MAX_EQUATIONS);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    format!("{list}{more}: implied by the other equations, checked but not proved")
}

/// An idle freedom as a sentence.
pub fn idle_sentence(mechanism: &Mechanism, held: &HeldFreedom) -> String {
    let names = |slots: &[usize]| -> String {
        let names = slots.iter().map(|u| mechanism.unknowns[*u].name.as_str());
        names.collect::<Vec<_>>().join(", ")
    };
    let held_name = &mechanism.unknowns[held.unknown].name;
    match held.turning {
        Some(index) => format!(
            "a link of loop {} can spin about the line of its own joints ({}); `{held_name}` is held",
            mechanism.loops[index].name,
            names(&held.moving)
        ),
        None => format!(
            "{} can be exchanged without moving anything; `{held_name}` is held",
            names(&held.moving)
        ),
    }
}

/// The report as JSON.
pub fn freedoms_document(mechanism: &Mechanism, mobility: &Mobility) -> Value {
    let name = |u: &usize| mechanism.unknowns[*u].name.clone();
    let count = &mobility.count;
    let loops: Vec<Value> = count
        .loops
        .iter()
        .map(|l| json!({ "loop": l.name, "dimension": l.dimension, "planar": l.is_planar }))
        .collect();
    let redundant: Vec<Value> = mobility
        .redundant
        .iter()
        .map(|row| match *row {
            RowName::Loop(index, component) => {
                json!({ "loop": mechanism.loops[index].name, "equation": component_name(component) })
            }
            RowName::Equation(index) => {
                json!({ "loop": null, "equation": mechanism.equations[index].name })
            }
        })
        .collect();
    let idle: Vec<Value> = mobility
        .idle
        .iter()
        .map(|held| {
            json!({
                "held": name(&held.unknown),
                "moving": held.moving.iter().map(name).collect::<Vec<_>>(),
                "loop": held.turning.map(|index| mechanism.loops[index].name.clone()),
            })
        })
        .collect();
    json!({
        "count": count.freedoms(),
        "joint_freedoms": count.joints,
        "equation_coordinates": count.free,
        "coordinates": mobility.coordinates,
        "inputs": mobility.inputs,
        "loops": loops,
        "equations": count.equations,
        "shared": count.shared,
        "by_coordinates": count.is_by_coordinates,
        "planar_dependents": count.planar_dependents(),
        "numeric": mobility.generic.map(|n| n.mobility),
        "numeric_rank": mobility.generic.map(|n| n.rank),
        "numeric_at_start": mobility.at_start.map(|n| n.mobility),
        "redundant": redundant,
        "conditions": mobility.conditions,
        "idle": idle,
    })
}
