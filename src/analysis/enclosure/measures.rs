//! Measures of all pieces: the quantities of the poses as functions of the dimensions, reduced along the tracks and
//! inserted into the formulas of the measures. If the derivatives show at which corner of the tolerances a measure has
//! its extreme, all poses of that piece are solved and proved.

use super::plan::TolerancePlan;
use super::pose_bands::{BandObstacle, PieceFinder, is_sharp};
use super::reductions::taken_number;
use super::tracked::Tracked;
use crate::analysis::study::Nominal;
use crate::kinematics::abreast::anchor::AnchorPose;
use crate::kinematics::enclosure::pose::{Encloser, PoseEnclosure, REFINING};
use crate::kinematics::enclosure::quadratic::{BoxFace, QuadraticBound};
use crate::kinematics::enclosure::rows::expression_gradient;
use crate::kinematics::loops::observed::observed_slots;
use crate::model::expression::Expression;
use crate::model::measure::MeasureSource;
use crate::numbers::affine_form::AffineForm;
use crate::numbers::form_room::FormRoom;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::{Ring, Scalar};

/// The range of a measure over all pieces; infinite if it is not bounded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasureBand {
    /// No piece is lower.
    pub lo: f64,
    /// No piece is higher.
    pub hi: f64,
    /// Whether this holds for the whole drive, not only for the poses of the measure.
    pub at_all_times: bool,
}

/// Ranges of all measures, from the poses of the family's tracks with the file's dimensions.
///
/// # Errors
/// The first pose that has no box, counted over all tracks.
pub fn enclose_measures(
    plan: &TolerancePlan,
    nominal: &Nominal,
) -> Result<Vec<MeasureBand>, (usize, BandObstacle)> {
    let encloser = Encloser::new(plan.family.system());
    let room = FormRoom::new(plan.room_for(plan.dimensions.len()));
    if let Some(passage) = nominal.singular {
        let time = passage.time;
        return Err((passage.behind, BandObstacle::BehindSingularPose { time }));
    }
    let mut search = MeasureSearch {
        plan,
        encloser: &encloser,
        finder: PieceFinder::new(plan, &encloser),
        nominal,
        anchors: Vec::new(),
    };
    // Poses that first-order forms cannot enclose are enclosed with second-order forms at once.
    let (mut plain, mut is_rough) = (Vec::new(), Vec::new());
    for (index, pose) in nominal.poses.iter().enumerate() {
        let (enclosure, rough) = match search.finder.enclosed_plainly(pose, &room) {
            Ok(enclosed) => enclosed,
            Err(_) => {
                let bent = search.finder.enclosed(pose, &room);
                (bent.map_err(|obstacle| (index, obstacle))?, false)
            }
        };
        plain.push(enclosure);
        is_rough.push(rough);
    }
    let first = search.reached(&plain, &room);
    let list = |reached: &[Reached]| reached.iter().map(|r| r.band).collect::<Vec<_>>();
    let sharp = |r: &Reached| {
        let size = r.band.lo.abs().max(r.band.hi.abs());
        is_sharp([r.band.lo, r.band.hi], r.found, size)
    };
    if !is_rough.contains(&true) || first.iter().all(sharp) {
        return Ok(list(&first));
    }
    let mut enclosures = Vec::new();
    for (known, rough) in plain.into_iter().zip(is_rough) {
        enclosures.push(match rough {
            true => search.finder.refined(&known, &room, REFINING[1]),
            false => known,
        });
    }
    let second = list(&search.reached(&enclosures, &room));
    let pairs = first.iter().zip(second);
    let tighter = pairs.map(|(a, b)| MeasureBand {
        lo: a.band.lo.max(b.lo),
        hi: a.band.hi.min(b.hi),
        at_all_times: false,
    });
    Ok(tighter.collect())
}

/// A band, and the least and greatest values that pieces take at its ends.
struct Reached {
    band: MeasureBand,
    found: [f64; 2],
}

struct MeasureSearch<'p> {
    plan: &'p TolerancePlan<'p>,
    encloser: &'p Encloser<'p>,
    finder: PieceFinder<'p>,
    nominal: &'p Nominal,
    /// Solvers for every pose, created when the first pieces are needed.
    anchors: Vec<Option<AnchorPose>>,
}

impl MeasureSearch<'_> {
    /// Bands from the enclosures of all poses, and the values of the pieces at their ends.
    fn reached<'r>(
        &mut self,
        enclosures: &[PoseEnclosure<'r>],
        room: &'r FormRoom,
    ) -> Vec<Reached> {
        let count = self.plan.dimensions.len();
        let inputs = plan_inputs(self.plan, room);
        let value = |pose: usize, formula: &Expression| {
            let (form, rates) = enclosures[pose].formula(formula);
            Tracked { form, rates }
        };
        let numbers = measure_numbers(self.plan, inputs.clone(), count, value);
        let faces: Vec<[BoxFace; 2]> = numbers
            .iter()
            .map(|number| {
                let function = QuadraticBound {
                    value: number.form.value,
                    open: 0.0,
                    rates: number.rates.clone(),
                };
                [-1.0, 1.0].map(|sign| function.face(sign))
            })
            .collect();
        let mut places: Vec<&[f64]> = Vec::new();
        // Without derivatives there is no corner to examine.
        let bounded = |face: &&BoxFace| face.beyond.is_finite();
        for face in faces.iter().flatten().filter(bounded) {
            for place in [&face.middle, &face.best] {
                if !places.contains(&&place[..]) {
                    places.push(place);
                }
            }
        }
        let at = self.measured_pieces(enclosures, &places, &inputs);
        let measured = |place: &[f64], index: usize| {
            let known = places.iter().position(|known| *known == place)?;
            Some(at[known].as_ref()?[index]).filter(|range| range.is_finite())
        };
        let one = |(index, number): (usize, &Tracked)| {
            let mut range = match number.form.is_finite() {
                true => number.form.range(),
                false => Interval::ENTIRE,
            };
            let mut found = [number.form.value; 2];
            let [least, greatest] = &faces[index];
            if let Some(lowest) = measured(&least.middle, index) {
                let reach = lowest - Interval::point(least.beyond);
                range.lo = range.lo.max(reach.lo);
            }
            if let Some(highest) = measured(&greatest.middle, index) {
                let reach = highest + Interval::point(greatest.beyond);
                range.hi = range.hi.min(reach.hi);
            }
            for face in [least, greatest] {
                if let Some(value) = measured(&face.best, index) {
                    found = [found[0].min(value.middle()), found[1].max(value.middle())];
                }
            }
            let Interval { lo, hi } = range;
            Reached {
                band: MeasureBand {
                    lo,
                    hi,
                    at_all_times: false,
                },
                found,
            }
        };
        numbers.iter().enumerate().map(one).collect()
    }

    /// All measures of the pieces at δ; none of a piece with a pose that is not proved.
    fn measured_pieces(
        &mut self,
        enclosures: &[PoseEnclosure],
        places: &[&[f64]],
        inputs: &[Tracked],
    ) -> Vec<Option<Vec<Interval>>> {
        let system = self.plan.family.system();
        if self.anchors.is_empty() {
            let poses = self.nominal.poses.iter();
            self.anchors = poses.map(|pose| AnchorPose::new(system, pose)).collect();
        }
        // Slots of every pose at every place.
        let mut slots: Vec<Vec<Option<Vec<Interval>>>> = Vec::with_capacity(enclosures.len());
        for (enclosure, anchor) in enclosures.iter().zip(&self.anchors) {
            let pieces = self.finder.pieces(enclosure, places, anchor.as_ref());
            let shown = pieces.iter().zip(places).map(|(piece, place)| {
                let proved = self.encloser.piece(enclosure, place, piece.as_deref()?)?;
                Some(observed_slots(system.mechanism(), &proved))
            });
            slots.push(shown.collect());
        }
        let at = |(index, place): (usize, &&[f64])| {
            let poses: Option<Vec<&[Interval]>> =
                slots.iter().map(|pose| pose[index].as_deref()).collect();
            let poses = poses?;
            let inputs = inputs.iter().map(|input| of_piece(input, place)).collect();
            let value = |pose: usize, formula: &Expression| {
                Tracked::without_rates(AffineForm::of_interval(formula.value(poses[pose])), 0)
            };
            let numbers = measure_numbers(self.plan, inputs, 0, value);
            Some(numbers.iter().map(|number| number.form.range()).collect())
        };
        places.iter().enumerate().map(at).collect()
    }
}

/// An input of the piece at δ.
fn of_piece(input: &Tracked, place: &[f64]) -> Tracked<'static> {
    let form = &input.form;
    let drawn = Interval::point(form.value) + Interval::around_zero(form.error);
    let moved = form.slopes().iter().zip(place);
    let value = moved.fold(drawn, |sum, (slope, d)| {
        sum + Interval::point(*slope).scale(*d)
    });
    Tracked::without_rates(AffineForm::of_interval(value), 0)
}

/// All measures, from the inputs at the start of the drive and the values of formulas at the poses of the tracks.
fn measure_numbers<'r>(
    plan: &TolerancePlan,
    inputs: Vec<Tracked<'r>>,
    count: usize,
    value: impl Fn(usize, &Expression) -> Tracked<'r>,
) -> Vec<Tracked<'r>> {
    let first = inputs.len();
    let mut numbers = inputs;
    for measure in &plan.family.measures.list {
        let number = match &measure.source {
            MeasureSource::Formula(formula) => of_formula(formula, &numbers),
            // Derivatives by inputs and outputs with rates have no slopes by the dimensions.
            MeasureSource::Over { per: Some(_), .. } => Tracked::undefined(count),
            MeasureSource::Over { rates, .. } if !rates.is_empty() => Tracked::undefined(count),
            MeasureSource::Over {
                of, taking, power, ..
            } => {
                let poses = plan.family.poses_taken(&measure.source);
                let values: Vec<Vec<Tracked>> = (of.iter())
                    .map(|formula| poses.clone().map(|pose| value(pose, formula)).collect())
                    .collect();
                taken_number(*taking, *power, &values, count)
            }
        };
        numbers.push(number);
    }
    numbers.split_off(first)
}

/// A formula of numbers.
fn of_formula<'r>(formula: &Expression, numbers: &[Tracked<'r>]) -> Tracked<'r> {
    let forms: Vec<AffineForm> = numbers.iter().map(|number| number.form).collect();
    let value = formula.value(&forms);
    let count = numbers.iter().map(|number| number.rates.len()).max();
    if count.unwrap_or(0) == 0 {
        return Tracked::without_rates(value, 0);
    }
    // Chain rule: the rates of a formula from its gradient over the whole box and the rates of its slots.
    let gradient = expression_gradient(formula, &forms).into_iter();
    let parts: Vec<(AffineForm, &Tracked)> = gradient
        .map(|(slot, by_slot)| (by_slot, &numbers[slot]))
        .collect();
    let mut number = Tracked::through(value, &parts);
    number.rates.resize(count.unwrap_or(0), AffineForm::ZERO);
    number
}

/// The inputs at the start of the drive, as functions of the dimensions.
fn plan_inputs<'r>(plan: &TolerancePlan, room: &'r FormRoom) -> Vec<Tracked<'r>> {
    let family = plan.family;
    let unknowns = family.mechanism().unknowns.len();
    let start = family.actuation.inputs_at(0.0);
    let pose = [vec![0.0; unknowns], start.clone()].concat();
    let open = plan.input_open(&pose);
    let still = vec![AffineForm::ZERO; plan.dimensions.len()];
    // The rounding of the start values, then the tolerance of each dimension as a symbol of its own.
    let one = |(value, open): (&f64, f64)| Tracked {
        form: AffineForm::within(*value, open),
        rates: still.clone(),
    };
    let mut inputs: Vec<Tracked> = start.iter().zip(open).map(one).collect();
    for (k, tolerance) in plan.tolerances(&pose).iter().enumerate() {
        let input = &mut inputs[tolerance.slot - unknowns];
        let mut slopes = vec![0.0; plan.dimensions.len()];
        slopes[k] = tolerance.half_width;
        input.form = AffineForm::linear(room, input.form.value, &slopes, input.form.error);
        input.rates[k] = AffineForm::within(tolerance.half_width, 0.0);
    }
    inputs
}
