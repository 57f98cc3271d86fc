//! Shells that are written twice, once outwards and once inwards, as programs with two-sided faces export them: inwards takes away
//! what outwards encloses. Of each such shell one side is kept, outside out.

use super::flaps::each_sheet;
use super::shell_surface::{ShellSurface, oriented};
use glam::DVec3;

/// A shell encloses nothing if the volumes over its triangles cancel to this share of their sum: rounding leaves some 1e-16 for
/// every triangle, and of the thinnest plate half of them remain.
const CANCELLED: f64 = 1e-9;

/// The surface with one side of every shell that has two, and the places of its corners likewise. Sheets with two sides, and walls
/// between solids that touch, stay: they close nothing by themselves.
pub(super) fn halved(surface: ShellSurface, triangles: &mut Vec<[DVec3; 3]>) -> ShellSurface {
    let pairs = opposite_pairs(&surface.triangles);
    if pairs.is_empty() {
        return surface;
    }
    let single: Vec<[u32; 3]> = pairs
        .iter()
        .map(|pair| surface.triangles[pair[0]])
        .collect();
    let single = ShellSurface { triangles: single };
    // What happens to every triangle: left out, or reversed.
    let (mut is_left_out, mut is_turned) =
        (vec![false; triangles.len()], vec![false; triangles.len()]);
    each_sheet(&single.triangles, &single.edges(), |sheet| {
        let shell = ShellSurface {
            triangles: sheet.iter().map(|k| single.triangles[*k]).collect(),
        };
        let turned = shell.agreed();
        let same = |k: usize| shell.triangles[k] == turned.triangles[k];
        let places = sheet.iter().enumerate();
        let places: Vec<[DVec3; 3]> = places
            .map(|(k, pair)| oriented(triangles[pairs[*pair][0]], same(k)))
            .collect();
        let volume = six_volumes(places.iter());
        let size: f64 = each_volume(places.iter()).map(f64::abs).sum();
        if turned.edges().open().next().is_some() || volume.abs() <= CANCELLED * size {
            return;
        }
        for (k, pair) in sheet.iter().enumerate() {
            let [kept, other] = pairs[*pair];
            is_left_out[other] = true;
            is_turned[kept] = same(k) == (volume < 0.0);
        }
    });
    let kept = (0..triangles.len()).filter(|k| !is_left_out[*k]);
    let (mut own, mut places) = (Vec::new(), Vec::new());
    for k in kept {
        let [a, b, c] = surface.triangles[k];
        own.push(if is_turned[k] { [b, a, c] } else { [a, b, c] });
        places.push(oriented(triangles[k], !is_turned[k]));
    }
    *triangles = places;
    ShellSurface { triangles: own }
}

/// Triangles with the same corners and opposite orientations, two by two; of corners with several pairs none if they are even, as a
/// wall between two shells, and one if they are odd.
fn opposite_pairs(triangles: &[[u32; 3]]) -> Vec<[usize; 2]> {
    let mut all: Vec<([u32; 3], bool, usize)> = Vec::with_capacity(triangles.len());
    all.extend(triangles.iter().enumerate().map(|(k, corners)| {
        let mut sorted = *corners;
        sorted.sort_unstable();
        let is_even = (0..3).any(|turn| [0, 1, 2].map(|i| corners[(turn + i) % 3]) == sorted);
        (sorted, is_even, k)
    }));
    all.sort_unstable();
    let mut pairs = Vec::new();
    for same in all.chunk_by(|a, b| a.0 == b.0) {
        let split = same.partition_point(|item| !item.1);
        let (odd, even) = same.split_at(split);
        if odd.len().min(even.len()) % 2 == 1 {
            pairs.push([odd[0].2, even[0].2]);
        }
    }
    pairs
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
