//! The result of a search for assemblies, in words.

use super::rounded::at_least_three;
use super::sentences::counted_things;
use crate::kinematics::assemblies::{Mode, Modes, StartKind, UNSEEN};
use crate::kinematics::structure::block::slot_names;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::{Kind, Mechanism};

/// `40 placements of `plate``, and which of them are not isolated.
pub fn modes_headline(mechanism: &Mechanism, modes: &Modes) -> String {
    let placements = modes.placements();
    let what = match modes.bodies[..] {
        [] => assembly_count(placements, ""),
        [one] => {
            let name = &mechanism.bodies[one].name;
            format!("{} of `{name}`", counted_things(placements, "placement"))
        }
        _ => format!("{} of the bodies", counted_things(placements, "placement")),
    };
    let sets = [
        (modes.curves(), "curve"),
        (modes.larger_sets(), "larger set"),
    ];
    let sets: Vec<String> = sets
        .iter()
        .filter(|(count, _)| *count > 0)
        .map(|(count, noun)| format!("{} of solutions", counted_things(*count, noun)))
        .collect();
    match sets.is_empty() {
        true => what,
        false => {
            let kind = match modes.bodies.is_empty() {
                true => assembly_count(modes.isolated(), "isolated "),
                false => counted_things(modes.isolated(), "isolated placement"),
            };
            format!("{kind} and {}", sets.join(" and "))
        }
    }
}

/// `1 assembly`, `3 isolated assemblies`.
fn assembly_count(count: usize, which: &str) -> String {
    match count {
        1 => format!("1 {which}assembly"),
        n => format!("{n} {which}assemblies"),
    }
}

/// The meaning of the rows, and the reliability of the count.
pub fn mode_remarks(system: &System, modes: &Modes) -> Vec<String> {
    let mut lines = vec![
        format!(
            "This is a count, not a proof: {} of {} starts closed ({}).",
            modes.closed(),
            modes.starts(),
            mode_kinds(modes)
        ),
        search_worth(modes),
    ];
    lines.extend(search_range(system.mechanism(), modes));
    if modes.list.iter().any(|m| m.is_scene) {
        lines.push("* is where the scene's start values lead.".to_owned());
    }
    if modes.list.len() > modes.placements() {
        lines.push(format!(
            "{} modes in {}: in those of one placement, only links without a body differ.",
            modes.list.len(),
            counted_things(modes.placements(), "placement")
        ));
    }
    lines.extend(second_angles(system, modes));
    if modes.list.iter().any(|m| m.dimension > 0) {
        lines.push("~ is one point of a continuous set of solutions.".to_owned());
    }
    let meeting = |m: &&Mode| m.is_singular && m.dimension == 0;
    let meeting = modes.list.iter().filter(meeting).count();
    if meeting > 0 {
        lines.push(format!(
            "{} singular: assemblies meet there, unless a set of solutions passes that could not be followed.",
            match meeting {
                1 => "1 mode is".to_owned(),
                n => format!("{n} modes are"),
            }
        ));
    }
    lines
}

/// The results of each kind of starts.
fn mode_kinds(modes: &Modes) -> String {
    let made = modes.tallies.iter().filter(|(_, tally)| tally.starts > 0);
    let parts = made.map(|(kind, tally)| {
        let new = counted_things(tally.new, "new placement");
        format!("{} {}: {new}", tally.starts, kind_words(*kind))
    });
    parts.collect::<Vec<_>>().join(", ")
}

/// A kind of starts, as in `500 random`.
pub const fn kind_words(kind: StartKind) -> &'static str {
    match kind {
        StartKind::Scene => "of the scene",
        StartKind::Random => "random",
        StartKind::Mirrored => "mirrored",
        StartKind::Continued => "continued",
    }
}

/// An estimate of what is missing.
fn search_worth(modes: &Modes) -> String {
    let left = match modes.unseen {
        0.0 => format!(
            "no placement was reached by one random start only: another has an estimated chance below {UNSEEN:.0e} (Good-Turing)"
        ),
        chance => format!(
            "one more random start leads to a new placement with an estimated chance of {chance:.1e} (Good-Turing)"
        ),
    };
    let mut text = match modes.is_exhausted {
        false if modes.is_hopeless => format!("There are far more placements: {left}."),
        true if modes.unseen > 0.0 => {
            format!("The search ended since {left}, below {UNSEEN:.0e}.")
        }
        true => format!("The search ended since {left}."),
        false => {
            format!("The search ended with its starts; more --starts may find more, since {left}.")
        }
    };
    if modes.unlikely > 0 && modes.is_exhausted {
        text.push_str(&format!(
            " No random start led to {} of them, so there may be others of that kind.",
            modes.unlikely
        ));
    }
    text
}

/// How far the random starts reached where no link says how far there may be assemblies.
fn search_range(mechanism: &Mechanism, modes: &Modes) -> Option<String> {
    let reaches = modes.reaches.iter().map(|(slot, reach)| {
        let unknown = &mechanism.unknowns[*slot];
        let (value, unit) = match unknown.kind {
            Kind::Angle => {
                let unit = &mechanism.angle_unit;
                (reach / unit.radians.number(), format!(" {}", unit.name))
            }
            Kind::Length => (*reach, format!(" {}", mechanism.length_unit)),
            Kind::Number => (*reach, String::new()),
        };
        format!("`{}` up to {}{unit}", unknown.name, at_least_three(value))
    });
    let list = reaches.collect::<Vec<_>>().join(", ");
    (!list.is_empty()).then(|| {
        format!(
            "Random starts took {list} from zero: the estimate says nothing of what is farther out, or of roots that lie far closer together."
        )
    })
}

/// That ball joints have two sets of angles.
fn second_angles(system: &System, modes: &Modes) -> Option<String> {
    let mechanism = system.mechanism();
    let mut balls: Vec<usize> = Vec::new();
    for mode in &modes.list {
        balls.extend(&mode.renamed_balls);
    }
    balls.sort_unstable();
    balls.dedup();
    let wrists = balls.iter().map(|ball| {
        let slots = system.balls()[*ball].slots.into_iter();
        slot_names(mechanism, slots).join(", ")
    });
    let wrists: Vec<String> = wrists.collect();
    (!wrists.is_empty()).then(|| {
        format!(
            "Wrist angles ({}) have two sets of values for every placement: {} names in all, of which those with the smallest angles are listed.",
            wrists.join("; "),
            modes.names()
        )
    })
}
