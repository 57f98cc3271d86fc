//! The signed distance of two convex cores as the least, over all directions, of how far their difference reaches.
//!
//! With C the difference of both cores and h(n) how far C reaches along the unit vector n, the signed distance is minus
//! the least h: apart, the widest gap between two parallel planes; overlapping, the shortest translation that parts
//! them. All directions are searched: the sphere is cut into cells, and cells that could hide a smaller h are cut again. A
//! point x of C bounds h from below, h(n) >= n·x; with x the point that C has in the middle of a cell, the bound is as
//! near as the second power of the cell's width.

use super::number::{Number, Vector};
use super::solids::Solid;
use glam::DVec3;
use mechanim::numbers::double_double::DoubleDouble;
use std::f64::consts::SQRT_2;

/// Half the width of the first cells on the faces of a cube.
const FIRST: f64 = 0.25;

/// How far beside a cell, in its own width, other ends of edges are looked for.
const BESIDE: f64 = 3.0;

/// How many of the lowest cells are looked at more closely.
const FOLLOWED: usize = 2;

/// More cells than this at once mean that whole curves of directions are as good as each other.
const MOST_CELLS: usize = 500;

/// A square on a face of the cube [-1, 1]³, seen from the middle.
#[derive(Clone, Copy)]
struct Cell {
    face: usize,
    at: [f64; 2],
    half: f64,
}

impl Cell {
    fn first() -> Vec<Self> {
        let count = (1.0 / FIRST) as i32;
        let places: Vec<f64> = (0..count)
            .map(|k| f64::from(2 * k + 1) * FIRST - 1.0)
            .collect();
        let mut cells = Vec::new();
        for face in 0..6 {
            for x in &places {
                cells.extend(places.iter().map(|y| Self {
                    face,
                    at: [*x, *y],
                    half: FIRST,
                }));
            }
        }
        cells
    }

    fn quarters(self) -> [Self; 4] {
        let half = 0.5 * self.half;
        [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)].map(|(x, y)| Self {
            at: [self.at[0] + x * half, self.at[1] + y * half],
            half,
            ..self
        })
    }

    /// The direction of its middle, not of unit length.
    fn middle(self) -> [f64; 3] {
        let sign = if self.face < 3 { 1.0 } else { -1.0 };
        let mut n = [0.0; 3];
        n[self.face % 3] = sign;
        n[(self.face + 1) % 3] = self.at[0];
        n[(self.face + 2) % 3] = self.at[1];
        n
    }
}

/// What is found in the middle of a cell.
struct Look<N> {
    cell: Cell,
    value: N,
    /// Unit direction, the farthest point of C along it.
    n: DVec3,
    x: DVec3,
    /// Sine of the angle at which a corner of the cell is seen from its middle, at most.
    sine: f64,
}

impl<N: Number> Look<N> {
    fn at([a, b]: [&Solid<N>; 2], cell: Cell) -> Self {
        let m = Vector(cell.middle().map(N::from));
        let length = m.length();
        let x = a.farthest(m) - b.farthest(-m);
        Self {
            cell,
            value: m.dot(x).over(length),
            n: m.rounded().normalize(),
            x: x.rounded(),
            sine: (SQRT_2 * cell.half / length.rounded()).min(1.0),
        }
    }

    /// How much lower than in the middle h could be within the cell, seen from a point of C.
    fn drop_from(&self, p: DVec3) -> f64 {
        let (high, versine) = (
            self.value.rounded(),
            self.sine * self.sine / (1.0 + (1.0 - self.sine * self.sine).sqrt()),
        );
        let lower = self.n.dot(self.x - p);
        let along = high - lower;
        let aside = (p - self.n * self.n.dot(p)).length();
        let far = along.hypot(aside);
        lower
            + if along <= -far * (1.0 - versine) {
                // The point lies straight behind some direction of the cell.
                aside * aside / (far - along).max(f64::MIN_POSITIVE)
            } else {
                along * versine + aside * self.sine
            }
    }

    /// The ways from its own point to those that C has beside the cell.
    fn ways(&self, rough: [&Solid<f64>; 2]) -> Vec<DVec3> {
        let (u, v) = self.n.any_orthonormal_pair();
        let way = |side: DVec3| {
            let n = Vector((self.n + side * (BESIDE * self.sine)).to_array());
            (rough[0].farthest(n) - rough[1].farthest(-n)).rounded() - self.x
        };
        let ways = [u, -u, v, -v].map(way).into_iter();
        ways.filter(|way| *way != DVec3::ZERO).collect()
    }

    /// Points on these ways that lie straighter ahead than its own: C may have an edge, and h a kink, on which no end
    /// of the edge says much.
    fn on_edges(&self, ways: &[DVec3]) -> Vec<DVec3> {
        let across = |v: DVec3| v - self.n * self.n.dot(v);
        let mine = across(self.x);
        let between = ways.iter().filter_map(|way| {
            let share = -across(*way).dot(mine) / across(*way).length_squared();
            (share > 0.0 && share <= 1.0).then(|| self.x + *way * share)
        });
        between.collect()
    }

    /// Directions on the kinks beside its middle, and where two of them meet.
    fn on_kinks(&self, ways: &[DVec3]) -> Vec<DVec3> {
        let along = |way: &DVec3| self.n - *way * (self.n.dot(*way) / way.length_squared());
        let mut kinks: Vec<DVec3> = ways.iter().map(along).collect();
        for (k, first) in ways.iter().enumerate() {
            for second in &ways[k + 1..] {
                let both = first.cross(*second).normalize_or_zero();
                kinks.push(both * self.n.dot(both).signum());
            }
        }
        kinks.retain(|n| n.dot(self.n) > 0.5);
        kinks
    }
}

/// How far C reaches along a direction of any length.
fn reach<N: Number>([a, b]: [&Solid<N>; 2], m: Vector<N>) -> N {
    m.dot(a.farthest(m) - b.farthest(-m)).over(m.length())
}

/// Cuts cells until the least h is known to within `enough`, the bracket. The cells that are left are those that
/// could hold it if all that is known of them were wrong by `margin`.
fn cut<N: Number>(
    [a, b]: [&Solid<N>; 2],
    rough: [&Solid<f64>; 2],
    mut cells: Vec<Cell>,
    enough: f64,
    margin: f64,
) -> (Vec<Cell>, [N; 2]) {
    let mut best: Option<N> = None;
    let mut done: Vec<(Cell, N)> = Vec::new();
    loop {
        let mut looks: Vec<Look<N>> = cells.iter().map(|c| Look::at([a, b], *c)).collect();
        looks.sort_by(|p, q| p.value.rounded().total_cmp(&q.value.rounded()));
        let mut take = |h: N| best = Some(best.map_or(h, |best: N| best.lesser(h)));
        looks.iter().for_each(|look| take(look.value));
        // The cells' middles are not on the kinks; the points of edges lead to them.
        for look in looks.iter().take(FOLLOWED) {
            for n in look.on_kinks(&look.ways(rough)) {
                take(reach([a, b], Vector::of(n)));
            }
        }
        let Some(high) = best else {
            panic!("there are cells to begin with");
        };
        cells.clear();
        let is_full = looks.len() > MOST_CELLS;
        for look in looks {
            let low_for = |drop: f64| look.value - N::from(drop);
            let above_for = |drop: f64| (low_for(drop) - high).rounded();
            let mut drop = look.drop_from(look.x);
            if above_for(drop) < -enough {
                let edges = look.on_edges(&look.ways(rough));
                drop = edges
                    .iter()
                    .fold(drop, |drop, p| drop.min(look.drop_from(*p)));
            }
            let above = above_for(drop);
            if above >= margin {
                continue;
            }
            if above >= -enough || is_full {
                done.push((look.cell, low_for(drop)));
            } else {
                cells.extend(look.cell.quarters());
            }
        }
        if cells.is_empty() {
            let keeps = |low: N| (low - high).rounded() < margin;
            done.retain(|(_, low)| keeps(*low));
            let low = done.iter().fold(high, |least, (_, low)| least.lesser(*low));
            return (done.iter().map(|(cell, _)| *cell).collect(), [low, high]);
        }
    }
}

/// Lower and upper bound of the least h; `size` is the extent of both cores.
pub fn least(
    rough: [&Solid<f64>; 2],
    exact: [&Solid<DoubleDouble>; 2],
    size: f64,
) -> [DoubleDouble; 2] {
    // What f64 leaves open is decided in the longer arithmetic.
    let (cells, _) = cut(rough, rough, Cell::first(), 1e-12 * size, 1e-13 * size);
    let (_, bracket) = cut(exact, rough, cells, 1e-14 * size, 0.0);
    bracket
}
