//! Pavings of the exact set of positions for which bars keep their angles: squares inside it, squares on its boundary,
//! and the rest.
//!
//! A dyad whose bars are nowhere closer to collinear than an angle δ satisfies |e × f| ≥ sin δ |e| |f|, whatever the
//! lengths of its bars. For one point with fixed ends this means: inside exactly one of two circles. Two sets of a
//! point are paved: its positions with the others as drawn (`section`), and its positions for some positions of the
//! others near theirs (`projection`).

use super::chain::DyadChain;
use super::dyad::{Dyad, are_apart};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// A square: its centre and half its side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PavedSquare {
    /// Middle.
    pub middle: [f64; 2],
    /// Half of the side.
    pub half: f64,
}

/// A paved set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Paving {
    /// Squares all of whose points belong to it (proved).
    pub inner: Vec<PavedSquare>,
    /// Undecided squares. Points of the window outside both lists do not belong to the set (proved).
    pub edge: Vec<PavedSquare>,
    /// Half the side of the window.
    pub reach: f64,
}

impl Paving {
    /// Fractions of the window that are inside, and on the boundary.
    pub fn shares(&self) -> [f64; 2] {
        let whole = self.reach * self.reach;
        [&self.inner, &self.edge].map(|list| {
            let areas = list.iter().map(|cell| cell.half * cell.half);
            areas.fold(0.0, |sum, area| sum + area) / whole
        })
    }
}

/// What a paving asks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PavingWindow {
    /// The least angle between the bars of a dyad as lines, radians.
    pub least: f64,
    /// Half the side of the window around a point as drawn.
    pub reach: f64,
    /// How often squares are halved.
    pub halvings: u32,
}

type Box2 = [Interval; 2];

fn point_box(p: [f64; 2], half: f64) -> Box2 {
    p.map(|v| Interval::point(v) + Interval::around_zero(half))
}

/// The positions of `point` with all others as drawn.
pub fn pave_section(chain: &DyadChain, point: usize, window: PavingWindow) -> Paving {
    let drawn: Vec<Box2> = chain.points.iter().map(|p| point_box(*p, 0.0)).collect();
    pave_cells(chain, point, window, |cell| {
        judge_cell(&chain.dyads, point, cell, &drawn, window.least)
    })
}

/// The positions of `point` for some positions of the other moving points within `reach` of their own. `random` gives
/// numbers from -1 to 1, and `tries` is the number of positions of the others examined for squares inside.
pub fn pave_projection(
    chain: &DyadChain,
    point: usize,
    window: PavingWindow,
    tries: usize,
    mut random: impl FnMut() -> f64,
) -> Paving {
    let anywhere: Vec<Box2> = (0..chain.points.len())
        .map(|k| {
            let wide = !chain.fixed.contains(&k) && k != point;
            point_box(chain.points[k], if wide { window.reach } else { 0.0 })
        })
        .collect();
    let others = |k: &usize| !chain.fixed.contains(k) && *k != point;
    let mut witnesses: Vec<Vec<Box2>> = Vec::new();
    for item in 0..tries {
        // First the positions as drawn, then positions farther and farther away.
        let share = item as f64 / tries as f64;
        let mut places = chain.points.clone();
        for k in (0..places.len()).filter(others) {
            for axis in &mut places[k] {
                *axis += share * window.reach * random();
            }
        }
        let places: Vec<Box2> = places.iter().map(|p| point_box(*p, 0.0)).collect();
        let mut apart = chain.dyads.iter().filter(|d| !is_part_of(d, point));
        let sine = Interval::point(window.least).sin_cos().0;
        if apart.all(|dyad| dyad_answer(dyad, &places, sine) == Some(true)) {
            witnesses.push(places);
        }
    }
    pave_cells(chain, point, window, |cell| {
        let is_inside = |places: &Vec<Box2>| {
            judge_cell(&chain.dyads, point, cell, places, window.least) == Some(true)
        };
        if witnesses.iter().any(is_inside) {
            return Some(true);
        }
        let none = judge_cell(&chain.dyads, point, cell, &anywhere, window.least);
        (none == Some(false)).then_some(false)
    })
}

fn is_part_of(dyad: &Dyad, point: usize) -> bool {
    dyad.point == point || dyad.ends.contains(&point)
}

fn dyad_answer(dyad: &Dyad, places: &[Box2], sine: Interval) -> Option<bool> {
    are_apart(places[dyad.point], dyad.ends.map(|end| places[end]), sine)
}

/// Whether all positions in a cell satisfy all dyads, or none does.
fn judge_cell(
    dyads: &[Dyad],
    point: usize,
    cell: PavedSquare,
    places: &[Box2],
    least: f64,
) -> Option<bool> {
    // The bars of every dyad are examined with the point anywhere in the cell.
    let sine = Interval::point(least).sin_cos().0;
    let mut all = Some(true);
    let own = point_box(cell.middle, cell.half);
    for dyad in dyads {
        let of = |k: usize| if k == point { own } else { places[k] };
        match are_apart(of(dyad.point), dyad.ends.map(of), sine) {
            Some(false) => return Some(false),
            None => all = None,
            Some(true) => {}
        }
    }
    all
}

/// Halves the window's square until every cell is decided or small.
fn pave_cells(
    chain: &DyadChain,
    point: usize,
    window: PavingWindow,
    answer: impl Fn(PavedSquare) -> Option<bool>,
) -> Paving {
    let mut paving = Paving {
        reach: window.reach,
        ..Paving::default()
    };
    let whole = PavedSquare {
        middle: chain.points[point],
        half: window.reach,
    };
    // Depth-first subdivision of the window into four quarters.
    let mut open = vec![(whole, 0)];
    while let Some((cell, halvings)) = open.pop() {
        match answer(cell) {
            Some(true) => paving.inner.push(cell),
            Some(false) => {}
            // Undecided cells of the smallest size form the boundary.
            None if halvings == window.halvings => paving.edge.push(cell),
            None => {
                let half = 0.5 * cell.half;
                for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]] {
                    let middle = [cell.middle[0] + x * half, cell.middle[1] + y * half];
                    open.push((PavedSquare { middle, half }, halvings + 1));
                }
            }
        }
    }
    paving
}
