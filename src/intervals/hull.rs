//! The smallest box around a solution set: in every orthant the set is a polytope, whose extremes are linear
//! programmes.

use super::kaucher::Kaucher;
use super::simplex::{ProgrammeResult, maximise};
use super::system::{IntervalSystem, SolutionSet};

/// Most unknowns: the number of orthants is two to this power.
pub const MOST_UNKNOWNS: usize = 16;

/// The hull of a solution set, computed in plain f64.
#[derive(Clone, Debug, PartialEq)]
pub enum SolutionHull {
    /// No point solves.
    Empty,
    /// The set is unbounded along the unknown of this number.
    Unbounded(usize),
    /// The box.
    Box(Vec<Kaucher>),
    /// More unknowns than [`MOST_UNKNOWNS`].
    TooMany,
}

/// The hull of the set of that kind.
pub fn solution_hull(system: &IntervalSystem, kind: &SolutionSet) -> SolutionHull {
    let n = system.unknowns();
    if n > MOST_UNKNOWNS {
        return SolutionHull::TooMany;
    }
    let inclusion = system.inclusion(kind);
    let mut found: Option<Vec<Kaucher>> = None;
    // Within one orthant every |x| is linear, so that the set is a polytope.
    for orthant in 0..1u32 << n {
        let sign = |j: usize| if orthant >> j & 1 == 1 { -1.0 } else { 1.0 };
        let (rows, sides) = orthant_rows(&inclusion, sign);
        for j in 0..n {
            // The extremes along each axis are two linear programmes.
            for up in [1.0, -1.0] {
                let mut objective = vec![0.0; n];
                objective[j] = up * sign(j);
                let place = match maximise(&objective, &rows, &sides) {
                    // An empty orthant needs no further programmes.
                    ProgrammeResult::Infeasible => break,
                    ProgrammeResult::Unbounded => return SolutionHull::Unbounded(j),
                    ProgrammeResult::Optimal { x, .. } => x,
                };
                let value = sign(j) * place[j];
                let point = |k: usize| Kaucher::point(sign(k) * place[k]);
                let known = found.get_or_insert_with(|| (0..n).map(point).collect());
                known[j] = known[j].join(Kaucher::point(value));
            }
        }
    }
    found.map_or(SolutionHull::Empty, SolutionHull::Box)
}

/// G x ⊆ h in one orthant, as rows of |x|.
fn orthant_rows(
    inclusion: &IntervalSystem,
    sign: impl Fn(usize) -> f64,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let (mut rows, mut sides) = (Vec::new(), Vec::new());
    for (entries, h) in inclusion.a.iter().zip(&inclusion.b) {
        let along: Vec<Kaucher> = entries
            .iter()
            .enumerate()
            .map(|(j, g)| if sign(j) > 0.0 { *g } else { -*g })
            .collect();
        // G x ⊆ h as two inequalities per row: the lower end and the upper end.
        rows.push(along.iter().map(|k| -k.lo).collect());
        sides.push(-h.lo);
        rows.push(along.iter().map(|k| k.hi).collect());
        sides.push(h.hi);
    }
    (rows, sides)
}
