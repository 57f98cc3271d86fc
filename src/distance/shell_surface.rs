//! The triangles of a mesh with merged corners: open edges, connected parts, consistent orientation.

use super::flaps::find_flaps;
use super::surface_edges::{SurfaceEdges, triangle_edges};
use crate::model::shape::TriangleSoup;
use crate::weld::{FlatTable, first_equal, point_bits};
use glam::DVec3;

/// Open edges are joined where their ends are nearer than this fraction of the largest coordinate: files hold single
/// precision, seven digits.
const WELD: f64 = 1e-6;

/// ... but no farther than this fraction of the mesh's extent, so that a small mesh far from its origin is not
/// distorted.
const LARGEST_WELD: f64 = 1e-4;

/// Size of the cells in which corners are searched, as a multiple of the distance at which they are joined: wide enough
/// that most corners have partners in one cell only, narrow enough that few corners share one.
const CELL: f64 = 8.0;

/// No other corner.
const NONE: u32 = u32::MAX;

/// All cells from one to another, corner to corner.
fn cells_between(low: DVec3, high: DVec3) -> impl Iterator<Item = DVec3> {
    let [nx, ny, nz] = (high - low).to_array().map(|n| n.min(1.0) as u32 + 1);
    let index =
        (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])));
    index.map(move |offset| low + DVec3::from(offset.map(f64::from)))
}

/// Triangles by corners, with equal corners merged.
pub(crate) struct ShellSurface {
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The triangles of every connected part, stored consecutively.
pub(crate) struct Parts {
    ends: Vec<u32>,
    list: Vec<u32>,
}

impl Parts {
    /// The triangles of one after another.
    pub(crate) fn each(&self) -> impl Iterator<Item = &[u32]> {
        (0..self.len()).map(|k| self.part(k))
    }

    /// Number of parts.
    pub(crate) fn len(&self) -> usize {
        self.ends.len()
    }

    /// The triangles of one part.
    pub(crate) fn part(&self, index: usize) -> &[u32] {
        let start = index.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.list[start as usize..self.ends[index] as usize]
    }
}

impl ShellSurface {
    /// Merges corners at exactly the same place.
    pub(crate) fn new(soup: &TriangleSoup) -> Self {
        let own = first_equal(soup.vertices.len(), |k| point_bits(soup.vertices[k]));
        let index = |k: u32| own.get(k as usize).copied().unwrap_or_default();
        Self {
            triangles: soup.triangles.iter().map(|t| t.map(index)).collect(),
        }
    }

    /// Every edge with its sides.
    pub(crate) fn edges(&self) -> SurfaceEdges {
        SurfaceEdges::new(&self.triangles)
    }

    /// Closes a surface that is closed but for flaps and triangles of the wrong orientation: removes the flaps, and
    /// reverses the others. Changes nothing and returns `false` where that is not enough.
    pub(crate) fn close(
        &mut self,
        edges: &SurfaceEdges,
        triangles: &mut Vec<[DVec3; 3]>,
        vertices: &[DVec3],
        flaps: &mut Vec<[DVec3; 3]>,
    ) -> bool {
        let at = |k: u32| vertices[k as usize];
        // Without the flaps, neighbours are oriented consistently as far as possible.
        let is_flap = find_flaps(&self.triangles, edges, at, weld_distance(vertices));
        let kept: Vec<usize> = (0..is_flap.len()).filter(|k| !is_flap[*k]).collect();
        let shell = Self {
            triangles: kept.iter().map(|k| self.triangles[*k]).collect(),
        };
        let turned = shell.agreed();
        // An oriented surface without open edges is closed; until here nothing has been changed.
        if kept.is_empty() || turned.edges().open().next().is_some() {
            return false;
        }
        // The places of the corners follow: flaps are handed out, reversed triangles have two corners exchanged.
        let taken = (0..is_flap.len()).filter(|k| is_flap[*k]);
        *flaps = taken.map(|k| triangles[k]).collect();
        let pairs = kept
            .iter()
            .zip(shell.triangles.iter().zip(&turned.triangles));
        *triangles = pairs
            .map(|(k, (old, new))| oriented(triangles[*k], old == new))
            .collect();
        *self = turned;
        true
    }

    /// Merges corners of open edges within the error of the numbers in the file.
    pub(crate) fn weld(&mut self, vertices: &[DVec3], edges: &SurfaceEdges) {
        let near = weld_distance(vertices);
        if near <= 0.0 {
            return;
        }
        let mut corners: Vec<u32> = edges.open().flatten().collect();
        corners.sort_unstable();
        corners.dedup();
        let place = |item: usize| vertices[corners[item] as usize];
        let cell = |p: DVec3| (p / (near * CELL)).floor();
        let key = |item: usize| point_bits(cell(place(item)));
        let mut cells = FlatTable::with_room(corners.len());
        // Those of one cell are consecutive; they are few, since near ones were merged.
        let mut next = vec![NONE; corners.len()];
        let mut first: Vec<u32> = (0..vertices.len() as u32).collect();
        let chain = |start: Option<usize>, next: &[u32], is_it: &dyn Fn(usize) -> bool| {
            let mut at = start?;
            while !is_it(at) {
                at = Some(next[at]).filter(|k| *k != NONE)? as usize;
            }
            Some(at)
        };
        for item in 0..corners.len() {
            let own = place(item);
            let here = cell(own);
            let is_near = |other: usize| place(other).distance(own) <= near;
            // The cells that a box of twice the distance about the corner overlaps: mostly its own alone.
            let [low, high] = [own - near, own + near].map(cell);
            let known = cells_between(low, high)
                .find_map(|c| chain(cells.get(&point_bits(c), key), &next, &is_near));
            if let Some(other) = known {
                first[corners[item] as usize] = corners[other];
                continue;
            }
            let head = cells.get_or_insert(&point_bits(here), item, key);
            if head != item {
                let is_last = |k: usize| next[k] == NONE;
                let last = chain(Some(head), &next, &is_last).unwrap_or(head);
                next[last] = item as u32;
            }
        }
        for corner in self.triangles.iter_mut().flatten() {
            *corner = first[*corner as usize];
        }
    }

    /// The same triangles, oriented so that neighbours run along their common edge in opposite directions, if possible;
    /// in each connected part the minority is reversed.
    pub(super) fn agreed(&self) -> Self {
        let mut triangles = self.triangles.clone();
        let edges = self.edges();
        let mut is_done = vec![false; triangles.len()];
        let mut together = Vec::new();
        // Breadth-first through each connected part, from any of its triangles.
        for seed in 0..triangles.len() {
            if std::mem::replace(&mut is_done[seed], true) {
                continue;
            }
            together.clear();
            together.push(seed);
            let (mut next, mut turned) = (0, 0);
            while let Some(k) = together.get(next).copied() {
                next += 1;
                for edge in triangle_edges(triangles[k]) {
                    let others = edges.pair(edge).into_iter().flatten();
                    let Some(other) = others.into_iter().find(|j| *j != k) else {
                        continue;
                    };
                    if std::mem::replace(&mut is_done[other], true) {
                        continue;
                    }
                    // Neighbours agree if they run along their common edge in opposite directions.
                    if triangle_edges(triangles[other]).contains(&edge) {
                        triangles[other].swap(0, 1);
                        turned += 1;
                    }
                    together.push(other);
                }
            }
            // The orientation of the majority is kept.
            if 2 * turned > together.len() {
                together.iter().for_each(|k| triangles[*k].swap(0, 1));
            }
        }
        Self { triangles }
    }

    /// The triangles of every connected part, the parts in the order of their first triangles.
    pub(crate) fn parts(&self) -> Parts {
        let count = self.triangles.iter().flatten().max().map_or(0, |k| k + 1);
        // Union and find over the corners.
        let mut root: Vec<u32> = (0..count).collect();
        fn find(root: &mut [u32], mut k: u32) -> u32 {
            while root[k as usize] != k {
                root[k as usize] = root[root[k as usize] as usize];
                k = root[k as usize];
            }
            k
        }
        for [a, b, c] in &self.triangles {
            for other in [b, c] {
                let (p, q) = (find(&mut root, *a), find(&mut root, *other));
                root[p.max(q) as usize] = p.min(q);
            }
        }
        let mut of: Vec<u32> = Vec::with_capacity(self.triangles.len());
        of.extend(self.triangles.iter().map(|t| find(&mut root, t[0])));
        drop(root);
        let mut number = vec![NONE; count as usize];
        let mut ends: Vec<u32> = Vec::new();
        for part in &mut of {
            let number = &mut number[*part as usize];
            if *number == NONE {
                *number = ends.len() as u32;
                ends.push(0);
            }
            *part = *number;
            ends[*part as usize] += 1;
        }
        drop(number);
        // Start of each part; while the list is filled, it becomes the end.
        let mut start = 0;
        for end in &mut ends {
            (start, *end) = (start + *end, start);
        }
        let mut list = vec![0; of.len()];
        for (k, part) in of.iter().enumerate() {
            let place = &mut ends[*part as usize];
            list[*place as usize] = k as u32;
            *place += 1;
        }
        Parts { ends, list }
    }
}

/// A triangle as it is, or reversed.
pub(super) fn oriented<T>([a, b, c]: [T; 3], as_it_is: bool) -> [T; 3] {
    if as_it_is { [a, b, c] } else { [b, a, c] }
}

/// The distance below which corners of open edges are merged.
fn weld_distance(vertices: &[DVec3]) -> f64 {
    let largest = vertices
        .iter()
        .fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let low = vertices.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
    let high = vertices.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
    (WELD * largest).min(LARGEST_WELD * (high - low).length())
}
