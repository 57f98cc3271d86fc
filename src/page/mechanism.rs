//! The parts of a mechanism, in words: bodies, joints, loops, coordinates, freedoms.

use super::checked::CheckedMotion;
use super::markup::Section;
use crate::model::bar_ends::BarEnds;
use crate::model::joints::JointKind;
use crate::model::mechanism::{Coordinate, Mechanism};
use crate::report::sentences::{counted_things, with_unit};

/// Most names in a list.
const MOST_NAMES: usize = 24;

/// The section about the mechanism itself.
pub fn mechanism_section(checked: &CheckedMotion) -> Section {
    let mechanism = &checked.scene.mechanism;
    let mut section = Section::new("Mechanism");
    let bodies = mechanism.bodies.iter().map(|b| b.name.as_str());
    let loops = mechanism.loops.iter().map(|l| l.name.as_str());
    let unknowns = mechanism.unknowns.iter().map(|c| c.name.as_str());
    let mut terms = vec![
        ("Bodies".to_owned(), named_list(bodies)),
        ("Joints".to_owned(), joint_list(mechanism)),
        ("Closed loops".to_owned(), named_list(loops)),
    ];
    let is_bar = |name: &str| mechanism.bars.iter().any(|bar| bar.name == name);
    let equations = mechanism.equations.iter().map(|e| e.name.as_str());
    let (bars, equations): (Vec<&str>, Vec<&str>) = equations.partition(|name| is_bar(name));
    for (head, names) in [("Bars", bars), ("Equations", equations)] {
        if !names.is_empty() {
            terms.push((head.to_owned(), named_list(names.into_iter())));
        }
    }
    let inputs = mechanism.inputs.iter().enumerate();
    let inputs: Vec<String> = inputs
        .map(|(k, input)| driven_range(checked, k, input))
        .collect();
    terms.push((
        "Inputs".to_owned(),
        match inputs.is_empty() {
            true => "none".to_owned(),
            false => inputs.join("; "),
        },
    ));
    terms.push(("Unknowns".to_owned(), named_list(unknowns)));
    let freedoms = checked.answer.freedoms.iter();
    terms.extend(freedoms.map(|(head, text)| (long_head(head).to_owned(), text.clone())));
    section.terms(&terms);
    section
}

fn long_head(head: &str) -> &str {
    match head {
        "mobility" => "Freedoms",
        "redundant" => "Redundant equations",
        "condition" => "Condition on the inputs",
        "idle" => "Idle freedom",
        other => other,
    }
}

/// `4: crank, rod, slider, frame`.
fn named_list<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<&str> = names.collect();
    if names.is_empty() {
        return "none".to_owned();
    }
    let shown = names[..names.len().min(MOST_NAMES)].join(", ");
    let more = match names.len().saturating_sub(MOST_NAMES) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{}: {shown}{more}", names.len())
}

/// `3 revolute joints, 1 prismatic joint`.
fn joint_list(mechanism: &Mechanism) -> String {
    let mut kinds: Vec<(JointKind, usize)> = Vec::new();
    let ends = BarEnds::new(mechanism);
    let real = (mechanism.joints.list.iter()).filter(|joint| !ends.place_joint(joint));
    let guides = ends.guides().into_iter().map(|_| JointKind::Prismatic);
    for of_joint in real.map(|joint| joint.kind).chain(guides) {
        match kinds.iter_mut().find(|(kind, _)| *kind == of_joint) {
            Some((_, count)) => *count += 1,
            None => kinds.push((of_joint, 1)),
        }
    }
    let words = kinds
        .iter()
        .map(|(kind, count)| counted_things(*count, kind.words()));
    match words.collect::<Vec<_>>() {
        words if words.is_empty() => "none".to_owned(),
        words => words.join(", "),
    }
}

/// `phi from 0 deg to 360 deg`, as the samples have it.
fn driven_range(checked: &CheckedMotion, index: usize, input: &Coordinate) -> String {
    let values = checked.trajectory.samples.iter().map(|s| s.inputs[index]);
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
        (l.min(v), h.max(v))
    });
    let value = |v: f64| with_unit(&checked.scene.mechanism, input.kind, v);
    match low == high {
        true => format!("{} held at {}", input.name, value(low)),
        false => format!("{} between {} and {}", input.name, value(low), value(high)),
    }
}
