//! A plot as resolved: which quantities of the motion are drawn against which, in which units.

use super::dimension::raised_power;
use super::expression::Expression;
use super::mechanism::Kind;
use super::rate::RateOrder;

/// A plot of the motion; curves of different units are in separate panels.
#[derive(Clone, Debug, PartialEq)]
pub struct Plot {
    /// Its title; may be empty.
    pub title: String,
    /// The quantity on the horizontal axis.
    pub x: Abscissa,
    /// The curves.
    pub y: Vec<PlotCurve>,
    /// Whether both axes have the same scale: for paths in a plane.
    pub equal: bool,
    /// Reference points, in the units of the axes.
    pub marks: Vec<[f64; 2]>,
    /// Reference lines, in the units of the axes.
    pub lines: Vec<[[f64; 2]; 2]>,
}

/// The horizontal axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub enum Abscissa {
    /// Seconds of the drive.
    Time,
    /// A quantity of the motion.
    Quantity(PlotCurve),
}

/// A quantity of the motion.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotCurve {
    /// Name for people.
    pub label: String,
    /// Unit in which it is drawn; empty for plain numbers.
    pub unit: String,
    /// From internal values (radians, the scene's length unit) to that unit.
    pub factor: f64,
    /// Slots: coordinates, then x, y, z of every trace, outputs, and `rates`.
    pub expression: Expression,
    /// The kind of the expression.
    pub kind: Kind,
    /// Whether its rate is drawn instead of itself.
    pub rate: Option<RateOrder>,
    /// The rates it uses, of formulas with the same slots.
    pub rates: Vec<(Expression, RateOrder)>,
}

/// Unit and factor of a rate from those of the quantity and of its variable.
pub fn rate_unit(
    (unit, factor): (&str, f64),
    (per, per_factor): (&str, f64),
    order: usize,
) -> (String, f64) {
    let power = |k: usize| raised_power(k as i32);
    let text = match (unit, per) {
        (unit, "") => unit.to_owned(),
        (unit, per) if unit == per && order == 1 => String::new(),
        (unit, per) if unit == per => format!("1/{per}{}", power(order - 1)),
        ("", per) => format!("1/{per}{}", power(order)),
        (unit, per) => format!("{unit}/{per}{}", power(order)),
    };
    (text, factor / per_factor.powi(order as i32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_of_rates() {
        for (unit, per, order, expected) in [
            ("mm", "s", 1, "mm/s"),
            ("mm", "deg", 2, "mm/deg²"),
            ("deg", "deg", 1, ""),
            ("rad", "rad", 3, "1/rad²"),
            ("", "s", 4, "1/s⁴"),
            ("mm", "", 6, "mm"),
            ("mm", "s", 6, "mm/s^6"),
        ] {
            assert_eq!(rate_unit((unit, 1.0), (per, 1.0), order).0, expected);
        }
        assert_eq!(rate_unit(("deg", 8.0), ("deg", 2.0), 2).1, 2.0);
    }
}
