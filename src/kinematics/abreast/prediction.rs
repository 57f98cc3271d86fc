//! Predictions of the next pose of eight motions from the last poses and their tangents.
//!
//! Along the tangent the prediction is of first order. The change of the tangents since the previous step makes it one of second
//! order (Adams-Bashforth). Three poses with their tangents determine a polynomial of fifth degree (Hermite
//! interpolation by divided differences with double nodes, Hairer, Nørsett and Wanner, Solving ODEs I, II.6 and III.1):
//! where the path is smooth, it saves one evaluation of the equations in three.

use crate::numbers::octet::{LaneMask, Octet};

/// Two changes of the inputs have the same direction if the perpendicular part is below this fraction of the longer
/// one, squared.
const ACROSS: f64 = 1e-12;

/// Lengths of successive steps between which three poses are extrapolated: the polynomial amplifies errors by about
/// the fifth power of their ratio.
const RATIOS: [f64; 2] = [0.5, 2.0];

/// A step was smooth if its prediction missed by at most this share of it: three poses amplify a kink about twentyfold,
/// and a correction of a tenth of the step is not trusted.
const SMOOTH: f64 = 1e-3;

/// A step: the pose where it began, and the changes of all coordinates along the tangents there.
#[derive(Clone, Debug, Default)]
struct BegunStep {
    from: Vec<Octet>,
    rates: Vec<Octet>,
}

/// The last steps of eight motions.
#[derive(Clone, Debug, Default)]
pub(super) struct RecentSteps {
    /// The present step, then those before.
    steps: [BegunStep; 3],
    /// How many there are.
    count: usize,
    /// Lanes in which the last step was smooth, and the one before.
    smooth: [LaneMask; 2],
}

/// Lengths of this step and of another one.
struct StepRatio {
    /// This step over the other one.
    ratio: Octet,
    /// Lanes in which both have the same direction.
    is_along: LaneMask,
}

impl RecentSteps {
    /// Forgets all steps.
    pub fn clear(&mut self) {
        self.count = 0;
        self.smooth = [LaneMask::NONE; 2];
    }

    /// Begins a step at a pose.
    pub fn begin(&mut self, coordinates: &[Octet]) {
        self.steps.rotate_right(1);
        self.count = (self.count + 1).min(self.steps.len());
        let BegunStep { from, rates } = &mut self.steps[0];
        from.clear();
        from.extend_from_slice(coordinates);
        rates.clear();
        rates.resize(coordinates.len(), Octet::ZERO);
    }

    /// Where the present step began.
    pub fn from(&self) -> &[Octet] {
        &self.steps[0].from
    }

    /// The changes of all coordinates along the tangents of the present step.
    pub fn rates(&self) -> &[Octet] {
        &self.steps[0].rates
    }

    /// The same, to be determined.
    pub fn rates_mut(&mut self) -> &mut [Octet] {
        &mut self.steps[0].rates
    }

    /// The present step ended `off` beside its prediction in these lanes, of a length along the tangents.
    pub fn end(&mut self, off: Octet, length: Octet) {
        self.smooth = [off.at_most(length * SMOOTH), self.smooth[0]];
    }

    /// In these lanes the present step has a kink, and counts with the tangents at its end; three poses are not extrapolated
    /// across it.
    pub fn turn(&mut self, kinked: LaneMask, ends: &[Octet]) {
        self.smooth[0] = self.smooth[0].without(kinked);
        for (rate, end) in self.steps[0].rates.iter_mut().zip(ends) {
            *rate = kinked.choose(*end, *rate);
        }
    }

    /// What the unknowns change by beyond the tangents, if the inputs continue in the same direction; `unknowns` are the
    /// first coordinates. None before the second step.
    pub fn bends(&self, unknowns: usize, bends: &mut Vec<Octet>) {
        bends.clear();
        bends.resize(unknowns, Octet::ZERO);
        if self.count < 2 {
            return;
        }
        let [now, last, before] = &self.steps;
        let to_last = StepRatio::new(&now.rates[unknowns..], &last.rates[unknowns..]);
        // Half the change of the tangents is the second-order term of the path.
        for (k, bend) in bends.iter_mut().enumerate() {
            let turned = now.rates[k] - last.rates[k] * to_last.ratio;
            let second_order = turned * to_last.ratio * 0.5;
            *bend = to_last.is_along.choose(second_order, Octet::ZERO);
        }
        let smooth = self.smooth[0].and(self.smooth[1]).and(to_last.is_similar());
        if self.count < 3 || !smooth.any() {
            return;
        }
        let to_before = StepRatio::new(&now.rates[unknowns..], &before.rates[unknowns..]);
        let smooth = smooth.and(to_before.is_similar());
        let nodes = Nodes::new(to_last.ratio, to_before.ratio);
        for (k, bend) in bends.iter_mut().enumerate() {
            let tangents = [
                now.rates[k],
                last.rates[k] * to_last.ratio,
                before.rates[k] * to_before.ratio,
            ];
            let fifth_order = nodes.bend([now.from[k], last.from[k], before.from[k]], tangents);
            *bend = smooth.choose(fifth_order, *bend);
        }
    }
}

impl StepRatio {
    fn new(now: &[Octet], other: &[Octet]) -> Self {
        let dot = |a: &[Octet], b: &[Octet]| {
            let pairs = a.iter().zip(b);
            pairs.fold(Octet::ZERO, |sum, (a, b)| sum + *a * *b)
        };
        let (square, other_square) = (dot(now, now), dot(other, other));
        // The other step, scaled to this one, and the part of this one that is perpendicular to it.
        let ratio = dot(now, other) / other_square;
        let across = square - ratio * ratio * other_square;
        Self {
            ratio,
            is_along: across.at_most(square * ACROSS),
        }
    }

    /// Lanes in which the steps have the same direction and similar lengths.
    fn is_similar(&self) -> LaneMask {
        let [least, most] = RATIOS.map(Octet::splat);
        let within = least.at_most(self.ratio).and(self.ratio.at_most(most));
        self.is_along.and(within)
    }
}

/// Three poses on the way to the next one: at 0, -a and -b in lengths of the present step.
struct Nodes {
    a: Octet,
    b: Octet,
    /// 1/a, 1/b, 1/(b - a)
    inverse: [Octet; 3],
}

impl Nodes {
    /// From the present step over the last one and over the one before.
    fn new(over_last: Octet, over_before: Octet) -> Self {
        let one = Octet::splat(1.0);
        let a = one / over_last;
        let b = a + one / over_before;
        Self {
            a,
            b,
            inverse: [over_last, one / b, over_before],
        }
    }

    /// What the polynomial through three values with these tangents adds to the first value and tangent at 1.
    fn bend(&self, [y, y_a, y_b]: [Octet; 3], [d, d_a, d_b]: [Octet; 3]) -> Octet {
        let [by_a, by_b, by_ab] = self.inverse;
        // Divided differences of the nodes 0, 0, -a, -a, -b, -b.
        let (to_a, to_b) = ((y - y_a) * by_a, (y_a - y_b) * by_ab);
        let second = [
            (d - to_a) * by_a,
            (to_a - d_a) * by_a,
            (d_a - to_b) * by_ab,
            (to_b - d_b) * by_ab,
        ];
        let third = [
            (second[0] - second[1]) * by_a,
            (second[1] - second[2]) * by_b,
            (second[2] - second[3]) * by_ab,
        ];
        let fourth = [(third[0] - third[1]) * by_b, (third[1] - third[2]) * by_b];
        let fifth = (fourth[0] - fourth[1]) * by_b;
        let one = Octet::splat(1.0);
        let (from_a, from_b) = (one + self.a, one + self.b);
        second[0] + from_a * (third[0] + from_a * (fourth[0] + from_b * fifth))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The polynomial of fifth degree is exact for its own degree, whatever the lengths of the steps are.
    #[test]
    fn polynomials_of_fifth_degree_are_continued_exactly() {
        let coefficients = [0.3, -1.2, 0.7, 0.4, -0.25, 0.1];
        let value = |x: f64| coefficients.iter().rev().fold(0.0, |sum, c| sum * x + c);
        let slope = |x: f64| {
            let terms = coefficients.iter().enumerate().skip(1);
            terms.fold(0.0, |sum, (k, c)| sum + k as f64 * c * x.powi(k as i32 - 1))
        };
        for [over_last, over_before] in [[1.0, 1.0], [0.6, 1.7], [1.9, 0.5]] {
            let (a, b) = (1.0 / over_last, 1.0 / over_last + 1.0 / over_before);
            let nodes = Nodes::new(Octet::splat(over_last), Octet::splat(over_before));
            let places = [0.0, -a, -b];
            let found = nodes.bend(
                places.map(|x| Octet::splat(value(x))),
                places.map(|x| Octet::splat(slope(x))),
            );
            let expected = value(1.0) - value(0.0) - slope(0.0);
            let off = (found.lane(3) - expected).abs();
            // Steps of half the length amplify rounding most.
            assert!(off < 1e-12, "{over_last} {over_before}: {off}");
        }
    }

    /// On a circle the prediction is of sixth order once two steps were smooth, of third order before.
    #[test]
    fn smooth_paths_are_predicted_to_the_sixth_order() {
        let h = 0.03;
        let mut steps = RecentSteps::default();
        let mut bends = Vec::new();
        let mut missed = Vec::new();
        for k in 0..6 {
            let angle = h * f64::from(k);
            // One unknown, the sine of the one input.
            steps.begin(&[libm::sin(angle), angle].map(Octet::splat));
            let rate = h * libm::cos(angle);
            steps
                .rates_mut()
                .copy_from_slice(&[rate, h].map(Octet::splat));
            steps.bends(1, &mut bends);
            let predicted = libm::sin(angle) + rate + bends[0].lane(0);
            let off = (predicted - libm::sin(angle + h)).abs();
            steps.end(Octet::splat(off), Octet::splat(rate));
            missed.push(off);
        }
        // The first step is the tangent's own; two smooth ones follow.
        assert!(missed[0] < h.powi(3) && missed[1] < h.powi(3), "{missed:?}");
        assert!(missed[3..].iter().all(|off| *off < h.powi(6)), "{missed:?}");
    }
}
