//! Bounds of the distance of two elements during a short motion of one of them.

use super::curved;
use super::meeting::Meeting;
use super::mesh_meeting;
use super::slab::Slab;
use crate::distance::bodies::separation_along;
use crate::distance::pair::Proximity;
use crate::distance::point::point_to;
use crate::distance::primitive::Primitive;
use glam::DVec3;

/// Cosine of the largest angle between a normal and a steady one that is tried for it: a line that leans more has left the edge.
const STEADY: f64 = 0.9;

impl Meeting<'_> {
    /// Lower bound of the distance. Work stops when it reaches the second goal, or cannot reach the first.
    pub fn below(&self, goals: [f64; 2]) -> f64 {
        let lowest = self.below_planes(goals);
        let is_ring = |core: &Primitive| matches!(core, Primitive::Circle(_));
        // No plane separates a body inside a ring from the ring.
        if lowest < goals[0] && (is_ring(&self.a.core) || is_ring(&self.b.core)) {
            let low = curved::lower_bound(self, [goals[0]; 2]);
            return low.map_or(lowest, |low| lowest.max(low));
        }
        lowest
    }

    /// The same from planes between the elements.
    fn below_planes(&self, goals: [f64; 2]) -> f64 {
        let plain = self.found.lowest() - self.moved.distance(self.mine.bounds());
        let is = |kind: fn(&Primitive) -> bool| kind(&self.a.core) || kind(&self.b.core);
        // A half-space is as far from a mesh as from its hull.
        if is(|core| matches!(core, Primitive::Mesh(..)))
            && !is(|core| matches!(core, Primitive::HalfSpace(_)))
        {
            return plain.max(mesh_meeting::lower_bound(self, goals).min(self.found.distance));
        }
        let supports =
            |[n, back]: [DVec3; 2]| Some(self.a.core.support(n)? + self.b.core.support(back)?);
        let mut lowest = plain;
        for slab in self.slabs().iter().flatten() {
            if lowest < goals[0] {
                let gap = slab.gap(goals[0], supports);
                lowest = gap.map_or(lowest, |gap| lowest.max(gap));
            }
        }
        match lowest < goals[0] {
            true => lowest.max(self.below_steady_plane(goals[0], supports)),
            false => lowest,
        }
    }

    /// The same from a plane that the motion does not tilt against: where a solid slides over a face and beyond its edge, the
    /// line between the nearest points begins to lean, and no plane square to it keeps the gap.
    fn below_steady_plane(&self, goal: f64, supports: impl Fn([DVec3; 2]) -> Option<f64>) -> f64 {
        let Some(normal) = self.steady_normal() else {
            return f64::NEG_INFINITY;
        };
        let distance = separation_along(self.a, self.b, normal);
        if distance < goal {
            return f64::NEG_INFINITY;
        }
        let found = Proximity {
            distance,
            normal,
            missed: 0.0,
            ..self.found
        };
        let beside = Self { found, ..*self };
        let off = self.moved.deviation(self.mine.bounds());
        let gap = beside.slab(DVec3::ZERO, off).gap(goal, supports);
        gap.unwrap_or(f64::NEG_INFINITY)
    }

    /// The direction nearest to the normal in which points hardly move: the axis of the rotation, or across the translation.
    fn steady_normal(&self) -> Option<DVec3> {
        let (moved, n) = (self.moved, self.found.normal);
        let across = || {
            let way = moved.rate(self.found.points[1]).try_normalize()?;
            (n - way * way.dot(n)).try_normalize()
        };
        let axis = moved
            .spin
            .try_normalize()
            .map(|axis| axis * axis.dot(n).signum());
        axis.or_else(across)
            .filter(|steady| steady.dot(n) >= STEADY)
    }

    /// The plane between the elements is fixed, rotates with the line between the nearest points, or with the element that
    /// moves.
    pub(super) fn slabs(&self) -> [Option<Slab>; 3] {
        let (moved, n) = (self.moved, self.found.normal);
        if n == DVec3::ZERO {
            return [None, None, None];
        }
        let ball = self.mine.bounds();
        let (off, bending) = (moved.deviation(ball), moved.bending(ball));
        let turned = |turn: DVec3| {
            let length = (1.0 + turn.length_squared()).sqrt();
            self.slab(turn, turn.length() * bending + length * off)
        };
        let (line, carried) = (self.line_turn(), moved.spin.cross(n));
        // The same rotation need not be tried twice.
        let is_other = carried != DVec3::ZERO && line.is_none_or(|line| line != carried);
        [
            Some(self.slab(DVec3::ZERO, off)),
            line.map(turned),
            is_other.then(|| turned(carried)),
        ]
    }

    fn slab(&self, t: DVec3, lost: f64) -> Slab {
        let moved = self.moved;
        let (n, most) = (self.found.normal, self.found.distance);
        let first = n.cross(moved.spin) + t;
        let second = moved.twist.transpose() * n + t.cross(moved.spin);
        let (across, bend) = (
            n.dot(moved.shift),
            n.dot(moved.bend) + t.dot(moved.shift) - 0.5 * most.max(0.0) * t.length_squared(),
        );
        Slab {
            normal: n,
            turn: t,
            first,
            second,
            across,
            bend,
            radii: self.radii(),
            most,
            lost,
        }
    }

    /// The same for bodies in contact, where it pays to look more closely: how surfaces slide along each other counts too.
    pub fn below_in_contact(&self, enough: f64) -> f64 {
        let flat = self.below_planes([enough; 2]);
        let goals = [f64::NEG_INFINITY, enough];
        curved::lower_bound(self, goals).map_or(flat, |low| flat.max(low))
    }

    /// Upper bound of the distance: that of the points that were nearest.
    pub fn above(&self) -> f64 {
        let [from, to] = self.core_points();
        let rate = self.moved.rate(to);
        let linear = (to - from + rate).length().max((to - from - rate).length());
        // The distance from a convex core is convex along the path of a point.
        let linear = match &self.a.core {
            Primitive::Circle(_) => linear,
            core => [to - rate, to + rate]
                .map(|q| point_to(core, q).map_or(f64::INFINITY, |hit| hit.distance))
                .into_iter()
                .fold(f64::NEG_INFINITY, f64::max)
                .min(linear),
        };
        let high = linear + self.beyond_linear() - self.radii();
        let high = curved::upper_bound(self).map_or(high, |curved| high.min(curved));
        // Contact with a mesh counts as zero, not as a depth.
        let is = |kind: fn(&Primitive) -> bool| kind(&self.a.core) || kind(&self.b.core);
        let has_no_depth = is(|core| matches!(core, Primitive::Mesh(..)));
        if has_no_depth && !is(|core| matches!(core, Primitive::HalfSpace(_))) {
            return high.max(0.0);
        }
        high
    }
}

#[cfg(test)]
mod tests {
    use super::super::near_part;
    use super::super::relative::RelativeChain;
    use super::*;
    use crate::distance::mesh_tree::MeshTree;
    use crate::distance::pair::signed_distance;
    use crate::distance::primitive::{BoxCore, Circle, Element, Frustum, HalfSpace};
    use crate::kinematics::certificate::tube::TaylorModel;
    use crate::math::Pose;
    use crate::model::chain::{ArgumentValue, Chain, ChainStep, ElementaryMotion};
    use crate::model::shape::TriangleSoup;
    use glam::{DMat3, DQuat};
    use std::sync::Arc;

    /// Numbers in -1..1 that are the same in every run.
    struct Draws(u32);

    impl Draws {
        fn next(&mut self) -> f64 {
            self.0 = self.0.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(self.0 >> 8) / f64::from(1_u32 << 23) - 1.0
        }

        fn vector(&mut self, size: f64) -> DVec3 {
            DVec3::from_array(std::array::from_fn(|_| size * self.next()))
        }

        fn pose(&mut self, size: f64) -> Pose {
            Pose {
                rotation: DMat3::from_quat(DQuat::from_scaled_axis(self.vector(3.0))),
                translation: self.vector(size),
            }
        }

        /// Triangles anywhere, large and small.
        fn soup(&mut self, size: f64) -> TriangleSoup {
            let count = 4 + 40 * u32::from(self.next() > 0.0);
            let mut vertices = Vec::new();
            for _ in 0..count {
                let (place, part) = (self.vector(size), 0.7 * size * self.next());
                vertices.extend([0; 3].map(|_| place + self.vector(part)));
            }
            TriangleSoup {
                source: String::new(),
                vertices,
                triangles: (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
                is_surface: true,
            }
        }

        /// Three joints that move.
        fn motion(&mut self) -> (RelativeChain, [TaylorModel; 3]) {
            let fixed = [0; 4].map(|_| ChainStep::Fixed(self.pose(1.0).into()));
            let chain = Chain {
                steps: vec![
                    fixed[0],
                    joint(ElementaryMotion::Rotation, 2, 0),
                    fixed[1],
                    joint(ElementaryMotion::Translation, 0, 1),
                    fixed[2],
                    joint(ElementaryMotion::Rotation, 1, 2),
                    fixed[3],
                ],
            };
            let models = [0; 3].map(|_| {
                let mut model = TaylorModel::constant(self.next());
                (model.c[1], model.c[2]) = (self.next(), 0.3 * self.next());
                model
            });
            (RelativeChain::new(&Chain::default(), &chain), models)
        }

        fn element(&mut self, kind: usize) -> Element {
            let size = 1.0 + 0.5 * self.next();
            let (axis, centre, from) = (DVec3::Z, DVec3::ZERO, DVec3::ZERO);
            let core = match kind {
                0 => Primitive::Point(from),
                1 => Primitive::Segment([from, axis * size]),
                2 | 3 => Primitive::Circle(Circle {
                    centre,
                    axis,
                    radius: if kind == 2 { size } else { 8.0 * size },
                }),
                4 => Primitive::Box(BoxCore {
                    from_box: Pose::IDENTITY,
                    half: DVec3::new(size, 0.5, 0.2),
                }),
                5 => Primitive::Frustum(Frustum {
                    from,
                    axis,
                    length: 2.0,
                    radii: [size, 0.7],
                }),
                6 => Primitive::HalfSpace(HalfSpace {
                    point: centre,
                    normal: axis,
                }),
                _ => Primitive::Mesh(Arc::new(MeshTree::new(&self.soup(size))), Pose::IDENTITY),
            };
            let radius = if kind < 4 { 0.3 } else { 0.0 };
            let shape = 0;
            let core = core.moved(&self.pose(1.5));
            Element {
                core,
                radius,
                shape,
            }
        }
    }

    /// The pose of a motion at a place.
    fn pose_at(chain: &RelativeChain, models: &[TaylorModel; 3], s: f64) -> Pose {
        chain.pose(&models.map(|m| ArgumentValue::new(m.c[0] + s * (m.c[1] + s * m.c[2]))))
    }

    fn joint(motion: ElementaryMotion, axis: usize, argument: usize) -> ChainStep {
        ChainStep::Joint {
            motion,
            axis,
            argument,
            sign: 1.0,
        }
    }

    /// Every kind against every kind that moves, by three joints, far, near, in contact and deep.
    #[test]
    fn no_distance_during_a_move_is_beyond_its_bounds() {
        let mut draws = Draws(7);
        let (mut near, mut gained) = ([0, 0], [0, 0]);
        for round in 0..4000 {
            let kinds = [0, 1, 2, 3, 4, 5, 6, 7, 7];
            let (kind, moving) = (kinds[round % 9], [0, 1, 2, 3, 4, 5, 7][round / 9 % 7]);
            let (a, mine) = (draws.element(kind), draws.element(moving));
            let (chain, models) = draws.motion();
            let (s, half) = (0.5 * draws.next(), [0.4, 0.1, 0.01][round % 3]);
            let moved = chain.around(&models, s, half);
            let b = mine.moved(&moved.pose);
            let a = if round % 5 == 0 {
                // Right through each other.
                a.moved(&Pose::from_translation(b.bounds().0 - a.bounds().0))
            } else {
                a
            };
            let meeting = Meeting::new(&a, &b, &mine, &moved);
            let found = meeting.found;
            let (low, high) = (meeting.below_in_contact(f64::INFINITY), meeting.above());
            let parts = near_part::in_parts([&a, &b, &mine], &moved, found.distance - 0.1);
            gained[1] += usize::from(parts.is_some_and(|low| low >= found.distance - 0.1));
            // The requested bound is refined, and stays valid.
            let asked = [1e-3, 1e-2, 0.1, 0.5].map(|off| found.distance - off);
            let reached = asked.map(|goal| meeting.below([goal; 2]));
            gained[0] += asked
                .iter()
                .zip(reached)
                .filter(|(goal, low)| low >= goal)
                .count();
            let plain = found.lowest() - moved.distance(mine.bounds());
            assert!(low >= plain && low <= found.distance);
            let of_curve = curved::lower_bound(&meeting, [f64::NEG_INFINITY, f64::INFINITY]);
            let mut least = f64::INFINITY;
            for step in -8..=8 {
                let there = s + half * f64::from(step) / 8.0;
                let there = pose_at(&chain, &models, there);
                let d = signed_distance(&a, &mine.moved(&there)).distance;
                least = least.min(d);
                assert!(parts.is_none_or(|low| low <= d + 1e-12), "{parts:?} > {d}");
                assert!(
                    reached.iter().all(|low| *low <= d + 1e-12),
                    "{kind} {moving}: {reached:?} > {d}"
                );
                assert!(
                    low <= d + 1e-12,
                    "{kind} {moving} {half}: {low} > {d}, {of_curve:?}"
                );
                assert!(high >= d - 1e-12, "{kind} {moving} {half}: {high} < {d}");
            }
            if let Some(of_curve) = of_curve.filter(|_| half == 0.01) {
                let way = moved.distance(mine.bounds());
                near[usize::from(least - of_curve < 4.0 * way * way)] += 1;
            }
        }
        // The error is quadratic in the displacement.
        assert!(near[1] > 9 * near[0], "{near:?}");
        assert!(gained[0] > 4000 && gained[1] > 20, "{gained:?}");
    }

    /// Points and circles beside circles: both bounds of the distance lose with the third power of the time.
    #[test]
    fn bounds_beside_circles_are_of_third_order() {
        let mut draws = Draws(11);
        let mut gains = [Vec::new(), Vec::new()];
        for round in 0..400 {
            let (a, mine) = (draws.element(3), draws.element([0, 2][round % 2]));
            let (chain, models) = draws.motion();
            // Apart, as the centre lines of bodies in contact are.
            let a = a.moved(&Pose::from_translation(draws.vector(20.0)));
            let lost = [0.04, 0.02].map(|half| {
                let moved = chain.around(&models, 0.0, half);
                let b = mine.moved(&moved.pose);
                let meeting = Meeting::new(&a, &b, &mine, &moved);
                let steps = (-32..=32).map(|step| {
                    let there = pose_at(&chain, &models, half * f64::from(step) / 32.0);
                    signed_distance(&a, &mine.moved(&there)).distance
                });
                let [least, most] = steps.fold([f64::INFINITY, f64::NEG_INFINITY], |ends, d| {
                    [ends[0].min(d), ends[1].max(d)]
                });
                let low = curved::lower_bound(&meeting, [f64::NEG_INFINITY, f64::INFINITY])
                    .unwrap_or(f64::NAN);
                [least - low, meeting.above() - most]
            });
            for k in 0..2 {
                assert!(lost[0][k] > -1e-12 && lost[1][k] > -1e-12, "{lost:?}");
                gains[k].push(lost[0][k] / lost[1][k]);
            }
        }
        for gains in &mut gains {
            gains.sort_by(f64::total_cmp);
            let middle = gains[gains.len() / 2];
            assert!(middle > 6.0, "{middle}");
        }
    }
}
