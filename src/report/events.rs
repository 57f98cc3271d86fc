//! Events and intervals without a pose as JSON, in the scene's units.

use crate::kinematics::results::trajectory::{
    Ending, Event, EventKind, Instant, MotionGap, RemainingGap, Trajectory,
};
use crate::model::mechanism::Mechanism;
use serde_json::{Map, Value, json};

/// All events of a motion: kind, time, inputs, and further data of the kind.
pub fn event_list(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<Value> {
    let events = trajectory.events.iter();
    events.map(|e| event_value(mechanism, e)).collect()
}

fn event_value(mechanism: &Mechanism, event: &Event) -> Value {
    let kind = match &event.kind {
        EventKind::MotionEnds(_) => "motion-ends",
        EventKind::MotionResumes { .. } => "motion-resumes",
        EventKind::SingularPosePassed => "singular-pose-passed",
        EventKind::SingularPoseMet => "singular-pose-met",
        EventKind::BranchChosen { .. } => "branch-chosen",
        EventKind::LimitPosition { .. } => "limit-position",
        EventKind::InputUndefined { .. } => "input-undefined",
        EventKind::StartNotClosed { .. } => "start-not-closed",
        EventKind::GimbalLock { .. } => "gimbal-lock",
        EventKind::StartSingular => "start-singular",
        EventKind::StartMoved { .. } => "start-moved",
        EventKind::AxesParallel { .. } => "axes-parallel",
        EventKind::OtherStart => "other-start",
    };
    let mut object = Map::new();
    object.insert("kind".to_owned(), json!(kind));
    object.insert("time".to_owned(), json!(event.time));
    object.insert(
        "inputs".to_owned(),
        input_values(mechanism, &event.inputs).into(),
    );
    match &event.kind {
        EventKind::MotionEnds(ending) => {
            object.insert("ending".to_owned(), self::ending_value(ending));
        }
        EventKind::MotionResumes { same_branch } => {
            object.insert("same_branch".to_owned(), json!(same_branch));
        }
        EventKind::LimitPosition {
            name,
            measure,
            value,
            is_largest,
        } => {
            let extreme = if *is_largest { "largest" } else { "smallest" };
            object.insert("coordinate".to_owned(), json!(name));
            object.insert(
                "value".to_owned(),
                json!(value * mechanism.file_units(*measure)),
            );
            object.insert("extreme".to_owned(), json!(extreme));
        }
        EventKind::AxesParallel { contact } => {
            object.insert("contact".to_owned(), json!(contact));
        }
        EventKind::StartMoved {
            name,
            measure,
            wanted,
            found,
            mode,
            ..
        } => {
            let units = mechanism.file_units(*measure);
            object.insert("coordinate".to_owned(), json!(name));
            object.insert("start".to_owned(), json!(wanted * units));
            object.insert("value".to_owned(), json!(found * units));
            object.insert("mode".to_owned(), json!(mode));
        }
        EventKind::BranchChosen { taken, others } => {
            object.insert("branch".to_owned(), json!(taken));
            object.insert("others".to_owned(), json!(others));
        }
        EventKind::StartNotClosed { proved, .. } | EventKind::InputUndefined { proved, .. } => {
            object.insert("proved".to_owned(), json!(proved));
        }
        EventKind::GimbalLock { names, distance } => {
            object.insert("coordinates".to_owned(), json!(names));
            object.insert("distance".to_owned(), json!(distance));
        }
        _ => {}
    }
    object.into()
}

/// The kind of a motion's end, in a word, and its certainty.
fn ending_value(ending: &Ending) -> Value {
    let word = ending.word();
    match ending {
        Ending::Fold { proved, .. } => json!({ "kind": word, "proved": proved }),
        Ending::NoValue { name, proved, .. } => {
            json!({ "kind": word, "equation": name, "proved": proved })
        }
        Ending::InputUndefined { name, proved } => {
            json!({ "kind": word, "input": name, "proved": proved })
        }
        Ending::GivenUp { sigma_min } => json!({ "kind": word, "sigma_min": sigma_min }),
        Ending::Jump { name } => json!({ "kind": word, "formula": name }),
        Ending::AngleTooLarge | Ending::NotFound => json!({ "kind": word }),
    }
}

/// All intervals without a pose: where poses end, where they begin again, and the closure error in between; null if the
/// drive begins or ends inside.
pub fn gap_list(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<Value> {
    let gaps = trajectory.gaps.iter();
    gaps.map(|g| gap_value(mechanism, g)).collect()
}

fn gap_value(mechanism: &Mechanism, gap: &MotionGap) -> Value {
    json!({
        "from": gap.from.as_ref().map(|at| instant_value(mechanism, at)),
        "until": gap.until.as_ref().map(|at| instant_value(mechanism, at)),
        "ending": gap.ending.as_ref().map(ending_value),
        "beginning": gap.beginning.as_ref().map(ending_value),
        "widest": gap.widest.as_ref().map(|lack| self::lack_value(mechanism, lack)),
    })
}

fn instant_value(mechanism: &Mechanism, at: &Instant) -> Value {
    json!({ "time": at.time, "inputs": input_values(mechanism, &at.inputs) })
}

/// The angle is in radians, like all angles of proofs.
fn lack_value(mechanism: &Mechanism, lack: &RemainingGap) -> Value {
    json!({
        "time": lack.at.time,
        "inputs": input_values(mechanism, &lack.at.inputs),
        "loop": lack.name,
        "angle": lack.angle,
        "distance": lack.distance,
        "proved": lack.proved,
    })
}

fn input_values(mechanism: &Mechanism, values: &[f64]) -> Map<String, Value> {
    let pairs = mechanism.inputs.iter().zip(values);
    // An input without a value is null.
    let named = pairs.map(|(input, v)| {
        let value = v * mechanism.file_units(input.kind);
        (input.name.clone(), json!(value))
    });
    named.collect()
}
