//! A formula with `abs`, `min` and `max` as several formulas without: one for every choice of sides.

use super::{Expression, Function, Op};
use crate::numbers::constant::Constant;

impl Expression {
    /// The formula with every `abs`, `min` and `max` replaced by one of its sides, in all ways; itself if there is none of them, and
    /// `None` if there are more than `most`.
    pub fn branches(&self, most: usize) -> Option<Vec<Self>> {
        let count = self.ops().iter().filter(|op| has_sides(**op)).count();
        let choices = 0..1usize.checked_shl(u32::try_from(count).ok()?)?;
        (count <= most).then(|| choices.map(|choice| self.branch(choice)).collect())
    }

    /// The formula on one side of every kink: that of the k-th is told by bit k.
    fn branch(&self, mut choice: usize) -> Self {
        let mut ops: Vec<Op> = Vec::with_capacity(self.ops().len() + 2);
        let mut places: Vec<usize> = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            if !has_sides(*op) {
                ops.push(op.mapped(|k| places[k]));
                places.push(ops.len() - 1);
                continue;
            }
            let is_first = choice & 1 == 0;
            choice >>= 1;
            match *op {
                Op::Call(Function::Abs, a, _) if !is_first => {
                    ops.push(Op::Negate(places[a]));
                    places.push(ops.len() - 1);
                }
                Op::Call(_, a, b) => places.push(places[if is_first { a } else { b }]),
                _ => {}
            }
        }
        // The value of a formula is that of its last operation.
        if let Some(value) = places.last()
            && value + 1 != ops.len()
        {
            let value = *value;
            ops.push(Op::Constant(Constant::exact(0.0)));
            ops.push(Op::Add(value, ops.len() - 1));
        }
        Self::new(ops)
    }
}

/// Whether it is equal to one of its operands, or to the negative of one.
fn has_sides(op: Op) -> bool {
    use Function::{Abs, Max, Min};
    matches!(op, Op::Call(Abs | Min | Max, ..))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The greatest branch of a convex formula is the formula, the least one of a concave formula.
    #[test]
    fn branches_meet_at_the_kinks() {
        let slot = |k: usize| Op::Slot(k);
        // |x| + max(x, y), and its negative.
        let ops = vec![
            slot(0),
            Op::Call(Function::Abs, 0, 0),
            slot(1),
            Op::Call(Function::Max, 0, 2),
            Op::Add(1, 3),
        ];
        let convex = Expression::new(ops.clone());
        let concave = Expression::new([ops, vec![Op::Negate(4)]].concat());
        let last = Expression::new(vec![slot(0), slot(1), Op::Call(Function::Min, 0, 1)]);
        let all = convex.branches(2).unwrap_or_default();
        assert_eq!((all.len(), convex.branches(1)), (4, None));
        for place in [[1.0, 2.0], [-3.0, 0.5], [0.0, 0.0], [2.0, -2.0]] {
            let values = |formula: &Expression| {
                let branches = formula.branches(9).unwrap_or_default();
                let values: Vec<f64> = branches.iter().map(|b| b.value(&place[..])).collect();
                values
            };
            let most = values(&convex).into_iter().fold(f64::MIN, f64::max);
            let least = values(&concave).into_iter().fold(f64::MAX, f64::min);
            let [x, y] = place;
            assert_eq!((most, least), (x.abs() + x.max(y), -x.abs() - x.max(y)));
            assert_eq!(values(&last), [x, y]);
        }
    }
}
