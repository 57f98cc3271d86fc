//! Forms over a block's box, with what its sides change them by apart: if the sides shrink, so do these effects, and
//! nothing else needs to be evaluated again.

use super::form::DimensionForm;
use crate::numbers::rounding::GROW;

/// Rows of forms that nearly vanish at δ = 0.
pub struct SidedForms<F> {
    /// Without the effects of the sides.
    pub list: Vec<F>,
    /// Forms in a row.
    pub columns: usize,
    /// Bounds of the linear parts.
    pub radii: Vec<f64>,
    /// Bounds of everything else except what the sides change: in all, and without coefficients.
    beyond: [Vec<f64>; 2],
    /// Changes along every side, form after form.
    sides: Vec<f64>,
}

/// Bounds of forms for sides of some length.
pub struct SidedBounds {
    /// Of what no coefficient describes.
    pub opens: Vec<f64>,
    /// Of everything except the linear parts.
    pub rests: Vec<f64>,
    /// Of the magnitudes.
    pub sizes: Vec<f64>,
}

impl<F: DimensionForm> SidedForms<F> {
    /// Forms that depend on the first `span` numbers and on as many `sides` behind them.
    pub fn new(forms: impl Iterator<Item = F>, columns: usize, span: usize, sides: usize) -> Self {
        let mut all = Self {
            list: Vec::with_capacity(forms.size_hint().0),
            columns,
            radii: Vec::new(),
            beyond: Default::default(),
            sides: Vec::new(),
        };
        for form in forms {
            let kept = form.cut(span);
            let beside = kept.nominal().abs();
            let own = span..span + sides;
            all.sides.extend(own.map(|index| form.effect_of(index)));
            all.list.push(kept);
            all.radii.push(kept.radius());
            let beyond = [kept.beyond(), kept.rest()].map(|rest| (beside + rest) * GROW);
            let lists = all.beyond.iter_mut().zip(beyond);
            lists.for_each(|(list, rest)| list.push(rest));
        }
        all
    }

    /// Bounds for sides with these shares of their lengths.
    pub fn bounds(&self, shares: &[f64]) -> SidedBounds {
        let by_form = self.sides.chunks_exact(shares.len().max(1));
        let effects = by_form.map(|own| own.iter().zip(shares).map(|(s, share)| s * share).sum());
        let effects: Vec<f64> = effects.collect();
        let [rests, opens] = self.beyond.each_ref().map(|list| {
            let pairs = list.iter().zip(&effects);
            let bounds = pairs.map(|(rest, effect): (&f64, &f64)| (rest + effect) * GROW);
            bounds.collect::<Vec<_>>()
        });
        let sizes = self.radii.iter().zip(&rests);
        SidedBounds {
            sizes: sizes.map(|(radius, rest)| (radius + rest) * GROW).collect(),
            rests,
            opens,
        }
    }
}
