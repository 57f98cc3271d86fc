//! Messages about the events of a motion on standard error, and the resulting outcome.

use crate::cli::open::mode;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::kinematics::motion::feasible::feasible_inputs;
use crate::kinematics::results::trajectory::{Event, EventKind, Trajectory};
use crate::kinematics::solve::wishes::StartPreferences;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Coordinate;
use crate::report::event_sentences::{event_sentence, gap_sentence};
use crate::report::sentences::{counted_things, samples_without_pose, with_unit};

/// Maximum number of events that are printed one by one.
const MAX_LINES: usize = 12;

/// Reports the events; a motion without any pose is a failure.
pub fn tell_events(
    system: &System,
    actuation: &Actuation,
    trajectory: &Trajectory,
    term: &Term,
) -> Result<Outcome, Failure> {
    if trajectory.poses().next().is_none() {
        return Err(never_closed(system, actuation, trajectory));
    }
    let mechanism = system.mechanism();
    let is_limit = |e: &&Event| matches!(e.kind, EventKind::LimitPosition { .. });
    let told = |e: &&Event| !e.kind.is_told_by_gap() && !is_limit(e);
    let gaps = trajectory.gaps.iter().map(|g| gap_sentence(mechanism, g));
    let events = trajectory.events.iter().filter(told);
    let lines: Vec<String> = gaps
        .chain(events.map(|e| event_sentence(mechanism, e)))
        .collect();
    for line in lines.iter().take(MAX_LINES) {
        term.warning(line);
    }
    if lines.len() > MAX_LINES {
        term.warning(&format!("and {} more events", lines.len() - MAX_LINES));
    }
    let limits = trajectory.events.iter();
    for event in limits.filter(is_limit) {
        term.note(&event_sentence(mechanism, event));
    }
    let missing = trajectory.missing();
    if trajectory.is_whole() {
        return Ok(Outcome::Done);
    }
    term.warning(&match missing {
        0 => "every sample has a pose, but not every instant between them".to_owned(),
        _ => samples_without_pose(missing, trajectory.asked()),
    });
    if trajectory.is_undecided() {
        return Ok(Outcome::Undecided);
    }
    Ok(Outcome::NotClosed)
}

/// Adds an event if the motion starts far from a named start value and another assembly is nearer: probably not the
/// intended one.
///
/// Errors: Ctrl-C.
pub fn note_moved_start(
    system: &System,
    actuation: &Actuation,
    trajectory: &mut Trajectory,
) -> Result<(), Failure> {
    let mechanism = system.mechanism();
    let first = trajectory.samples.first().filter(|s| s.time == 0.0);
    let Some((first, pose)) = first.and_then(|s| Some((s, s.pose.as_ref()?))) else {
        return Ok(());
    };
    let start = actuation.start_at(first.time);
    let wishes = StartPreferences::new(mechanism, &start, &actuation.named);
    if !wishes.are_missed(&pose.unknowns) {
        return Ok(());
    }
    let Some(nearer) = mode::nearer_mode(system, actuation, &wishes, &pose.unknowns)? else {
        return Ok(());
    };
    let unknown = nearer.unknown;
    let Coordinate { name, kind } = &mechanism.unknowns[unknown];
    let event = Event {
        time: first.time,
        inputs: first.inputs.clone(),
        kind: EventKind::StartMoved {
            name: name.clone(),
            measure: *kind,
            wanted: start[unknown],
            found: pose.unknowns[unknown],
            nearer: nearer.value,
            mode: nearer.mode,
        },
    };
    trajectory.events.insert(0, event);
    Ok(())
}

fn never_closed(system: &System, actuation: &Actuation, trajectory: &Trajectory) -> Failure {
    let mechanism = system.mechanism();
    let first = trajectory.events.first();
    let message = first.map_or_else(
        || "no pose was found".to_owned(),
        |event| event_sentence(mechanism, event),
    );
    let mut hints: Vec<String> = first
        .into_iter()
        .filter_map(|e| event_contradiction(system, e))
        .collect();
    // Where no assembly has a pose, no start values help.
    let is_proved = first
        .is_some_and(|event| matches!(event.kind, EventKind::StartNotClosed { proved: true, .. }));
    hints.extend(match is_proved {
        true => vec!["change the inputs, or dimensions: no assembly has a pose here".to_owned()],
        false => vec![
            "give start values nearer to a pose: `[guess]` in the scene or --guess NAME=VALUE"
                .to_owned(),
            "or change the inputs: the mechanism may not reach this far".to_owned(),
        ],
    });
    for feasible in feasible_inputs(system, actuation) {
        let input = &mechanism.inputs[feasible.input];
        let value = |v: f64| with_unit(mechanism, input.kind, v);
        // The given value has no pose, however near to it others have one.
        let given = actuation.inputs_at(0.0)[feasible.input];
        let end = |v: f64| match value(v) == value(given) {
            true if v < given => format!("just below {}", value(v)),
            true if v > given => format!("just above {}", value(v)),
            _ => value(v),
        };
        let stretches = feasible.stretches.iter();
        let list: Vec<String> = stretches
            .map(|[from, to]| match value(*from) == value(*to) {
                true => format!("near {}", value(*from)),
                false => format!("from {} to {}", end(*from), end(*to)),
            })
            .collect();
        hints.push(format!(
            "poses were found for `{}` {}",
            input.name,
            list.join(", and ")
        ));
    }
    Failure::without_pose(trajectory.is_undecided(), message, hints)
}

/// The message for a loop that does not close because it has fewer unknowns than equations.
fn event_contradiction(system: &System, event: &Event) -> Option<String> {
    let mechanism = system.mechanism();
    let EventKind::StartNotClosed { name, .. } = &event.kind else {
        return None;
    };
    let block = system.structure().overfull_block(mechanism, name)?;
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
        "`{name}` has {} and {}: {fit} exactly",
        counted_things(rows, "equation"),
        counted_things(unknowns, "unknown")
    ))
}
