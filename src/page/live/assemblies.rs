//! The assemblies of a live scene: found where its motion starts, and chosen by their start values.

use super::following::named_values;
use super::session::{LiveError, LiveScene, guess_text, opened_scene};
use crate::kinematics::assemblies::{DEFAULT_STARTS, Mode, find_modes};
use crate::report::assemblies::modes_headline;
use crate::scene::Overrides;
use serde_json::{Value, json};

impl LiveScene {
    /// The assemblies at the start of the motion, as `modes` counts them, each with the start values that lead to it.
    ///
    /// Errors: an input without a value at the start.
    pub(super) fn assemblies(&self) -> Result<Value, LiveError> {
        let (mechanism, actuation) = (self.mechanism(), &self.now.scene.actuation);
        let start = actuation.start_at(0.0);
        let (_, inputs) = start.split_at(actuation.guess.len());
        if let Some(k) = inputs.iter().position(|value| !value.is_finite()) {
            let name = &mechanism.inputs[k].name;
            let why = format!("input `{name}` has no value at t = 0 s");
            return Err(LiveError::Request(why));
        }
        let (system, named) = (&self.now.system, &actuation.named);
        let modes = find_modes(system, &start, named, DEFAULT_STARTS, &|| false);
        let mut list: Vec<&Mode> = Vec::new();
        for mode in &modes.list {
            // The first name of every placement, unless the motion itself has another.
            match list.last_mut() {
                Some(last) if last.placement == mode.placement => {
                    if mode.is_scene {
                        *last = mode;
                    }
                }
                _ => list.push(mode),
            }
        }
        let shown = list.into_iter().map(|mode| {
            let pose = named_values(mechanism, &mode.coordinates);
            json!({
                "label": mode_label(mode),
                "now": mode.is_scene,
                "guess": guess_text(mechanism, &pose),
            })
        });
        Ok(json!({
            "headline": modes_headline(mechanism, &modes),
            "assemblies": shown.collect::<Vec<_>>(),
        }))
    }

    /// Assembles the mechanism from other start values, with the present parameters.
    ///
    /// Errors: start values from which no motion begins; everything stays as it is.
    pub fn choose(&mut self, guess: Vec<(String, String)>) -> Result<(), LiveError> {
        let changed = Overrides {
            guess,
            ..self.overrides.clone()
        };
        let now = opened_scene(&self.text, &changed, &self.asked)?;
        if now.first_pose().is_none() {
            let why = "no motion begins at this assembly";
            return Err(LiveError::Request(why.to_owned()));
        }
        self.adopt(changed, now);
        Ok(())
    }
}

/// `3: +-, smallest singular value 2.7e-2`
fn mode_label(mode: &Mode) -> String {
    let branch = match mode.branch.is_empty() {
        true => String::new(),
        false => format!(" {},", mode.branch),
    };
    let kind = match (mode.dimension, mode.is_singular) {
        (0, false) => "",
        (0, true) => ", singular",
        _ => ", one of a continuous set",
    };
    format!(
        "{}:{branch} smallest singular value {:.1e}{kind}",
        mode.placement, mode.sigma_min
    )
}
