//! A pose for all dimensions in their intervals: unknowns, traced points, outputs, and any formula of them.

use super::block::{Unbounded, enclose_block, refine_block};
use super::form::StoredForm;
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

/// Most numbers of forms of second order: a form takes four times the square of it in bytes.
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

/// Where forms are kept.
#[derive(Debug)]
pub struct Rooms<'w, 'r> {
    /// Those on the way to a result: given up by the next one.
    pub work: &'w mut FormRoom,
    /// Those of the result; its size is theirs.
    pub kept: &'r FormRoom,
}

/// Encloses poses of one system. Its layout is computed once.
#[derive(Clone, Debug)]
pub struct Encloser<'s> {
    pub(super) system: &'s System,
    pub(super) layouts: Vec<Layout<'s>>,
}

/// The poses of all pieces at one place of the drive.
#[derive(Clone, Debug)]
pub struct PoseEnclosure<'r> {
    pub(super) region: Region<'r, AffineForm<'r>>,
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

    /// Encloses the poses near a closed one, in forms as large as those of `rooms`.
    ///
    /// # Errors
    /// No box is proved.
    pub fn enclose<'r>(
        &self,
        sought: Sought,
        rooms: Rooms<'_, 'r>,
    ) -> Result<PoseEnclosure<'r>, Unbounded> {
        let Rooms { work, kept } = rooms;
        match self.enclose_plainly(sought, Rooms { work, kept }) {
            // If the second order of the Jacobian makes the boxes wide, it is kept.
            Ok((plain, true)) => Ok(self.refined(&plain, Rooms { work, kept }, REFINING[1])),
            Ok((plain, false)) => Ok(plain),
            Err(unbounded) if unbounded.reason == Reason::Singular && kept.count() <= MOST_BENT => {
                work.empty(kept.count());
                let (region, _) = self
                    .region::<QuadraticForm>(&*work, sought)
                    .map_err(|_| unbounded)?;
                Ok(self.kept(plain_region(region), kept))
            }
            Err(unbounded) => Err(unbounded),
        }
    }

    /// The same with first-order forms only; also returns whether second-order forms would be tried.
    ///
    /// # Errors
    /// No box is proved.
    pub fn enclose_plainly<'r>(
        &self,
        sought: Sought,
        Rooms { work, kept }: Rooms<'_, 'r>,
    ) -> Result<(PoseEnclosure<'r>, bool), Unbounded> {
        work.empty(kept.count());
        let (region, roughness) = self.region::<AffineForm>(&*work, sought)?;
        let is_rough = roughness > ROUGH && kept.count() <= MOST_BENT;
        Ok((self.kept(region, kept), is_rough))
    }

    /// The result in a room of its own: what led to it is given up.
    fn kept<'r>(&self, region: Region<AffineForm>, room: &'r FormRoom) -> PoseEnclosure<'r> {
        let forms = |list: &[AffineForm]| list.iter().map(|form| form.kept_in(room)).collect();
        PoseEnclosure {
            coordinates: self.system.mechanism().coordinate_count(),
            region: Region {
                room,
                count: region.count,
                slots: forms(&region.slots),
                rates: forms(&region.rates),
                open: region.open,
                boxes: region.boxes,
            },
        }
    }

    /// A first-order enclosure that keeps terms of second order, in one of the numbers of rounds of [`REFINING`].
    pub fn refined<'r>(
        &self,
        plain: &PoseEnclosure,
        Rooms { work, kept }: Rooms<'_, 'r>,
        rounds: usize,
    ) -> PoseEnclosure<'r> {
        work.empty(kept.count());
        self.kept(self.refined_region(&plain.region, &*work, rounds), kept)
    }

    fn refined_region<'w>(
        &self,
        plain: &Region<'w, AffineForm<'w>>,
        room: &'w FormRoom,
        rounds: usize,
    ) -> Region<'w, AffineForm<'w>> {
        let mechanism = self.system.mechanism();
        let (unknowns, coordinates) = (mechanism.unknowns.len(), mechanism.coordinate_count());
        // The coordinates as second-order forms whose coefficients of second order are still zero.
        let lifted = |form: &AffineForm<'w>| QuadraticForm::from(form.working_in(room));
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
            region.slots[slot] = StoredForm::integral(room, value, plain.open[slot], rates);
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

    /// Enclosures of all slots, and the largest share of the unknowns' range that remains open.
    fn region<'r, F: StoredForm<'r>>(
        &self,
        room: &'r FormRoom,
        sought: Sought,
    ) -> Result<(Region<'r, F>, f64), Unbounded> {
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
fn plain_region<'r>(region: Region<'r, QuadraticForm<'r>>) -> Region<'r, AffineForm<'r>> {
    let lines = |forms: &[QuadraticForm<'r>]| forms.iter().map(QuadraticForm::affine).collect();
    Region {
        room: region.room,
        count: region.count,
        slots: lines(&region.slots),
        rates: lines(&region.rates),
        open: region.open,
        boxes: region.boxes,
    }
}

/// Appends x, y, z of every trace and all outputs.
fn show_all<'r, F: StoredForm<'r>>(mechanism: &Mechanism, region: &mut Region<'r, F>) {
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
fn show_traces<'r, F: StoredForm<'r>>(
    mechanism: &Mechanism,
    region: &mut Region<'r, F>,
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

impl<'r> PoseEnclosure<'r> {
    /// Slot `index` (coordinates, x, y, z of the traces, outputs) as a function of the dimensions.
    pub fn slot(&self, index: usize) -> QuadraticBound<'r> {
        QuadraticBound {
            value: self.region.slots[index].value,
            open: self.region.open[index],
            rates: self.region.rates_of(index).to_vec(),
        }
    }

    /// Derivatives of slot `index` by every δ.
    pub fn rates(&self, index: usize) -> &[AffineForm<'r>] {
        self.region.rates_of(index)
    }

    /// Slot `index` to the first order.
    pub fn form(&self, index: usize) -> AffineForm<'r> {
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
    pub fn formula(&self, expression: &Expression) -> (AffineForm<'r>, Vec<AffineForm<'r>>) {
        let region = &self.region;
        let rates = region.chain(&expression_gradient(expression, &region.slots));
        let centre = expression.value(&region.centre());
        let value = centre.middle();
        let form = match centre.is_finite() {
            true => StoredForm::integral(region.room, value, centre.distance(value), &rates),
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
                let bend: f64 = rate.slopes().iter().zip(place).map(|(s, e)| s * e).sum();
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
