//! A region of the plane, given by the directed edges around it, divided into trapezoids with horizontal sides, in
//! stripes if wanted.
//!
//! The region is where the edges wind around a point: solids that overlap give their union, and holes run the other way
//! round. This needs no order among the edges, and a sweep from below divides everything, whatever the edges cross. A
//! triangulation of polygons with holes would need the union first.

use crate::sorting::{sort_by, sort_by_number};
use glam::DVec2;

/// Most stripes across a region: more could not be seen, and would only fill the memory.
const MOST_STRIPES: f64 = 4096.0;

/// Two horizontal sides and two others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// Heights of the lower and the upper side.
    pub heights: [f64; 2],
    /// Left ends of both sides.
    pub left: [f64; 2],
    /// Right ends of both sides.
    pub right: [f64; 2],
    /// Whether it belongs to a stripe.
    pub is_striped: bool,
}

impl Trapezoid {
    /// Its area.
    pub fn area(&self) -> f64 {
        let widths = [0, 1].map(|k| self.right[k] - self.left[k]);
        0.5 * (widths[0] + widths[1]) * (self.heights[1] - self.heights[0])
    }
}

/// Horizontal stripes at equal distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strips {
    /// Distance from stripe to stripe.
    pub pitch: f64,
    /// Their height, less than the distance.
    pub width: f64,
}

/// An edge that is not horizontal.
#[derive(Clone, Copy, Debug)]
struct SweptEdge {
    low: DVec2,
    high: DVec2,
    /// What it adds to the winding of points to its right: 1 going down, with the inside to the right of it.
    turn: i32,
}

impl SweptEdge {
    /// The place at a height between its ends; exact at the ends.
    fn at(&self, height: f64) -> f64 {
        if height <= self.low.y {
            return self.low.x;
        }
        if height >= self.high.y {
            return self.high.x;
        }
        let share = (height - self.low.y) / (self.high.y - self.low.y);
        self.low.x + (self.high.x - self.low.x) * share
    }
}

/// Divides the region to the left of closed directed edges; edges that are not finite are left out.
pub fn divide_region(border: &[[DVec2; 2]], strips: Option<Strips>) -> Vec<Trapezoid> {
    let edges = border.iter().filter_map(|[from, to]| {
        let is_usable = from.is_finite() && to.is_finite() && from.y != to.y;
        let upwards = from.y < to.y;
        let (low, high) = if upwards { (*from, *to) } else { (*to, *from) };
        let turn = if upwards { -1 } else { 1 };
        is_usable.then_some(SweptEdge { low, high, turn })
    });
    let mut edges: Vec<SweptEdge> = edges.collect();
    sort_by_number(&mut edges, |edge| edge.low.y);
    let (first, last) = edges
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), edge| {
            (first.min(edge.low.y), last.max(edge.high.y))
        });
    let strips = strips.filter(|strips| {
        strips.pitch > 0.0 && (last - first) / strips.pitch < MOST_STRIPES && edges.len() > 1
    });
    // Heights at which something begins, ends or crosses: between two of them the edges keep their order.
    let mut heights: Vec<f64> = edges.iter().flat_map(|e| [e.low.y, e.high.y]).collect();
    heights.extend(crossings(&edges));
    if let Some(strips) = strips {
        let number = |height: f64| (height / strips.pitch).floor() as i64;
        let starts = (number(first)..=number(last)).map(|k| k as f64 * strips.pitch);
        heights.extend(starts.flat_map(|start| [start, start + strips.width]));
    }
    heights.retain(|height| (first..=last).contains(height));
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    Sweep::new(&edges).run(&heights, strips)
}

/// Heights at which two edges cross.
fn crossings(edges: &[SweptEdge]) -> Vec<f64> {
    let mut found = Vec::new();
    let mut active: Vec<usize> = Vec::new();
    for (index, edge) in edges.iter().enumerate() {
        active.retain(|other| edges[*other].high.y > edge.low.y);
        for other in active.iter().map(|other| &edges[*other]) {
            // The difference of both places is linear over the heights that they share.
            let shared = [edge.low.y, edge.high.y.min(other.high.y)];
            let [start, end] = shared.map(|height| edge.at(height) - other.at(height));
            if start * end < 0.0 {
                let share = start / (start - end);
                found.push(shared[0] + (shared[1] - shared[0]) * share);
            }
        }
        active.push(index);
    }
    found
}

/// A sweep over the edges from below.
struct Sweep<'e> {
    edges: &'e [SweptEdge],
    /// Those at the present height, from left to right.
    active: Vec<usize>,
    /// The next edge to begin.
    next: usize,
    /// Trapezoids that may go on upwards: their edges and their lower height.
    open: Vec<([usize; 2], f64)>,
    done: Vec<Trapezoid>,
}

impl<'e> Sweep<'e> {
    fn new(edges: &'e [SweptEdge]) -> Self {
        Self {
            edges,
            active: Vec::new(),
            next: 0,
            open: Vec::new(),
            done: Vec::new(),
        }
    }

    fn run(mut self, heights: &[f64], strips: Option<Strips>) -> Vec<Trapezoid> {
        let mut was_striped = false;
        for pair in heights.windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            let is_striped = strips.is_some_and(|strips| {
                let above = middle - (middle / strips.pitch).floor() * strips.pitch;
                above < strips.width
            });
            // A stripe begins or ends everything.
            if is_striped != was_striped {
                self.close(pair[0], was_striped, &[]);
                was_striped = is_striped;
            }
            let intervals = self.intervals(pair[0], middle);
            self.close(pair[0], is_striped, &intervals);
            let known = |interval: &[usize; 2]| self.open.iter().any(|(own, _)| own == interval);
            let begun: Vec<_> = intervals.into_iter().filter(|i| !known(i)).collect();
            let begun = begun.into_iter().map(|interval| (interval, pair[0]));
            self.open.extend(begun);
        }
        if let Some(last) = heights.last() {
            self.close(*last, was_striped, &[]);
        }
        self.done
    }

    /// The pairs of edges between which the region lies just above `height`.
    fn intervals(&mut self, height: f64, middle: f64) -> Vec<[usize; 2]> {
        let edges = self.edges;
        self.active.retain(|edge| edges[*edge].high.y > height);
        while edges.get(self.next).is_some_and(|e| e.low.y <= height) {
            self.active.push(self.next);
            self.next += 1;
        }
        sort_by(&mut self.active, |a, b| {
            let order = edges[*a].at(middle).total_cmp(&edges[*b].at(middle));
            order.then(a.cmp(b))
        });
        // From outside to inside and back.
        let mut found = Vec::new();
        let (mut winding, mut left) = (0, None);
        for edge in &self.active {
            let before = winding;
            winding += edges[*edge].turn;
            if before <= 0 && winding > 0 {
                left = Some(*edge);
            } else if before > 0 && winding <= 0 {
                found.extend(left.take().map(|left| [left, *edge]));
            }
        }
        found
    }

    /// Ends all trapezoids but those between the pairs of edges that go on.
    fn close(&mut self, height: f64, is_striped: bool, going_on: &[[usize; 2]]) {
        let (edges, done) = (self.edges, &mut self.done);
        self.open.retain(|(pair, low)| {
            let goes_on = going_on.contains(pair);
            if !goes_on {
                let heights = [*low, height];
                let [left, right] = pair.map(|edge| heights.map(|h| edges[edge].at(h)));
                done.push(Trapezoid {
                    heights,
                    left,
                    right,
                    is_striped,
                });
            }
            goes_on
        });
    }
}
