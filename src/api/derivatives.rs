//! Exact derivatives of a motion's values with respect to parameters of its scene.

use super::error::{Error, ErrorKind, find_column};
use super::loaded::Loaded;
use super::motion::Motion;
use crate::analysis::study::{FamilyError, MeasureSlopes, ParametricMechanism};
use crate::kinematics::abreast::pose_group::PoseGroup;
use crate::kinematics::loops::observed::{dependencies, needed_slots};
use crate::kinematics::results::columns::ValueColumn;
use crate::model::mechanism::{Mechanism, OutputSource};
use crate::numbers::octet::LANES;
use crate::scene::KeptIn;

impl Motion {
    /// The derivatives of values with respect to parameters at every sample, exact to rounding. They solve the
    /// linearised loop-closure equations; there are no finite differences, except where a parameter changes the solids of a
    /// distance (about nine digits). They apply to the motion's assembly mode, at fixed times and inputs.
    ///
    /// The result has the shape samples × `names` × `parameters`, the last index varying fastest, in units of the value
    /// per unit of the parameter as used in the scene. It is `NaN` where a sample has no pose, and at singular poses.
    ///
    /// Errors: an unknown value or parameter; a parameter that is not a plain number or that affects the structure, a drive or
    /// the axis of a rotation; a value that contains rates.
    ///
    /// ```
    /// // h = r cos(phi) + sqrt(L² - r² sin²(phi)): at phi = 0 it grows with L one to one.
    /// let scene = mechanim::Scene::builtin("slider-crank")?;
    /// let motion = scene.solve(mechanim::Samples::At(vec![0.0]))?;
    /// let slopes = motion.jacobian(&["h"], &["r", "L"])?;
    /// assert!((slopes[1] - 1.0).abs() < 1e-12);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn jacobian(&self, names: &[&str], parameters: &[&str]) -> Result<Vec<f64>, Error> {
        let mechanism = &self.loaded.scene.mechanism;
        let columns: Vec<ValueColumn> = names
            .iter()
            .map(|name| find_column(mechanism, name))
            .collect::<Result<_, Error>>()?;
        let family = varied(&self.loaded, parameters)?;
        let varied = family.mechanism();
        let (own, nominal) = (mechanism.inputs.len(), family.start());
        let slots: Vec<usize> = columns.iter().map(|c| c.slot(varied)).collect();
        for (name, slot) in names.iter().zip(&slots) {
            refuse_rates(varied, name, &dependencies(varied, &[*slot]))?;
        }
        let needed = dependencies(varied, &slots);
        let units = units(mechanism, varied, &columns);
        let moved: Vec<usize> = (own..own + parameters.len()).collect();
        let mut group = PoseGroup::new(family.system());
        let width = columns.len() * parameters.len();
        let mut slopes = vec![f64::NAN; self.len() * width];
        // Eight samples at a time, so that memory does not grow with their number.
        let samples = self.trajectory.samples.chunks(LANES);
        for (rows, samples) in slopes.chunks_mut((LANES * width).max(1)).zip(samples) {
            let rows = rows.chunks_mut(width.max(1)).zip(samples);
            let (mut rows, places): (Vec<_>, Vec<_>) = rows
                .filter_map(|(row, sample)| {
                    let pose = sample.pose.as_ref()?;
                    let place = [pose.unknowns.as_slice(), &sample.inputs, &nominal].concat();
                    Some((row, place))
                })
                .unzip();
            let sensitivities = group.sensitivities(&places, &moved);
            for ((row, place), sensitivity) in rows.iter_mut().zip(&places).zip(&sensitivities) {
                let values = needed_slots(varied, place, |slot| needed[slot]);
                let known = (&values[..], &needed[..]);
                let found = MeasureSlopes::new(varied, &moved, known, sensitivity);
                let by_slot = slots
                    .iter()
                    .flat_map(|s| found.rows.iter().map(|row| row[*s]));
                for ((entry, slope), unit) in row.iter_mut().zip(by_slot).zip(&units) {
                    *entry = if slope.is_finite() {
                        slope * unit
                    } else {
                        f64::NAN
                    };
                }
            }
        }
        Ok(slopes)
    }
}

/// Refuses a value that depends on an output with rates: these exist along a motion only, which its derivatives would change.
fn refuse_rates(mechanism: &Mechanism, name: &str, needed: &[bool]) -> Result<(), Error> {
    let is_rated = |k: usize| {
        let output = ValueColumn::Output(k).slot(mechanism);
        let rated = matches!(mechanism.outputs[k].source, OutputSource::Rated(_));
        rated && needed.get(output) == Some(&true)
    };
    if !(0..mechanism.outputs.len()).any(is_rated) {
        return Ok(());
    }
    let why = format!("`{name}` contains rates, whose derivatives by parameters are not computed");
    Err(Error::new(ErrorKind::Argument, why, Vec::new()))
}

/// The same scene with parameters as additional inputs.
fn varied(loaded: &Loaded, parameters: &[&str]) -> Result<ParametricMechanism, Error> {
    for (k, name) in parameters.iter().enumerate() {
        if parameters[..k].contains(name) {
            let why = format!("the parameter `{name}` is named twice");
            return Err(Error::new(ErrorKind::Argument, why, Vec::new()));
        }
    }
    let names = parameters.iter().map(|name| (*name).to_owned()).collect();
    let (text, size) = (&loaded.text, loaded.scene.mechanism.size);
    let family = ParametricMechanism::of(text, &loaded.overrides, names, size)?;
    // What a formula says of the drive does not matter for rows of inputs.
    let is_driven_by_rows = loaded.overrides.drives.is_some();
    let mut kept = family.kept.iter();
    let lost = kept.find(|kept| match kept.place {
        KeptIn::Drive => !is_driven_by_rows,
        place => place == KeptIn::Direction,
    });
    match lost {
        Some(kept) => Err(FamilyError::Kept(kept.clone()).into()),
        None => Ok(family),
    }
}

/// Factors that convert internal derivatives to the file's units, one for each pair of value and parameter.
fn units(mechanism: &Mechanism, varied: &Mechanism, columns: &[ValueColumn]) -> Vec<f64> {
    let parameters = &varied.inputs[mechanism.inputs.len()..];
    let pairs = columns.iter().flat_map(|column| {
        let value = mechanism.file_units(column.kind(mechanism));
        let parameters = parameters.iter();
        parameters.map(move |p| value / mechanism.file_units(p.kind))
    });
    pairs.collect()
}
