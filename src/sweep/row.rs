//! A row of a sweep as numbers: the status of its design, its values, and what is proved about them.

/// Outcome of the motion of a design.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowStatus {
    /// All poses exist, on the assembly of the file's own values.
    Ok,
    /// Some poses do not exist, or the motion ends at a fold: proved.
    NotClosed,
    /// The poses are those of another assembly.
    OtherBranch,
    /// The straight path from the file's values does not reach the design; the poses were assembled anew, and have the
    /// signs of the file's assembly.
    NotReached,
    /// The scene cannot be read with these values, or a requested value does not exist.
    Refused,
    /// Poses are missing, but it is not proved that they do not exist.
    Undecided,
    /// There are poses, but redundant equations are proved not to hold at some of them.
    Open,
}

impl RowStatus {
    /// All of them, in the order of their codes.
    pub const ALL: [Self; 7] = [
        Self::Ok,
        Self::NotClosed,
        Self::OtherBranch,
        Self::NotReached,
        Self::Refused,
        Self::Undecided,
        Self::Open,
    ];

    /// Of two motions of one design the answer that says less good: a proof that poses are missing or open before a
    /// doubt, a doubt before what is said of the start.
    pub(super) fn worse(self, other: Self) -> Self {
        let worst = [Self::NotClosed, Self::Open, Self::Undecided];
        let pair = [self, other];
        match worst.into_iter().find(|status| pair.contains(status)) {
            Some(status) => status,
            None if self == Self::Ok => other,
            None => self,
        }
    }

    /// Its name in tables.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NotClosed => "not-closed",
            Self::OtherBranch => "other-branch",
            Self::NotReached => "not-reached",
            Self::Refused => "refused",
            Self::Undecided => "undecided",
            Self::Open => "open",
        }
    }
}

/// One row.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The outcome.
    pub status: RowStatus,
    /// Whether it is ok and meets all limits; for a check, whether that passed.
    pub is_feasible: bool,
    /// The requested values, in the file's units; NaN where there is none.
    pub values: Vec<f64>,
    /// Largest gap of any loop, relative to the size, by an independent evaluation.
    pub closure_error: f64,
    /// Largest certified error of a coordinate.
    pub error_bound: f64,
    /// Number of poses without a certificate.
    pub unproved: f64,
}

/// Numbers of a row besides its values.
const BESIDE: usize = 5;

impl Row {
    /// Numbers that a partial result stores per row with this many values.
    pub const fn width(values: usize) -> usize {
        BESIDE + values
    }

    /// The numbers of the row as tables show them, after those of its design.
    pub fn numbers<'r>(&'r self, design: &'r [f64]) -> impl Iterator<Item = f64> + 'r {
        let proofs = [self.closure_error, self.error_bound, self.unproved];
        design.iter().chain(&self.values).copied().chain(proofs)
    }

    /// As the numbers that a partial result stores.
    pub fn record(&self) -> Vec<f64> {
        let status = RowStatus::ALL.iter().position(|s| *s == self.status);
        let mut record = Vec::with_capacity(BESIDE + self.values.len());
        record.push(status.unwrap_or(0) as f64);
        record.push(f64::from(u8::from(self.is_feasible)));
        record.extend([self.closure_error, self.error_bound, self.unproved]);
        record.extend_from_slice(&self.values);
        record
    }

    /// The row from such numbers; `None` if they are invalid.
    pub fn of_record(record: &[f64]) -> Option<Self> {
        let (beside, values) = record.split_at_checked(BESIDE)?;
        Some(Self {
            status: *RowStatus::ALL.get(beside[0] as usize)?,
            is_feasible: beside[1] == 1.0,
            closure_error: beside[2],
            error_bound: beside[3],
            unproved: beside[4],
            values: values.to_vec(),
        })
    }
}
