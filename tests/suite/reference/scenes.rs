//! Built-in and written scenes for tests, and the values of their poses by name.

use crate::driven::Model;
use mechanim::diag::Source;
use mechanim::kinematics::results::trajectory::{ClosedPose, Trajectory};

use mechanim::scene::{Overrides, builtin, load_scene};

/// A built-in scene with some parameters and start values of its own.
pub fn scene(name: &str, parameters: &[(&str, &str)], guess: &[(&str, &str)]) -> Model {
    let pairs = |list: &[(&str, &str)]| -> Vec<(String, String)> {
        let owned = list.iter().map(|(n, v)| (n.to_string(), v.to_string()));
        owned.collect()
    };
    let overrides = Overrides {
        parameters: pairs(parameters),
        guess: pairs(guess),
        ..Overrides::default()
    };
    let loaded = load_scene(&builtin::find_builtin(name).unwrap(), &overrides);
    Model::from(loaded.unwrap_or_else(|e| panic!("{name}: {:#?}", e.diagnostics)))
}

/// The scene of a text.
pub fn written(text: &str) -> Model {
    let source = Source {
        name: "test".to_owned(),
        text: text.to_owned(),
    };
    let loaded = load_scene(&source, &Overrides::default());
    Model::from(loaded.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics)))
}

/// An unknown or output by its name, in the file's units.
pub fn value(mechanism: &Model, pose: &ClosedPose, name: &str) -> f64 {
    if let Some(k) = mechanism.unknowns.iter().position(|c| c.name == name) {
        return pose.unknowns[k] * mechanism.file_units(mechanism.unknowns[k].kind);
    }
    let k = mechanism.outputs.iter().position(|o| o.name == name);
    let k = k.unwrap_or_else(|| panic!("no `{name}`"));
    pose.outputs[k] * mechanism.file_units(mechanism.outputs[k].kind)
}

/// Every pose of a motion that has no gap.
pub fn whole(trajectory: &Trajectory) -> Vec<&ClosedPose> {
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    trajectory.poses().collect()
}

/// Difference of two angles, up to whole turns.
pub fn turned(difference: f64, turn: f64) -> f64 {
    difference - turn * (difference / turn).round()
}
