//! Which minima are worth starting near: distinct ones, the best first, preferring those tried less often. Contains no
//! search.

use super::found::FinishedStart;
use super::starts::StartOrigin;
use crate::sorting::sort_by_number;

/// Number of basins that are remembered.
const MOST: usize = 6;

/// Minima belong to one basin if no variable differs by more than this fraction of its size, ...
const SAME_PLACE: f64 = 0.1;

/// ... or if their values differ by less than this fraction: mirror images, and endless valleys.
const SAME_VALUE: f64 = 0.02;

/// After this many tries a basin ranks behind the next better one.
const TRIES_A_RANK: usize = 2;

/// Distinct minima, the best first.
pub struct Basins {
    /// Starts that found them, and how many starts were made near each.
    list: Vec<(usize, usize)>,
}

impl Basins {
    /// The basins of these starts; `sizes` are typical sizes of the variables.
    pub fn new(starts: &[FinishedStart], sizes: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..starts.len())
            .filter(|k| starts[*k].value().is_finite())
            .collect();
        sort_by_number(&mut order, |a| starts[*a].value());
        let mut list: Vec<(usize, usize)> = Vec::new();
        // The basin of every start: the best one that it is equivalent to.
        let mut basin_of = vec![None; starts.len()];
        for start in order {
            let same = list
                .iter()
                .position(|(other, _)| is_same(&starts[*other], &starts[start], sizes));
            basin_of[start] = same.or_else(|| {
                list.push((start, 0));
                Some(list.len() - 1)
            });
        }
        for start in starts {
            if let StartOrigin::Near(base) = start.origin
                && let Some(basin) = basin_of[base]
            {
                list[basin].1 += 1;
            }
        }
        list.truncate(MOST);
        Self { list }
    }

    /// The start near whose minimum the next one begins, which counts as a try.
    pub fn next(&mut self) -> Option<usize> {
        let ranked = self.list.iter_mut().enumerate();
        let (_, (start, tries)) =
            ranked.min_by_key(|(rank, (_, tries))| tries + TRIES_A_RANK * rank)?;
        *tries += 1;
        Some(*start)
    }

    /// The best start of each of the best `count` basins.
    pub fn best(&self, count: usize) -> impl Iterator<Item = usize> + '_ {
        self.list.iter().take(count).map(|(start, _)| *start)
    }
}

fn is_same(a: &FinishedStart, b: &FinishedStart, sizes: &[f64]) -> bool {
    let (Some(first), Some(second)) = (&a.minimum, &b.minimum) else {
        return false;
    };
    let places = first.x.iter().zip(&second.x).zip(sizes);
    let apart = places.map(|((x, y), size)| ((x - y) / size).abs());
    let (near, far) = (a.value().abs(), b.value().abs());
    apart.fold(0.0, f64::max) < SAME_PLACE || (near - far).abs() <= SAME_VALUE * near.max(far)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::analysis::optimise::{Minimum, StopReason};

    fn basin_start(origin: StartOrigin, value: f64, x: [f64; 2]) -> FinishedStart {
        let minimum = Minimum {
            x: x.to_vec(),
            value,
            iterations: 1,
            evaluations: 1,
            gradients: 1,
            ended: StopReason::Converged,
        };
        FinishedStart {
            minimum: Some(minimum),
            excess: 0.0,
            ..FinishedStart::none(origin)
        }
    }

    #[test]
    fn the_same_minimum_found_twice_is_one_basin() {
        let broken = FinishedStart {
            excess: 0.1,
            ..basin_start(StartOrigin::Random, 0.1, [9.0, 9.0])
        };
        let starts = [
            basin_start(StartOrigin::Scene, 5.0, [0.0, 0.0]),
            // Its mirror image: at another place, with the same value.
            basin_start(StartOrigin::Random, 5.01, [-40.0, 0.0]),
            basin_start(StartOrigin::Random, 3.0, [10.0, 0.0]),
            // On the way there, but not converged yet.
            basin_start(StartOrigin::Random, 4.0, [10.4, 0.0]),
            FinishedStart::none(StartOrigin::Random),
            broken,
        ];
        let basins = Basins::new(&starts, &[10.0, 10.0]);
        assert_eq!(basins.best(9).collect::<Vec<_>>(), [2, 0]);
    }

    #[test]
    fn better_basins_are_tried_first_and_more_often_but_not_only() {
        let mut starts = vec![
            basin_start(StartOrigin::Random, 1.0, [0.0, 0.0]),
            basin_start(StartOrigin::Random, 2.0, [50.0, 0.0]),
            basin_start(StartOrigin::Random, 3.0, [0.0, 50.0]),
        ];
        let mut tried = Vec::new();
        for _ in 0..12 {
            let base = Basins::new(&starts, &[10.0, 10.0]).next().unwrap();
            tried.push(base);
            // Every try returns to the minimum near which it began.
            let minimum = starts[base].minimum.clone();
            starts.push(FinishedStart {
                minimum,
                excess: 0.0,
                ..FinishedStart::none(StartOrigin::Near(base))
            });
        }
        assert_eq!(tried[..4], [0, 0, 0, 1]);
        let of = |k| tried.iter().filter(|base| **base == k).count();
        assert_eq!([of(0), of(1), of(2)], [6, 4, 2]);
        assert_eq!(Basins::new(&[], &[]).next(), None);
    }
}
