//! Events of a trajectory in words and the outcome they mean.

use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::kinematics::motion::feasible::feasible_inputs;
use crate::kinematics::results::trajectory::{Event, EventKind, Gap, Instant, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};

/// Angles above this are no rounding of a zero.
const SEEN_ANGLE: f64 = 5e-7;

/// Most events that are printed one by one.
const MAX_LINES: usize = 12;

/// Angles this near to gimbal lock are called locked: what is left is rounding of the way there.
const LOCKED: f64 = 1e-9;

/// Says what happened; a motion without any pose is a failure.
pub fn events(
    system: &System,
    actuation: &Actuation,
    trajectory: &Trajectory,
    term: &Term,
) -> Result<Outcome, Failure> {
    if trajectory.poses().next().is_none() {
        return Err(never_closed(system, actuation, trajectory));
    }
    let mechanism = system.mechanism();
    // What a gap says is not said again as an event.
    let told = |e: &&Event| {
        !matches!(
            e.kind,
            EventKind::MotionEnds
                | EventKind::MotionResumes { same_branch: true }
                | EventKind::LimitPosition { .. }
        )
    };
    let gaps = trajectory.gaps.iter().map(|g| gap_sentence(mechanism, g));
    let events = trajectory.events.iter().filter(told);
    let lines: Vec<String> = gaps.chain(events.map(|e| sentence(mechanism, e))).collect();
    for line in lines.iter().take(MAX_LINES) {
        term.warning(line);
    }
    if lines.len() > MAX_LINES {
        term.warning(&format!("and {} more events", lines.len() - MAX_LINES));
    }
    let limits = trajectory.events.iter();
    for event in limits.filter(|e| matches!(e.kind, EventKind::LimitPosition { .. })) {
        term.note(&sentence(mechanism, event));
    }
    let missing = trajectory.missing();
    if missing == 0 && trajectory.gaps.is_empty() {
        return Ok(Outcome::Done);
    }
    term.warning(&match missing {
        0 => "every sample has a pose, but not every instant between them".to_owned(),
        _ => format!(
            "{missing} of {} samples have no pose",
            trajectory.samples.len()
        ),
    });
    Ok(Outcome::NotClosed)
}

/// A stretch without a pose as a sentence: the feasible interval of the drive ends and begins at its ends.
pub fn gap_sentence(mechanism: &Mechanism, gap: &Gap) -> String {
    let at = |i: &Instant| format!("t = {:.9} s ({})", i.time, inputs(mechanism, &i.inputs));
    let stretch = match (&gap.from, &gap.until) {
        (Some(from), Some(until)) => format!("between {} and {}", at(from), at(until)),
        (Some(from), None) => format!("beyond {}", at(from)),
        (None, Some(until)) => format!("before {}", at(until)),
        (None, None) => "at any sample".to_owned(),
    };
    let lack = gap.widest.as_ref().map_or_else(String::new, |lack| {
        let unit = &mechanism.length_unit;
        let turned = if lack.angle > SEEN_ANGLE {
            format!(" and {:.6} rad", lack.angle)
        } else {
            String::new()
        };
        if !lack.distance.is_finite() {
            let at = inputs(mechanism, &lack.at.inputs);
            return format!("; `{}` has no value at {at}", lack.name);
        }
        let at = inputs(mechanism, &lack.at.inputs);
        if mechanism.equations.iter().any(|e| e.name == lack.name)
            && !mechanism.contacts.contains(&lack.name)
        {
            return format!(
                "; equation `{}` leaves {} at {at}",
                lack.name,
                amount(lack.distance)
            );
        }
        format!(
            "; `{}` stays {} {unit}{turned} open at {at}",
            lack.name,
            amount(lack.distance)
        )
    });
    format!("no pose exists {stretch}{lack}")
}

/// One event as a sentence.
pub fn sentence(mechanism: &Mechanism, event: &Event) -> String {
    let at = format!(
        "t = {:.9} s ({})",
        event.time,
        inputs(mechanism, &event.inputs)
    );
    match &event.kind {
        EventKind::MotionEnds => format!("no pose exists beyond {at}"),
        EventKind::MotionResumes { same_branch: true } => format!("poses exist again from {at} on"),
        EventKind::MotionResumes { same_branch: false } => {
            format!("poses exist again from {at} on, on another branch than before")
        }
        EventKind::SingularPosePassed => format!("singular pose near {at}, passed straight on"),
        EventKind::SingularPoseMet => format!(
            "singular pose at {at}, where the drive turns back: the motion returns on its branch, though another one begins there"
        ),
        EventKind::BranchChosen { taken, others } if others.is_empty() => {
            format!("from {at} on the motion follows branch {taken}, the only one found there")
        }
        EventKind::BranchChosen { taken, others } => format!(
            "of the branches that meet at {at} the motion follows {taken}, the one nearest to the start values; --guess or --mode takes another ({})",
            others.join(", ")
        ),
        EventKind::LimitPosition {
            name,
            measure,
            value,
            is_largest,
        } => {
            let extreme = if *is_largest { "largest" } else { "smallest" };
            let value = with_unit(mechanism, *measure, *value);
            format!("`{name}` is {extreme} at {at}: {value}")
        }
        EventKind::InputUndefined { name } => format!("input `{name}` has no value at {at}"),
        EventKind::StartNotClosed {
            name,
            angle,
            distance,
        } => {
            let unit = &mechanism.length_unit;
            if mechanism.contacts.contains(name) {
                return format!(
                    "contact `{name}` cannot be made at {at}: the best pose found leaves {distance:.6} {unit} between the surfaces"
                );
            }
            if !distance.is_finite() {
                return format!("`{name}` has no value at {at} where the search ended");
            }
            if mechanism.equations.iter().any(|e| e.name == *name) {
                let left = amount(*distance);
                return format!(
                    "equation `{name}` does not hold at {at}: the best pose found leaves {left} in place of zero"
                );
            }
            format!(
                "loop `{name}` does not close at {at}: the best pose found leaves {} {unit} and {angle:.6} rad",
                amount(*distance)
            )
        }
        EventKind::GimbalLock { names, distance } => {
            let [a, b, c] = names;
            let how = if *distance <= LOCKED {
                format!("gimbal-locked coordinates {a}, {b}, {c}")
            } else {
                format!("coordinates {a}, {b}, {c} within {distance:.1e} of gimbal lock")
            };
            format!(
                "{how} at {at}: only the sum or difference of {a} and {c} is determined there; positions are exact"
            )
        }
        EventKind::StartSingular => format!(
            "the motion starts at a singular pose at {at}: rates are infinite or not determined there, and assemblies may meet"
        ),
        EventKind::OtherStart => format!(
            "the start values lead to no pose at {at}; a perturbed start was used, which may be on another branch"
        ),
    }
}

/// What is lacking, in decimals as long as these show it.
fn amount(value: f64) -> String {
    if value == 0.0 || (1e-4..1e7).contains(&value) {
        format!("{value:.6}")
    } else {
        format!("{value:.3e}")
    }
}

/// A radius with as many digits as it needs.
pub fn radius(value: f64) -> String {
    if value < 0.01 {
        format!("{value:.1e}")
    } else {
        format!("{value:.3}")
    }
}

/// `p = -17 mm, phi = 0.2 rad`.
pub fn inputs(mechanism: &Mechanism, values: &[f64]) -> String {
    let pairs = mechanism.inputs.iter().zip(values);
    let texts = pairs.map(|(input, value)| {
        let value = with_unit(mechanism, input.kind, *value);
        format!("{} = {value}", input.name)
    });
    let list = texts.collect::<Vec<_>>().join(", ");
    if list.is_empty() {
        "no inputs".to_owned()
    } else {
        list
    }
}

/// `-17.000000000 mm`.
fn with_unit(mechanism: &Mechanism, kind: Kind, value: f64) -> String {
    let unit = match kind {
        Kind::Angle => format!(" {}", mechanism.angle_unit.name),
        Kind::Length => format!(" {}", mechanism.length_unit),
        Kind::Number => String::new(),
    };
    format!("{:.9}{unit}", value * mechanism.file_units(kind))
}

fn never_closed(system: &System, actuation: &Actuation, trajectory: &Trajectory) -> Failure {
    let mechanism = system.mechanism();
    let first = trajectory.events.first();
    let message = first.map_or_else(
        || "no pose was found".to_owned(),
        |event| sentence(mechanism, event),
    );
    let mut hints: Vec<String> = first
        .into_iter()
        .filter_map(|e| contradiction(system, e))
        .collect();
    hints.extend([
        "give start values nearer to a pose: `[guess]` in the scene or --guess NAME=VALUE"
            .to_owned(),
        "or change the inputs: the mechanism may not reach this far".to_owned(),
    ]);
    for feasible in feasible_inputs(system, actuation) {
        let input = &mechanism.inputs[feasible.input];
        let value = |v: f64| with_unit(mechanism, input.kind, v);
        let stretches = feasible.stretches.iter();
        let list: Vec<String> = stretches
            .map(|[from, to]| format!("{} to {}", value(*from), value(*to)))
            .collect();
        hints.push(format!(
            "poses were found for `{}` from {}",
            input.name,
            list.join(", and from ")
        ));
    }
    Failure::NeverClosed { message, hints }
}

/// What to say when the loop that does not close has too few unknowns for its equations.
fn contradiction(system: &System, event: &Event) -> Option<String> {
    let mechanism = system.mechanism();
    let EventKind::StartNotClosed { name, .. } = &event.kind else {
        return None;
    };
    let block = system.structure().overfull(mechanism, name)?;
    let slots = block
        .arguments
        .iter()
        .flat_map(|a| mechanism.arguments[*a].coordinates());
    let equations = block.equations.iter();
    let mut slots: Vec<usize> = slots
        .chain(equations.flat_map(|e| mechanism.equations[*e].expression.slots()))
        .filter_map(|slot| slot.checked_sub(mechanism.unknowns.len()))
        .collect();
    slots.sort_unstable();
    slots.dedup();
    let (rows, unknowns) = (block.rows(), block.unknowns.len());
    let inputs: Vec<&str> = slots
        .iter()
        .map(|k| mechanism.inputs[*k].name.as_str())
        .collect();
    let fit = match inputs[..] {
        [] => "the dimensions must fit".to_owned(),
        [one] => format!("input {one} and the dimensions must fit"),
        _ => format!(
            "inputs {} contradict each other unless they fit",
            inputs.join(", ")
        ),
    };
    Some(format!(
        "`{name}` has {rows} equations and {unknowns} unknowns: {fit} exactly"
    ))
}
