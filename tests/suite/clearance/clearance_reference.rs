//! Signed distances of random pairs against a slow reference with about 31 digits, every kind against every other.

use crate::slow_distance::{inside_by, known, off_distance, size};
use crate::solids::{Random, capsule, cone, cuboid, cylinder, half_space, sphere, torus, v};
use glam::DVec3;
use mechanim::distance::pair::{Proximity, signed_distance, signed_distance_below};
use mechanim::distance::primitive::{Element, Primitive};
use mechanim::math::Pose;
use std::thread;

const KINDS: [&str; 7] = [
    "sphere",
    "capsule",
    "cylinder",
    "cone",
    "box",
    "torus",
    "half-space",
];

/// How a pair was made.
const MAKES: [&str; 6] = ["far", "near", "touching", "aligned", "thin", "unlike"];

/// Every kind with every kind, but two half-spaces, whose planes meet somewhere.
fn kinds() -> Vec<[usize; 2]> {
    let pairs = (0..6).flat_map(|i| (i..7).map(move |j| [i, j]));
    pairs.collect()
}

/// A solid around the origin along the z axis.
fn upright(random: &mut Random, kind: usize, size: f64, thick: f64) -> Element {
    let half = v(0.0, 0.0, size * random.range(0.3, 2.0));
    let r = thick * random.range(0.3, 1.0);
    match kind {
        0 => sphere(DVec3::ZERO, r),
        1 => capsule(-half, half, r),
        2 => cylinder(-half, half, r),
        3 => cone(-half, half, r, r * random.range(0.0, 1.0)),
        4 => cuboid(DVec3::ZERO, v(2.0 * r, random.range(0.5, 2.0) * r, half.z)),
        5 => torus(DVec3::ZERO, DVec3::Z, half.z + r, 0.5 * r),
        _ => half_space(DVec3::ZERO, DVec3::Z),
    }
}

/// Nearly coaxial, parallel, concentric or coplanar, off by 1 to 1e-12.
fn aligned(random: &mut Random, [i, j]: [usize; 2]) -> (Element, Element) {
    let off = 10f64.powi(-(random.range(0.0, 13.0) as i32));
    let (a, b) = (upright(random, i, 1.0, 1.0), upright(random, j, 1.0, 1.0));
    let shift = match random.range(0.0, 4.0) as usize {
        0 => DVec3::ZERO,
        1 => DVec3::Z * random.range(-4.0, 4.0),
        2 => DVec3::X * random.range(-4.0, 4.0),
        _ => random.vector(3.0),
    };
    let turn = random.vector(off);
    let mut there = Pose {
        translation: shift + random.vector(off),
        ..Pose::IDENTITY
    };
    there.rotation = glam::DMat3::from_quat(glam::DQuat::from_scaled_axis(turn));
    let world = random.pose(2.0);
    (a.moved(&world), b.moved(&(world * there)))
}

/// The pair of a number, its kinds and how it was made.
fn pair(k: usize) -> ([usize; 2], usize, Element, Element) {
    let all = kinds();
    let [i, j] = all[k % all.len()];
    let make = (k / all.len()) % MAKES.len();
    let mut random = Random(k as u64);
    let mut free = |reach: f64| {
        let a = random.solid(i);
        let b = random.solid(j).moved(&random.pose(reach));
        (a, b)
    };
    let (a, b) = match make {
        0 => free(4.0),
        1 => free(1.2),
        2 => {
            let (a, b) = free(4.0);
            let found = signed_distance(&a, &b);
            // Down to 1e-9 apart or deep in each other.
            let left = 10f64.powi(-(random.range(1.0, 10.0) as i32));
            let left = if random.unit() < 0.5 { left } else { -left };
            let way = found.normal * (left - found.distance);
            let b = b.moved(&Pose::from_translation(way));
            (a, b)
        }
        3 => aligned(&mut random, [i, j]),
        _ => {
            let (size, thick) = if make == 4 {
                (1.0, 1e-3)
            } else {
                (100.0, 100.0)
            };
            let a = upright(&mut random, i, size, thick).moved(&random.pose(2.0));
            let b = upright(&mut random, j, 1.0, thick.min(1.0)).moved(&random.pose(2.0));
            (a, b)
        }
    };
    ([i, j], make, a, b)
}

/// What is allowed, relative to the extent of a pair.
const ALLOWED: f64 = 1e-12;

const PAIRS: usize = 100_000;

/// What was looked at.
#[derive(Default, Clone, Debug)]
struct StartResults {
    count: usize,
    /// Pairs that overlap.
    deep: usize,
    /// Pairs whose depth was not searched for, since it is not below a limit.
    spared: usize,
    /// Pairs that the reference does not decide to within what is allowed.
    open: usize,
}

fn off_surfaces(elements: [&Element; 2], found: &Proximity) -> f64 {
    let is_ring = |e: &Element| matches!(e.core, Primitive::Circle(_));
    let off = |k: usize| {
        let inside = inside_by(elements[k], found.points[k]);
        // The deepest point of a ring below an edge of a solid has two ways out, neither of them square to the ring.
        if found.distance < 0.0 && is_ring(elements[k]) {
            (-inside).max(0.0)
        } else {
            inside.abs()
        }
    };
    off(0).max(off(1))
}

/// The pairs of some numbers against the reference.
fn compare(numbers: impl Iterator<Item = usize>) -> StartResults {
    let mut tally = StartResults::default();
    for k in numbers {
        let ([i, j], make, a, b) = pair(k);
        let (found, back) = (signed_distance(&a, &b), signed_distance(&b, &a));
        let truth = known(&a, &b);
        let size = size(&a, &b);
        let errors = [
            truth.misses(found.distance),
            off_distance(found.points, found.distance),
            off_surfaces([&a, &b], &found),
        ];
        let errors = errors.map(|e| e / size);
        let name = format!("{k}: {} and {}, {}", KINDS[i], KINDS[j], MAKES[make]);
        assert!(
            errors.iter().all(|e| *e <= ALLOWED),
            "{name}: {errors:?}\n{found:?} {truth:?}\n{a:?}\n{b:?}"
        );
        let bits = |p: &Proximity| (p.distance.to_bits(), p.points);
        let (distance, [p, q]) = bits(&back);
        assert_eq!(
            bits(&found),
            (distance, [q, p]),
            "{name}, the other way round"
        );
        // What is not below a limit need not be exact, but must not be said to be below it.
        let limit = found.distance + 0.1 * size * ((k % 9) as f64 - 4.0);
        let limited = signed_distance_below(&a, &b, limit);
        match found.distance < limit {
            true => assert_eq!(bits(&limited), bits(&found), "{name}, below {limit:e}"),
            false => assert!(
                (limit..=found.distance).contains(&limited.distance),
                "{name}"
            ),
        }
        tally.spared += usize::from(limited != found);
        tally.count += 1;
        tally.deep += usize::from(found.distance < 0.0);
        tally.open += usize::from(truth.width() > ALLOWED * size);
    }
    tally
}

/// Distance or depth and both points of all pairs of kinds, to 1e-12 of the pairs' extent; the same bits both ways round.
///
/// The reference leaves a depth open where whole curves of directions are as good as each other (coaxial cylinders): there
/// the bracket is as wide as it says, and a depth must lie in it.
#[test]
fn a_hundred_thousand_pairs_agree_with_the_slow_reference() {
    let threads = thread::available_parallelism().map_or(2, usize::from);
    let tallies: Vec<StartResults> = thread::scope(|scope| {
        let parts: Vec<_> = (0..threads)
            .map(|part| scope.spawn(move || compare((part..PAIRS).step_by(threads))))
            .collect();
        parts.into_iter().map(|part| part.join().unwrap()).collect()
    });
    let sum = |of: fn(&StartResults) -> usize| tallies.iter().map(of).sum::<usize>();
    assert_eq!(sum(|t| t.count), PAIRS);
    assert!(sum(|t| t.deep) > PAIRS / 4, "{tallies:?}");
    assert!(sum(|t| t.open) < PAIRS / 40, "{tallies:?}");
    assert!(sum(|t| t.spared) > PAIRS / 100, "{tallies:?}");
}
