//! The equations of one block over a time interval, with bounds of their second derivatives in the ball around the
//! path.

use super::chain::{ArgumentModel, LoopModel, Reaches};
use super::form::{Form, FormChange};
use super::path::TubePath;
use super::taylor_model::{TaylorModel, polynomial_size};
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::loop_part::LoopPart;
use crate::kinematics::structure::proof_plan::ProofRows;
use crate::kinematics::structure::system::System;
use crate::linalg::lanes::{LaneMatrix, Lanes};
use crate::model::mechanism::{Closes, Mechanism};
use crate::numbers::interval::Interval;
use crate::numbers::rounding::{GROW, OPERATION};

/// Number of coefficients of the Jacobian that are kept: the inverse follows it to the same order, and higher orders
/// are small enough in the bound.
pub const JACOBIAN_TERMS: usize = 4;

/// A block and what its unknowns are called by; laid out once.
#[derive(Clone, Debug)]
pub struct TubeLayout<'m> {
    pub mechanism: &'m Mechanism,
    pub block: &'m Block,
    /// The rows of its loops.
    places: ProofRows,
    /// Unknowns: the block's own, then those of earlier blocks.
    pub columns: Vec<usize>,
    /// Number of own unknowns.
    pub own: usize,
    /// Forms that the block uses: its arguments, then its equations. What follows is indexed by the places in this list, so
    /// that a layout is as large as its block, not as the mechanism.
    used: Vec<usize>,
    /// For every form: columns it depends on, with the scale of the unknown.
    moves: Vec<Vec<(usize, f64)>>,
    /// Changes, by the own unknowns and by all, of forms whose change is the same everywhere: affine ones, and
    /// equations of second degree, of which only the curvature is needed.
    changes: [Vec<FormChange>; 2],
    /// Places of forms whose changes depend on the pose.
    bent: Vec<usize>,
}

/// A block over a stretch.
#[derive(Clone, Debug, Default)]
pub struct TubeRows {
    /// Residuals.
    pub residual: Vec<TaylorModel>,
    /// Derivatives by the columns: one matrix a coefficient.
    jacobian: [LaneMatrix; JACOBIAN_TERMS],
    /// Number of them in use: for a constant pose only the first.
    terms: usize,
    /// What they leave out.
    pub rest: LaneMatrix,
    /// For every loop that must not be rotated by π: the trace of its rotation.
    pub traces: Vec<TaylorModel>,
}

impl TubeRows {
    /// The coefficients of the Jacobian, a matrix each.
    pub fn jacobian(&self) -> &[LaneMatrix] {
        &self.jacobian[..self.terms]
    }

    fn begin(&mut self, [rows, columns]: [usize; 2], terms: usize) {
        self.terms = terms;
        for matrix in self.jacobian[..terms].iter_mut().chain([&mut self.rest]) {
            matrix.reset(rows, columns);
        }
        self.residual.clear();
        self.residual.resize(rows, TaylorModel::ZERO);
        self.traces.clear();
    }

    /// Appends the truncation error of a row of the Jacobian and the rounding of its products: `products` of every
    /// entry.
    pub fn add_slack(&self, row: usize, products: f64, slack: &mut Vec<Lanes>) {
        let first = slack.len();
        slack.extend_from_slice(self.rest.row(row));
        for matrix in self.jacobian() {
            for (sums, entries) in slack[first..].iter_mut().zip(matrix.row(row)) {
                let pairs = sums.iter_mut().zip(entries);
                pairs.for_each(|(sum, entry)| *sum += products * entry.abs());
            }
        }
    }

    /// Truncation error of a residual and rounding of its products.
    pub fn open_of(&self, row: usize, products: f64) -> f64 {
        let residual = &self.residual[row];
        residual.rest + products * polynomial_size(&residual.c)
    }
}

/// Bounds that hold within the ball around the path.
#[derive(Debug)]
pub struct Bends {
    /// Of the second derivatives along the block's own unknowns, row by row.
    pub own: Vec<f64>,
    /// The same along those of earlier blocks too.
    pub all: Vec<f64>,
    /// For every loop that must not be rotated by π: bound of its rotation along all unknowns.
    pub turns: Vec<f64>,
    /// Radius of the ball, in radians and sizes.
    pub ball: f64,
}

impl<'m> TubeLayout<'m> {
    /// Lays out a block whose arguments and equations are `forms`.
    pub fn new(system: &'m System, forms: &[Form], block: &'m Block) -> Self {
        let mechanism = system.mechanism();
        let first = mechanism.arguments.len();
        let equations = block.equations.iter().map(|index| first + index);
        // Columns: the block's own unknowns, then those of earlier blocks that stand in its arguments.
        let used: Vec<usize> = block.arguments.iter().copied().chain(equations).collect();
        let mut others: Vec<usize> = used
            .iter()
            .flat_map(|form| forms[*form].coordinates())
            .collect();
        others.sort_unstable();
        others.dedup();
        others.retain(|slot| *slot < mechanism.unknowns.len() && block.columns.of(*slot).is_none());
        let columns = [block.unknowns.clone(), others].concat();
        let own = block.unknowns.len();
        let mut moves = vec![Vec::new(); used.len()];
        for (form, moves) in used.iter().zip(&mut moves) {
            for slot in forms[*form].coordinates() {
                if let Some(column) = columns.iter().position(|c| *c == slot) {
                    moves.push((column, mechanism.scale_of(slot)));
                }
            }
        }
        let rates = [own, columns.len()].map(|count| rates_of(mechanism, &columns[..count]));
        // Changes that are the same everywhere are computed once.
        let mut changes = [(); 2].map(|()| vec![FormChange::default(); used.len()]);
        let mut bent = Vec::new();
        for (place, &form) in used.iter().enumerate() {
            let is_equation = form >= first;
            for (changes, rates) in changes.iter_mut().zip(&rates) {
                match &forms[form] {
                    affine @ Form::Affine(_) => changes[place] = affine.change(&[], rates),
                    formula @ Form::Formula(_) => {
                        let bend = formula.bend(rates).filter(|_| is_equation);
                        changes[place] = FormChange {
                            rate: f64::INFINITY,
                            bend: bend.unwrap_or(f64::INFINITY),
                        };
                    }
                }
            }
            if changes[0][place].bend.is_infinite() {
                bent.push(place);
            }
        }
        Self {
            mechanism,
            block,
            places: ProofRows::new(system.structure(), block),
            columns,
            own,
            used,
            moves,
            changes,
            bent,
        }
    }

    /// Whether a loop could be closed up to a rotation by π; one that closes in a point may rotate.
    fn must_not_turn(&self, part: &LoopPart) -> bool {
        self.mechanism.loops[part.index].closes == Closes::Frame
    }

    /// Scalar equations: place among the forms, row, scale.
    fn equations(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let equations = self.block.equations.iter();
        let places = (self.block.arguments.len()..).zip(self.places.first_equation..);
        let equations = equations.zip(places);
        equations.map(|(index, (place, row))| (place, row, self.mechanism.equations[*index].weight))
    }

    /// Place of an argument among the forms.
    fn place(&self, argument: usize) -> Option<usize> {
        self.block.arguments.binary_search(&argument).ok()
    }

    /// Columns on which an argument depends.
    fn moves_of(&self, argument: usize) -> &[(usize, f64)] {
        self.place(argument).map_or(&[], |place| &self.moves[place])
    }

    /// Number of rows, those beyond the block's included.
    pub fn count(&self) -> usize {
        self.places.count
    }

    /// Residual and Jacobian along the path.
    pub fn rows(&self, forms: &[Form], path: &TubePath, rows: &mut TubeRows) -> Result<(), Reason> {
        let terms = path.still().map_or(JACOBIAN_TERMS, |_| 1);
        rows.begin([self.count(), self.columns.len()], terms);
        // Arguments of the joints as Taylor models of the path parameter.
        let mut arguments: Vec<Option<ArgumentModel>> = vec![None; self.mechanism.arguments.len()];
        for &index in &self.block.arguments {
            let value = forms[index].value(path);
            if !value.is_finite() {
                return Err(Reason::Formula);
            }
            arguments[index] = Some(value.into());
        }
        let derivatives: Vec<Vec<TaylorModel>> = self
            .used
            .iter()
            .map(|index| forms[*index].derivatives(path))
            .collect();
        // Loops: the residual, and a column of the Jacobian for every joint.
        for (part, places) in self.block.loops.iter().zip(&self.places.loops) {
            let closed = &self.mechanism.loops[part.index];
            let moves = |a: usize| !self.moves_of(a).is_empty();
            let item = LoopModel::new(&closed.chain.steps, &arguments, moves, closed.size);
            for (component, row) in places {
                rows.residual[*row] = item.residual(*component);
            }
            if self.must_not_turn(part) {
                rows.traces.push(item.trace());
            }
            let open = item.open();
            for joint in &item.joints {
                let Some(place) = self.place(joint.argument) else {
                    continue;
                };
                let column = item.column(joint, open);
                for (component, row) in places {
                    self.add(rows, *row, place, &column[*component], &derivatives[place]);
                }
            }
        }
        // Scalar equations: the formula and its gradient.
        for (place, row, scale) in self.equations() {
            let weight = TaylorModel::constant(scale);
            rows.residual[row] = forms[self.used[place]].value(path).scaled(scale);
            self.add(rows, row, place, &weight, &derivatives[place]);
        }
        let matrices = rows.jacobian().iter().chain([&rows.rest]);
        let numbers = matrices.flat_map(|m| m.groups().as_flattened());
        let models = rows.residual.iter().chain(&rows.traces);
        let whole = numbers.copied().all(f64::is_finite) && models.copied().all(|m| m.is_finite());
        whole.then_some(()).ok_or(Reason::Formula)
    }

    /// Adds a row's derivative by the form at a place, times that of the form by its unknowns.
    fn add(
        &self,
        rows: &mut TubeRows,
        row: usize,
        place: usize,
        by_form: &TaylorModel,
        of_form: &[TaylorModel],
    ) {
        for ((column, scale), rate) in self.moves[place].iter().zip(of_form) {
            let entry = match (rate.as_number(), by_form.as_number()) {
                (Some(rate), _) => by_form.scaled(rate * scale),
                (None, Some(by_form)) => rate.scaled(by_form * scale),
                (None, None) => by_form.times(rate).scaled(*scale),
            };
            let entry = entry.shortened(JACOBIAN_TERMS);
            for (matrix, c) in rows.jacobian[..rows.terms].iter_mut().zip(&entry.c) {
                *matrix.at_mut(row, *column) += c;
            }
            // Sums of a few entries in one place round by less than each of them once.
            let size: f64 = entry.c.iter().map(|c| c.abs()).sum();
            *rows.rest.at_mut(row, *column) += entry.rest * GROW + 8.0 * OPERATION * size;
        }
    }

    /// Whether second derivatives depend on the ball: those of formulas of unknowns.
    pub fn bends_in_ball(&self) -> bool {
        !self.bent.is_empty()
    }

    /// Second derivatives and turns, valid within `ball` around the whole path.
    pub fn bends(&self, forms: &[Form], path: &TubePath, ball: f64) -> Result<Bends, Reason> {
        // Formulas are bounded over the box of the path and its ball; what changes alike everywhere needs no box.
        let [mut own, mut all] = self.changes.clone();
        let mut around = Vec::new();
        if !self.bent.is_empty() {
            let [by_own, by_all] = [self.own, self.columns.len()]
                .map(|count| rates_of(self.mechanism, &self.columns[..count]));
            around = path.place(&by_all, ball);
            for place in &self.bent {
                let form = &forms[self.used[*place]];
                all[*place] = form.change(&around, &by_all);
                own[*place] = match self.own == self.columns.len() {
                    true => all[*place],
                    false => form.change(&around, &by_own),
                };
            }
        }
        let change = |of: &[FormChange], argument: usize| {
            self.place(argument)
                .map_or(FormChange::default(), |place| of[place])
        };
        let mut bends = Bends {
            own: vec![0.0; self.count()],
            all: vec![0.0; self.count()],
            turns: Vec::new(),
            ball,
        };
        // Second derivatives of a loop from the reaches of its joints.
        for (part, places) in self.block.loops.iter().zip(&self.places.loops) {
            let item = &self.mechanism.loops[part.index];
            // The value over the path, and what the ball adds to it.
            let farthest = |a: usize| match &forms[a] {
                Form::Affine(affine) => {
                    let value = TaylorModel::of_affine(affine, &path.coordinates);
                    value.size() + change(&all, a).rate * ball
                }
                form @ Form::Formula(_) => form.range(&around).magnitude(),
            };
            let reaches = Reaches::new(&item.chain.steps, farthest, item.size);
            let of_own = reaches.second_derivatives(|a| change(&own, a));
            let of_all = reaches.second_derivatives(|a| change(&all, a));
            for (component, row) in places {
                bends.own[*row] = of_own[component / 3];
                bends.all[*row] = of_all[component / 3];
            }
            if self.must_not_turn(part) {
                bends.turns.push(reaches.turn(|a| change(&all, a).rate));
            }
        }
        for (place, row, scale) in self.equations() {
            bends.own[row] = own[place].bend * scale;
            bends.all[row] = all[place].bend * scale;
        }
        let mut bounds = bends.own.iter().chain(&bends.all);
        if bounds.all(|b| b.is_finite()) {
            Ok(bends)
        } else {
            Err(Reason::Formula)
        }
    }
}

/// How fast every coordinate moves where those in `columns` move by one unit of their scale.
fn rates_of(mechanism: &Mechanism, columns: &[usize]) -> Vec<f64> {
    let mut rates = vec![0.0; mechanism.coordinate_count()];
    for slot in columns {
        rates[*slot] = mechanism.scale_of(*slot);
    }
    rates
}

impl TubePath {
    /// All values of the coordinates in a ball around the path; `scales` are those of the unknowns in the ball.
    fn place(&self, scales: &[f64], ball: f64) -> Vec<Interval> {
        let all = self.coordinates.iter().zip(scales);
        all.map(|(x, scale)| x.range() + Interval::around_zero(ball * scale))
            .collect()
    }
}
