//! The shells of a mesh: its connected parts, whether each encloses space, and which side of it is outside.

use super::flaps::Sides;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// How a file's triangles enclose space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShellEnclosure {
    /// Closed, outside out.
    Solid,
    /// Closed, but the triangles are numbered as seen from inside.
    InsideOut,
    /// It has edges with one side only.
    Open,
    /// The scene says that it is a surface, which has no inside.
    Surface,
}

/// Open edges are joined where their ends are nearer than this part of the largest coordinate: files hold single precision,
/// seven digits.
const WELD: f64 = 1e-6;

/// ... but no farther than this part of the mesh's extent: a small mesh far from its origin stays what it is.
const LARGEST_WELD: f64 = 1e-4;

/// The shells of a mesh.
pub struct Shells {
    /// Whether there is an inside.
    pub enclosure: ShellEnclosure,
    /// Edges with one side only.
    pub open_edges: usize,
    /// A corner of every shell.
    pub points: Vec<DVec3>,
    /// The triangles, those of closed shells as seen from outside.
    pub triangles: Vec<[DVec3; 3]>,
    /// Triangles that belong to no shell and enclose nothing, beside the others.
    pub flaps: Vec<[DVec3; 3]>,
}

/// Triangles by corners that are one where they belong together.
struct ShellSurface {
    triangles: Vec<[usize; 3]>,
}

impl Shells {
    /// Of triangles as a file holds them.
    pub fn new(soup: &TriangleSoup) -> Self {
        let corner = |k: u32| soup.vertices.get(k as usize).copied().unwrap_or_default();
        let mut triangles: Vec<[DVec3; 3]> = soup.triangles.iter().map(|t| t.map(corner)).collect();
        // Triangles that share edges; corners nearly at one place are welded if edges stay open.
        let mut surface = ShellSurface::new(soup);
        if !surface.open_edges().is_empty() {
            surface.weld(&soup.vertices);
        }
        let mut open_edges = surface.open_edges().len();
        let points = surface.parts();
        let points = points
            .iter()
            .filter_map(|list| triangles.get(*list.first()?));
        let points = points.map(|t| t[0]).collect();
        // What is still open may be flaps on closed shells.
        let mut flaps = Vec::new();
        if open_edges > 0 && surface.close(&mut triangles, &soup.vertices, &mut flaps) {
            open_edges = 0;
        }
        // A closed mesh has an inside; the sign of its volume says whether it is inside out.
        let is_hollow = !soup.is_surface && open_edges == 0 && !triangles.is_empty();
        let enclosure = match (soup.is_surface, is_hollow) {
            (true, _) => ShellEnclosure::Surface,
            (false, false) => ShellEnclosure::Open,
            (false, true) if six_volumes(&triangles) < 0.0 => ShellEnclosure::InsideOut,
            (false, true) => ShellEnclosure::Solid,
        };
        if is_hollow {
            turn_outside_out(&mut triangles, &surface.parts());
        }
        Self {
            enclosure,
            open_edges,
            points,
            triangles,
            flaps,
        }
    }
}

impl ShellSurface {
    /// Corners at exactly the same place are one.
    fn new(soup: &TriangleSoup) -> Self {
        let mut first: HashMap<[u64; 3], usize> = HashMap::new();
        let own: Vec<usize> = soup
            .vertices
            .iter()
            .enumerate()
            .map(|(k, p)| {
                // Adding zero makes -0 into 0.
                *first
                    .entry((*p + 0.0).to_array().map(f64::to_bits))
                    .or_insert(k)
            })
            .collect();
        let index = |k: u32| own.get(k as usize).copied().unwrap_or_default();
        Self {
            triangles: soup.triangles.iter().map(|t| t.map(index)).collect(),
        }
    }

    /// Every edge with its sides; triangles with two equal corners have none.
    fn sides(&self) -> Sides {
        let mut sides = Sides::new();
        for (k, [a, b, c]) in self.triangles.iter().copied().enumerate() {
            if a == b || b == c || c == a {
                continue;
            }
            for [from, to] in [[a, b], [b, c], [c, a]] {
                sides.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)]
                    .push(k);
            }
        }
        sides
    }

    /// Edges that do not have as many sides along them as against them, in order.
    fn open_edges(&self) -> Vec<[usize; 2]> {
        let whole = self
            .triangles
            .iter()
            .filter(|[a, b, c]| a != b && b != c && c != a);
        let mut edges: Vec<([usize; 2], bool)> = whole
            .flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]])
            .map(|[from, to]| ([from.min(to), from.max(to)], from < to))
            .collect();
        edges.sort_unstable();
        let equal = edges.chunk_by(|first, second| first.0 == second.0);
        let open = equal.filter(|sides| 2 * sides.iter().filter(|s| s.1).count() != sides.len());
        open.filter_map(|sides| Some(sides.first()?.0)).collect()
    }

    /// Makes a closed surface of one that is closed but for flaps and for triangles that are numbered the other way round:
    /// takes the flaps out, and turns the others. Changes nothing and says so where that is not enough.
    fn close(
        &mut self,
        triangles: &mut Vec<[DVec3; 3]>,
        vertices: &[DVec3],
        flaps: &mut Vec<[DVec3; 3]>,
    ) -> bool {
        let at = |k: usize| vertices[k];
        let is_flap =
            super::flaps::find_flaps(&self.triangles, &self.sides(), at, weld_distance(vertices));
        let kept: Vec<usize> = (0..is_flap.len()).filter(|k| !is_flap[*k]).collect();
        let shell = Self {
            triangles: kept.iter().map(|k| self.triangles[*k]).collect(),
        };
        let turned = shell.agreed();
        if kept.is_empty() || !turned.open_edges().is_empty() {
            return false;
        }
        let taken = (0..is_flap.len()).filter(|k| is_flap[*k]);
        *flaps = taken.map(|k| triangles[k]).collect();
        let pairs = kept
            .iter()
            .zip(shell.triangles.iter().zip(&turned.triangles));
        *triangles = pairs
            .map(|(k, (old, new))| {
                let [a, b, c] = triangles[*k];
                if old == new { [a, b, c] } else { [b, a, c] }
            })
            .collect();
        *self = turned;
        true
    }

    /// Makes corners of open edges one that are as near as the numbers of a file can be wrong.
    fn weld(&mut self, vertices: &[DVec3]) {
        let near = weld_distance(vertices);
        let mut corners: Vec<usize> = self.open_edges().into_iter().flatten().collect();
        corners.sort_unstable();
        corners.dedup();
        if near <= 0.0 {
            return;
        }
        // Cells as large as what is joined: partners lie in neighbouring ones.
        let cell = |p: DVec3| (p / near).floor();
        let key = |p: DVec3| (p + 0.0).to_array().map(f64::to_bits);
        let mut cells: HashMap<[u64; 3], Vec<usize>> = HashMap::new();
        let mut first: Vec<usize> = (0..vertices.len()).collect();
        for k in corners {
            let here = cell(vertices[k]);
            let around = (0..27).map(|n| {
                let offset = DVec3::new(f64::from(n % 3), f64::from(n / 3 % 3), f64::from(n / 9));
                here + offset - DVec3::ONE
            });
            let mut known = around.filter_map(|c| cells.get(&key(c))).flatten();
            match known.find(|j| vertices[**j].distance(vertices[k]) <= near) {
                Some(other) => first[k] = *other,
                None => cells.entry(key(here)).or_default().push(k),
            }
        }
        for corner in self.triangles.iter_mut().flatten() {
            *corner = first[*corner];
        }
    }

    /// The same triangles, turned so that neighbours run along their common edge in opposite directions, where that can be;
    /// of those that hang together the smaller part is turned.
    fn agreed(&self) -> Self {
        let mut triangles = self.triangles.clone();
        let sides = self.sides();
        let mut is_done = vec![false; triangles.len()];
        for seed in 0..triangles.len() {
            if std::mem::replace(&mut is_done[seed], true) {
                continue;
            }
            let (mut together, mut next, mut turned) = (vec![seed], 0, 0);
            while let Some(k) = together.get(next).copied() {
                next += 1;
                let [a, b, c] = triangles[k];
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    let Some([along, against]) = sides.get(&[from.min(to), from.max(to)]) else {
                        continue;
                    };
                    let mut others = along.iter().chain(against).filter(|j| **j != k);
                    let (Some(&other), 2) = (others.next(), along.len() + against.len()) else {
                        continue;
                    };
                    if std::mem::replace(&mut is_done[other], true) {
                        continue;
                    }
                    let [p, q, r] = triangles[other];
                    let runs_along = [[p, q], [q, r], [r, p]].contains(&[from, to]);
                    if runs_along {
                        triangles[other] = [q, p, r];
                        turned += 1;
                    }
                    together.push(other);
                }
            }
            if 2 * turned > together.len() {
                together.iter().for_each(|k| triangles[*k].swap(0, 1));
            }
        }
        Self { triangles }
    }

    /// The triangles of every connected part.
    fn parts(&self) -> Vec<Vec<usize>> {
        let count = self.triangles.iter().flatten().max().map_or(0, |k| k + 1);
        // Union and find over the corners.
        let mut root: Vec<usize> = (0..count).collect();
        fn find(root: &mut [usize], mut k: usize) -> usize {
            while root[k] != k {
                root[k] = root[root[k]];
                k = root[k];
            }
            k
        }
        for [a, b, c] in &self.triangles {
            for other in [b, c] {
                let (p, q) = (find(&mut root, *a), find(&mut root, *other));
                root[p.max(q)] = p.min(q);
            }
        }
        let mut place: HashMap<usize, usize> = HashMap::new();
        let mut parts: Vec<Vec<usize>> = Vec::new();
        for (k, t) in self.triangles.iter().enumerate() {
            let own = find(&mut root, t[0]);
            let place = *place.entry(own).or_insert_with(|| {
                parts.push(Vec::new());
                parts.len() - 1
            });
            parts[place].push(k);
        }
        parts
    }
}

/// How near to each other corners of open edges are one.
fn weld_distance(vertices: &[DVec3]) -> f64 {
    let largest = vertices
        .iter()
        .fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
    let low = vertices.iter().fold(DVec3::INFINITY, |m, p| m.min(*p));
    let high = vertices.iter().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
    (WELD * largest).min(LARGEST_WELD * (high - low).length())
}

/// Turns closed shells whose outside is inside, but for the walls of a cavity.
fn turn_outside_out(triangles: &mut [[DVec3; 3]], shells: &[Vec<usize>]) {
    if six_volumes(triangles) < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    if shells.len() < 2 {
        return;
    }
    let of = |all: &[[DVec3; 3]], shell: &[usize]| -> Vec<[DVec3; 3]> {
        shell.iter().map(|k| all[*k]).collect()
    };
    for (own, shell) in shells.iter().enumerate() {
        let mine = of(triangles, shell);
        if six_volumes(&mine) >= 0.0 {
            continue;
        }
        let others = shells.iter().enumerate().filter(|(k, _)| *k != own);
        let others: Vec<usize> = others.flat_map(|(_, list)| list.iter().copied()).collect();
        // The wall of a cavity lies in another shell.
        if turns_around(&of(triangles, &others), mine[0][0]).abs() < 0.5 {
            shell.iter().for_each(|k| triangles[*k].swap(0, 1));
        }
    }
}

fn six_volumes(triangles: &[[DVec3; 3]]) -> f64 {
    let origin = triangles.first().map_or(DVec3::ZERO, |t| t[0]);
    let volume = |t: &[DVec3; 3]| {
        let [a, b, c] = t.map(|p| p - origin);
        a.dot(b.cross(c))
    };
    triangles.iter().map(volume).sum()
}

/// How often triangles go around a point: their solid angles, in whole spheres.
pub fn turns_around(triangles: &[[DVec3; 3]], point: DVec3) -> f64 {
    let angle = |t: &[DVec3; 3]| {
        let [a, b, c] = t.map(|p| (p - point).normalize_or_zero());
        let volume = a.dot(b.cross(c));
        2.0 * libm::atan2(volume, 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
    };
    triangles.iter().map(angle).sum::<f64>() / (4.0 * PI)
}
