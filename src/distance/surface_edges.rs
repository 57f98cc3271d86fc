//! The edges of a surface in one list: the triangles adjacent to each. Its memory suits meshes of millions of
//! triangles, however many of them meet in one edge.

/// A side of a triangle, stored with the lower of its two corners.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TriangleSide {
    /// The higher corner.
    high: u32,
    /// Twice the triangle; plus one where it runs from the higher corner to the lower one.
    run: u32,
}

impl TriangleSide {
    /// The triangle.
    pub(crate) fn triangle(self) -> usize {
        (self.run / 2) as usize
    }

    /// Whether the triangle runs from the lower corner to the higher one.
    pub(crate) fn is_along(self) -> bool {
        self.run.is_multiple_of(2)
    }
}

/// All sides of some triangles by their edges; triangles with two equal corners have none.
pub(crate) struct SurfaceEdges {
    /// Start of the sides of each lower corner, and the end of the last ones.
    starts: Vec<u32>,
    sides: Vec<TriangleSide>,
}

impl SurfaceEdges {
    /// Of triangles by their corners, fewer than 2^31 of them.
    pub(crate) fn new(triangles: &[[u32; 3]]) -> Self {
        let corners = triangles.iter().flatten().max().map_or(0, |k| k + 1) as usize;
        let mut starts = vec![0u32; corners + 2];
        let sides_of = |k: usize| {
            let is_whole = has_sides(&triangles[k]);
            triangle_edges(triangles[k])
                .into_iter()
                .filter(move |_| is_whole)
        };
        // Counted one place later, so that filling the list moves every start to its place.
        for [from, to] in (0..triangles.len()).flat_map(sides_of) {
            starts[from.min(to) as usize + 2] += 1;
        }
        for k in 2..starts.len() {
            starts[k] += starts[k - 1];
        }
        let count = starts.last().copied().unwrap_or(0) as usize;
        let mut sides = vec![TriangleSide { high: 0, run: 0 }; count];
        for triangle in 0..triangles.len() {
            for [from, to] in sides_of(triangle) {
                let start = &mut starts[from.min(to) as usize + 1];
                sides[*start as usize] = TriangleSide {
                    high: from.max(to),
                    run: 2 * triangle as u32 + u32::from(from > to),
                };
                *start += 1;
            }
        }
        starts.pop();
        for ends in starts.windows(2) {
            sides[ends[0] as usize..ends[1] as usize].sort_unstable();
        }
        Self { starts, sides }
    }

    /// The sides at an edge, in the order of their triangles.
    pub(crate) fn at(&self, [from, to]: [u32; 2]) -> &[TriangleSide] {
        let [low, high] = [from.min(to), from.max(to)];
        let all = self.with_lower(low as usize);
        let start = all.partition_point(|side| side.high < high);
        let rest = &all[start..];
        &rest[..rest.partition_point(|side| side.high == high)]
    }

    /// The two triangles at an edge, if there are exactly two.
    pub(crate) fn pair(&self, edge: [u32; 2]) -> Option<[usize; 2]> {
        match self.at(edge) {
            [a, b] => Some([a.triangle(), b.triangle()]),
            _ => None,
        }
    }

    /// Edges that do not have as many sides in one direction as in the other, in order.
    pub(crate) fn open(&self) -> impl Iterator<Item = [u32; 2]> {
        (0..self.starts.len().saturating_sub(1)).flat_map(|low| {
            let equal = self.with_lower(low).chunk_by(|a, b| a.high == b.high);
            let open = equal
                .filter(|all| 2 * all.iter().filter(|side| side.is_along()).count() != all.len());
            open.filter_map(move |all| Some([low as u32, all.first()?.high]))
        })
    }

    fn with_lower(&self, low: usize) -> &[TriangleSide] {
        match (self.starts.get(low), self.starts.get(low + 1)) {
            (Some(start), Some(end)) => &self.sides[*start as usize..*end as usize],
            _ => &[],
        }
    }
}

/// Whether all three corners are distinct.
fn has_sides([a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// The edges of a triangle as it runs along them.
pub(crate) fn triangle_edges([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// Against a map of lists, on triangles that share corners and edges in every way.
    #[test]
    fn edges_have_the_sides_that_run_along_them() {
        let mut state = 1u32;
        let mut corner = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 16) % 7
        };
        for count in [0, 1, 2, 30, 200] {
            let triangles: Vec<[u32; 3]> =
                (0..count).map(|_| [corner(), corner(), corner()]).collect();
            let mut known: BTreeMap<[u32; 2], Vec<(usize, bool)>> = BTreeMap::new();
            for (k, t) in triangles.iter().enumerate().filter(|(_, t)| has_sides(t)) {
                for [from, to] in triangle_edges(*t) {
                    let edge = known.entry([from.min(to), from.max(to)]).or_default();
                    edge.push((k, from < to));
                }
            }
            let edges = SurfaceEdges::new(&triangles);
            for low in 0..8 {
                for high in low + 1..9 {
                    let sides = edges.at([high, low]).iter();
                    let sides: Vec<_> = sides.map(|s| (s.triangle(), s.is_along())).collect();
                    let expected = known.get(&[low, high]).cloned().unwrap_or_default();
                    assert_eq!(sides, expected, "{low} {high}");
                }
            }
            let is_open = |sides: &Vec<(usize, bool)>| {
                2 * sides.iter().filter(|s| s.1).count() != sides.len()
            };
            let open: Vec<[u32; 2]> = known
                .iter()
                .filter(|(_, sides)| is_open(sides))
                .map(|(edge, _)| *edge)
                .collect();
            assert_eq!(edges.open().collect::<Vec<_>>(), open);
        }
    }
}
