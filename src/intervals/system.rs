//! Interval systems and their solution sets: "for all" or "for some" is chosen entry by entry.
//!
//! A point x is in the set if for all values of the entries under "all" there are values of those under "some" with A x
//! = b. With G = A∀ + dual A∃ and h = dual b∀ + b∃ this is the inclusion G x ⊆ h in Kaucher arithmetic.

use super::kaucher::Kaucher;

/// How an entry of A or b is quantified.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantifier {
    /// For every value in the interval.
    All,
    /// For some value in it.
    Some,
}

/// An interval system of as many rows as there are right sides.
#[derive(Clone, Debug, PartialEq)]
pub struct IntervalSystem {
    /// Row after row.
    pub a: Vec<Vec<Kaucher>>,
    /// Right side.
    pub b: Vec<Kaucher>,
}

/// Whether something holds; rounding may leave it open.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TernaryAnswer {
    /// It does.
    Yes,
    /// It does not.
    No,
    /// Rounding does not tell.
    Open,
}

/// Errors of a system.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SystemError {
    /// Rows of different length, or not as many as right sides.
    #[error("a system has rows of one length, and as many right sides as rows")]
    Shape,
    /// Lower end above the upper one.
    #[error("row {row}: the lower end of an interval is above its upper end")]
    Improper {
        /// Number of the row from 1.
        row: usize,
    },
}

impl IntervalSystem {
    /// A system of proper intervals, each given by its ends.
    ///
    /// # Errors
    /// Sizes that do not fit; ends out of order.
    pub fn new(a: &[Vec<[f64; 2]>], b: &[[f64; 2]]) -> Result<Self, SystemError> {
        let system = Self::any(a, b)?;
        let rows = system.a.iter().zip(&system.b).enumerate();
        for (row, (entries, side)) in rows {
            if !entries.iter().chain([side]).all(|k| k.is_proper()) {
                return Err(SystemError::Improper { row: row + 1 });
            }
        }
        Ok(system)
    }

    /// A system of Kaucher intervals.
    ///
    /// # Errors
    /// Sizes that do not fit.
    pub fn any(a: &[Vec<[f64; 2]>], b: &[[f64; 2]]) -> Result<Self, SystemError> {
        let columns = a.first().map_or(0, Vec::len);
        if a.len() != b.len() || columns == 0 || a.iter().any(|row| row.len() != columns) {
            return Err(SystemError::Shape);
        }
        let of = |ends: &[f64; 2]| Kaucher::new(ends[0], ends[1]);
        Ok(Self {
            a: a.iter().map(|row| row.iter().map(of).collect()).collect(),
            b: b.iter().map(of).collect(),
        })
    }

    /// Number of unknowns.
    pub fn unknowns(&self) -> usize {
        self.a.first().map_or(0, Vec::len)
    }

    /// Entries of A, and of b, exchanged for their duals.
    pub fn dual(&self, of_a: bool, of_b: bool) -> Self {
        let turn = |k: &Kaucher, turn: bool| if turn { k.dual() } else { *k };
        Self {
            a: (self.a.iter())
                .map(|row| row.iter().map(|k| turn(k, of_a)).collect())
                .collect(),
            b: self.b.iter().map(|k| turn(k, of_b)).collect(),
        }
    }

    /// The inclusion that a set is: G and h.
    pub fn inclusion(&self, kind: &SolutionSet) -> Self {
        let of = |k: Kaucher, is_dual: bool| if is_dual { k.dual() } else { k };
        let a = self.a.iter().enumerate().map(|(i, row)| {
            let entries = row.iter().enumerate();
            entries
                .map(|(j, k)| of(*k, kind.of_a(i, j) == Quantifier::Some))
                .collect()
        });
        let b = self.b.iter().enumerate();
        Self {
            a: a.collect(),
            b: b.map(|(i, k)| of(*k, kind.of_b(i) == Quantifier::All))
                .collect(),
        }
    }

    /// A x, rounded outwards.
    pub fn times(&self, x: &[Kaucher]) -> Vec<Kaucher> {
        let rows = self.a.iter().map(|row| {
            let terms = row.iter().zip(x).map(|(a, x)| *a * *x);
            terms.fold(Kaucher::default(), |sum, term| sum + term)
        });
        rows.collect()
    }

    /// Whether a point is in a set.
    pub fn holds_point(&self, x: &[f64], kind: &SolutionSet) -> TernaryAnswer {
        let point: Vec<Kaucher> = x.iter().map(|v| Kaucher::point(*v)).collect();
        let inclusion = self.inclusion(kind);
        let outer = inclusion.times(&point);
        // Rounded inwards: the dual of the dual system's product.
        let inner = inclusion.dual(true, true).times(&point);
        let pairs = outer.iter().zip(&inner).zip(&inclusion.b);
        let mut answer = TernaryAnswer::Yes;
        for ((outer, inner), h) in pairs {
            if !inner.dual().is_in(*h) {
                return TernaryAnswer::No;
            }
            if !outer.is_in(*h) {
                answer = TernaryAnswer::Open;
            }
        }
        answer
    }

    /// Whether all points of a proper box lie in a set. This is exact if A is quantified by "all" throughout; otherwise
    /// it is only sufficient, and `Open` if it fails.
    pub fn holds_box(&self, x: &[Kaucher], kind: &SolutionSet) -> TernaryAnswer {
        let inclusion = self.inclusion(kind);
        let is_in = inclusion
            .times(x)
            .iter()
            .zip(&inclusion.b)
            .all(|(g, h)| g.is_in(*h));
        match is_in {
            true => TernaryAnswer::Yes,
            false => TernaryAnswer::Open,
        }
    }
}

/// Which solution set.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SolutionSet {
    /// Some A and some b.
    United,
    /// All A, and for each some b.
    Tolerable,
    /// All b, and for each some A.
    Controllable,
    /// Any choice: quantifiers of A row after row, then those of b.
    Mask(Vec<Vec<Quantifier>>, Vec<Quantifier>),
}

impl SolutionSet {
    fn of_a(&self, i: usize, j: usize) -> Quantifier {
        match self {
            Self::United | Self::Controllable => Quantifier::Some,
            Self::Tolerable => Quantifier::All,
            Self::Mask(a, _) => a
                .get(i)
                .and_then(|row| row.get(j))
                .copied()
                .unwrap_or(Quantifier::Some),
        }
    }

    fn of_b(&self, i: usize) -> Quantifier {
        match self {
            Self::United | Self::Tolerable => Quantifier::Some,
            Self::Controllable => Quantifier::All,
            Self::Mask(_, b) => b.get(i).copied().unwrap_or(Quantifier::Some),
        }
    }
}
