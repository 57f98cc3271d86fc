//! Computes normals of triangles without any: smooth below the crease angle, sharp above it.

use super::mesh::Mesh;
use crate::weld::{first_equal, number_first, point_bits};
use glam::DVec3;

/// Faces that meet at a smaller angle than this belong to one smooth surface: cosine of 40 degrees. Round parts
/// exported with 12 or more segments per turn stay smooth, chamfers of 45 degrees stay sharp.
const CREASE_COSINE: f64 = 0.766_044_443_118_978;

/// Number of corners at one position that are compared one by one. If more meet, those with similar normals are merged:
/// comparing all would take hours at the tip of a fine cone.
const MOST_COMPARED: usize = 256;

/// Cells along the edge of the octahedron by which normals are then sorted: about 6 degrees each.
const CELLS: usize = 16;

/// A mesh of bare triangles: corners at one position are welded, normals are the angle-weighted means of the
/// surrounding faces within the crease angle. Triangles without area or with an index out of range are removed.
pub fn mesh_of_triangles(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Mesh {
    let faces = CreaseFaces::new(vertices, triangles);
    let around = faces.around();
    let mut mesh = Mesh::default();
    mesh.positions.reserve_exact(3 * faces.list.len());
    // Every face has three vertices of its own, so that creases can have two normals.
    for face in &faces.list {
        mesh.positions.extend(faces.corners(*face));
    }
    mesh.normals = vec![DVec3::ZERO; mesh.positions.len()];
    // Corners at one position are smoothed together; many are binned by direction first, since all pairs would be
    // quadratic.
    for corners in around.corners() {
        match corners.len() {
            ..=MOST_COMPARED => faces.smooth_normals(corners, &mut mesh.normals),
            _ => faces.smooth_many(corners, &mut mesh.normals),
        }
    }
    drop(around);
    drop(faces);
    let count = mesh.positions.len() as u32;
    // Equal vertices are shared again.
    mesh.triangles = (0..count / 3)
        .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
        .collect();
    share_vertices(mesh)
}

/// Merges corners with equal position and normal into one vertex, in order of first use.
pub(super) fn share_vertices(mut mesh: Mesh) -> Mesh {
    // By corners, since the order of the vertices may differ from that of their use.
    let corner = |k: usize| mesh.triangles[k / 3][k % 3] as usize;
    let key = |k: usize| {
        [
            point_bits(mesh.positions[corner(k)]),
            point_bits(mesh.normals[corner(k)]),
        ]
    };
    let mut ids = first_equal(3 * mesh.triangles.len(), key);
    let is_in_order = mesh.positions.len() == ids.len() && (0..ids.len()).all(|k| corner(k) == k);
    let firsts = ids
        .iter()
        .enumerate()
        .filter(|(k, first)| *k == **first as usize);
    if is_in_order {
        // In place, because a mesh of bare triangles can fill most of the memory.
        let kept: Vec<bool> = (0..ids.len()).map(|k| ids[k] as usize == k).collect();
        retain_kept(&mut mesh.positions, &kept);
        retain_kept(&mut mesh.normals, &kept);
    } else {
        let (positions, normals) = firsts
            .map(|(k, _)| (mesh.positions[corner(k)], mesh.normals[corner(k)]))
            .unzip();
        (mesh.positions, mesh.normals) = (positions, normals);
    }
    number_first(&mut ids);
    for (triangle, ids) in mesh.triangles.iter_mut().zip(ids.chunks_exact(3)) {
        triangle.copy_from_slice(ids);
    }
    mesh
}

fn retain_kept(list: &mut Vec<DVec3>, kept: &[bool]) {
    let mut kept = kept.iter();
    list.retain(|_| kept.next().copied().unwrap_or(false));
    list.shrink_to_fit();
}

/// Triangles with an area.
struct CreaseFaces<'t> {
    vertices: &'t [DVec3],
    triangles: &'t [[u32; 3]],
    /// Indices of those that have one.
    list: Vec<u32>,
    normals: Vec<DVec3>,
}

impl<'t> CreaseFaces<'t> {
    fn new(vertices: &'t [DVec3], triangles: &'t [[u32; 3]]) -> Self {
        let mut faces = Self {
            vertices,
            triangles,
            list: Vec::new(),
            normals: Vec::new(),
        };
        for (index, triangle) in triangles.iter().enumerate() {
            if triangle
                .iter()
                .any(|corner| *corner as usize >= vertices.len())
            {
                continue;
            }
            // Faces without area have no normal and are left out.
            let [a, b, c] = faces.corners(index as u32);
            if let Some(normal) = (b - a).cross(c - a).try_normalize() {
                faces.list.push(index as u32);
                faces.normals.push(normal);
            }
        }
        faces
    }

    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|corner| self.vertices[corner as usize])
    }

    /// The angle of a face at one of its corners; a corner is three times its face plus 0 to 2.
    fn angle(&self, corner: u32) -> f64 {
        let points = self.corners(self.list[corner as usize / 3]);
        let [at, first, second] = [0, 1, 2].map(|k| points[(corner as usize + k) % 3]);
        let (u, v) = (first - at, second - at);
        libm::atan2(u.cross(v).length(), u.dot(v))
    }

    fn normal(&self, corner: u32) -> DVec3 {
        self.normals[corner as usize / 3]
    }

    /// Groups corners by position.
    fn around(&self) -> AroundVertex {
        let mut ids = first_equal(self.vertices.len(), |k| point_bits(self.vertices[k]));
        let mut starts = vec![0; number_first(&mut ids) + 1];
        let corners = || {
            let faces = self.list.iter().flat_map(|f| self.triangles[*f as usize]);
            faces.map(|vertex| ids[vertex as usize] as usize)
        };
        corners().for_each(|id| starts[id + 1] += 1);
        for id in 1..starts.len() {
            starts[id] += starts[id - 1];
        }
        let mut list = vec![0; 3 * self.list.len()];
        for (corner, id) in corners().enumerate() {
            list[starts[id] as usize] = corner as u32;
            starts[id] += 1;
        }
        // Every start is now that of the next position: one list less in memory.
        starts.pop();
        AroundVertex { ends: starts, list }
    }

    /// The normals of all corners at one position.
    fn smooth_normals(&self, corners: &[u32], normals: &mut [DVec3]) {
        let angles: Vec<f64> = corners.iter().map(|corner| self.angle(*corner)).collect();
        for corner in corners {
            let own = self.normal(*corner);
            let others = corners.iter().zip(&angles);
            // The mean of the normals within the crease angle, weighted by the angle of the face at the corner.
            let mean = others.fold(DVec3::ZERO, |sum, (other, angle)| {
                let normal = self.normal(*other);
                if normal.dot(own) >= CREASE_COSINE {
                    sum + normal * *angle
                } else {
                    sum
                }
            });
            normals[*corner as usize] = mean.try_normalize().unwrap_or(own);
        }
    }

    /// The same if very many meet: normals in one cell of directions are merged.
    fn smooth_many(&self, corners: &[u32], normals: &mut [DVec3]) {
        let mut sums = vec![DVec3::ZERO; 2 * CELLS * CELLS];
        for corner in corners {
            let normal = self.normal(*corner);
            sums[direction_cell(normal)] += normal * self.angle(*corner);
        }
        let filled = sums
            .iter()
            .filter_map(|sum| Some((*sum, sum.try_normalize()?)));
        let filled: Vec<(DVec3, DVec3)> = filled.collect();
        // The same mean over the direction cells instead of the faces.
        for corner in corners {
            let own = self.normal(*corner);
            let near = filled
                .iter()
                .filter(|(_, middle)| middle.dot(own) >= CREASE_COSINE);
            let mean = near.fold(DVec3::ZERO, |sum, (part, _)| sum + *part);
            normals[*corner as usize] = mean.try_normalize().unwrap_or(own);
        }
    }
}

/// The cell of a direction on the octahedron, whose two halves are unfolded next to each other.
fn direction_cell(direction: DVec3) -> usize {
    let flat = direction / direction.abs().element_sum();
    let index = |v: f64| (((v + 1.0) * 0.5 * CELLS as f64) as usize).min(CELLS - 1);
    let half = usize::from(flat.z < 0.0);
    (half * CELLS + index(flat.x)) * CELLS + index(flat.y)
}

/// Corners by position, those of one position side by side in the order of the faces.
struct AroundVertex {
    /// Where those of each position end.
    ends: Vec<u32>,
    list: Vec<u32>,
}

impl AroundVertex {
    fn corners(&self) -> impl Iterator<Item = &[u32]> {
        let ends = self.ends.iter().map(|end| *end as usize);
        ends.scan(0, |start, end| {
            let corners = &self.list[*start..end];
            *start = end;
            Some(corners)
        })
    }
}
