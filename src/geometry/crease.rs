//! Normals of triangles that come without: smooth within the crease angle, sharp beyond it.

use super::mesh::Mesh;
use glam::DVec3;
use std::collections::HashMap;

/// Faces that meet at a smaller angle than this belong to one smooth surface: cosine of 40 degrees. Round
/// parts exported with 12 or more segments a turn stay smooth, chamfers of 45 degrees stay sharp.
const CREASE_COSINE: f64 = 0.766_044_443_118_978;

/// A mesh of bare triangles: corners at one position are welded, normals are the angle-weighted means of
/// the faces around within the crease angle. Triangles without area or with an index out of range go.
pub fn mesh_of_triangles(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Mesh {
    let faces: Vec<Face> = triangles
        .iter()
        .filter_map(|t| Face::of(vertices, *t))
        .collect();
    let mut around: HashMap<[u64; 3], Vec<(u32, u8)>> = HashMap::new();
    for (index, face) in faces.iter().enumerate() {
        for (corner, point) in face.corners.iter().enumerate() {
            around
                .entry(key(*point))
                .or_default()
                .push((index as u32, corner as u8));
        }
    }
    let mut mesh = Mesh::default();
    for face in &faces {
        let corners = face.corners.map(|point| {
            let mean = around.get(&key(point)).into_iter().flatten().fold(
                DVec3::ZERO,
                |sum, (other, corner)| {
                    let other = &faces[*other as usize];
                    if other.normal.dot(face.normal) >= CREASE_COSINE {
                        sum + other.normal * other.angles[*corner as usize]
                    } else {
                        sum
                    }
                },
            );
            let normal = mean.try_normalize().unwrap_or(face.normal);
            mesh.push_vertex(point, normal)
        });
        mesh.triangles.push(corners);
    }
    share_vertices(mesh)
}

/// Makes corners with equal position and normal into one vertex, in order of first use.
pub(super) fn share_vertices(mesh: Mesh) -> Mesh {
    let mut shared = Mesh::default();
    let mut seen = HashMap::new();
    for triangle in mesh.triangles {
        let corners = triangle.map(|i| {
            let (position, normal) = (mesh.positions[i as usize], mesh.normals[i as usize]);
            *seen
                .entry([key(position), key(normal)])
                .or_insert_with(|| shared.push_vertex(position, normal))
        });
        shared.triangles.push(corners);
    }
    shared
}

fn key(point: DVec3) -> [u64; 3] {
    // Adding zero makes -0 into 0.
    (point + 0.0).to_array().map(f64::to_bits)
}

struct Face {
    corners: [DVec3; 3],
    normal: DVec3,
    angles: [f64; 3],
}

impl Face {
    fn of(vertices: &[DVec3], triangle: [u32; 3]) -> Option<Self> {
        let mut corners = [DVec3::ZERO; 3];
        for (corner, index) in corners.iter_mut().zip(triangle) {
            *corner = *vertices.get(index as usize)?;
        }
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).try_normalize()?;
        let angle = |at: DVec3, first: DVec3, second: DVec3| {
            let (u, v) = (first - at, second - at);
            libm::atan2(u.cross(v).length(), u.dot(v))
        };
        Some(Self {
            corners,
            normal,
            angles: [angle(a, b, c), angle(b, c, a), angle(c, a, b)],
        })
    }
}
