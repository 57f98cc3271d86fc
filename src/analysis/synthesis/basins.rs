//! Which minima are worth starting near: distinct ones, the best first, and those more that were tried less. Holds no
//! search.

use super::{Origin, Start};

/// Basins that are kept in mind.
const MOST: usize = 6;

/// Minima are of one basin where no variable differs by more than this share of its size, ...
const SAME_PLACE: f64 = 0.1;

/// ... or where their values differ by less than this share: mirror images, and valleys without an end.
const SAME_VALUE: f64 = 0.1;

/// By how many tries a basin is put behind the next better one.
const TRIES_A_RANK: usize = 2;

/// Distinct minima, the best first.
pub struct Basins {
    /// Starts that found them, with how many starts were made near each.
    list: Vec<(usize, usize)>,
}

impl Basins {
    /// The basins of these starts; `sizes` are typical sizes of the variables.
    pub fn new(starts: &[Start], sizes: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..starts.len())
            .filter(|k| starts[*k].value().is_finite())
            .collect();
        order.sort_by(|a, b| starts[*a].value().total_cmp(&starts[*b].value()));
        let mut list: Vec<(usize, usize)> = Vec::new();
        // The basin of every start: the best one that it cannot be told from.
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
            if let Origin::Near(base) = start.origin
                && let Some(basin) = basin_of[base]
            {
                list[basin].1 += 1;
            }
        }
        list.truncate(MOST);
        Self { list }
    }

    /// The start near whose minimum another one is to begin, which counts as a try.
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

fn is_same(a: &Start, b: &Start, sizes: &[f64]) -> bool {
    let (Some(first), Some(second)) = (&a.minimum, &b.minimum) else {
        return false;
    };
    let places = first.x.iter().zip(&second.x).zip(sizes);
    let apart = places.map(|((x, y), size)| ((x - y) / size).abs());
    let (near, far) = (a.value().abs(), b.value().abs());
    apart.fold(0.0, f64::max) < SAME_PLACE || (near - far).abs() <= SAME_VALUE * near.max(far)
}
