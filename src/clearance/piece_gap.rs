//! Lower bound of the distance of two bodies for all pieces: dimensions anywhere in their intervals, at a pose or over a
//! time interval.
//!
//! A plane separates two convex elements: the position of each of their corners along its normal is a function of the dimensions,
//! known to second order with a bounded remainder. Its minimum over all corners bounds the distance or the
//! depth. The normal is that of the nearest points in the middle, so that the bound is exact to first order. Other elements, and
//! those far apart, are bounded by the largest displacement of any point.

use super::part::JudgedPart;
use super::piece_corners::{Corner, carried_corner, carried_element, rim_corners};
use super::relative::RelativeChain;
use crate::distance::bodies::sphere_separation;
use crate::distance::pair::{Proximity, signed_distance};
use crate::distance::primitive::{Element, Primitive};
use crate::kinematics::certificate::tube::TaylorModel;
use crate::kinematics::enclosure::observer::{Directed, Observer};
use crate::math::Pose;
use crate::model::carried::CarriedShape;
use crate::model::chain::{ArgumentValue, Chain};
use crate::model::mechanism::Mechanism;
use glam::DVec3;

/// Rounding of the position of any point of a body, in lengths of the chain that leads to it from the
/// other body.
const POSE_SLACK: f64 = 1e-12;

/// Two bodies with the vectors to the points of their solids, in the frame of the first one.
pub struct PartWays<'p> {
    part: &'p JudgedPart,
    between: RelativeChain,
    shapes: [Vec<ShapeWays>; 2],
}

/// The vectors to the points of a solid.
struct ShapeWays {
    points: Vec<RelativeChain>,
    /// The same from the body itself.
    own: Vec<RelativeChain>,
    /// From each point to the next.
    spans: Vec<RelativeChain>,
    sizes: Vec<RelativeChain>,
}

/// A pose and the enclosure of all poses around it.
pub struct PieceView<'e> {
    observer: Observer<'e>,
    /// Arguments with their errors.
    spread: Vec<TaylorModel>,
    middle: Vec<ArgumentValue>,
    /// All of these have bounds.
    is_bounded: bool,
}

/// The result for two bodies.
#[derive(Clone, Debug)]
pub struct PieceLook {
    /// Lower bound for all pieces.
    pub lowest: f64,
    /// δ near which the closest piece lies, if it was searched.
    pub place: Option<Vec<f64>>,
}

/// Elements of two bodies at the middle pose, in the frame of the first one.
struct Facing<'f> {
    index: [usize; 2],
    elements: [&'f Element; 2],
    found: Proximity,
    /// How far any point of the second moves, the shapes with it.
    way: f64,
}

impl<'e> PieceView<'e> {
    /// Of an observer that knows the arguments in `used`.
    pub fn new(observer: Observer<'e>, mechanism: &Mechanism, used: &[usize]) -> Self {
        let count = mechanism.arguments.len();
        let mut spread = vec![TaylorModel::constant(0.0); count];
        let mut middle = vec![ArgumentValue::new(0.0); count];
        for argument in used {
            let [value, off] = observer.spread(*argument);
            spread[*argument] = TaylorModel {
                rest: off,
                ..TaylorModel::constant(value)
            };
            middle[*argument] = ArgumentValue::new(value);
        }
        Self {
            is_bounded: spread.iter().all(TaylorModel::is_finite),
            observer,
            spread,
            middle,
        }
    }

    /// Largest displacement of a ball at the end of a vector from its middle position.
    fn off(&self, way: &RelativeChain, ball: (DVec3, f64)) -> f64 {
        if way.joints() == 0 {
            return 0.0;
        }
        way.around(&self.spread, 0.0, 1.0).distance(ball)
    }
}

impl<'p> PartWays<'p> {
    /// The ways of the bodies' solids in `carried`; what is not carried keeps its place in its body.
    pub fn new(part: &'p JudgedPart, mechanism: &Mechanism, carried: &[CarriedShape]) -> Self {
        let chain = |k: usize| &mechanism.bodies[part.bodies[k]].world_from_body;
        let shapes = [0, 1].map(|side: usize| {
            let body = part.bodies[side];
            let count = mechanism.bodies[body].shapes.len();
            let ways = |shape: usize| {
                let mut known = carried.iter();
                let known = known.find(|c| c.body == body && c.shape == shape);
                // A solid that is not carried follows the chain of its body.
                let still = [chain(side).clone()];
                let points = known.map_or(&still[..], |c| &c.points);
                let sizes = known.map_or(&[][..], |c| &c.sizes);
                let seen = |from: &Chain, list: &[Chain]| -> Vec<RelativeChain> {
                    let list = list.iter();
                    list.map(|to| RelativeChain::new(from, to)).collect()
                };
                ShapeWays {
                    points: seen(chain(0), points),
                    own: seen(chain(side), points),
                    spans: points
                        .windows(2)
                        .map(|pair| RelativeChain::new(&pair[0], &pair[1]))
                        .collect(),
                    sizes: seen(&Chain::default(), sizes),
                }
            };
            (0..count).map(ways).collect()
        });
        Self {
            part,
            between: RelativeChain::new(chain(0), chain(1)),
            shapes,
        }
    }

    /// Arguments of all vectors.
    pub fn arguments(&self) -> Vec<usize> {
        let shapes = self.shapes.iter().flatten();
        let ways = shapes.flat_map(|s| s.points.iter().chain(&s.own).chain(&s.sizes));
        let ways = std::iter::once(&self.between).chain(ways);
        let mut all: Vec<usize> = ways.flat_map(RelativeChain::arguments).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    /// Lower bound over all pieces; pairs that stay above `goal` are not refined.
    pub fn look(&self, view: &PieceView, goal: f64) -> PieceLook {
        if !view.is_bounded {
            return PieceLook {
                lowest: f64::NEG_INFINITY,
                place: None,
            };
        }
        let [first, second] = self.part.hulls.each_ref();
        let pose = self.between.pose(&view.middle);
        let moved = self.between.around(&view.spread, 0.0, 1.0);
        let extent = pose.translation.length() + second.ball.0.length() + second.ball.1;
        let slack = POSE_SLACK * extent.min(f64::MAX);
        let grown = |side: usize, shape: usize| self.grown(view, side, shape);
        let all = |side: usize| {
            let shapes = 0..self.shapes[side].len();
            shapes.map(|shape| grown(side, shape)).fold(0.0, f64::max)
        };
        let far = first.apart(second, &pose) - moved.distance(second.ball) - all(0) - all(1);
        let mut look = PieceLook {
            lowest: f64::INFINITY,
            place: None,
        };
        if far - slack >= goal {
            look.lowest = far - slack;
            return look;
        }
        // Element by element.
        for (j, mine) in second.elements.iter().enumerate() {
            let placed = mine.moved(&pose);
            let way = moved.distance(mine.bounds()) + grown(1, mine.shape);
            for (i, element) in first.elements.iter().enumerate() {
                if self.part.left_out.contains(&[i, j]) {
                    continue;
                }
                let way = way + grown(0, element.shape);
                let goal = goal.min(look.lowest);
                let low = sphere_separation(element, &placed, goal + way + slack) - way - slack;
                if low >= goal {
                    look.lowest = look.lowest.min(low);
                    continue;
                }
                let facing = Facing {
                    index: [i, j],
                    elements: [element, &placed],
                    found: signed_distance(element, &placed),
                    way,
                };
                let (low, place) = self.gap(view, &facing, goal);
                if low - slack < look.lowest {
                    look = PieceLook {
                        lowest: low - slack,
                        place: place.or(look.place),
                    };
                }
            }
        }
        look
    }

    /// How far the points of a shape are from where they are drawn in their body, at most.
    fn grown(&self, view: &PieceView, side: usize, shape: usize) -> f64 {
        let ways = &self.shapes[side][shape];
        let (centre, radius) = self.part.hulls[side].ball;
        let reach = (DVec3::ZERO, 2.0 * radius + centre.length());
        let points = ways.own.iter().map(|way| view.off(way, reach));
        let tilted = self.tilt(view, side, shape);
        let tilted = if tilted == 0.0 { 0.0 } else { tilted * radius };
        points.fold(0.0, f64::max) + tilted + self.swollen(view, side, shape)
    }

    /// Bound on how much a shape can exceed its nominal size.
    fn swollen(&self, view: &PieceView, side: usize, shape: usize) -> f64 {
        let sizes = self.shapes[side][shape].sizes.iter();
        sizes.map(|way| view.off(way, (DVec3::ZERO, 0.0))).sum()
    }

    /// How far the line between two points of a shape may turn in its body.
    fn tilt(&self, view: &PieceView, side: usize, shape: usize) -> f64 {
        let spans = self.shapes[side][shape].spans.iter();
        spans
            .map(|span| span.tilt(&view.spread, &view.middle))
            .fold(0.0, f64::max)
    }

    /// How far a direction of the first body is turned against a shape, at most: the length by which what the shape sees of it changes.
    fn turned(&self, view: &PieceView, [side, shape]: [usize; 2], n: DVec3) -> f64 {
        let ways = self.shapes[side][shape].points.iter();
        let turned = ways.map(|way| way.turned(&view.spread, n));
        turned.fold(0.0, f64::max) + self.tilt(view, side, shape)
    }

    /// Bound of the distance of two elements, and where it is attained about.
    fn gap(&self, view: &PieceView, facing: &Facing, goal: f64) -> (f64, Option<Vec<f64>>) {
        let [a, b] = facing.elements;
        let n = facing.found.normal;
        let is = |kind: fn(&Primitive) -> bool| kind(&a.core) || kind(&b.core);
        let is_mesh = is(|core| matches!(core, Primitive::Mesh(..)));
        let is_flat = is(|core| matches!(core, Primitive::HalfSpace(_)));
        // Of what meets a mesh no depth is known.
        let plain = match is_mesh && !is_flat && facing.found.distance <= 0.0 {
            true => f64::NEG_INFINITY,
            false => facing.found.lowest() - facing.way,
        };
        let exact = match plain < goal && n != DVec3::ZERO {
            true => self.along_normal(view, facing),
            false => None,
        };
        // A convex hull does not bound the depth of a non-convex element.
        let is_convex = !is_mesh && !is(|core| matches!(core, Primitive::Circle(_)));
        match exact {
            Some((low, place)) if is_convex || is_flat || low > 0.0 => {
                (low.max(plain), Some(place))
            }
            Some((_, place)) => (plain, Some(place)),
            None => (plain, None),
        }
    }

    /// What a plane square to the normal parts the elements by, over all corners; `None` where they have none.
    fn along_normal<'e>(&self, view: &PieceView<'e>, facing: &Facing) -> Option<(f64, Vec<f64>)> {
        let n = facing.found.normal;
        let [i, j] = facing.index;
        let shape = |side: usize, k: usize| self.part.hulls[side].elements[k].shape;
        let (of_first, of_second) = (shape(0, i), shape(1, j));
        let (theirs, lost) = self.corners(view, facing, 1, -n)?;
        // Elements that are fixed in their body: the support function suffices.
        let still = self.shapes[0][of_first].own.iter();
        let still = still.map(RelativeChain::joints).sum::<usize>() == 0;
        let (ours, lost_here) = match still {
            true => (Vec::new(), 0.0),
            false => self.corners(view, facing, 0, n)?,
        };
        let radii = facing.elements[0].radius + facing.elements[1].radius;
        let swollen = self.swollen(view, 0, of_first) + self.swollen(view, 1, of_second);
        let lost = lost + lost_here + radii + swollen;
        let add =
            |corner: &Corner, side: usize, shape: usize, sign: f64, sum: &mut Directed<'e>| {
                for (way, share) in corner.on.iter().filter(|(_, share)| *share != 0.0) {
                    let steps = self.shapes[side][shape].points[*way].steps();
                    let direction = (n * (sign * share)).to_array();
                    view.observer
                        .add_along(steps, corner.offset.to_array(), direction, sum);
                }
            };
        let mut lowest: Option<(f64, Vec<f64>)> = None;
        let mut take = |low: f64, place: Vec<f64>| {
            if lowest.as_ref().is_none_or(|(known, _)| low < *known) {
                lowest = Some((low, place));
            }
        };
        for corner in &theirs {
            let mut sum = Directed::default();
            add(corner, 1, of_second, 1.0, &mut sum);
            if still {
                let here = facing.elements[0].core.support(n)?;
                let range = view.observer.function(&sum)?.range();
                take(range.lo - here, range.lowest);
                continue;
            }
            for own in &ours {
                let mut sum = sum.clone();
                add(own, 0, of_first, -1.0, &mut sum);
                let range = view.observer.function(&sum)?.range();
                take(range.lo, range.lowest);
            }
        }
        lowest.map(|(low, place)| (low - lost, place))
    }

    /// Corners of an element, one of which is farthest along `n` for every piece, to within what is given beside.
    fn corners(
        &self,
        view: &PieceView,
        facing: &Facing,
        side: usize,
        n: DVec3,
    ) -> Option<(Vec<Corner>, f64)> {
        let element = facing.elements[side];
        let shape = self.part.hulls[side].elements[facing.index[side]].shape;
        let turned = || self.turned(view, [side, shape], n);
        let (points, lost) = match &element.core {
            Primitive::Point(p) => (vec![*p], 0.0),
            Primitive::Segment(ends) => (ends.to_vec(), 0.0),
            Primitive::Triangle(corners) => (corners.to_vec(), 0.0),
            Primitive::Box(block) => (block.corners().to_vec(), 0.0),
            Primitive::Circle(circle) => rim_corners(circle, n, turned()),
            Primitive::Frustum(frustum) => {
                let turned = turned();
                let [(mut one, first), (other, second)] =
                    frustum.rims().map(|rim| rim_corners(&rim, n, turned));
                one.extend(other);
                // The rims stay square to the line between their centres.
                let tilt = self.tilt(view, side, shape);
                let widest = frustum.radii[0].max(frustum.radii[1]);
                (one, first.max(second) + widest * tilt)
            }
            // The plane of a half-space is displaced but not rotated.
            Primitive::HalfSpace(half) if side == 0 && n == half.normal && turned() == 0.0 => {
                (vec![half.point], 0.0)
            }
            Primitive::HalfSpace(_) | Primitive::Mesh(..) => return None,
        };
        let ends = self.shapes[side][shape].points.iter();
        let ends: Vec<Pose> = ends.map(|way| way.pose(&view.middle)).collect();
        let list = points.into_iter().map(|place| carried_corner(&ends, place));
        Some((list.collect(), lost))
    }

    /// The distance of the bodies of one piece at a pose of its own, with its own solids; `None` where these are not known exactly.
    pub fn distance(&self, view: &PieceView, arguments: &[ArgumentValue]) -> Option<f64> {
        // Solids whose sizes depend on the pose are not placed here.
        let mut sizes = self.shapes.iter().flatten().flat_map(|s| &s.sizes);
        if sizes.any(|way| way.joints() > 0) {
            return None;
        }
        // Every element moves with the chain of its own solid, from the middle of the piece to the given pose.
        let middle = self.between.pose(&view.middle);
        let placed = |side: usize| -> Vec<Element> {
            let elements = self.part.hulls[side].elements.iter();
            let carried = elements.map(|element| {
                let drawn = if side == 1 {
                    element.moved(&middle)
                } else {
                    element.clone()
                };
                let ways = &self.shapes[side][element.shape].points;
                let before: Vec<Pose> = ways.iter().map(|way| way.pose(&view.middle)).collect();
                let after: Vec<Pose> = ways.iter().map(|way| way.pose(arguments)).collect();
                carried_element(&drawn, &before, &after)
            });
            carried.collect()
        };
        // The minimum over all pairs of elements; bounding spheres exclude the distant ones.
        let (ours, theirs) = (placed(0), placed(1));
        let mut least = f64::INFINITY;
        for (i, a) in ours.iter().enumerate() {
            for (j, b) in theirs.iter().enumerate() {
                let is_far = || sphere_separation(a, b, least) >= least;
                if !self.part.left_out.contains(&[i, j]) && !is_far() {
                    least = least.min(signed_distance(a, b).distance);
                }
            }
        }
        Some(least)
    }
}
