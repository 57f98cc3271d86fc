//! Numbers with their derivatives by the dimensions, from which measures are computed.

use crate::numbers::affine_form::AffineForm;
use crate::numbers::form_sum::SummedForm;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// A function of the dimensions. Without derivatives it is the number of one piece.
#[derive(Clone, Debug)]
pub(super) struct Tracked<'r> {
    /// Its values.
    pub form: AffineForm<'r>,
    /// Derivatives by every δ.
    pub rates: Vec<AffineForm<'r>>,
}

impl<'r> Tracked<'r> {
    /// A value of which no derivative is known.
    pub fn without_rates(form: AffineForm<'r>, count: usize) -> Self {
        Self {
            form,
            rates: vec![AffineForm::undefined(); count],
        }
    }

    /// Nothing is known.
    pub fn undefined(count: usize) -> Self {
        Self::without_rates(AffineForm::undefined(), count)
    }

    /// A value that depends on others with the given slopes.
    pub fn through(form: AffineForm<'r>, parts: &[(AffineForm<'r>, &Self)]) -> Self {
        let count = parts.iter().map(|(_, part)| part.rates.len()).max();
        let mut rates = vec![AffineForm::ZERO; count.unwrap_or(0)];
        // Chain rule: rates of the parts, weighted by the slopes.
        for (k, rate) in rates.iter_mut().enumerate() {
            let terms = parts.iter();
            let terms = terms.filter_map(|(slope, part)| Some((slope, part.rates.get(k)?)));
            *rate = AffineForm::sum_of_products(terms);
        }
        Self { form, rates }
    }

    /// a + b
    pub fn plus(&self, b: &Self) -> Self {
        let one = AffineForm::within(1.0, 0.0);
        Self::through(self.form + b.form, &[(one, self), (one, b)])
    }

    /// a - b
    pub fn minus(&self, b: &Self) -> Self {
        let one = AffineForm::within(1.0, 0.0);
        Self::through(self.form - b.form, &[(one, self), (-one, b)])
    }

    /// -a
    pub fn negative(&self) -> Self {
        Self::through(-self.form, &[(AffineForm::within(-1.0, 0.0), self)])
    }

    /// a b
    pub fn times(&self, b: &Self) -> Self {
        Self::through(self.form * b.form, &[(b.form, self), (self.form, b)])
    }

    /// a / b
    pub fn over(&self, b: &Self) -> Self {
        let (quotient, one) = (self.form / b.form, AffineForm::within(1.0, 0.0));
        let inverse = one / b.form;
        Self::through(quotient, &[(inverse, self), (-quotient * inverse, b)])
    }

    /// √(a² + b²)
    pub fn hypotenuse(&self, b: &Self) -> Self {
        let length = self.form.hypot(b.form);
        let parts = [(self.form / length, self), (b.form / length, b)];
        Self::through(length, &parts)
    }

    /// `form` has the derivatives of this one, or of any rival that may replace it, or anything in between.
    pub fn rivalled<'t>(
        &self,
        form: AffineForm<'r>,
        rivals: impl Iterator<Item = &'t Self> + Clone,
    ) -> Self
    where
        'r: 't,
    {
        // The maximum may follow any rival: its rate lies in the hull of the differences.
        let of = |(k, rate): (usize, &AffineForm<'r>)| {
            let apart = rivals.clone().map(|rival| (rival.rates[k] - *rate).range());
            let hull = apart.fold(Interval::ZERO, Interval::hull);
            match hull == Interval::ZERO {
                true => *rate,
                false => *rate + AffineForm::of_interval(hull),
            }
        };
        Self {
            form,
            rates: self.rates.iter().enumerate().map(of).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::form_room::FormRoom;
    use crate::numbers::rounding::GROW;

    type Number<'r> = Tracked<'r>;

    fn moving(room: &FormRoom, value: f64, slopes: [f64; 2]) -> Number<'_> {
        Number {
            form: AffineForm::linear(room, value, &slopes, 0.0),
            rates: slopes.map(|s| AffineForm::within(s, 0.0)).to_vec(),
        }
    }

    /// Derivatives of every operation enclose the difference quotients of plain numbers throughout the box.
    #[test]
    fn derivatives_are_enclosed() {
        type Two<T> = fn(&T, &T) -> T;
        type Plain = fn(f64, f64) -> f64;
        let rows: [(Two<Number>, Plain); 5] = [
            (Number::plus, |a, b| a + b),
            (Number::minus, |a, b| a - b),
            (Number::times, |a, b| a * b),
            (Number::over, |a, b| a / b),
            (Number::hypotenuse, |a, b| libm::hypot(a, b)),
        ];
        let room = FormRoom::new(2);
        let (a, b) = (
            moving(&room, 2.0, [0.3, -0.1]),
            moving(&room, 1.0, [0.1, 0.2]),
        );
        let at = |[p, q]: [f64; 2]| (2.0 + 0.3 * p - 0.1 * q, 1.0 + 0.1 * p + 0.2 * q);
        for (index, (tracked, plain)) in rows.into_iter().enumerate() {
            let found = tracked(&a, &b);
            for place in [[0.0, 0.0], [0.9, -0.9], [-0.7, 0.8], [-0.95, -0.95]] {
                for k in 0..2 {
                    let value = |step: f64| {
                        let mut moved = place;
                        moved[k] += step;
                        let (a, b) = at(moved);
                        plain(a, b)
                    };
                    let slope = (value(1e-5) - value(-1e-5)) / 2e-5;
                    let rate = &found.rates[k];
                    let line = rate.value + rate.slope(0) * place[0] + rate.slope(1) * place[1];
                    let off = (slope - line).abs();
                    assert!(
                        off <= rate.error * GROW + 1e-9,
                        "{index} {k} {place:?}: {off}"
                    );
                }
            }
        }
    }

    #[test]
    fn rivals_widen_derivatives_to_their_own() {
        let room = FormRoom::new(2);
        let (a, b) = (
            moving(&room, 2.0, [0.3, -0.1]),
            moving(&room, 1.9, [0.1, -0.1]),
        );
        let either = a.rivalled(a.form, std::iter::once(&b));
        let range = either.rates[0].range();
        assert!(range.lo <= 0.1 && range.hi >= 0.3 && range.hi - range.lo < 0.2001);
        assert_eq!(either.rates[1], a.rates[1]);
    }
}
