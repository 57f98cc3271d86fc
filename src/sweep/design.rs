//! The designs of a sweep: each is determined by its number alone, so that the work can be divided anywhere.

use super::permutation::Permutation;
use super::sobol;
use crate::analysis::random::Random;

/// Maximum number of designs: numbers up to here are exact as f64, too, which is how other programs read them.
pub const MOST_DESIGNS: u64 = 1 << 53;

/// First random stream of Latin hypercubes, which use one per parameter; those of random pieces begin at 0.
const FIRST_STREAM: u64 = 1 << 32;

/// A parameter and its values, in the file's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct DesignAxis {
    /// The parameter.
    pub name: String,
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
    /// Number of values of a grid; 1 elsewhere.
    pub count: u64,
}

/// How the designs are spread.
#[derive(Clone, Debug, PartialEq)]
pub enum DesignSampling {
    /// Every combination of equally spaced values; the last parameter changes fastest.
    Grid,
    /// Latin hypercube: every range is divided into as many equal intervals as there are designs, with one design in
    /// each.
    LatinHypercube {
        /// Seed of the random numbers.
        seed: u64,
    },
    /// Points of Sobol's sequence, from its first one.
    Sobol,
    /// The rows of a table, with one number per axis.
    Table(Vec<f64>),
}

/// The designs of a sweep.
#[derive(Clone, Debug, PartialEq)]
pub struct Design {
    /// The varied parameters.
    pub axes: Vec<DesignAxis>,
    /// The kind of design.
    pub spread: DesignSampling,
    count: u64,
}

impl Design {
    /// Every combination of the values of `axes`.
    ///
    /// Errors, in words: more than [`MOST_DESIGNS`].
    pub fn grid(axes: Vec<DesignAxis>) -> Result<Self, String> {
        let product = |all: u64, axis: &DesignAxis| all.checked_mul(axis.count);
        let count = axes.iter().try_fold(1, product);
        let count = count
            .filter(|n| *n <= MOST_DESIGNS)
            .ok_or_else(|| format!("the grid has more than {MOST_DESIGNS} designs"))?;
        Ok(Self {
            axes,
            spread: DesignSampling::Grid,
            count,
        })
    }

    /// `count` designs within the ranges of `axes`.
    ///
    /// Errors, in words: more parameters than Sobol's sequence has dimensions here.
    pub fn spread(
        axes: Vec<DesignAxis>,
        spread: DesignSampling,
        count: u64,
    ) -> Result<Self, String> {
        let most = sobol::MOST_DIMENSIONS;
        if spread == DesignSampling::Sobol && axes.len() > most {
            return Err(format!(
                "sobol takes at most {most} parameters, not {}; lhs takes any number",
                axes.len()
            ));
        }
        Ok(Self {
            axes,
            spread,
            count,
        })
    }

    /// The rows of a table: `values` holds one number per name for each row.
    pub fn table(names: Vec<String>, values: Vec<f64>) -> Self {
        let width = names.len().max(1);
        let axis = |(k, name): (usize, String)| {
            let column = || values.iter().skip(k).step_by(width).copied();
            DesignAxis {
                name,
                low: column().fold(f64::INFINITY, f64::min),
                high: column().fold(f64::NEG_INFINITY, f64::max),
                count: 1,
            }
        };
        Self {
            axes: names.into_iter().enumerate().map(axis).collect(),
            count: (values.len() / width) as u64,
            spread: DesignSampling::Table(values),
        }
    }

    /// Number of designs.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// Names of the parameters.
    pub fn names(&self) -> Vec<String> {
        self.axes.iter().map(|axis| axis.name.clone()).collect()
    }

    /// The values of design `item` (below the count), in the file's units.
    pub fn values(&self, item: u64) -> Vec<f64> {
        match &self.spread {
            DesignSampling::Grid => self.grid_values(item),
            DesignSampling::LatinHypercube { seed } => {
                let axes = self.axes.iter().zip(FIRST_STREAM..);
                axes.map(|(axis, stream)| {
                    let place = Permutation::new(self.count, *seed, stream).place(item);
                    let within = Random::new(*seed, stream, item).unit();
                    axis.at((place as f64 + within) / self.count as f64)
                })
                .collect()
            }
            DesignSampling::Sobol => {
                let axes = self.axes.iter().enumerate();
                axes.map(|(k, axis)| axis.at(sobol::coordinate(k, item)))
                    .collect()
            }
            DesignSampling::Table(values) => {
                let width = self.axes.len();
                let start = item as usize * width;
                values[start..start + width].to_vec()
            }
        }
    }

    /// Places on the axes of a grid of design `item`.
    pub fn grid_places(&self, item: u64) -> Vec<u64> {
        let (mut rest, mut places) = (item, vec![0; self.axes.len()]);
        for (place, axis) in places.iter_mut().zip(&self.axes).rev() {
            (*place, rest) = (rest % axis.count, rest / axis.count);
        }
        places
    }

    fn grid_values(&self, item: u64) -> Vec<f64> {
        let places = self.grid_places(item).into_iter().zip(&self.axes);
        places.map(|(place, axis)| axis.grid_value(place)).collect()
    }
}

impl DesignAxis {
    /// Value `place` of a grid; the first and last are exactly the ends of the range.
    pub fn grid_value(&self, place: u64) -> f64 {
        match self.count - 1 {
            0 => self.low,
            last if place == last => self.high,
            last => self.at(place as f64 / last as f64),
        }
    }

    fn at(&self, share: f64) -> f64 {
        // This form is exact for the middle of a range around zero.
        self.low * (1.0 - share) + self.high * share
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn axis(name: &str, low: f64, high: f64, count: u64) -> DesignAxis {
        DesignAxis {
            name: name.to_owned(),
            low,
            high,
            count,
        }
    }

    #[test]
    fn a_grid_has_every_combination_and_its_ends() {
        let grid = Design::grid(vec![axis("a", 0.1, 0.7, 3), axis("b", -2.0, 2.0, 5)]).unwrap();
        assert_eq!(grid.count(), 15);
        assert_eq!(grid.values(0), [0.1, -2.0]);
        assert_eq!(grid.values(1), [0.1, -1.0]);
        assert_eq!(grid.values(14), [0.7, 2.0]);
        assert_eq!(grid.grid_places(7), [1, 2]);
    }

    #[test]
    fn a_grid_beyond_all_numbers_is_refused() {
        let many = |name| axis(name, 0.0, 1.0, 1 << 20);
        let grid = Design::grid(vec![many("a"), many("b"), many("c"), many("d")]);
        assert!(grid.unwrap_err().contains("more than"));
    }

    /// One design in each of as many intervals as there are designs, in a different order for each parameter.
    #[test]
    fn a_latin_hypercube_is_even() {
        let axes = vec![axis("a", 1.0, 2.0, 1), axis("b", -5.0, 5.0, 1)];
        let spread = DesignSampling::LatinHypercube { seed: 3 };
        let design = Design::spread(axes.clone(), spread, 100).unwrap();
        let mut orders = Vec::new();
        for (k, axis) in axes.iter().enumerate() {
            let place = |item| {
                let share = (design.values(item)[k] - axis.low) / (axis.high - axis.low);
                (share * 100.0) as u64
            };
            let order: Vec<u64> = (0..100).map(place).collect();
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..100).collect::<Vec<_>>());
            orders.push(order);
        }
        assert_ne!(orders[0], orders[1]);
    }

    #[test]
    fn a_table_keeps_its_rows_and_knows_its_ranges() {
        let names = vec!["a".to_owned(), "b".to_owned()];
        let table = Design::table(names, vec![1.0, 5.0, 3.0, 4.0, 2.0, 6.0]);
        assert_eq!((table.count(), table.values(1)), (3, vec![3.0, 4.0]));
        assert_eq!((table.axes[0].low, table.axes[1].high), (1.0, 6.0));
    }
}
