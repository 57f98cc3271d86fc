//! Drives given by rows of values.

use super::error::{Error, ErrorKind};
use crate::limits::{Resource, current_limits};
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::{Coordinate, Mechanism};
use crate::scene::OtherDrives;

/// Piecewise linear drives of all inputs.
pub(super) fn drives(
    mechanism: &Mechanism,
    times: &[f64],
    columns: &[(&str, &[f64])],
) -> Result<OtherDrives, Error> {
    let refused = |why: String| Error::new(ErrorKind::Argument, why, Vec::new());
    let inputs = &mechanism.inputs;
    for (name, values) in columns {
        if !inputs.iter().any(|input| input.name == *name) {
            let names = inputs.iter().map(|input| input.name.as_str());
            return Err(Error::unknown_name("input", name, names));
        }
        if values.len() != times.len() {
            let [given, wanted] = [values.len(), times.len()];
            return Err(refused(format!(
                "`{name}` has {given} values for {wanted} times"
            )));
        }
        if values.iter().any(|value| !value.is_finite()) {
            return Err(refused(format!("`{name}` has values that are not numbers")));
        }
    }
    let ascend = times.windows(2).all(|pair| pair[0] < pair[1]);
    let (Some(first), Some(last)) = (times.first(), times.last()) else {
        return Err(refused("there is no row".to_owned()));
    };
    if !ascend || *first < 0.0 || !last.is_finite() {
        return Err(refused(
            "times of rows ascend from zero or later".to_owned(),
        ));
    }
    current_limits().allow(
        Resource::Samples,
        (times.len() * (1 + inputs.len())) as f64,
        &"rows of inputs",
    )?;
    let drive = |input: &Coordinate| {
        let mut own = columns.iter().filter(|(name, _)| *name == input.name);
        let (Some((_, values)), None) = (own.next(), own.next()) else {
            return Err(refused(format!(
                "the input `{}` has not one column",
                input.name
            )));
        };
        let inside = |value: &f64| mechanism.inner_value(input.kind, *value);
        Ok(Drive::Keys {
            times: times.to_vec(),
            values: values.iter().map(inside).collect(),
            ease: Ease::Linear,
        })
    };
    Ok(OtherDrives {
        drives: inputs.iter().map(drive).collect::<Result<_, Error>>()?,
        // A single row has no duration.
        duration: if *last > 0.0 { *last } else { 1.0 },
    })
}
