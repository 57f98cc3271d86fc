//! One block as rows: residual, Jacobian and bounds of its equations. The test itself is in `kantorovich`.

use super::super::newton::CLOSURE_TOLERANCE;
use super::super::structure::Block;
use super::chain::{ArgumentDouble, LoopAtPose, U, affine_value, evaluate};
use super::kantorovich::{Earlier, UnknownBound, prove};
use super::{BALL, Certifier, Reason};
use crate::model::chain::Motion;
use crate::model::mechanism::Closes;

/// Relative rounding of a joint's column: a dozen operations on numbers that carry the last bit of f64.
const COLUMN_ROUNDING: f64 = 64.0 * U;

/// A trace below this could belong to a half-turn (trace -1) as well as to the identity (trace 3), after what the
/// rotation can change within the error bound.
const LEAST_TRACE: f64 = 1e-6;

/// A block at a pose.
pub struct BlockProof<'a, 'm> {
    pub certifier: &'a Certifier<'m>,
    pub block: &'a Block,
    pub coordinates: &'a [f64],
    pub arguments: &'a [ArgumentDouble],
    pub earlier: &'a Earlier,
}

/// One row of the block.
pub struct Row {
    /// At the pose.
    pub residual: f64,
    /// Absolute error of the residual.
    pub open: f64,
    /// Derivative by every form of the block, in the order of `forms`.
    pub columns: Vec<f64>,
    /// Bound of the second derivative within the ball, along the block's unknowns.
    pub second: f64,
    /// The same along the block's unknowns and those of earlier blocks.
    pub second_all: f64,
    /// Error of the row of the Jacobian, summed over all unknowns.
    pub column_error: f64,
}

/// A form (argument or affine equation) that the block uses.
pub struct FormUse {
    /// Index into the certifier's forms.
    index: usize,
    /// Rate by each unknown of the block in scaled form, as (column, rate).
    pub own: Vec<(usize, f64)>,
    /// Rate by unknowns of earlier blocks, as (unknown, scaled rate).
    pub before: Vec<(usize, f64)>,
    /// How far the form is open, as what it is used for.
    pub open: f64,
}

impl FormUse {
    /// Largest change by the block's unknowns.
    pub fn own_rate(&self) -> f64 {
        self.own.iter().map(|(_, c)| c.abs()).sum()
    }

    /// Largest change by all unknowns.
    pub fn rate(&self) -> f64 {
        self.own_rate() + self.before.iter().map(|(_, c)| c.abs()).sum::<f64>()
    }
}

impl BlockProof<'_, '_> {
    /// Error bounds of the block's unknowns, and its radius of uniqueness.
    pub fn run(&self, basis: &[usize]) -> Result<(Vec<UnknownBound>, f64), Reason> {
        let mut forms: Vec<FormUse> = Vec::new();
        for &argument in &self.block.arguments {
            forms.push(self.form_use(argument));
        }
        for index in self.certifier.equations_of(self.block) {
            forms.push(self.form_use(index));
        }
        let mut position = vec![usize::MAX; self.certifier.forms.len()];
        for (k, form) in forms.iter().enumerate() {
            position[form.index] = k;
        }
        let (mut rows, loops) = self.loop_rows(&mut forms, &position)?;
        self.equation_rows(&forms, &mut rows);
        if self.left_out_rows_are_open(&rows, basis) {
            return Err(Reason::Open);
        }
        let square: Vec<&Row> = basis.iter().map(|k| &rows[*k]).collect();
        let (bounds, radius, error) = prove(&square, &forms, self.earlier)?;
        let moved = error.max(self.earlier.largest);
        for item in &loops {
            let turned = item.first_derivatives(|a| forms[position[a]].rate())[0];
            if item.trace - 2.0 * turned * moved <= LEAST_TRACE {
                return Err(Reason::HalfTurn);
            }
        }
        Ok((bounds, radius))
    }

    fn form_use(&self, index: usize) -> FormUse {
        let mechanism = self.certifier.mechanism;
        let (mut own, mut before) = (Vec::new(), Vec::new());
        let terms = self.certifier.forms[index].as_ref().map(|f| &f.terms[..]);
        for &(slot, c) in terms.unwrap_or_default() {
            if let Some(column) = self.block.column_of[slot] {
                own.push((column, c * mechanism.scale_of(slot)));
            } else if slot < mechanism.unknowns.len() {
                before.push((slot, c * mechanism.scale_of(slot)));
            }
        }
        FormUse {
            index,
            own,
            before,
            open: 0.0,
        }
    }

    /// Rows of all loops, and those loops that must not be turned by π.
    fn loop_rows(
        &self,
        forms: &mut [FormUse],
        position: &[usize],
    ) -> Result<(Vec<Row>, Vec<LoopAtPose>), Reason> {
        let mechanism = self.certifier.mechanism;
        let mut rows = Vec::new();
        let mut loops = Vec::new();
        for part in &self.block.loops {
            let steps = &mechanism.loops[part.index].chain.steps;
            let play = |a: usize| forms[position[a]].rate() * BALL;
            let item = evaluate(steps, self.arguments, play, mechanism.size);
            // Where a point closes the loop may be turned by anything.
            let may_turn = mechanism.loops[part.index].closes == Closes::Point;
            if !may_turn && (item.trace.is_nan() || item.trace <= LEAST_TRACE) {
                return Err(Reason::HalfTurn);
            }
            for joint in &item.joints {
                let argument = &self.arguments[joint.argument];
                let open = match joint.motion {
                    Motion::Rotation => argument.open_angle,
                    Motion::Translation => argument.open_length,
                };
                let form = &mut forms[position[joint.argument]];
                form.open = form.open.max(open);
            }
            self.add_rows(&item, &part.components, forms, position, &mut rows);
            if !may_turn {
                loops.push(item);
            }
        }
        Ok((rows, loops))
    }

    fn add_rows(
        &self,
        item: &LoopAtPose,
        components: &[usize],
        forms: &[FormUse],
        position: &[usize],
        rows: &mut Vec<Row>,
    ) {
        let own = item.second_derivatives(|a| forms[position[a]].own_rate());
        let all = item.second_derivatives(|a| forms[position[a]].rate());
        let first = item.first_derivatives(|a| forms[position[a]].rate());
        let open = item.first_derivatives(|a| forms[position[a]].open);
        let reach = item.joints.first().map_or(0.0, |j| 1.0 + j.reach);
        let start = rows.len();
        for &component in components {
            let kind = component / 3;
            let farthest = if kind == 0 { 1.0 } else { reach };
            // The columns carry rounding, and belong to arguments that are open by `open`.
            let slack = COLUMN_ROUNDING + open[0];
            rows.push(Row {
                residual: item.residual[component],
                open: item.open[kind] + open[0] * open[0] * farthest + open[0] * open[1],
                columns: vec![0.0; forms.len()],
                second: own[kind],
                second_all: all[kind],
                column_error: slack * (first[kind] + first[0] * farthest) + open[kind] * first[0],
            });
        }
        for joint in &item.joints {
            let column = item.column(joint);
            for (row, component) in rows[start..].iter_mut().zip(components) {
                row.columns[position[joint.argument]] += column[*component];
            }
        }
    }

    fn equation_rows(&self, forms: &[FormUse], rows: &mut Vec<Row>) {
        let mechanism = self.certifier.mechanism;
        let first = forms.len() - self.block.equations.len();
        for (k, index) in self.block.equations.iter().enumerate() {
            let scale = mechanism
                .size
                .powf(-mechanism.equations[*index].length_exponent);
            let form = &forms[first + k];
            let Some(affine) = &self.certifier.forms[form.index] else {
                continue;
            };
            let (value, open) = affine_value(affine, self.coordinates);
            let residual = value.hi * scale;
            let mut columns = vec![0.0; forms.len()];
            columns[first + k] = scale;
            rows.push(Row {
                residual,
                open: (open + value.lo.abs()) * scale + 4.0 * U * residual.abs(),
                columns,
                second: 0.0,
                second_all: 0.0,
                column_error: COLUMN_ROUNDING * scale * form.rate(),
            });
        }
    }

    fn left_out_rows_are_open(&self, rows: &[Row], basis: &[usize]) -> bool {
        let small = |row: &Row| row.residual.abs() <= CLOSURE_TOLERANCE;
        let mut left_out = rows.iter().enumerate().filter(|(k, _)| !basis.contains(k));
        left_out.any(|(_, row)| !small(row))
    }
}
