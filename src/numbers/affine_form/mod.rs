//! Affine forms: the first-order dependence of a number on n others, and a bound of everything else.
//!
//! A form `value + Σ slopesₖ δₖ ± error` encloses a function of δ in [-1, 1]ⁿ. First-order terms that two forms share
//! cancel, unlike in interval arithmetic; terms of second order and rounding go into the error. Affine arithmetic of de
//! Figueiredo and Stolfi (Numerical Algorithms 37, 2004) with functions by the mean value theorem.

mod arithmetic;
mod functions;
pub(super) mod sum;

use super::form_room::FormRoom;
use super::interval::Interval;
use super::lists::sum_of_magnitudes;
use super::rounding::GROW;
use super::scalar::Scalar;

/// An enclosure of a function of δ in [-1, 1]ⁿ. Its slopes lie in a [`FormRoom`]: a form is small and cheap to copy.
#[derive(Clone, Copy, Debug)]
pub struct AffineForm<'r> {
    /// At δ = 0.
    pub value: f64,
    /// Bound of the difference between the function and the linear one.
    pub error: f64,
    /// Change along the first δ; that along all others is zero.
    slopes: &'r [f64],
    /// Bound of the linear part.
    radius: f64,
    /// Where results keep their slopes; a plain number needs nothing.
    room: Option<&'r FormRoom>,
}

/// A list without the zeros at its end.
fn trimmed(list: &[f64]) -> &[f64] {
    let last = list.iter().rposition(|value| *value != 0.0);
    &list[..last.map_or(0, |last| last + 1)]
}

impl<'r> AffineForm<'r> {
    /// Exactly zero.
    pub const ZERO: Self = Self::within(0.0, 0.0);

    /// A number that stays within `error` of `value`.
    pub const fn within(value: f64, error: f64) -> Self {
        Self {
            value,
            error,
            slopes: &[],
            radius: 0.0,
            room: None,
        }
    }

    /// A number within `error` of `value`, plus `slopes` times the first δ; slopes that the room has no place for go into the error.
    pub fn linear(room: &'r FormRoom, value: f64, slopes: &[f64], error: f64) -> Self {
        let (own, others) = slopes.split_at(slopes.len().min(room.count()));
        let mut all = room.slopes().blank();
        all.extend_from_slice(trimmed(own));
        let error = match sum_of_magnitudes(others) {
            0.0 => error,
            beyond => (error + beyond * GROW) * GROW,
        };
        Self::within(value, error).sloped(all, Some(room))
    }

    /// All numbers of an interval.
    pub fn of_interval(interval: Interval) -> Self {
        let value = interval.middle();
        match interval.is_finite() {
            true => Self::within(value, interval.distance(value)),
            false => Self::undefined(),
        }
    }

    /// The same with other slopes, at most as many as the room's; without space they go into the error.
    pub(super) fn sloped(self, slopes: Vec<f64>, room: Option<&'r FormRoom>) -> Self {
        let radius = sum_of_magnitudes(&slopes) * GROW;
        let flat = Self {
            slopes: &[],
            radius: 0.0,
            room,
            ..self
        };
        if radius == 0.0 {
            if let Some(room) = room {
                room.slopes().give_back(slopes);
            }
            return flat;
        }
        match room.and_then(|room| room.slopes().keep(slopes)) {
            Some(slopes) => Self {
                slopes,
                radius,
                ..flat
            },
            None => Self {
                error: (flat.error + radius) * GROW,
                ..flat
            },
        }
    }

    /// Another form with the slopes of this one, each changed by `of`.
    pub(super) fn with_each_slope(&self, of: impl Fn(f64) -> f64, value: f64, error: f64) -> Self {
        let list = Self::within(value, error);
        let mut slopes = self.blank();
        slopes.extend(self.slopes.iter().map(|slope| of(*slope)));
        list.sloped(slopes, self.room)
    }

    /// The same with its error as the change along a number of its own, `index`, if there is room for it.
    pub fn marked(self, index: usize) -> Self {
        match self.room {
            Some(room) if index < room.count() => {
                let mut slopes = room.slopes().blank();
                slopes.extend_from_slice(self.slopes);
                slopes.resize(slopes.len().max(index + 1), 0.0);
                slopes[index] = self.error;
                Self::within(self.value, 0.0).sloped(slopes, self.room)
            }
            _ => self,
        }
    }

    /// The same with everything that depends on numbers from `first` on moved into the error.
    pub fn folded(self, first: usize) -> Self {
        let Some((kept, moved)) = self.slopes.split_at_checked(first) else {
            return self;
        };
        let beyond = sum_of_magnitudes(moved) * GROW;
        Self {
            slopes: kept,
            radius: sum_of_magnitudes(kept) * GROW,
            error: (self.error + beyond) * GROW,
            ..self
        }
    }

    /// A list for slopes, if there are some.
    fn blank(&self) -> Vec<f64> {
        match (self.slopes, self.room) {
            ([], _) | (_, None) => Vec::new(),
            (_, Some(room)) => room.slopes().blank(),
        }
    }

    /// The same with its slopes in another room, which outlives this one.
    pub fn kept_in<'k>(&self, room: &'k FormRoom) -> AffineForm<'k> {
        match self.slopes {
            [] => AffineForm {
                room: Some(room),
                ..AffineForm::within(self.value, self.error)
            },
            slopes => AffineForm::linear(room, self.value, slopes, self.error),
        }
    }

    /// The same, so that results go into another room.
    pub fn working_in(self, room: &'r FormRoom) -> Self {
        Self {
            room: Some(room),
            ..self
        }
    }

    /// Where results keep their slopes.
    pub(super) fn room(&self) -> Option<&'r FormRoom> {
        self.room
    }

    /// Change along the first δ; that along all others is zero.
    #[inline]
    pub fn slopes(&self) -> &'r [f64] {
        self.slopes
    }

    /// Change along one δ.
    #[inline]
    pub fn slope(&self, index: usize) -> f64 {
        self.slopes.get(index).copied().unwrap_or(0.0)
    }

    /// Bound of the linear part.
    #[inline]
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Bound of the difference from the value.
    #[inline]
    pub fn deviation(&self) -> f64 {
        (self.radius + self.error) * GROW
    }

    /// Bound of the magnitude.
    pub fn magnitude(&self) -> f64 {
        (self.value.abs() + self.deviation()) * GROW
    }

    /// All its values.
    pub fn range(&self) -> Interval {
        Interval::point(self.value) + Interval::around_zero(self.deviation())
    }

    /// Exactly zero, so that products with it are zero too.
    pub(super) fn is_zero(&self) -> bool {
        self.value == 0.0 && self.is_number()
    }

    /// Exactly its value.
    fn is_number(&self) -> bool {
        self.error == 0.0 && self.slopes.is_empty()
    }
}

impl PartialEq for AffineForm<'_> {
    fn eq(&self, b: &Self) -> bool {
        self.value == b.value && self.error == b.error && self.slopes == b.slopes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::form_sum::SummedForm;
    use crate::numbers::scalar::Ring;

    type Form<'r> = AffineForm<'r>;

    fn random(state: &mut u64) -> f64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Values of x + 0.1 δ₀ and y + 0.2 δ₁ through every operation lie within the form's linear part and its error.
    #[test]
    fn forms_hold_what_they_enclose() {
        let (mut state, room) = (0x51_ced1, FormRoom::new(2));
        for _ in 0..2000 {
            let (x, y) = (
                0.5 + 0.2 * random(&mut state),
                0.6 + 0.2 * random(&mut state),
            );
            let (tx, ty) = (
                0.1 * random(&mut state).abs(),
                0.2 * random(&mut state).abs(),
            );
            let linear = |value, slopes: &[f64]| Form::linear(&room, value, slopes, 0.0);
            let a = linear(x, &[tx]) + linear(0.25, &[0.0, 0.5 * ty]);
            let b = linear(y, &[0.0, ty]);
            let d = [random(&mut state), random(&mut state)];
            let (p, q) = (x + 0.25 + tx * d[0] + 0.5 * ty * d[1], y + ty * d[1]);
            let holds = |form: Form, value: f64| {
                let line = form.value + form.slope(0) * d[0] + form.slope(1) * d[1];
                let off = (line - value).abs();
                assert!(off <= form.error + 4e-16, "{form:?} at {d:?}: {value}");
            };
            holds(a + b, p + q);
            holds(a - b, p - q);
            holds(a * b, p * q);
            holds(a / b, p / q);
            holds(a.square(), p * p);
            holds(a.scale(-1.7), -1.7 * p);
            holds(a.sin(), libm::sin(p));
            holds(a.cos(), libm::cos(p));
            holds(a.exp(), libm::exp(p));
            holds(a.ln(), libm::log(p));
            holds(a.sqrt(), p.sqrt());
            holds((a.scale(0.5)).asin(), libm::asin(0.5 * p));
            holds((a.scale(0.5)).acos(), libm::acos(0.5 * p));
            holds(a.atan(), libm::atan(p));
            holds(a.atan2(b), libm::atan2(p, q));
            holds(a.hypot(b), libm::hypot(p, q));
            // On both sides of kinks and beside them.
            let place = 0.3 * random(&mut state);
            let (e, f) = (a - Form::number(x + place), p - (x + place));
            holds(e.abs(), f.abs());
            holds(a.max(b), p.max(q));
            holds(a.min(b), p.min(q));
            holds(e.choose(a, b), if f < 0.0 { p } else { q });
            let terms = [(1.5, &a), (0.0, &b), (-0.3, &b), (2.0, &Form::ZERO)];
            let sum = Form::combination(-1.0, terms.into_iter());
            holds(sum, -1.0 + 1.5 * p - 0.3 * q);
            let (two, c) = (Form::number(2.0), Form::within(0.1, 0.2));
            let products = [(&a, &b), (&two, &a), (&b, &b), (&c, &a), (&Form::ZERO, &b)];
            let sum = Form::sum_of_products(products.into_iter());
            holds(sum, p * q + 2.0 * p + q * q + (0.1 + 0.2 * d[0]) * p);
            // Elsewhere it is the same; without storage only sharpness is lost.
            let (other, small) = (FormRoom::new(2), FormRoom::new(1));
            assert_eq!(sum.kept_in(&other), sum);
            holds(a.kept_in(&small), p);
            holds(a.kept_in(&other).working_in(&room) * b, p * q);
            holds(Form { room: None, ..a } * Form { room: None, ..b }, p * q);
            holds(Form { room: None, ..a }.sin(), libm::sin(p));
        }
    }

    #[test]
    fn errors_are_of_second_order_and_common_parts_cancel() {
        let room = FormRoom::new(2);
        let [wide, narrow] = [1e-2, 1e-3].map(|t| Form::linear(&room, 0.7, &[t], 0.0));
        for f in [
            Scalar::sin,
            Scalar::exp,
            Scalar::sqrt,
            Scalar::ln,
            Scalar::square,
        ] {
            let ratio = f(wide).error / f(narrow).error;
            assert!((90.0..110.0).contains(&ratio), "{ratio}");
        }
        assert!((wide - wide).deviation() < 1e-15);
    }

    #[test]
    fn nothing_is_made_up() {
        let room = FormRoom::new(2);
        let around_zero = Form::linear(&room, 0.0, &[1.0], 0.0);
        for none in [
            Form::number(1.0) / around_zero,
            around_zero.ln(),
            around_zero.sqrt(),
            around_zero.atan2(Form::number(-1.0)),
            around_zero.floor(),
            Form::number(1.0).asin(),
            Form::undefined() * Form::ZERO,
            Form::undefined() + Form::number(1.0),
            Form::combination(1.0, [(0.0, &Form::undefined())].into_iter()),
        ] {
            assert!(!none.is_finite(), "{none:?}");
        }
        assert_eq!(Form::ZERO * around_zero, Form::ZERO);
        assert_eq!(Form::ZERO.sin_cos(), (Form::ZERO, Form::number(1.0)));
    }
}
