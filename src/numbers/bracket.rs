//! A bracket of a zero, for false position with halved weights (Illinois).

/// Two places with values of opposite signs.
#[derive(Clone, Copy, Debug)]
pub struct Bracket {
    /// Places, the low one first.
    pub ends: [f64; 2],
    /// The values there; that of an end that stays again and again counts less and less.
    values: [f64; 2],
    /// The end that was replaced last.
    replaced: Option<usize>,
}

impl Bracket {
    /// Between two places, each with its value.
    pub fn new([low, at_low]: [f64; 2], [high, at_high]: [f64; 2]) -> Self {
        Self {
            ends: [low, high],
            values: [at_low, at_high],
            replaced: None,
        }
    }

    /// Share of the bracket below the zero of the line through both values.
    pub fn secant_share(&self) -> f64 {
        let [low, high] = self.values;
        low / (low - high)
    }

    /// The place at a share of the bracket.
    pub fn at(&self, share: f64) -> f64 {
        let [low, high] = self.ends;
        low + (high - low) * share
    }

    /// Whether a value has the sign of that at the low end.
    pub fn is_low(&self, value: f64) -> bool {
        value * self.values[0] > 0.0
    }

    /// Replaces the low or the high end. The other one, if it stays for the second time, counts half, so that the next secant
    /// passes the zero.
    pub fn replace(&mut self, is_low: bool, place: f64, value: f64) {
        let (new, stays) = if is_low { (0, 1) } else { (1, 0) };
        if self.replaced.replace(new) == Some(new) {
            self.values[stays] *= 0.5;
        }
        (self.ends[new], self.values[new]) = (place, value);
    }
}
