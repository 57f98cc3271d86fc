//! Assembly modes for given input values.

use super::error::{Error, ErrorKind};
use super::loaded::Loaded;
use crate::kinematics::assemblies::{DEFAULT_STARTS, find_modes};

/// One of the assembly modes of a mechanism at the same input values.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Assembly {
    /// Signature of the assembly mode: one sign per block of equations.
    pub branch: String,
    /// Every unknown by name, in the scene's units.
    pub values: Vec<(String, f64)>,
    /// Assemblies with the same number place the bodies identically.
    pub placement: usize,
    /// Whether the pose is singular: assembly modes meet here, or it is a point of a continuous set.
    pub is_singular: bool,
}

impl Assembly {
    pub(super) fn search(loaded: &Loaded, time: f64) -> Result<Vec<Self>, Error> {
        let (mechanism, actuation) = (&loaded.scene.mechanism, &loaded.scene.actuation);
        let start = actuation.start_at(time);
        let (_, inputs) = start.split_at(actuation.guess.len());
        if let Some(k) = inputs.iter().position(|value| !value.is_finite()) {
            let name = &mechanism.inputs[k].name;
            let why = format!("input `{name}` has no value at t = {time} s");
            return Err(Error::new(ErrorKind::Argument, why, Vec::new()));
        }
        let named = &actuation.named;
        let modes = find_modes(&loaded.system, &start, named, DEFAULT_STARTS, &|| false);
        let list = modes.list.into_iter().map(|mode| {
            let unknowns = mechanism.unknowns.iter().zip(&mode.coordinates);
            let values = unknowns.map(|(c, v)| (c.name.clone(), v * mechanism.file_units(c.kind)));
            Self {
                values: values.collect(),
                branch: mode.branch,
                placement: mode.placement,
                is_singular: mode.is_singular,
            }
        });
        Ok(list.collect())
    }
}
