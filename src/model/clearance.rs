//! The clearances requested by a scene.

/// A pair that is excluded from the check.
#[derive(Clone, Debug, PartialEq)]
pub struct Ignored {
    /// Indices of the bodies, ascending.
    pub pair: [usize; 2],
    /// Why, in the scene's words.
    pub reason: String,
    /// Excluded shapes of the first and the second body; all if there are none.
    pub shapes: Vec<[usize; 2]>,
    /// Least accepted distance, zero or negative; any depth if absent.
    pub down_to: Option<f64>,
    /// Whether it is one of several pairs of a pattern: then it may be unnecessary.
    pub is_one_of_many: bool,
}

/// A pair with its own minimum.
#[derive(Clone, Debug, PartialEq)]
pub struct PairMinimum {
    /// Indices of the bodies, ascending.
    pub pair: [usize; 2],
    /// Least distance that passes, in the scene's unit.
    pub minimum: f64,
    /// One of several pairs of a pattern.
    pub is_one_of_many: bool,
}

/// The `[clearance]` section.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClearanceRules {
    /// Least distance that passes, in the scene's unit; not negative.
    pub minimum: f64,
    /// Pairs with their own minima; those of patterns last.
    pub pairs: Vec<PairMinimum>,
    /// Pairs that may touch.
    pub ignored: Vec<Ignored>,
    /// Pairs that touch all the time: ascending indices.
    pub touching: Vec<[usize; 2]>,
}

impl ClearanceRules {
    /// Least distance that passes for a pair (ascending indices).
    pub fn minimum_of(&self, pair: [usize; 2]) -> f64 {
        let own = self.pairs.iter().find(|p| p.pair == pair);
        own.map_or(self.minimum, |p| p.minimum)
    }

    /// Whether the scene gives a minimum for this very pair, which is then judged whatever joint connects it.
    pub fn has_own_minimum(&self, pair: [usize; 2]) -> bool {
        let mut own = self.pairs.iter().filter(|p| !p.is_one_of_many);
        own.any(|p| p.pair == pair)
    }

    /// The largest minimum of pairs that the scene does not name one by one.
    pub fn largest_minimum(&self) -> f64 {
        let many = self.pairs.iter().filter(|p| p.is_one_of_many);
        many.map(|p| p.minimum).fold(self.minimum, f64::max)
    }
}
