//! The thickest capsule along the axis of a convex solid, wholly inside it. What solids contain is no nearer to anything
//! than they are: the signed distance of two inner capsules, which costs little, is an upper bound of theirs.

use super::primitive::{BoxCore, Element, Frustum, Primitive};
use glam::DVec3;

/// A point, a capsule or a half-space inside an element; `None` for what has no axis to take: circles, triangles, meshes.
pub fn inner_capsule(element: &Element) -> Option<Element> {
    let (core, thickness) = match &element.core {
        core @ (Primitive::Point(_) | Primitive::Segment(_) | Primitive::HalfSpace(_)) => {
            (core.clone(), 0.0)
        }
        Primitive::Box(block) => spine_of_box(block),
        Primitive::Frustum(frustum) => spine_of_frustum(frustum),
        Primitive::Circle(_) | Primitive::Triangle(_) | Primitive::Mesh(..) => return None,
    };
    Some(Element {
        core,
        radius: element.radius + thickness,
        ..*element
    })
}

/// Along the longest edges.
fn spine_of_box(block: &BoxCore) -> (Primitive, f64) {
    let longest = block.half.max_element();
    let radius = block.half.min_element();
    let along = block.half.to_array().map(|half| half == longest);
    let along = match along {
        [true, ..] => DVec3::X,
        [_, true, _] => DVec3::Y,
        _ => DVec3::Z,
    };
    let way = along * (longest - radius);
    let ends = [-way, way].map(|p| block.from_box.transform_point(p));
    (Primitive::Segment(ends), radius)
}

/// Along the axis of the largest cylinder inside.
fn spine_of_frustum(frustum: &Frustum) -> (Primitive, f64) {
    let radius = frustum.radii[0].min(frustum.radii[1]);
    let radius = radius.min(0.5 * frustum.length);
    let ends = [radius, frustum.length - radius].map(|way| frustum.from + frustum.axis * way);
    (Primitive::Segment(ends), radius)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::distance::pair::{signed_distance, signed_distance_below};
    use crate::math::Pose;

    /// Numbers from 0 to 1, always the same.
    fn numbers(seed: u64) -> impl FnMut() -> f64 {
        let mut state = seed;
        move || {
            state = state
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1_u64 << 53) as f64
        }
    }

    fn solid(next: &mut impl FnMut() -> f64, kind: usize) -> Element {
        let mut point = || DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5);
        let (at, axis, sizes) = (point(), point().normalize(), point() + 0.6);
        let core = match kind {
            0 => Primitive::Point(at),
            1 => Primitive::Segment([at, at + axis]),
            2 => Primitive::Box(BoxCore {
                from_box: Pose::from_translation(at) * Pose::from_z_axis(axis),
                half: sizes,
            }),
            _ => Primitive::Frustum(Frustum {
                from: at,
                axis,
                length: 2.0 * sizes.x,
                radii: [sizes.y, if kind == 3 { sizes.y } else { sizes.z }],
            }),
        };
        Element {
            core,
            radius: 0.2 * sizes.z,
            shape: 0,
        }
    }

    #[test]
    fn inner_capsules_are_never_nearer() {
        let mut next = numbers(7);
        let (mut overlaps, mut least_share) = (0, f64::INFINITY);
        for k in 0..2500 {
            let [a, b] = [k % 5, k / 5 % 5].map(|kind| solid(&mut next, kind));
            let outer = signed_distance(&a, &b).distance;
            let [inner, other] = [&a, &b].map(|e| inner_capsule(e).into_iter());
            let bounds = inner
                .zip(other)
                .map(|(p, q)| signed_distance(&p, &q).distance);
            let bound = bounds.fold(f64::NAN, f64::max);
            assert!(outer <= bound + 1e-12, "{a:?} {b:?}: {outer} {bound}");
            if outer < 0.0 {
                overlaps += 1;
                least_share = least_share.min(bound / outer);
            }
        }
        // A bound that is never of use would pass as well.
        assert!(
            overlaps > 500 && least_share < 1.0,
            "{overlaps} {least_share}"
        );
    }

    #[test]
    fn distances_below_a_limit_are_the_distances() {
        let mut next = numbers(8);
        let mut spared = 0;
        for k in 0..2500 {
            let [a, b] = [k % 5, k / 5 % 5].map(|kind| solid(&mut next, kind));
            let exact = signed_distance(&a, &b);
            let limit = exact.distance + 0.4 * (next() - 0.5);
            let found = signed_distance_below(&a, &b, limit);
            if exact.distance < limit {
                assert_eq!(found, exact);
            } else {
                assert!((limit..=exact.distance).contains(&found.distance));
                spared += usize::from(found != exact);
            }
        }
        assert!(spared > 20, "{spared}");
    }
}
