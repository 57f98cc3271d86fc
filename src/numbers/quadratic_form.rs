//! Quadratic forms: how a number changes with N others to the second order, and a bound of all the rest.
//!
//! A form `value + Σ slopesₖ δₖ + Σ bendsₖₗ δₖ δₗ ± error` encloses a function of δ in [-1, 1]ᴺ: what [`AffineForm`] is to the first order.
//! Products and sines are of the second order, other functions of the first. They cost N² a product: worth it where
//! what two forms share in the second order cancels.

use super::affine_form::{AffineForm, sum_of_magnitudes};
use super::constant::Constant;
use super::interval::Interval;
use super::rounding::{GROW, OPERATION, UNDERFLOW};
use super::scalar::{Ring, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// An enclosure of a function of δ in [-1, 1]ᴺ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadraticForm<const N: usize> {
    /// At δ = 0, the change along each δ, and a bound of what neither they nor the bends are.
    pub line: AffineForm<N>,
    /// Factors of δₖ δₗ for k ≤ l; zero below the diagonal.
    pub bends: [[f64; N]; N],
}

/// Roundings in a coefficient of a product, generously: four products and their sum.
const OF_PRODUCT: f64 = 8.0 * OPERATION;

impl<const N: usize> From<AffineForm<N>> for QuadraticForm<N> {
    fn from(line: AffineForm<N>) -> Self {
        Self {
            line,
            bends: [[0.0; N]; N],
        }
    }
}

impl<const N: usize> QuadraticForm<N> {
    /// Exactly zero.
    pub const ZERO: Self = Self {
        line: AffineForm::ZERO,
        bends: [[0.0; N]; N],
    };

    /// Bound of the quadratic part.
    pub fn bend(&self) -> f64 {
        let rows = self.bends.iter().enumerate();
        let row = |(k, row): (usize, &[f64; N])| sum_of_magnitudes(&row[k..]);
        rows.map(row).sum::<f64>() * GROW
    }

    /// The same to the first order: the quadratic part is in the error.
    pub fn affine(&self) -> AffineForm<N> {
        let mut line = self.line;
        line.error = (line.error + self.bend()) * GROW;
        line
    }

    /// Adds `factor` times `b`.
    pub fn add_scaled(&mut self, factor: f64, b: &Self) {
        self.line.add_scaled(factor, &b.line);
        if factor == 0.0 {
            return;
        }
        let mut size = 0.0;
        for (k, (row, other)) in self.bends.iter_mut().zip(&b.bends).enumerate() {
            let (row, other) = (&mut row[k..], &other[k..]);
            for (bend, added) in row.iter_mut().zip(other) {
                *bend += factor * added;
            }
            size += sum_of_magnitudes(row) + factor.abs() * sum_of_magnitudes(other);
        }
        // Rounding of every sum of second-order terms.
        self.line.error = (self.line.error + OPERATION * size) * GROW;
    }

    /// Adds a product, its terms up to the second order multiplied out in place.
    pub fn add_product(&mut self, a: &Self, b: &Self) {
        for (number, other) in [(a, b), (b, a)] {
            if number.is_number() {
                return self.add_scaled(number.line.value, other);
            }
        }
        let (u, v) = (a.line.value, b.line.value);
        let (x, y) = (&a.line.slopes, &b.line.slopes);
        let rows = a.bends.iter().zip(&b.bends).enumerate();
        let mut size = 0.0;
        for (own, (k, (of_a, of_b))) in self.bends.iter_mut().zip(rows) {
            own[k] += u * of_b[k] + v * of_a[k] + x[k] * y[k];
            let (p, q) = (x[k], y[k]);
            let rest = own[k + 1..].iter_mut();
            let terms = of_a[k + 1..].iter().zip(&of_b[k + 1..]);
            let slopes = x[k + 1..].iter().zip(&y[k + 1..]);
            for ((bend, (a, b)), (x, y)) in rest.zip(terms).zip(slopes) {
                *bend += u * b + v * a + (p * y + x * q);
            }
            size += sum_of_magnitudes(&own[k..]);
        }
        let line = &mut self.line;
        for (k, slope) in line.slopes.iter_mut().enumerate() {
            *slope += u * y[k] + v * x[k];
        }
        line.value += u * v;
        size += line.value.abs() + sum_of_magnitudes(&line.slopes);
        let (rx, ry) = (a.line.radius(), b.line.radius());
        let (qx, qy) = (a.bend(), b.bend());
        let (ex, ey) = (a.line.error, b.line.error);
        let (far, wide) = (u.abs() + rx + qx, v.abs() + ry + qy);
        // Errors times values, all products of third and fourth order, rounding, underflow.
        let open = [
            u.abs() * ey + v.abs() * ex,
            rx * (qy + ey) + ry * (qx + ex),
            (qx + ex) * (qy + ey),
            OF_PRODUCT * far * wide + OPERATION * size,
            UNDERFLOW,
        ];
        line.error = (line.error + open.iter().sum::<f64>()) * GROW;
    }

    /// `start` and the sum of all forms times their factors, rounded as a whole.
    pub fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self {
        let mut sum = Self::from(AffineForm::within(start, 0.0));
        let (mut count, mut size, mut open) = (1.0, start.abs(), 0.0);
        for (factor, form) in terms {
            if factor == 0.0 || form.line.is_zero() && form.bend() == 0.0 {
                // What is not known stays so.
                let error = form.line.error;
                open += if error.is_finite() { 0.0 } else { error };
                continue;
            }
            let (own, line) = (&mut sum.line, &form.line);
            own.value += factor * line.value;
            for (s, slope) in own.slopes.iter_mut().zip(&line.slopes) {
                *s += factor * slope;
            }
            let mut magnitudes = line.value.abs() + sum_of_magnitudes(&line.slopes);
            for (k, (row, other)) in sum.bends.iter_mut().zip(&form.bends).enumerate() {
                let other = &other[k..];
                for (bend, added) in row[k..].iter_mut().zip(other) {
                    *bend += factor * added;
                }
                magnitudes += sum_of_magnitudes(other);
            }
            count += 1.0;
            size += factor.abs() * magnitudes;
            open += factor.abs() * line.error;
        }
        // A sum of products loses no more than so many operations on the sum of their magnitudes.
        sum.line.error = (open + count * (OPERATION * size + UNDERFLOW)) * GROW;
        sum
    }

    /// Whether it is a number without an error.
    fn is_number(&self) -> bool {
        self.line == AffineForm::within(self.line.value, 0.0) && self.bend() == 0.0
    }

    /// A function that is known to the first order.
    fn by_line(self, of: impl Fn(AffineForm<N>) -> AffineForm<N>) -> Self {
        Self::from(of(self.affine()))
    }

    /// value + slope y - ½ (that function) y² and a third-order rest: sine or cosine, whose second derivative is minus itself.
    fn wave_form(self, value: Interval, slope: Interval) -> Self {
        let (here, rate) = (value.middle(), slope.middle());
        let line = &self.line;
        let (radius, beyond) = (line.radius(), self.bend() + line.error);
        let wide = (radius + beyond) * GROW;
        let mut bends = [[0.0; N]; N];
        for (k, (row, own)) in bends.iter_mut().zip(&self.bends).enumerate() {
            let slope = line.slopes[k];
            row[k] = rate * own[k] - 0.5 * here * slope * slope;
            for l in k + 1..N {
                row[l] = rate * own[l] - here * slope * line.slopes[l];
            }
        }
        let open = [
            value.distance(here) * (1.0 + wide * wide),
            slope.distance(rate) * wide,
            rate.abs() * line.error,
            0.5 * here.abs() * beyond * (2.0 * radius + beyond),
            // No derivative is above one.
            wide * wide * wide / 6.0,
            OF_PRODUCT * (rate.abs() * wide + here.abs() * radius * radius),
            UNDERFLOW,
        ];
        Self {
            line: AffineForm {
                value: here,
                slopes: line.slopes.map(|s| rate * s),
                error: open.iter().sum::<f64>() * GROW,
            },
            bends,
        }
    }
}

impl<const N: usize> Ring for QuadraticForm<N> {
    fn number(value: f64) -> Self {
        Self::from(AffineForm::within(value, 0.0))
    }

    fn scale(self, factor: f64) -> Self {
        if factor.abs() == 1.0 {
            return if factor < 0.0 { -self } else { self };
        }
        let mut scaled = Self::ZERO;
        scaled.add_scaled(factor, &self);
        scaled
    }

    fn scale_by(self, factor: Constant) -> Self {
        match factor.is_exact() {
            true => self.scale(factor.number()),
            false => self * Self::from_constant(factor),
        }
    }
}

impl<const N: usize> Scalar for QuadraticForm<N> {
    fn from_constant(constant: Constant) -> Self {
        Self::from(AffineForm::from_constant(constant))
    }

    fn undefined() -> Self {
        Self::from(AffineForm::undefined())
    }

    fn is_finite(self) -> bool {
        self.affine().is_finite()
    }

    fn as_number(self) -> Option<f64> {
        self.is_number().then_some(self.line.value)
    }

    fn nominal(self) -> f64 {
        self.line.value
    }

    fn first_order(self, _value: f64) -> Self {
        Self::undefined()
    }

    fn is_below_zero(self) -> Option<bool> {
        self.affine().is_below_zero()
    }

    fn sin_cos(self) -> (Self, Self) {
        if self.is_number() || !self.is_finite() {
            let (sin, cos) = self.line.sin_cos();
            return (Self::from(sin), Self::from(cos));
        }
        let (sin, cos) = Interval::point(self.line.value).sin_cos();
        (self.wave_form(sin, cos), self.wave_form(cos, -sin))
    }

    fn exp(self) -> Self {
        self.by_line(Scalar::exp)
    }

    fn ln(self) -> Self {
        self.by_line(Scalar::ln)
    }

    fn sqrt(self) -> Self {
        self.by_line(Scalar::sqrt)
    }

    fn asin(self) -> Self {
        self.by_line(Scalar::asin)
    }

    fn acos(self) -> Self {
        self.by_line(Scalar::acos)
    }

    fn atan(self) -> Self {
        self.by_line(Scalar::atan)
    }

    fn atan2(self, x: Self) -> Self {
        self.by_line(|y| y.atan2(x.affine()))
    }

    fn floor(self) -> Self {
        self.by_line(Scalar::floor)
    }
}

impl<const N: usize> Neg for QuadraticForm<N> {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            line: -self.line,
            bends: self.bends.map(|row| row.map(|b| -b)),
        }
    }
}

impl<const N: usize> Add for QuadraticForm<N> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let mut sum = self;
        sum.line = self.line + b.line;
        let mut size = 0.0;
        for (k, (row, other)) in sum.bends.iter_mut().zip(&b.bends).enumerate() {
            let row = &mut row[k..];
            for (bend, added) in row.iter_mut().zip(&other[k..]) {
                *bend += added;
            }
            size += sum_of_magnitudes(row);
        }
        if size > 0.0 {
            // Rounding of every sum of second-order terms.
            sum.line.error = (sum.line.error + OPERATION * size) * GROW;
        }
        sum
    }
}

impl<const N: usize> Sub for QuadraticForm<N> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl<const N: usize> Mul for QuadraticForm<N> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let mut product = Self::ZERO;
        product.add_product(&self, &b);
        product
    }
}

impl<const N: usize> Div for QuadraticForm<N> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let inverse = AffineForm::number(1.0) / b.affine();
        self * Self::from(inverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Form = QuadraticForm<2>;

    fn random(state: &mut u64) -> f64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn at(form: &Form, [p, q]: [f64; 2]) -> f64 {
        let [s, t] = form.line.slopes;
        let [[a, b], [_, c]] = form.bends;
        form.line.value + s * p + t * q + a * p * p + b * p * q + c * q * q
    }

    fn moving(value: f64, slopes: [f64; 2]) -> Form {
        let line = AffineForm::number(value)
            .moving(0, slopes[0])
            .moving(1, slopes[1]);
        Form::from(line)
    }

    #[test]
    fn forms_hold_what_they_enclose() {
        let mut state = 0x51_ced2;
        for _ in 0..2000 {
            let mut next = || random(&mut state);
            let (x, y) = (0.8 + 0.2 * next(), 0.9 + 0.2 * next());
            let (s, t) = ([0.1 * next(), 0.1 * next()], [0.1 * next(), 0.1 * next()]);
            let (a, b) = (moving(x, s), moving(y, t));
            let d = [next(), next()];
            let (p, q) = (x + s[0] * d[0] + s[1] * d[1], y + t[0] * d[0] + t[1] * d[1]);
            let holds = |form: Form, value: f64| {
                let off = (at(&form, d) - value).abs();
                assert!(off <= form.line.error + 8e-16, "{form:?} at {d:?}: {value}");
                let line = form.affine();
                let far =
                    (line.value + line.slopes[0] * d[0] + line.slopes[1] * d[1] - value).abs();
                assert!(far <= line.error + 8e-16);
            };
            let (c, r) = (a * b, p * q);
            holds(a + b, p + q);
            holds(a - b, p - q);
            holds(c, r);
            holds(c * a, r * p);
            holds(c * c - a, r * r - p);
            holds(c.scale(-1.7), -1.7 * r);
            holds(a / b, p / q);
            holds(c.sin(), libm::sin(r));
            holds(c.cos(), libm::cos(r));
            holds(c.sqrt(), r.sqrt());
            holds(a.atan2(b), libm::atan2(p, q));
            let mut sum = a;
            sum.add_scaled(-0.3, &c);
            holds(sum, p - 0.3 * r);
            sum.add_product(&c, &b);
            holds(sum, p - 0.3 * r + r * q);
            let terms = [(1.5, &a), (0.0, &b), (-0.3, &c), (2.0, &Form::ZERO)];
            let sum = Form::combination(-1.0, terms.into_iter());
            holds(sum, -1.0 + 1.5 * p - 0.3 * r);
        }
    }

    #[test]
    fn errors_of_products_and_sines_are_of_third_order() {
        let of = |t: f64| {
            let (a, b) = (moving(0.7, [t, 0.0]), moving(0.4, [t, -t]));
            [(a * b) * (a * a), (a * b).sin(), (a * b).cos()].map(|f| f.line.error)
        };
        for (wide, narrow) in of(1e-2).into_iter().zip(of(1e-3)) {
            assert!(
                (900.0..1100.0).contains(&(wide / narrow)),
                "{wide} {narrow}"
            );
        }
    }

    #[test]
    fn nothing_is_made_up() {
        let around_zero = moving(0.0, [1.0, 0.0]);
        for none in [
            Form::number(1.0) / around_zero,
            around_zero.ln(),
            Form::undefined() * Form::ZERO,
            Form::undefined() + Form::number(1.0),
            Form::combination(1.0, [(0.0, &Form::undefined())].into_iter()),
            Form::undefined().sin(),
        ] {
            assert!(!none.is_finite(), "{none:?}");
        }
        assert_eq!(Form::ZERO * around_zero, Form::ZERO);
    }
}
