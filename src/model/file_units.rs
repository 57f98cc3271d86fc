//! The units in which a scene's values are read and written, and their factors.

use super::dimension::PhysicalDimension;
use super::mechanism::{Kind, Mechanism, MechanismOutput};
use super::printed;
use crate::numbers::constant::Constant;

/// Name of the unit of computed angles.
const RADIAN: &str = "rad";

impl Mechanism {
    /// Whether anything in it is as long as something else: not in a scene of equations between numbers and angles.
    pub fn has_lengths(&self) -> bool {
        let mut coordinates = self.unknowns.iter().chain(&self.inputs);
        !self.loops.is_empty()
            || !self.bodies.is_empty()
            || coordinates.any(|coordinate| coordinate.kind == Kind::Length)
    }

    /// Name of the unit of distances between poses; empty where no unknown is a length.
    pub fn pose_unit(&self) -> &str {
        match self.has_lengths() {
            true => &self.length_unit,
            false => "",
        }
    }

    /// Name of the unit in which values of `kind` are read and written; empty for plain numbers.
    pub fn unit_name(&self, kind: Kind) -> &str {
        match kind {
            Kind::Length => &self.length_unit,
            Kind::Angle => &self.angle_unit.name,
            Kind::Number => "",
        }
    }

    /// The unit of an output in words, products and powers among them, and the factor to it from internal values.
    pub fn output_unit(&self, output: &MechanismOutput) -> (String, f64) {
        let angle = &self.angle_unit;
        let radians = angle.radians.number();
        output
            .dimension
            .unit_words(&self.length_unit, &angle.name, radians)
    }

    /// Name of the unit in which tables show an output or a measure. Products, powers and rates with angles are in radians whatever the
    /// file's unit is.
    pub fn table_unit(&self, kind: Kind, dimension: PhysicalDimension) -> String {
        match kind {
            Kind::Length | Kind::Angle => self.unit_name(kind).to_owned(),
            Kind::Number => dimension.unit_words(&self.length_unit, RADIAN, 1.0).0,
        }
    }

    /// Factor from the file's unit to internal values for a coordinate or output of `kind`.
    pub fn unit_of(&self, kind: Kind) -> Constant {
        match kind {
            Kind::Angle => self.angle_unit.radians,
            Kind::Length | Kind::Number => Constant::exact(1.0),
        }
    }

    /// Factor from internal values to the file's unit for a coordinate or output of `kind`.
    pub fn file_units(&self, kind: Kind) -> f64 {
        1.0 / self.unit_of(kind).number()
    }

    /// A length, an angle or a number that is neither large nor small in this mechanism.
    pub fn natural_size(&self, kind: Kind) -> f64 {
        match kind {
            Kind::Length => self.size,
            Kind::Angle | Kind::Number => 1.0,
        }
    }

    /// A value in the file's unit, as a number that is read as the value again: without digits that only the conversion adds.
    pub fn file_value(&self, kind: Kind, value: f64) -> f64 {
        printed::typed_in_unit(value, self.unit_of(kind))
    }

    /// The value that a number in the file's unit has.
    pub fn inner_value(&self, kind: Kind, number: f64) -> f64 {
        number * self.unit_of(kind).number()
    }

    /// The differences between the inputs as a table prints them and `coordinates`: one entry for every coordinate,
    /// zero for the unknowns.
    pub fn printed_rests(&self, coordinates: &[f64]) -> Vec<f64> {
        let mut rests = vec![0.0; coordinates.len()];
        let first = self.unknowns.len();
        for (k, input) in self.inputs.iter().enumerate() {
            rests[first + k] =
                printed::printing_error(coordinates[first + k], self.unit_of(input.kind));
        }
        rests
    }
}
