//! Clips triangles that reach behind the eye or far beyond the screen.

/// A corner in camera space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct ClipCorner {
    pub(super) position: [f32; 3],
    pub(super) normal: [f32; 3],
}

/// Most corners of a triangle after clipping by five planes.
const CORNERS: usize = 8;

/// A convex polygon.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Polygon {
    corners: [ClipCorner; CORNERS],
    count: usize,
}

impl Polygon {
    pub(super) fn corners(&self) -> &[ClipCorner] {
        &self.corners[..self.count]
    }

    fn push(&mut self, corner: ClipCorner) {
        if self.count < CORNERS {
            self.corners[self.count] = corner;
            self.count += 1;
        }
    }
}

/// The part of a triangle on the inner side of all planes, `n·p + d ≥ 0`. Empty for corners that are not
/// finite.
pub(super) fn clip_triangle(triangle: [ClipCorner; 3], planes: &[[f32; 4]]) -> Polygon {
    let mut polygon = Polygon::default();
    let finite = triangle.iter().flat_map(|c| c.position).all(f32::is_finite);
    if finite {
        triangle.into_iter().for_each(|c| polygon.push(c));
    }
    for plane in planes {
        polygon = cut_polygon(&polygon, plane);
    }
    polygon
}

fn cut_polygon(polygon: &Polygon, plane: &[f32; 4]) -> Polygon {
    let height = |c: &ClipCorner| {
        let p = c.position;
        plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3]
    };
    let mut kept = Polygon::default();
    let corners = polygon.corners();
    for (k, corner) in corners.iter().enumerate() {
        let next = &corners[(k + 1) % corners.len()];
        let (here, there) = (height(corner), height(next));
        if here >= 0.0 {
            kept.push(*corner);
        }
        if (here >= 0.0) != (there >= 0.0) {
            // Always from the inner corner, so that neighbours that share the edge cut it at the same point.
            let (inner, outer, share) = if here >= 0.0 {
                (corner, next, here / (here - there))
            } else {
                (next, corner, there / (there - here))
            };
            let between =
                |a: [f32; 3], b: [f32; 3]| std::array::from_fn(|i| a[i] + (b[i] - a[i]) * share);
            kept.push(ClipCorner {
                position: between(inner.position, outer.position),
                normal: between(inner.normal, outer.normal),
            });
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(x: f32, y: f32, z: f32) -> ClipCorner {
        ClipCorner {
            position: [x, y, z],
            normal: [0.0, 0.0, 1.0],
        }
    }

    #[test]
    fn a_cut_triangle_keeps_what_is_inside() {
        let triangle = [
            corner(0.0, 0.0, -2.0),
            corner(1.0, 0.0, -2.0),
            corner(0.0, 1.0, 2.0),
        ];
        let near = [0.0, 0.0, -1.0, -1.0];
        let part = clip_triangle(triangle, &[near]);
        assert_eq!(part.corners().len(), 4);
        assert!(part.corners().iter().all(|c| c.position[2] <= -1.0));
        assert_eq!(part.corners()[2].position, [0.75, 0.25, -1.0]);
        assert!(
            clip_triangle(triangle, &[[0.0, 0.0, -1.0, -3.0]])
                .corners()
                .is_empty()
        );
        let broken = [triangle[0], triangle[1], corner(f32::NAN, 0.0, 0.0)];
        assert!(clip_triangle(broken, &[near]).corners().is_empty());
    }
}
