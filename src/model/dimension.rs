//! What coordinates and formulas measure: lengths, angles and numbers, powers and products of these, and their units.

use std::ops::{Add, Mul, Sub};

/// The kind of a coordinate or an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// In the scene's length unit.
    Length,
    /// In radians inside the program, in the scene's angle unit in files.
    Angle,
    /// A plain number.
    Number,
}

impl Kind {
    /// The word used in messages.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::Angle => "angle",
            Self::Number => "number",
        }
    }
}

/// Powers of the three units that a scene has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PhysicalDimension {
    length: i32,
    angle: i32,
    time: i32,
}

impl PhysicalDimension {
    /// A plain number.
    pub const NUMBER: Self = Self {
        length: 0,
        angle: 0,
        time: 0,
    };
    /// Seconds.
    pub const TIME: Self = Self {
        time: 1,
        ..Self::NUMBER
    };

    /// That of a coordinate.
    pub const fn of(kind: Kind) -> Self {
        match kind {
            Kind::Length => Self {
                length: 1,
                ..Self::NUMBER
            },
            Kind::Angle => Self {
                angle: 1,
                ..Self::NUMBER
            },
            Kind::Number => Self::NUMBER,
        }
    }

    /// The kind of a coordinate with this dimension; a number if it is neither a length nor an angle.
    pub fn kind(self) -> Kind {
        match self.shown_powers() {
            shown if shown == Self::of(Kind::Length) => Kind::Length,
            shown if shown == Self::of(Kind::Angle) => Kind::Angle,
            _ => Kind::Number,
        }
    }

    /// Whether it is of an angle, of a power of one, or of a product with one.
    pub fn holds_angle(self) -> bool {
        self.angle != 0
    }

    /// Whether it is of a number, or of a product of angles alone.
    pub fn is_without_length(self) -> bool {
        self.length == 0 && self.time == 0
    }

    /// Half of every power, if there is one.
    pub fn half_powers(self) -> Self {
        let even = [self.length, self.angle, self.time];
        match even.iter().all(|power| power % 2 == 0) {
            true => Self {
                length: self.length / 2,
                angle: self.angle / 2,
                time: self.time / 2,
            },
            false => Self::NUMBER,
        }
    }

    /// Together with a length an angle is a number of radians: the arc on a radius.
    fn shown_powers(self) -> Self {
        match self.length != 0 && self.angle > 0 {
            true => Self { angle: 0, ..self },
            false => self,
        }
    }

    /// The unit in words, and the factor to it from internal values; `radians` are those of the angle's unit.
    pub fn unit_words(self, length: &str, angle: &str, radians: f64) -> (String, f64) {
        let shown = self.shown_powers();
        let powers = [
            (length, shown.length),
            (angle, shown.angle),
            ("s", shown.time),
        ];
        let product = |sign: i32| {
            let parts = powers.iter().filter(|(_, power)| power * sign > 0);
            let parts = parts.map(|(unit, power)| format!("{unit}{}", raised_power(power.abs())));
            let parts: Vec<String> = parts.collect();
            // A product below the line is one thing.
            match sign < 0 && parts.len() > 1 {
                true => format!("({})", parts.join("·")),
                false => parts.join("·"),
            }
        };
        let text = match (product(1), product(-1)) {
            (above, below) if below.is_empty() => above,
            (above, below) if above.is_empty() => format!("1/{below}"),
            (above, below) => format!("{above}/{below}"),
        };
        (text, radians.powi(-shown.angle))
    }
}

/// The sign of a power.
pub fn raised_power(power: i32) -> String {
    match power {
        1 => String::new(),
        2 => "²".to_owned(),
        3 => "³".to_owned(),
        4 => "⁴".to_owned(),
        power => format!("^{power}"),
    }
}

impl Add for PhysicalDimension {
    type Output = Self;

    /// That of a product.
    fn add(self, other: Self) -> Self {
        Self {
            length: self.length + other.length,
            angle: self.angle + other.angle,
            time: self.time + other.time,
        }
    }
}

impl Sub for PhysicalDimension {
    type Output = Self;

    /// That of a quotient.
    fn sub(self, other: Self) -> Self {
        self + other * -1
    }
}

impl Mul<i32> for PhysicalDimension {
    type Output = Self;

    /// That of a power.
    fn mul(self, power: i32) -> Self {
        Self {
            length: self.length * power,
            angle: self.angle * power,
            time: self.time * power,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const L: PhysicalDimension = PhysicalDimension::of(Kind::Length);
    const A: PhysicalDimension = PhysicalDimension::of(Kind::Angle);
    const T: PhysicalDimension = PhysicalDimension::TIME;

    #[test]
    fn units_are_those_of_the_board() {
        let degree = std::f64::consts::PI / 180.0;
        for (dimension, unit, turns) in [
            (PhysicalDimension::NUMBER, "", 0),
            (L, "mm", 0),
            (L * 2, "mm²", 0),
            (L * -1, "1/mm", 0),
            (L - T * 2, "mm/s²", 0),
            (A, "deg", -1),
            (A - T, "deg/s", -1),
            (L - A, "mm/deg", 1),
            (A + L - T, "mm/s", 0),
            (A - L, "1/mm", 0),
            (T * 6, "s^6", 0),
        ] {
            let (found, factor) = dimension.unit_words("mm", "deg", degree);
            assert_eq!(
                (found.as_str(), factor),
                (unit, degree.powi(turns)),
                "{dimension:?}"
            );
        }
        assert_eq!((L * 4).half_powers(), L * 2);
        assert_eq!((L * 3).half_powers(), PhysicalDimension::NUMBER);
        assert_eq!((A + L).kind(), Kind::Length);
        assert_eq!((L - L).kind(), Kind::Number);
        assert_eq!((L - L * 2).kind(), Kind::Number);
    }
}
