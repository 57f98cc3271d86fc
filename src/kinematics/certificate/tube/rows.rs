//! The equations of one block over a stretch, with bounds of their second derivatives in the ball around the path.

use super::super::Reason;
use super::super::interval::Interval;
use super::chain::{ArgumentSeries, LoopSeries, Reaches};
use super::form::{Change, Form};
use super::path::Path;
use super::series::Series;
use crate::kinematics::structure::{Block, LoopPart};
use crate::model::mechanism::{Closes, Mechanism};

/// A block over a stretch.
pub struct Rows {
    /// Residuals.
    pub residual: Vec<Series>,
    /// Derivatives by the columns, row by row.
    pub jacobian: Vec<Series>,
    /// Bounds of the second derivatives along the block's own unknowns.
    pub second: Vec<f64>,
    /// The same along those of earlier blocks too.
    pub second_all: Vec<f64>,
    /// Of every loop that must not be turned by π: the trace of its rotation, and by how much it can turn along all unknowns.
    pub traces: Vec<(Series, f64)>,
}

/// Forms that a block uses: its arguments, then its equations.
pub fn used<'b>(mechanism: &Mechanism, block: &'b Block) -> impl Iterator<Item = usize> + 'b {
    let first = mechanism.arguments.len();
    let equations = block.equations.iter().map(move |index| first + index);
    block.arguments.iter().copied().chain(equations)
}

/// A block and what its unknowns are called by.
#[derive(Clone, Copy)]
pub struct Site<'a> {
    pub mechanism: &'a Mechanism,
    pub forms: &'a [Form<'a>],
    pub block: &'a Block,
    /// Unknowns: the block's own, then those of earlier blocks.
    pub columns: &'a [usize],
    /// Radius, in radians and sizes, around the path within which second derivatives are bounded.
    pub ball: f64,
}

/// Residual, Jacobian and traces in one pass.
struct Pass {
    residual: Vec<Series>,
    jacobian: Vec<Series>,
    traces: Vec<Series>,
}

impl Site<'_> {
    /// Everything about the block along the path.
    pub fn rows(&self, path: &Path) -> Result<Rows, Reason> {
        let mut rows = self.bounds(path)?;
        let near = self.pass(&path.middle)?;
        let far = self.pass(&path.everywhere)?;
        let merge = |near: Vec<Series>, far: &[Series]| -> Vec<Series> {
            let pairs = near.into_iter().zip(far);
            pairs.map(|(n, f)| n.with_remainder_of(f)).collect()
        };
        rows.residual = merge(near.residual, &far.residual);
        rows.jacobian = merge(near.jacobian, &far.jacobian);
        let traces = merge(near.traces, &far.traces);
        let turns = rows.traces.iter_mut().zip(traces);
        turns.for_each(|(entry, trace)| entry.0 = trace);
        Ok(rows)
    }

    /// Whether a loop could be closed but for a turn by π; one that closes in a point may turn.
    fn must_not_turn(&self, part: &LoopPart) -> bool {
        self.mechanism.loops[part.index].closes == Closes::Frame
    }

    fn equations(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let first = self.mechanism.arguments.len();
        self.block
            .equations
            .iter()
            .map(move |index| (first + index, self.mechanism.weight_of(*index)))
    }

    /// Adds `derivative` times the derivatives of a form to a row of the Jacobian.
    fn add(&self, row: &mut [Series], derivative: &Series, of_form: &[(usize, Series)]) {
        for (slot, rate) in of_form {
            if let Some(column) = self.columns.iter().position(|c| c == slot) {
                let scale = Interval::point(self.mechanism.scale_of(*slot));
                row[column] = row[column] + (*derivative * *rate).scale(scale);
            }
        }
    }

    /// Whether a form depends on any of the columns.
    fn moves(&self, of_form: &[(usize, Series)]) -> bool {
        of_form.iter().any(|(slot, _)| self.columns.contains(slot))
    }

    fn pass(&self, coordinates: &[Series]) -> Result<Pass, Reason> {
        let width = self.columns.len();
        let mut arguments: Vec<Option<ArgumentSeries>> = vec![None; self.mechanism.arguments.len()];
        let mut derivatives: Vec<Vec<(usize, Series)>> = vec![Vec::new(); arguments.len()];
        for &index in &self.block.arguments {
            let form = &self.forms[index];
            let value = form.value(coordinates);
            derivatives[index] = form.derivatives(coordinates);
            if !value.is_finite() || !derivatives[index].iter().all(|(_, d)| d.is_finite()) {
                return Err(Reason::Formula);
            }
            arguments[index] = Some(value.into());
        }
        let mut pass = Pass {
            residual: Vec::new(),
            jacobian: Vec::new(),
            traces: Vec::new(),
        };
        for part in &self.block.loops {
            let steps = &self.mechanism.loops[part.index].chain.steps;
            let item = LoopSeries::new(steps, &arguments, self.mechanism.size);
            let first = pass.jacobian.len();
            pass.residual
                .extend(part.components.iter().map(|c| item.residual(*c)));
            if self.must_not_turn(part) {
                pass.traces.push(item.trace());
            }
            pass.jacobian
                .resize(first + part.components.len() * width, Series::ZERO);
            for joint in &item.joints {
                let of_argument = &derivatives[joint.argument];
                if !self.moves(of_argument) {
                    continue;
                }
                let rows = pass.jacobian[first..].chunks_exact_mut(width);
                for (row, component) in rows.zip(&part.components) {
                    self.add(row, &item.column(joint, *component), of_argument);
                }
            }
        }
        for (index, scale) in self.equations() {
            let form = &self.forms[index];
            let scale = Series::constant(Interval::point(scale));
            pass.residual.push(form.value(coordinates) * scale);
            let mut row = vec![Series::ZERO; width];
            self.add(&mut row, &scale, &form.derivatives(coordinates));
            pass.jacobian.extend(row);
        }
        let all = pass.residual.iter().chain(&pass.jacobian);
        if !all.chain(&pass.traces).all(Series::is_finite) {
            return Err(Reason::Formula);
        }
        Ok(pass)
    }

    /// Second derivatives and turns, valid within the ball around the whole path.
    fn bounds(&self, path: &Path) -> Result<Rows, Reason> {
        let n = self.block.unknowns.len();
        let mut place: Vec<Interval> = path.everywhere.iter().map(|s| s.0[0]).collect();
        let (mut own, mut all) = (vec![0.0; place.len()], vec![0.0; place.len()]);
        for (k, &slot) in self.columns.iter().enumerate() {
            let scale = self.mechanism.scale_of(slot);
            place[slot] = place[slot] + Interval::around_zero(self.ball * scale);
            all[slot] = scale;
            if k < n {
                own[slot] = scale;
            }
        }
        let changes = |rates: &[f64]| -> Vec<Change> {
            let mut changes = vec![Change::default(); self.forms.len()];
            for index in used(self.mechanism, self.block) {
                changes[index] = self.forms[index].change(&place, rates);
            }
            changes
        };
        let (own, all) = (changes(&own), changes(&all));
        let still: Vec<Series> = place.into_iter().map(Series::constant).collect();
        let mut rows = Rows {
            residual: Vec::new(),
            jacobian: Vec::new(),
            second: Vec::new(),
            second_all: Vec::new(),
            traces: Vec::new(),
        };
        for part in &self.block.loops {
            let steps = &self.mechanism.loops[part.index].chain.steps;
            let farthest = |a: usize| self.forms[a].value(&still).0[0].magnitude();
            let reaches = Reaches::new(steps, farthest, self.mechanism.size);
            let second = |changes: &[Change]| reaches.second_derivatives(|a| changes[a]);
            let (own, all_bounds) = (second(&own), second(&all));
            for component in &part.components {
                rows.second.push(own[component / 3]);
                rows.second_all.push(all_bounds[component / 3]);
            }
            if self.must_not_turn(part) {
                let turn = reaches.turn(|a| all[a].rate);
                rows.traces.push((Series::ZERO, turn));
            }
        }
        for (index, scale) in self.equations() {
            rows.second.push(own[index].bend * scale);
            rows.second_all.push(all[index].bend * scale);
        }
        let mut bounds = rows.second.iter().chain(&rows.second_all);
        if bounds.all(|b| b.is_finite()) {
            Ok(rows)
        } else {
            Err(Reason::Formula)
        }
    }
}
