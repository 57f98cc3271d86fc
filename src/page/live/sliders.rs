//! The sliders: the dimensions of a scene with their ranges, and its inputs.

use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::as_typed;
use crate::model::study::Variable;
use crate::scene::text::SceneText;
use crate::scene::{Overrides, Scene};
use serde_json::{Value, json};

/// Range of a dimension without one of its own, as a fraction of its value.
const SHARE: f64 = 0.3;

/// Range of a dimension with value zero, as a fraction of the mechanism's size, or as an angle.
const SHARE_OF_SIZE: f64 = 0.1;
const ANGLE: f64 = 0.35;

/// Inputs can be moved beyond their range in the motion by this fraction of it.
const BEYOND: f64 = 0.5;

/// The dimensions that a scene gives as numbers, the variables of its study first; none if they cannot be varied.
pub(super) fn dimensions(text: &SceneText, overrides: &Overrides, scene: &Scene) -> Vec<Value> {
    let own = scene.study.iter().flat_map(|s| &s.variables);
    let mut names: Vec<String> = own.map(|v| v.name.clone()).collect();
    let others: Vec<String> = scene
        .dimensions
        .iter()
        .filter(|n| !names.contains(n))
        .cloned()
        .collect();
    let own = names.len();
    names.extend(others);
    let overrides = Overrides {
        vary: names.clone(),
        ..overrides.clone()
    };
    let varied = text.resolved(&overrides).ok();
    let variables = varied
        .and_then(|scene| scene.study)
        .map_or_else(Vec::new, |s| s.variables.clone());
    let find = |name: &String| variables.iter().find(|v| v.name == *name);
    let found = names
        .iter()
        .enumerate()
        .filter_map(|(k, name)| Some((k, find(name)?)));
    found
        .map(|(k, variable)| dimension_slider(&scene.mechanism, variable, k < own))
        .collect()
}

fn dimension_slider(mechanism: &Mechanism, variable: &Variable, is_studied: bool) -> Value {
    let [low, high] = match is_studied && variable.lower.is_finite() && variable.upper.is_finite() {
        true => [variable.lower, variable.upper],
        false => {
            let half = half_range(mechanism, variable.kind, variable.start);
            [variable.start - half, variable.start + half]
        }
    };
    slider(
        mechanism,
        (&variable.name, variable.kind),
        variable.start,
        [low, high],
    )
}

fn half_range(mechanism: &Mechanism, kind: Kind, value: f64) -> f64 {
    match (value == 0.0, kind) {
        (false, _) => SHARE * value.abs(),
        (true, Kind::Angle) => ANGLE,
        (true, Kind::Length) => SHARE_OF_SIZE * mechanism.size,
        (true, Kind::Number) => SHARE,
    }
}

/// The inputs with their ranges in the motion, extended.
pub(super) fn inputs(mechanism: &Mechanism, motion: &Trajectory) -> Vec<Value> {
    let inputs = mechanism.inputs.iter().enumerate();
    inputs
        .map(|(k, input)| {
            let values = motion.samples.iter().map(|s| s.inputs[k]);
            let values = values.filter(|v| v.is_finite());
            let ends = values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            });
            let [low, high] = if ends[0] <= ends[1] { ends } else { [0.0, 0.0] };
            let more = match high - low {
                0.0 => half_range(mechanism, input.kind, low),
                span => BEYOND * span,
            };
            slider(
                mechanism,
                (&input.name, input.kind),
                low,
                [low - more, high + more],
            )
        })
        .collect()
}

fn slider(
    mechanism: &Mechanism,
    (name, kind): (&str, Kind),
    value: f64,
    [low, high]: [f64; 2],
) -> Value {
    let shown = |v: f64| as_typed(v * mechanism.file_units(kind));
    json!({
        "name": name, "unit": mechanism.unit_name(kind),
        "value": shown(value), "low": shown(low), "high": shown(high),
    })
}
