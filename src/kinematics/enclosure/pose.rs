//! A pose for all dimensions in their intervals: unknowns, traced points, outputs, and any formula of them.

use super::block::{Unbounded, enclose_block, refine_block};
use super::form::DimensionForm;
use super::quadratic::QuadraticBound;
use super::region::{Region, ToleranceInterval};
use super::rows::{Layout, Rates, argument_values, expression_gradient, turning_arguments};
use super::twists::ChainTwists;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::structure::system::System;
use crate::model::expression::Expression;
use crate::model::mechanism::{Mechanism, OutputSource};
use crate::numbers::affine_form::AffineForm;
use crate::numbers::form_room::FormRoom;
use crate::numbers::interval::Interval;
use crate::numbers::quadratic_form::QuadraticForm;
use crate::numbers::scalar::Scalar;

/// Poses whose boxes leave more than this share of the unknowns' range open are enclosed to second order.
const ROUGH: f64 = 1e-3;

/// Most dimensions of forms of second order: a form takes four times the square of it in bytes.
const MOST_BENT: usize = 36;

/// Rounds of a refinement: one makes nearly all bands of poses as narrow as their pieces; measures over many poses need the
/// others, which double the time, and after three nothing more was gained.
pub const REFINING: [usize; 2] = [1, 3];

/// What is enclosed.
#[derive(Clone, Copy, Debug)]
pub struct Sought<'p> {
    /// A closed pose: unknowns, then inputs.
    pub pose: &'p [f64],
    /// Uncertainty of the inputs as written.
    pub input_open: &'p [f64],
    /// What varies.
    pub tolerances: &'p [ToleranceInterval],
    /// The rows on which each block is proved.
    pub bases: &'p [Vec<usize>],
}

/// Encloses poses of one system. Its layout is computed once.
#[derive(Clone, Debug)]
pub struct Encloser<'s> {
    pub(super) system: &'s System,
    pub(super) layouts: Vec<Layout<'s>>,
}

/// The poses of all pieces at one place of the drive.
#[derive(Clone, Debug)]
pub struct PoseEnclosure<const N: usize> {
    pub(super) region: Region<AffineForm<N>>,
    coordinates: usize,
}

impl<'s> Encloser<'s> {
    /// Prepares the proofs.
    pub fn new(system: &'s System) -> Self {
        let blocks = system.blocks().iter();
        let layouts = blocks.map(|block| Layout::new(system.mechanism(), block));
        Self {
            layouts: layouts.collect(),
            system,
        }
    }

    /// Encloses the poses near a closed one. Forms of second order are kept in `room`.
    ///
    /// # Errors
    /// No box is proved.
    pub fn enclose<const N: usize>(
        &self,
        sought: Sought,
        room: &mut FormRoom,
    ) -> Result<PoseEnclosure<N>, Unbounded> {
        if sought.tolerances.len() > N {
            // No form has room for them.
            return Err(Reason::Formula.into());
        }
        let region = match self.region::<AffineForm<N>>((), sought) {
            // If the second order of the Jacobian makes the boxes wide, it is kept.
            Ok((region, roughness)) if Self::is_rough::<N>(roughness) => {
                self.refined_region(&region, room, REFINING[1])
            }
            Ok((region, _)) => region,
            Err(unbounded) if unbounded.reason == Reason::Singular && N <= MOST_BENT => {
                self.bent_region(sought, room).ok_or(unbounded)?
            }
            Err(unbounded) => return Err(unbounded),
        };
        Ok(PoseEnclosure {
            region,
            coordinates: sought.pose.len(),
        })
    }

    fn is_rough<const N: usize>(roughness: f64) -> bool {
        roughness > ROUGH && N <= MOST_BENT
    }

    /// The same with first-order forms only; also returns whether second-order forms would be tried.
    ///
    /// # Errors
    /// No box is proved.
    pub fn enclose_plainly<const N: usize>(
        &self,
        sought: Sought,
    ) -> Result<(PoseEnclosure<N>, bool), Unbounded> {
        if sought.tolerances.len() > N {
            return Err(Reason::Formula.into());
        }
        let (region, roughness) = self.region::<AffineForm<N>>((), sought)?;
        let enclosure = PoseEnclosure {
            region,
            coordinates: sought.pose.len(),
        };
        Ok((enclosure, Self::is_rough::<N>(roughness)))
    }

    /// A first-order enclosure that keeps terms of second order, in one of the numbers of rounds of [`REFINING`].
    pub fn refined<const N: usize>(
        &self,
        plain: &PoseEnclosure<N>,
        room: &mut FormRoom,
        rounds: usize,
    ) -> PoseEnclosure<N> {
        PoseEnclosure {
            region: self.refined_region(&plain.region, room, rounds),
            coordinates: plain.coordinates,
        }
    }

    fn refined_region<const N: usize>(
        &self,
        plain: &Region<AffineForm<N>>,
        room: &mut FormRoom,
        rounds: usize,
    ) -> Region<AffineForm<N>> {
        room.empty(self.form_size::<N>(plain.count));
        let room = &*room;
        let mechanism = self.system.mechanism();
        let (unknowns, coordinates) = (mechanism.unknowns.len(), mechanism.coordinate_count());
        // The coordinates as second-order forms whose coefficients of second order are still zero.
        let lifted = |form: &AffineForm<N>| QuadraticForm::within(*form, room);
        let mut region = Region {
            room,
            count: plain.count,
            slots: plain.slots[..coordinates].iter().map(lifted).collect(),
            open: plain.open[..coordinates].to_vec(),
            rates: plain.rates[..coordinates * plain.count]
                .iter()
                .map(lifted)
                .collect(),
            boxes: plain.boxes.clone(),
        };
        // Each unknown as the integral of its known rates: their slopes become terms of second order.
        for slot in 0..unknowns {
            let (value, rates) = (plain.slots[slot].value, region.rates_of(slot));
            region.slots[slot] = DimensionForm::integral(room, value, plain.open[slot], rates);
        }
        // With these forms the blocks are enclosed once more, in the boxes that are proved already.
        for (layout, known) in self.layouts.iter().zip(&plain.boxes) {
            if known.roughness > ROUGH {
                refine_block(layout, known, &mut region, rounds);
            }
        }
        // Traces and outputs follow from the coordinates; then second-order terms are bounded again.
        show_all(mechanism, &mut region);
        plain_region(region)
    }

    /// How much forms of this many dimensions and of the sides of a block's box depend on.
    fn form_size<const N: usize>(&self, dimensions: usize) -> usize {
        let largest = self.layouts.iter().map(Layout::own).max();
        (dimensions + largest.unwrap_or(0)).min(N)
    }

    /// Everything with forms of second order.
    fn bent_region<const N: usize>(
        &self,
        sought: Sought,
        room: &mut FormRoom,
    ) -> Option<Region<AffineForm<N>>> {
        room.empty(self.form_size::<N>(sought.tolerances.len()));
        let (region, _) = self.region::<QuadraticForm<N>>(&*room, sought).ok()?;
        Some(plain_region(region))
    }

    /// Enclosures of all slots, and the largest share of the unknowns' range that remains open.
    fn region<F: DimensionForm>(
        &self,
        room: F::Room,
        sought: Sought,
    ) -> Result<(Region<F>, f64), Unbounded> {
        let mechanism = self.system.mechanism();
        let unknowns = mechanism.unknowns.len();
        let Sought {
            pose,
            input_open,
            tolerances,
            ..
        } = sought;
        let mut region = Region::<F>::new(room, pose, unknowns, input_open, tolerances);
        let mut roughness = 0.0_f64;
        for (layout, basis) in self.layouts.iter().zip(sought.bases) {
            roughness = roughness.max(enclose_block(mechanism, layout, basis, &mut region)?);
        }
        show_all(mechanism, &mut region);
        Ok((region, roughness))
    }
}

/// The same to the first order, with the rest bounded.
fn plain_region<const N: usize>(region: Region<QuadraticForm<N>>) -> Region<AffineForm<N>> {
    let lines = |forms: &[QuadraticForm<N>]| forms.iter().map(QuadraticForm::affine).collect();
    Region {
        room: (),
        count: region.count,
        slots: lines(&region.slots),
        rates: lines(&region.rates),
        open: region.open,
        boxes: region.boxes,
    }
}

/// Appends x, y, z of every trace and all outputs.
fn show_all<F: DimensionForm>(mechanism: &Mechanism, region: &mut Region<F>) {
    let centre = observed_slots(mechanism, &region.centre());
    show_traces(mechanism, region, &centre);
    for (output, place) in mechanism.outputs.iter().zip(region.slots.len()..) {
        let rates = match &output.source {
            OutputSource::Formula(formula) => {
                region.chain(&expression_gradient(formula, &region.slots))
            }
            // A distance or a rate is not bounded here.
            OutputSource::Distance(_) | OutputSource::Rated(_) => region.chain(&[]),
        };
        region.push(centre[place], rates);
    }
}

/// Appends x, y, z of every trace.
fn show_traces<F: DimensionForm>(
    mechanism: &Mechanism,
    region: &mut Region<F>,
    centre: &[Interval],
) {
    let coordinates = region.slots.len();
    for trace in &mechanism.traces {
        let chain = &mechanism.bodies[trace.body].world_from_body;
        let used = chain.arguments();
        let known = &region.slots[..coordinates];
        let turning = turning_arguments(mechanism, std::iter::once(&chain.steps[..]));
        let (values, rates) = (
            argument_values(mechanism, &used, &turning, known),
            Rates::new(mechanism, &used, known),
        );
        let twists = ChainTwists::new(&chain.steps, &values, [0.0; 3]);
        let point = twists.end.point(trace.point.to_array());
        // Velocity of the point by every coordinate, summed over the joints that it moves.
        let mut gradients: [Vec<(usize, F)>; 3] = Default::default();
        twists.velocities(point, |argument, velocity| {
            for (slot, rate) in rates.of(argument) {
                for (gradient, along) in gradients.iter_mut().zip(velocity) {
                    let part = rate.times(along);
                    match gradient.iter_mut().find(|(known, _)| known == slot) {
                        Some((_, sum)) => *sum = *sum + part,
                        None => gradient.push((*slot, part)),
                    }
                }
            }
        });
        for gradient in gradients {
            let rates = region.chain(&gradient);
            region.push(centre[region.slots.len()], rates);
        }
    }
}

impl<const N: usize> PoseEnclosure<N> {
    /// Slot `index` (coordinates, x, y, z of the traces, outputs) as a function of the dimensions.
    pub fn slot(&self, index: usize) -> QuadraticBound<N> {
        QuadraticBound {
            value: self.region.slots[index].value,
            open: self.region.open[index],
            rates: self.region.rates_of(index).to_vec(),
        }
    }

    /// Derivatives of slot `index` by every δ.
    pub fn rates(&self, index: usize) -> &[AffineForm<N>] {
        self.region.rates_of(index)
    }

    /// Slot `index` to the first order.
    pub fn form(&self, index: usize) -> AffineForm<N> {
        self.region.slots[index]
    }

    /// Number of slots.
    pub fn len(&self) -> usize {
        self.region.slots.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A formula of the slots as a function of the dimensions, to the first order, and its derivatives by every δ.
    pub fn formula(&self, expression: &Expression) -> (AffineForm<N>, Vec<AffineForm<N>>) {
        let region = &self.region;
        let rates = region.chain(&expression_gradient(expression, &region.slots));
        let centre = expression.value(&region.centre());
        let value = centre.middle();
        let form = match centre.is_finite() {
            true => DimensionForm::integral((), value, centre.distance(value), &rates),
            false => AffineForm::undefined(),
        };
        (form, rates)
    }

    /// The coordinates at δ = 0.
    pub fn middle(&self) -> Vec<f64> {
        let slots = self.region.slots[..self.coordinates].iter();
        slots.map(|form| form.value).collect()
    }

    /// The coordinates at δ to the second order.
    pub fn coordinates_at(&self, place: &[f64]) -> Vec<f64> {
        let of = |slot: usize| {
            let mut value = self.region.slots[slot].value;
            for (rate, d) in self.region.rates_of(slot).iter().zip(place) {
                let bend: f64 = rate.slopes.iter().zip(place).map(|(s, e)| s * e).sum();
                value += d * (rate.value + 0.5 * bend);
            }
            value
        };
        (0..self.coordinates).map(of).collect()
    }

    /// Whether coordinates lie in the box, which contains one pose for every δ.
    pub fn holds(&self, coordinates: &[f64]) -> bool {
        let pairs = coordinates.iter().zip(&self.region.slots);
        pairs
            .into_iter()
            .all(|(x, form)| (x - form.value).abs() <= form.deviation())
    }
}
