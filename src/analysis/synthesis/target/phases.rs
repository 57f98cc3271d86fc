//! Assigns poses of a path to the rows of a table, in the table's order, such that the distances are least.

/// A pose for every row, such that poses ascend or descend with the rows and the sum of `costs[row][pose]` is least. A
/// closed path may be started anywhere. `None` without poses.
pub fn ordered_phases(costs: &[Vec<f64>], goes_round: bool) -> Option<Vec<usize>> {
    let count = costs.first()?.len();
    if count == 0 {
        return None;
    }
    let period = if goes_round { count - 1 } else { count };
    let turns = if goes_round { period } else { 1 };
    let mut best: Option<(f64, Vec<usize>)> = None;
    for backwards in [false, true] {
        for turn in 0..turns {
            // Position j of the path when it is started here.
            let place = |j: usize| match (backwards, goes_round) {
                (false, true) => (turn + j) % period,
                (true, true) => (turn + 2 * period - j) % period,
                (false, false) => j,
                (true, false) => count - 1 - j,
            };
            let (sum, chosen) = ascending(costs, count, &place);
            if sum.is_finite() && best.as_ref().is_none_or(|(least, _)| sum < *least) {
                best = Some((sum, chosen));
            }
        }
    }
    best.map(|(_, chosen)| chosen)
}

/// The least sum of costs with non-descending positions, row by row (dynamic programming).
fn ascending(
    costs: &[Vec<f64>],
    count: usize,
    place: &dyn Fn(usize) -> usize,
) -> (f64, Vec<usize>) {
    let mut sums = vec![0.0; count];
    let mut from: Vec<Vec<usize>> = Vec::with_capacity(costs.len());
    for row in costs {
        // The best position up to each one, in the previous row.
        let mut least = 0;
        let mut before = Vec::with_capacity(count);
        for j in 0..count {
            if sums[j] < sums[least] {
                least = j;
            }
            before.push(least);
        }
        let next = (0..count).map(|j| sums[before[j]] + row[place(j)]);
        sums = next.collect();
        from.push(before);
    }
    let last = (0..count).min_by(|a, b| sums[*a].total_cmp(&sums[*b]));
    let mut here = last.unwrap_or(0);
    let sum = sums[here];
    let mut chosen = Vec::with_capacity(costs.len());
    for before in from.iter().rev() {
        chosen.push(place(here));
        here = before[here];
    }
    chosen.reverse();
    (sum, chosen)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    /// Points of a circle met in order, from any start, in either direction.
    #[test]
    fn rows_are_met_in_their_order() {
        let path = |k: usize| (std::f64::consts::TAU * k as f64 / 36.0).sin_cos();
        for (first, by) in [(30_isize, 4_isize), (5, -3), (0, 4), (35, -4)] {
            let wanted: Vec<usize> = (0..9)
                .map(|row| (first + by * row).rem_euclid(36) as usize)
                .collect();
            let costs: Vec<Vec<f64>> = wanted
                .iter()
                .map(|w| {
                    let cost = |k| {
                        let ((a, b), (c, d)) = (path(k), path(*w));
                        (a - c) * (a - c) + (b - d) * (b - d)
                    };
                    (0..=36).map(cost).collect()
                })
                .collect();
            let found = ordered_phases(&costs, true).unwrap();
            let found: Vec<usize> = found.into_iter().map(|k| k % 36).collect();
            assert_eq!(found, wanted);
        }
    }

    #[test]
    fn a_path_with_ends_is_met_both_ways() {
        let costs = |wanted: [usize; 3]| -> Vec<Vec<f64>> {
            let row = |w: &usize| (0..7).map(|k| (k as f64 - *w as f64).powi(2)).collect();
            wanted.iter().map(row).collect()
        };
        assert_eq!(ordered_phases(&costs([1, 3, 6]), false).unwrap(), [1, 3, 6]);
        assert_eq!(ordered_phases(&costs([5, 5, 0]), false).unwrap(), [5, 5, 0]);
        assert!(ordered_phases(&[Vec::new()], false).is_none());
    }
}
