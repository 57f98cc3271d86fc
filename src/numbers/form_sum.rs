//! Forms that are summed in place: their roundings are counted once for all terms.

use super::scalar::Sign;

/// A sum under construction.
pub trait FormSum {
    /// What is summed.
    type Form;

    /// A sum that begins with a number.
    fn new(start: f64) -> Self;

    /// Adds `factor` times a form.
    fn add_scaled(&mut self, factor: f64, form: &Self::Form);

    /// Adds the same forms to several sums: sum i takes them times the factors from `factors[i * forms.len()]` on.
    fn add_scaled_to_all(sums: &mut [&mut Self], factors: &[f64], forms: &[&Self::Form]);

    /// Factors of several products, prepared for sums with others.
    type Factors;

    /// Prepares forms that depend on the first `span` numbers.
    fn factors(forms: Vec<Self::Form>, span: usize) -> Self::Factors;

    /// Adds the products of as many pairs.
    fn add_products(&mut self, a: &Self::Factors, b: &Self::Factors);

    /// Adds or subtracts a product.
    fn add_signed_product(&mut self, sign: Sign, a: &Self::Form, b: &Self::Form);

    /// Adds a product.
    fn add_product(&mut self, a: &Self::Form, b: &Self::Form) {
        self.add_signed_product(Sign::Plus, a, b);
    }

    /// The sum with all its roundings.
    fn finish(self) -> Self::Form;
}

/// A form with such a sum.
pub trait SummedForm: Sized {
    /// The sum.
    type Sum: FormSum<Form = Self>;

    /// Adds `factor` times `b`.
    #[inline]
    fn add_scaled(&mut self, factor: f64, b: &Self) {
        *self = Self::combination(0.0, [(1.0, &*self), (factor, b)].into_iter());
    }

    /// `start` and the sum of all forms times their factors, rounded as a whole.
    fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self
    where
        Self: 'f,
    {
        let mut sum = Self::Sum::new(start);
        terms.for_each(|(factor, form)| sum.add_scaled(factor, form));
        sum.finish()
    }

    /// The sum of products with their signs, rounded as a whole; products with `is_none` are left out.
    fn summed_products<const N: usize>(
        terms: [(Sign, Self, Self); N],
        is_none: impl Fn(&Self, &Self) -> bool,
    ) -> Self {
        let mut sum = Self::Sum::new(0.0);
        for (sign, a, b) in &terms {
            if !is_none(a, b) {
                sum.add_signed_product(*sign, a, b);
            }
        }
        sum.finish()
    }

    /// The sum of products, rounded as a whole.
    fn sum_of_products<'f>(terms: impl Iterator<Item = (&'f Self, &'f Self)>) -> Self
    where
        Self: 'f,
    {
        let mut sum = Self::Sum::new(0.0);
        terms.for_each(|(a, b)| sum.add_product(a, b));
        sum.finish()
    }
}
