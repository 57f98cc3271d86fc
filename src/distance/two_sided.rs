//! Shells that are written twice, once outwards and once inwards, as programs with two-sided faces export them: inwards takes away
//! what outwards encloses. Of each such shell one side is kept, outside out.

use super::flaps::each_sheet;
use super::shell_surface::{ShellSurface, oriented};
use crate::sorting::sort;
use glam::DVec3;

/// A shell encloses nothing if the volumes over its triangles cancel to this share of their sum: rounding leaves some 1e-16 for
/// every triangle, and of the thinnest plate half of them remain.
const CANCELLED: f64 = 1e-9;

/// The triangles with the same three corners.
struct SameCorners {
    /// Those of either orientation.
    sides: [Vec<usize>; 2],
}

impl SameCorners {
    /// How many have an opposite.
    fn pairs(&self) -> usize {
        self.sides[0].len().min(self.sides[1].len())
    }

    /// Whether some have none.
    fn has_rest(&self) -> bool {
        self.sides[0].len() != self.sides[1].len()
    }
}

/// What becomes of every triangle.
struct Kept {
    is_left_out: Vec<bool>,
    is_turned: Vec<bool>,
}

/// The surface with one side of every shell that has two, and the places of its corners likewise. Sheets with two sides, and walls
/// between solids that touch, stay: they close nothing by themselves.
pub(super) fn halved(surface: ShellSurface, triangles: &mut Vec<[DVec3; 3]>) -> ShellSurface {
    let groups = opposite_triangles(&surface.triangles);
    if groups.is_empty() {
        return surface;
    }
    let count = triangles.len();
    let mut kept = Kept {
        is_left_out: vec![false; count],
        is_turned: vec![false; count],
    };
    // A wall between two such shells stands there twice as often: first what is there an odd number of times, then the rest.
    let (odd, even): (Vec<_>, Vec<_>) = groups.iter().partition(|group| group.pairs() % 2 == 1);
    kept.choose(&surface, triangles, &odd);
    kept.choose(&surface, triangles, &even);
    let (mut own, mut places) = (Vec::new(), Vec::new());
    for k in (0..count).filter(|k| !kept.is_left_out[*k]) {
        own.push(oriented(surface.triangles[k], !kept.is_turned[k]));
        places.push(oriented(triangles[k], !kept.is_turned[k]));
    }
    *triangles = places;
    ShellSurface { triangles: own }
}

impl Kept {
    /// Leaves one side of every closed shell of these triangles, outside out; none of one that stands there alone as well.
    fn choose(&mut self, surface: &ShellSurface, places: &[[DVec3; 3]], groups: &[&SameCorners]) {
        let first = |group: &SameCorners| group.sides[0][0];
        let single = ShellSurface {
            triangles: groups
                .iter()
                .map(|group| surface.triangles[first(group)])
                .collect(),
        };
        each_sheet(&single.triangles, &single.edges(), |sheet| {
            let shell = ShellSurface {
                triangles: sheet.iter().map(|k| single.triangles[*k]).collect(),
            };
            let turned = shell.agreed();
            let same = |k: usize| shell.triangles[k] == turned.triangles[k];
            let own = sheet.iter().enumerate();
            let own: Vec<[DVec3; 3]> = own
                .map(|(k, group)| oriented(places[first(groups[*group])], same(k)))
                .collect();
            let volume = six_volumes(own.iter());
            let size: f64 = each_volume(own.iter()).map(f64::abs).sum();
            if turned.edges().open().next().is_some() || volume.abs() <= CANCELLED * size {
                return;
            }
            let is_elsewhere = sheet.iter().all(|k| groups[*k].has_rest());
            for (k, group) in sheet.iter().enumerate() {
                let group = groups[*group];
                // Of an odd number of pairs one goes, of an even number all.
                let gone = if group.pairs() % 2 == 1 {
                    1
                } else {
                    group.pairs()
                };
                let [left, right] = &group.sides;
                for (a, b) in left.iter().zip(right).take(gone) {
                    self.is_left_out[*a] = true;
                    self.is_left_out[*b] = true;
                }
                if !is_elsewhere {
                    self.is_left_out[left[0]] = false;
                    self.is_turned[left[0]] = same(k) == (volume < 0.0);
                }
            }
        });
    }
}

/// The triangles of which some have the same corners and the opposite orientation.
fn opposite_triangles(triangles: &[[u32; 3]]) -> Vec<SameCorners> {
    let mut all: Vec<([u32; 3], bool, usize)> = Vec::with_capacity(triangles.len());
    all.extend(triangles.iter().enumerate().map(|(k, corners)| {
        let mut sorted = *corners;
        sorted.sort_unstable();
        let is_even = (0..3).any(|turn| [0, 1, 2].map(|i| corners[(turn + i) % 3]) == sorted);
        (sorted, is_even, k)
    }));
    sort(&mut all);
    let mut groups = Vec::new();
    for same in all.chunk_by(|a, b| a.0 == b.0) {
        let (odd, even) = same.split_at(same.partition_point(|item| !item.1));
        if !odd.is_empty() && !even.is_empty() {
            let of = |side: &[([u32; 3], bool, usize)]| side.iter().map(|item| item.2).collect();
            groups.push(SameCorners {
                sides: [of(odd), of(even)],
            });
        }
    }
    groups
}

/// Six times the volume, negative for a shell that is inside out.
pub(super) fn six_volumes<'t>(triangles: impl Iterator<Item = &'t [DVec3; 3]> + Clone) -> f64 {
    each_volume(triangles).sum()
}

/// Six times the volume between every triangle and the first corner.
fn each_volume<'t>(
    triangles: impl Iterator<Item = &'t [DVec3; 3]> + Clone,
) -> impl Iterator<Item = f64> {
    let origin = triangles.clone().next().map_or(DVec3::ZERO, |t| t[0]);
    triangles.map(move |t| {
        let [a, b, c] = t.map(|p| p - origin);
        a.dot(b.cross(c))
    })
}
