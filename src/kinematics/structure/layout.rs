//! The layout of a block for the traversal of its loops: joints in order with the fixed pose before each, and for every
//! argument the columns that its rate contributes to. It is created once with the block and contains no values of a
//! pose.

use crate::math::Pose;
use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec3};
use std::ops::Range;

use super::columns::ColumnMap;
use super::loop_part::LoopPart;
use super::planned_quadratic::PlannedQuadratic;
use crate::linalg::lanes::{Lanes, lane_groups};

/// The target of a part of a rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateShare {
    /// The coordinate.
    pub slot: usize,
    /// Its column: below the number of the block's unknowns a column of the Jacobian, above it one of the derivative by
    /// coordinates of other blocks.
    pub column: usize,
    /// Scale of the unknown; one for coordinates of other blocks.
    pub scale: f64,
    /// Rate of the argument by the coordinate; unused for formulas.
    pub coefficient: f64,
}

/// An argument that the block's loops use.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedArgument {
    /// Index into the mechanism's arguments.
    pub index: usize,
    /// Value with all coordinates at zero; unused for formulas.
    pub constant: f64,
    /// Its entries of [`BlockPlan::shares`].
    pub shares: Range<usize>,
    /// Not affine.
    pub is_formula: bool,
    /// Whether it is the angle of a rotation; lengths need no sine and cosine.
    pub turns: bool,
    /// Whether it depends on unknowns of the block: the others are constant while the block is closed.
    pub moves: bool,
}

/// A joint and the fixed pose before it.
#[derive(Clone, Debug, PartialEq)]
pub struct LayoutJoint {
    /// Fixed translation before the joint, then the rotation, if there is one.
    pub shift: Option<DVec3>,
    /// Fixed rotation before the joint.
    pub turn: Option<DMat3>,
    /// Kind of motion.
    pub motion: ElementaryMotion,
    /// 0 x, 1 y, 2 z.
    pub axis: usize,
    /// Place in [`BlockPlan::arguments`].
    pub argument: usize,
    /// +1, or -1 for the inverse motion.
    pub sign: f64,
}

/// Four adjacent joints of a loop; the last group is filled up with joints that do nothing.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PlannedGroup {
    /// One for rotations.
    pub turns: Lanes,
    /// One for translations.
    pub slides: Lanes,
    /// Places in [`BlockPlan::arguments`].
    pub arguments: [usize; 4],
}

/// A coordinate's part of an affine argument.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutTerm {
    /// Place in [`BlockPlan::arguments`].
    pub argument: usize,
    /// The coordinate.
    pub slot: usize,
    /// Rate of the argument by the coordinate.
    pub coefficient: f64,
}

/// The target of a multiple of a joint's column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayoutEntry {
    /// The joint's place among those of its loop.
    pub joint: usize,
    /// Index of the first row in the column-major Jacobian, or in the padded derivative by coordinates of other blocks.
    pub start: usize,
    /// What the column is multiplied by.
    pub factor: f64,
}

/// A loop of the block.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedLoop {
    /// Its entries of [`BlockPlan::joints`].
    pub joints: Range<usize>,
    /// Its entries of [`BlockPlan::groups`].
    pub groups: Range<usize>,
    /// Its affine entries of the Jacobian.
    pub own: Vec<LayoutEntry>,
    /// Its affine entries of the derivative by coordinates of other blocks.
    pub outside: Vec<LayoutEntry>,
    /// Places of the joints whose arguments are formulas.
    pub formulas: Vec<usize>,
    /// Fixed pose after the last joint.
    pub end: Pose,
    /// Equations that are kept.
    pub components: Vec<usize>,
    /// Row of the first of them.
    pub row: usize,
    /// Unit of its translation.
    pub size: f64,
}

/// A scalar equation of the block.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedEquation {
    /// Index into the mechanism's equations.
    pub index: usize,
    /// Its row.
    pub row: usize,
    /// What its value is multiplied by.
    pub scale: f64,
    /// Coordinates it depends on.
    pub shares: Range<usize>,
    /// Of an equation of second degree: its layout over these coordinates.
    pub quadratic: Option<PlannedQuadratic>,
}

/// The layout of a block.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct BlockPlan {
    /// Arguments, as the block lists them.
    pub arguments: Vec<PlannedArgument>,
    /// Shares of arguments and equations.
    pub shares: Vec<RateShare>,
    /// Terms of all affine arguments.
    pub terms: Vec<LayoutTerm>,
    /// Scales of the block's unknowns.
    pub scales: Vec<f64>,
    /// Joints of all loops.
    pub joints: Vec<LayoutJoint>,
    /// The same joints, four at a time.
    pub groups: Vec<PlannedGroup>,
    /// Loops in the order of the rows.
    pub loops: Vec<PlannedLoop>,
    /// Equations, after the loops.
    pub equations: Vec<PlannedEquation>,
    /// Coordinates of other blocks that the block depends on, in the order of their columns.
    pub outer: Vec<usize>,
    /// All arguments are affine and no equation is of more than second degree, so that series of the unknowns follow from the
    /// joints and from products.
    pub has_series: bool,
}

impl BlockPlan {
    /// Lays out loops and equations. `arguments` are those that the loops use, ascending; `unknowns` are the columns.
    pub fn new(
        mechanism: &Mechanism,
        loops: &[LoopPart],
        equations: &[usize],
        arguments: &[usize],
        unknowns: &[usize],
    ) -> Self {
        let scales = unknowns.iter().map(|slot| mechanism.scale_of(*slot));
        let mut plan = Self {
            has_series: true,
            scales: scales.collect(),
            ..Self::default()
        };
        let columns = unknowns.len();
        let column_of = &ColumnMap::new(unknowns);
        for &index in arguments {
            plan.add_argument(mechanism, index, column_of, columns);
        }
        // Rows: those of the loops, then the scalar equations.
        let rows = loops
            .iter()
            .map(|part| part.components.len())
            .sum::<usize>()
            + equations.len();
        let mut row = 0;
        for part in loops {
            plan.add_loop(mechanism, part, arguments, row);
            plan.add_entries(rows, columns);
            row += part.components.len();
        }
        for (k, &index) in equations.iter().enumerate() {
            let equation = &mechanism.equations[index];
            let slots = equation.expression.slots();
            let terms: Vec<(usize, f64)> = slots.iter().map(|slot| (*slot, 0.0)).collect();
            let quadratic = equation.expression.quadratic();
            let shares = plan.add_shares(mechanism, &terms, column_of, columns);
            plan.has_series &= quadratic.is_some();
            plan.equations.push(PlannedEquation {
                index,
                row: row + k,
                scale: mechanism.equations[index].weight,
                shares,
                quadratic: quadratic.map(|form| PlannedQuadratic::new(&form, &slots)),
            });
        }
        plan
    }

    fn add_argument(
        &mut self,
        mechanism: &Mechanism,
        index: usize,
        column_of: &ColumnMap,
        columns: usize,
    ) {
        // An affine argument is a dot product; a formula has shares in its slots, with coefficients that depend on
        // the pose.
        let (constant, terms, is_formula): (_, Vec<_>, _) = match &mechanism.arguments[index] {
            Argument::Affine(affine) => {
                (affine.constant.number(), affine.numbers().collect(), false)
            }
            Argument::Formula(expression) => {
                let slots = expression.slots();
                (
                    0.0,
                    slots.into_iter().map(|slot| (slot, 0.0)).collect(),
                    true,
                )
            }
        };
        let shares = self.add_shares(mechanism, &terms, column_of, columns);
        self.has_series &= !is_formula;
        if !is_formula {
            let argument = self.arguments.len();
            self.terms
                .extend(terms.iter().map(|&(slot, coefficient)| LayoutTerm {
                    argument,
                    slot,
                    coefficient,
                }));
        }
        let moves = self.shares[shares.clone()]
            .iter()
            .any(|share| share.column < columns);
        self.arguments.push(PlannedArgument {
            index,
            constant,
            shares,
            is_formula,
            turns: false,
            moves,
        });
    }

    fn add_shares(
        &mut self,
        mechanism: &Mechanism,
        terms: &[(usize, f64)],
        column_of: &ColumnMap,
        columns: usize,
    ) -> Range<usize> {
        let start = self.shares.len();
        for &(slot, coefficient) in terms {
            let own = column_of.of(slot);
            // The block's own unknowns are scaled columns of the Jacobian; other coordinates follow, unscaled.
            let (column, scale) = match own {
                Some(column) => (column, mechanism.scale_of(slot)),
                None => (columns + self.outer_column(slot), 1.0),
            };
            self.shares.push(RateShare {
                slot,
                column,
                scale,
                coefficient,
            });
        }
        start..self.shares.len()
    }

    fn outer_column(&mut self, slot: usize) -> usize {
        let known = self.outer.iter().position(|s| *s == slot);
        known.unwrap_or_else(|| {
            self.outer.push(slot);
            self.outer.len() - 1
        })
    }

    fn add_loop(&mut self, mechanism: &Mechanism, part: &LoopPart, used: &[usize], row: usize) {
        let start = self.joints.len();
        let mut fixed = Pose::IDENTITY;
        // Constant poses between two joints are folded into the next joint's frame.
        for step in &mechanism.loops[part.index].chain.steps {
            match *step {
                ChainStep::Fixed(pose) => fixed = fixed * pose,
                ChainStep::Joint {
                    motion,
                    axis,
                    argument,
                    sign,
                } => {
                    let (shift, turn) = parts_of(&fixed);
                    let argument = used.binary_search(&argument).unwrap_or(0);
                    self.arguments[argument].turns |= motion == ElementaryMotion::Rotation;
                    self.joints.push(LayoutJoint {
                        shift,
                        turn,
                        motion,
                        axis,
                        argument,
                        sign,
                    });
                    fixed = Pose::IDENTITY;
                }
            }
        }
        // Four joints are evaluated at a time.
        let first = self.groups.len();
        self.groups
            .extend(self.joints[start..].chunks(4).map(PlannedGroup::new));
        self.loops.push(PlannedLoop {
            joints: start..self.joints.len(),
            groups: first..self.groups.len(),
            own: Vec::new(),
            outside: Vec::new(),
            formulas: Vec::new(),
            end: fixed,
            components: part.components.clone(),
            row,
            size: mechanism.loops[part.index].size,
        });
    }

    /// Lists where the columns of the last loop's joints go.
    fn add_entries(&mut self, rows: usize, columns: usize) {
        let Some(item) = self.loops.last_mut() else {
            return;
        };
        for (joint, planned) in self.joints[item.joints.clone()].iter().enumerate() {
            let argument = &self.arguments[planned.argument];
            if argument.is_formula {
                item.formulas.push(joint);
                continue;
            }
            // Column and factor of every joint are known before any pose.
            for share in &self.shares[argument.shares.clone()] {
                let (list, start) = match share.column.checked_sub(columns) {
                    None => (&mut item.own, share.column * rows),
                    Some(column) => (&mut item.outside, column * 4 * lane_groups(rows)),
                };
                list.push(LayoutEntry {
                    joint,
                    start: start + item.row,
                    factor: share.coefficient * share.scale,
                });
            }
        }
    }
}

impl PlannedGroup {
    fn new(joints: &[LayoutJoint]) -> Self {
        let mut group = Self::default();
        for (lane, joint) in joints.iter().enumerate() {
            match joint.motion {
                ElementaryMotion::Rotation => group.turns[lane] = 1.0,
                ElementaryMotion::Translation => group.slides[lane] = 1.0,
            }
            group.arguments[lane] = joint.argument;
        }
        group
    }
}

/// Translation and rotation of a fixed pose, unless they are the identity.
fn parts_of(pose: &Pose) -> (Option<DVec3>, Option<DMat3>) {
    (
        (pose.translation != DVec3::ZERO).then_some(pose.translation),
        (pose.rotation != DMat3::IDENTITY).then_some(pose.rotation),
    )
}
