//! How far a motion is from singular poses, as its smallest singular values tell.

/// A step across a singular pose starts from the last pose whose smallest singular value is above this fraction
/// of the best seen; nearer to the singular pose the tangent is noise.
const TRUSTED_SIGMA: f64 = 1e-4;

/// Below this fraction of the best smallest singular value no tangent is taken from a pose: it has lost its last
/// digits. Folds are approached to the square of it.
const USABLE_SIGMA: f64 = 1e-6;

/// A step may take the smallest singular value, as it falls, down to this share of itself.
const LEAST_LEFT: f64 = 0.1;

/// A change by a smaller share is the rounding of what is iterated.
const SEEN_CHANGE: f64 = 1e-4;

/// The smallest singular values of a motion so far.
#[derive(Clone, Copy, Debug, Default)]
pub struct Regularity {
    largest: f64,
    /// Time and value of the last accepted pose and of the one before it.
    accepted: [Option<[f64; 2]>; 2],
}

impl Regularity {
    /// A pose was closed.
    pub fn observe(&mut self, sigma: f64) {
        if sigma.is_finite() {
            self.largest = self.largest.max(sigma);
        }
    }

    /// A pose was accepted as the next one of the motion.
    pub fn accept(&mut self, time: f64, sigma: f64) {
        self.accepted = [Some([time, sigma]), self.accepted[0]];
    }

    /// What another motion of the same mechanism has closed counts, too.
    pub fn learn_from(&mut self, other: &Self) {
        self.largest = other.largest;
    }

    /// The largest of all values.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Whether the tangent of a pose is worth anything.
    pub fn is_usable(&self, sigma: f64) -> bool {
        sigma >= USABLE_SIGMA * self.largest
    }

    /// Whether a pose is far enough from singular ones to predict from across one.
    pub fn is_trusted(&self, sigma: f64) -> bool {
        sigma >= TRUSTED_SIGMA * self.largest
    }

    /// Whether the value, `sigma` at the last accepted pose, which is at `here`, falling on as it fell on the step before, would
    /// nearly vanish on the way to `time`: it may touch zero there and be as large as before behind it.
    pub fn heads_for_zero(&self, [here, time]: [f64; 2], sigma: f64) -> bool {
        let [Some([last, _]), Some([before, earlier])] = self.accepted else {
            return false;
        };
        let change = sigma - earlier;
        if last != here || before == last || change.abs() < SEEN_CHANGE * sigma {
            return false;
        }
        let left = sigma + change * (time - last) / (last - before);
        left < LEAST_LEFT * sigma
    }
}
