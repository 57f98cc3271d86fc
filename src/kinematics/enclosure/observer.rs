//! Points carried by chains, at all poses of an enclosure at once: their components along a direction, as functions of
//! the dimensions.

use super::pose::PoseEnclosure;
use super::quadratic::QuadraticBound;
use super::rows::Rates;
use super::twists::ChainTwists;
use crate::model::chain::{ArgumentValue, ChainStep};
use crate::model::mechanism::Mechanism;
use crate::model::outputs::output_arguments;
use crate::numbers::affine_form::AffineForm;
use crate::numbers::form_sum::SummedForm;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::{Ring, Scalar};

/// Looks at the poses of an enclosure.
pub struct Observer<'e> {
    enclosure: &'e PoseEnclosure<'e>,
    /// All arguments in use, and their values at δ = 0.
    forms: Vec<ArgumentValue<AffineForm<'e>>>,
    centre: Vec<ArgumentValue<Interval>>,
    rates: Rates<AffineForm<'e>>,
}

/// A sum of components along directions, each of a point that a chain carries.
#[derive(Clone, Debug)]
pub struct Directed<'e> {
    centre: Interval,
    /// Derivatives by coordinates.
    gradient: Vec<(usize, AffineForm<'e>)>,
}

impl Default for Directed<'_> {
    fn default() -> Self {
        Self {
            centre: Interval::ZERO,
            gradient: Vec::new(),
        }
    }
}

impl<'e> Observer<'e> {
    /// For chains with the arguments in `used`.
    pub fn new(enclosure: &'e PoseEnclosure<'e>, mechanism: &Mechanism, used: &[usize]) -> Self {
        let known = &enclosure.region.slots[..mechanism.coordinate_count()];
        let centre = enclosure.region.centre();
        Self {
            enclosure,
            forms: output_arguments(mechanism, used, known),
            centre: output_arguments(mechanism, used, &centre[..known.len()]),
            rates: Rates::new(mechanism, used, known),
        }
    }

    /// Value of an argument at δ = 0, and its uncertainty.
    pub fn spread(&self, argument: usize) -> [f64; 2] {
        let form = &self.forms[argument].value;
        [form.value, form.deviation()]
    }

    /// Adds the component along `direction` of a point at the end of a chain, relative to its start.
    pub fn add_along(
        &self,
        steps: &[ChainStep],
        point: [f64; 3],
        direction: [f64; 3],
        sum: &mut Directed<'e>,
    ) {
        let exact = ChainTwists::new(steps, &self.centre, [0.0; 3])
            .end
            .point(point);
        // The centre is computed with exact dimensions, the slopes with forms over their whole box.
        let along = |sum: Interval, k: usize| sum + exact[k].scale(direction[k]);
        sum.centre = (0..3).fold(sum.centre, along);
        let twists = ChainTwists::new(steps, &self.forms, [0.0; 3]);
        let point = twists.end.point(point);
        twists.velocities(point, |argument, velocity| {
            let mut speed = velocity[0].scale(direction[0]);
            speed.add_scaled(direction[1], &velocity[1]);
            speed.add_scaled(direction[2], &velocity[2]);
            for (slot, rate) in self.rates.of(argument) {
                let part = rate.times(speed);
                match sum.gradient.iter_mut().find(|(known, _)| known == slot) {
                    Some((_, known)) => *known = *known + part,
                    None => sum.gradient.push((*slot, part)),
                }
            }
        });
    }

    /// A sum as a function of the dimensions; `None` if it is not bounded.
    pub fn function(&self, sum: &Directed<'e>) -> Option<QuadraticBound<'e>> {
        let value = sum.centre.middle();
        let rates = self.enclosure.region.chain(&sum.gradient);
        let bounded = sum.centre.is_finite() && rates.iter().all(|rate| rate.is_finite());
        bounded.then(|| QuadraticBound {
            value,
            open: sum.centre.distance(value),
            rates,
        })
    }
}
