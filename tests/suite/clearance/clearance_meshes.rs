//! Distances of meshes against a slow reference with about 31 digits, triangle by triangle.

// Points and surfaces of the other solids are compared elsewhere.
use crate::slow_distance::{known, off_distance, size};
use crate::solids::{Random, element};
#[allow(dead_code)]
use glam::DVec3;
use mechanim::distance::pair::signed_distance;
use mechanim::distance::primitive::{Element, Primitive};
use mechanim::math::Pose;
use mechanim::model::shape::{Solid, TriangleSoup};
use std::sync::Arc;
use std::thread;

/// What is allowed, relative to the extent of a pair.
const ALLOWED: f64 = 1e-12;

/// Kinds of the second one of a pair: the solids of `Random`, then two kinds of meshes.
const KINDS: usize = 8;

const PAIRS: usize = 4_000;

/// Triangles with their mesh.
struct Mesh {
    triangles: Vec<[DVec3; 3]>,
    element: Element,
}

impl Mesh {
    fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let soup = TriangleSoup {
            source: String::new(),
            vertices: triangles.iter().flatten().copied().collect(),
            triangles: (0..triangles.len() as u32)
                .map(|k| [3 * k, 3 * k + 1, 3 * k + 2])
                .collect(),
            is_surface: true,
        };
        Self {
            triangles,
            element: element(Solid::Triangles(Arc::new(soup))),
        }
    }

    fn moved(&self, pose: &Pose) -> Self {
        let corners = |t: &[DVec3; 3]| t.map(|p| pose.transform_point(p));
        Self {
            triangles: self.triangles.iter().map(corners).collect(),
            element: self.element.moved(pose),
        }
    }

    /// Triangles anywhere, some of them thin or tiny.
    fn soup(random: &mut Random) -> Self {
        let count = [1, 2, 9, 30][random.range(0.0, 4.0) as usize];
        let triangles = (0..count).map(|_| {
            let (place, part) = (random.vector(1.5), 10f64.powf(random.range(-4.0, 0.3)));
            let [a, b, c] = [0; 3].map(|_| place + random.vector(part));
            let thin = 10f64.powf(random.range(-6.0, 0.0));
            [
                a,
                b,
                if random.unit() < 0.2 {
                    a + (c - a) * thin
                } else {
                    c
                },
            ]
        });
        Self::new(triangles.collect())
    }

    /// A grid of squares over a bowl: an edge or a corner is nearest, often two or more.
    fn bowl(random: &mut Random) -> Self {
        let cells = 2 + random.range(0.0, 6.0) as i32;
        let (deep, width) = (random.range(-0.5, 0.5), 2.0 / f64::from(cells));
        let flat = if random.unit() < 0.3 { 0.0 } else { deep };
        let at = |i: i32, j: i32| {
            let (x, y) = (f64::from(i) * width - 1.0, f64::from(j) * width - 1.0);
            DVec3::new(x, y, flat * (x * x + y * y))
        };
        let mut triangles = Vec::new();
        for i in 0..cells {
            for j in 0..cells {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        Self::new(triangles)
    }
}

/// A triangle as an element of its own.
fn single(corners: &[DVec3; 3]) -> Element {
    Element {
        core: Primitive::Triangle(*corners),
        radius: 0.0,
        shape: 0,
    }
}

/// Bounds of the least distance of two lists of elements; those whose balls are farther apart are not looked at.
fn slowest(a: &[Element], b: &[Element]) -> [f64; 2] {
    let mut pairs = Vec::new();
    for first in a {
        for second in b {
            let ((p, r), (q, s)) = (first.bounds(), second.bounds());
            pairs.push((p.distance(q) - r - s, first, second));
        }
    }
    pairs.sort_by(|p, q| p.0.total_cmp(&q.0));
    let mut least = [f64::INFINITY; 2];
    for (lowest, first, second) in pairs {
        if lowest > least[1] || least[1] <= 0.0 {
            break;
        }
        let found = known(first, second);
        least[0] = least[0].min(found.low.hi);
        least[1] = least[1].min(found.high.hi);
    }
    least.map(|bound| bound.max(0.0))
}

/// The pair of a number: a mesh, another element and the elements it is made of.
fn pair(k: usize) -> (Mesh, Element, Vec<Element>) {
    let mut random = Random(k as u64);
    let mesh = |random: &mut Random, kind: usize| match kind {
        0 => Mesh::soup(random),
        _ => Mesh::bowl(random),
    };
    let mut first = mesh(&mut random, k / KINDS % 2);
    let turned = random.pose(2.0);
    first = first.moved(&turned);
    let reach = [4.0, 1.2][k / (2 * KINDS) % 2];
    let kind = k % KINDS;
    if kind < 6 {
        let solid = random.solid(kind).moved(&random.pose(reach));
        return (first, solid.clone(), vec![solid]);
    }
    let second = mesh(&mut random, kind - 6);
    let near = match k / (4 * KINDS) % 3 {
        // Parallel, and off that by next to nothing.
        0 => turned * Pose::from_translation(random.vector(1.0) + DVec3::Z * 0.5),
        _ => random.pose(reach),
    };
    let second = second.moved(&near);
    let parts = second.triangles.iter().map(single).collect();
    (first, second.element, parts)
}

/// Whether a pair is apart, and whether the reference leaves its distance open.
fn compare(k: usize) -> [bool; 2] {
    let (mesh, other, parts) = pair(k);
    let found = signed_distance(&mesh.element, &other);
    let own: Vec<Element> = mesh.triangles.iter().map(single).collect();
    let [low, high] = slowest(&own, &parts);
    let errors = [
        (found.distance - high).max(low - found.distance),
        if low > 0.0 {
            off_distance(found.points, found.distance)
        } else {
            0.0
        },
    ];
    let size = size(&mesh.element, &other);
    assert!(
        errors.iter().all(|e| *e <= ALLOWED * size),
        "{k}: {errors:?} {found:?} {low} {high}\n{other:?}"
    );
    [low > 0.0, high - low > ALLOWED * size]
}

/// Meshes against every kind of solid and against each other.
#[test]
fn meshes_agree_with_the_slow_reference() {
    let threads = thread::available_parallelism().map_or(2, usize::from);
    let compared = |part: usize| (part..PAIRS).step_by(threads).map(compare).collect();
    let found: Vec<[bool; 2]> = thread::scope(|scope| {
        let part = |part: usize| scope.spawn(move || -> Vec<[bool; 2]> { compared(part) });
        let parts: Vec<_> = (0..threads).map(part).collect();
        let lists = parts.into_iter().map(|part| part.join().unwrap());
        lists.flatten().collect()
    });
    let count = |k: usize| found.iter().filter(|f| f[k]).count();
    assert!(count(0) > PAIRS / 3 && count(0) < PAIRS, "{}", count(0));
    assert!(count(1) < PAIRS / 40, "{}", count(1));
}

/// Also two meshes of equally many triangles at one pose, which only their corners tell apart.
#[test]
fn the_order_of_two_meshes_does_not_change_a_bit() {
    let mut random = Random(11);
    let mut alike = 0;
    for k in 0..400 {
        let (a, b) = match k % 2 {
            0 => (Mesh::soup(&mut random), Mesh::soup(&mut random)),
            _ => (Mesh::bowl(&mut random), Mesh::soup(&mut random)),
        };
        alike += usize::from(a.triangles.len() == b.triangles.len());
        let found = signed_distance(&a.element, &b.element);
        let back = signed_distance(&b.element, &a.element);
        let [q, p] = back.points;
        assert_eq!(found.distance.to_bits(), back.distance.to_bits(), "{k}");
        assert_eq!(found.points, [p, q], "{k}");
    }
    assert!(alike > 30, "{alike}");
}
