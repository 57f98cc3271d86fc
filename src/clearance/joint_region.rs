//! The region of a joint: the parts of two bodies' shapes that touch there, and no other parts.
//!
//! A long shape that is held by a joint is cut into the part that is near the joint and the parts that are not, so that only
//! the near parts of two shapes are left out of a check. A bar that folds onto its neighbour far from their pin is seen.

use crate::distance::bodies::BodyElements;
use crate::distance::mesh;
use crate::distance::pair::signed_distance;
use crate::distance::primitive::{BoxCore, Element, Frustum, Primitive};
use crate::math::Pose;
use glam::DVec3;

/// The region reaches this many thicknesses of both shapes from the joint: two equal bars leave it, and are judged, where
/// the angle between them is below 29 degrees.
const REACH: f64 = 2.0;

/// Shapes that touch at a joint may come deeper into each other than at the first pose by this part of the thinner one: the
/// least way that parts two shapes changes as they turn.
const GROWTH: f64 = 0.05;

/// A shape is on the joint's axis, or along it, to this part of its thickness.
const COAXIAL: f64 = 1e-9;

/// Shapes shorter than this many thicknesses are not cut.
const LONG: f64 = 2.0;

/// A shape whose sine to the joint's axis is below this one is carried away from it slowly: the region is longer on it, so that
/// it is as wide about the axis.
const STEEP: f64 = 0.5;

/// How often the region is doubled until the parts outside of it are clear of each other at the first pose.
const DOUBLINGS: u32 = 3;

/// Cuts of a shape that are closer than this share of its length are one.
const SAME_CUT: f64 = 1e-9;

/// Shapes touch where they miss each other by this part of their thickness.
const TOUCH: f64 = 1e-9;

/// Where a joint is, in the frame of one body.
#[derive(Clone, Debug)]
pub enum JointLocus {
    /// On these lines: points and directions.
    Lines(Vec<[DVec3; 2]>),
    /// In this point.
    Point(DVec3),
    /// Wherever the bodies touch: sliders have no place of their own.
    Anywhere,
}

impl JointLocus {
    /// The same as seen from a body.
    pub fn seen_from(&self, world_from_body: &Pose) -> Self {
        let body_from_world = world_from_body.inverse();
        let line = |[origin, direction]: &[DVec3; 2]| {
            [
                body_from_world.transform_point(*origin),
                body_from_world.transform_vector(*direction),
            ]
        };
        match self {
            Self::Lines(lines) => Self::Lines(lines.iter().map(line).collect()),
            Self::Point(point) => Self::Point(body_from_world.transform_point(*point)),
            Self::Anywhere => Self::Anywhere,
        }
    }

    /// Whether a point is within `reach` of it.
    pub fn is_near(&self, point: DVec3, reach: f64) -> bool {
        match self {
            Self::Anywhere => true,
            Self::Point(centre) => point.distance(*centre) <= reach,
            Self::Lines(lines) => lines.iter().any(|[origin, direction]| {
                let arm = point - *origin;
                (arm - *direction * arm.dot(*direction)).length() <= reach
            }),
        }
    }

    /// Whether an element looks the same however the joint turns.
    fn turns_into_itself(&self, element: &Element) -> bool {
        let (axis, points) = match &element.core {
            Primitive::Point(p) => (None, vec![*p]),
            Primitive::Segment([a, b]) => ((*b - *a).try_normalize(), vec![*a, *b]),
            Primitive::Frustum(f) => (Some(f.axis), vec![f.from]),
            Primitive::Circle(c) => (Some(c.axis), vec![c.centre]),
            _ => return false,
        };
        let play = COAXIAL * thickness(element);
        match self {
            Self::Point(centre) => axis.is_none() && points[0].distance(*centre) <= play,
            Self::Lines(lines) if lines.len() == 1 => {
                let is_along = axis.is_none_or(|axis| axis.cross(lines[0][1]).length() <= COAXIAL);
                is_along && points.iter().all(|point| self.is_near(*point, play))
            }
            _ => false,
        }
    }

    /// How far along a line from `from` in the direction `along`, unit, the joint is, and by what factor the region is longer on
    /// it; `None` if turning about it carries nothing of that line away.
    fn along(&self, from: DVec3, along: DVec3) -> Option<(f64, f64)> {
        match self {
            Self::Anywhere => None,
            Self::Point(centre) => Some(((*centre - from).dot(along), 1.0)),
            Self::Lines(lines) => {
                let sine = |line: &[DVec3; 2]| line[1].cross(along).length();
                let [origin, direction] = lines
                    .iter()
                    .max_by(|p, q| sine(p).total_cmp(&sine(q)))
                    .filter(|line| sine(line) > COAXIAL)?;
                // Nearest points of two lines.
                let across = direction.cross(along);
                let towards = (*origin - from).cross(*direction).dot(across);
                let longer = (STEEP / across.length()).max(1.0);
                Some((-towards / across.length_squared(), longer))
            }
        }
    }
}

/// The middle line of a long shape, and how thick that is.
struct Spine {
    from: DVec3,
    along: DVec3,
    length: f64,
    thickness: f64,
}

impl Spine {
    fn of(element: &Element) -> Option<Self> {
        let (from, way, thickness) = match &element.core {
            Primitive::Segment([a, b]) => (*a, *b - *a, 0.0),
            Primitive::Frustum(f) => (f.from, f.axis * f.length, f.radii[0].max(f.radii[1])),
            Primitive::Box(b) => {
                let axis = longest_axis(b.half);
                let way = b.from_box.rotation.col(axis) * (2.0 * b.half[axis]);
                let mut across = b.half;
                across[axis] = 0.0;
                (b.from_box.translation - way * 0.5, way, across.length())
            }
            _ => return None,
        };
        let (length, thickness) = (way.length(), thickness + element.radius);
        (length > LONG * thickness && length > 0.0).then(|| Self {
            from,
            along: way / length,
            length,
            thickness,
        })
    }
}

fn longest_axis(half: DVec3) -> usize {
    (0..3).fold(0, |best, k| if half[k] > half[best] { k } else { best })
}

/// A part of a long element: between two shares of its length.
fn element_part(element: &Element, low: f64, high: f64) -> Element {
    // The part of a primitive between two shares of its longest direction.
    let core = match &element.core {
        Primitive::Segment([a, b]) => Primitive::Segment([a.lerp(*b, low), a.lerp(*b, high)]),
        Primitive::Frustum(f) => {
            let radius = |share: f64| f.radii[0] + share * (f.radii[1] - f.radii[0]);
            Primitive::Frustum(Frustum {
                from: f.from + f.axis * (low * f.length),
                axis: f.axis,
                length: (high - low) * f.length,
                radii: [radius(low), radius(high)],
            })
        }
        Primitive::Box(b) => {
            let axis = longest_axis(b.half);
            let (mut half, mut from_box) = (b.half, b.from_box);
            half[axis] *= high - low;
            let shift = (low + high - 1.0) * b.half[axis];
            from_box.translation += b.from_box.rotation.col(axis) * shift;
            Primitive::Box(BoxCore { from_box, half })
        }
        other => other.clone(),
    };
    Element { core, ..*element }
}

/// Which part of an element is within `reach` of a place, as shares of its length; `None` if it is not cut.
fn near_shares(element: &Element, place: &JointLocus, reach: f64) -> Option<[f64; 2]> {
    let spine = Spine::of(element)?;
    let (at, longer) = place.along(spine.from, spine.along)?;
    let reach = reach * longer;
    let low = ((at - reach) / spine.length).clamp(0.0, 1.0);
    let high = ((at + reach) / spine.length).clamp(0.0, 1.0);
    (low < high && [low, high] != [0.0, 1.0]).then_some([low, high])
}

/// The parts of an element within `reach` of a place, and those beyond.
fn element_parts(element: &Element, place: &JointLocus, reach: f64) -> (Element, Vec<Element>) {
    let Some([low, high]) = near_shares(element, place, reach) else {
        return (element.clone(), Vec::new());
    };
    let mut beyond = Vec::new();
    beyond.extend((low > 0.0).then(|| element_part(element, 0.0, low)));
    beyond.extend((high < 1.0).then(|| element_part(element, high, 1.0)));
    (element_part(element, low, high), beyond)
}

/// Two bodies with the parts of their shapes that touch at their joint apart from all others.
#[derive(Clone, Debug)]
pub struct JointRegion {
    /// The bodies with their shapes in parts.
    pub hulls: [BodyElements; 2],
    /// Parts that touch at the joint.
    pub touching: Vec<[usize; 2]>,
    /// The location of the joint in the frame of either body.
    places: [JointLocus; 2],
    /// Nothing slides in the joint.
    only_turns: bool,
}

impl JointRegion {
    /// From pairs of elements that touch at the first pose at a joint, and its location in both frames. Parts farther away are
    /// cut off where it keeps `minimum` at that pose.
    pub fn new(
        hulls: [&BodyElements; 2],
        touching: &[[usize; 2]],
        places: &[JointLocus; 2],
        first_from_second: &Pose,
        minimum: f64,
    ) -> Self {
        // A pair whose parts near the joint do not touch meets elsewhere and does not belong to the joint.
        let is_there =
            |pair: &&[usize; 2]| touches_near(hulls, **pair, places, first_from_second, minimum);
        let pairs = touching.iter().filter(is_there);
        // Each pair has a region of its own: a wide hub does not hide the bars beside it.
        let regions: Vec<PairRegion> = pairs
            .map(|pair| PairRegion::new(hulls, *pair, places, first_from_second, minimum))
            .collect();
        Self::cut(hulls, &regions, places)
    }

    /// By how much two parts that touch may come deeper into each other than at the first pose.
    pub fn growth(&self, [i, j]: [usize; 2]) -> f64 {
        let [first, second] = [&self.hulls[0].elements[i], &self.hulls[1].elements[j]];
        GROWTH * thickness(first).min(thickness(second))
    }

    /// Whether two parts are as deep in each other at all poses: one of them looks the same however the joint turns.
    pub fn is_constant(&self, pair: [usize; 2]) -> bool {
        self.only_turns
            && (0..2).any(|k| self.places[k].turns_into_itself(&self.hulls[k].elements[pair[k]]))
    }

    /// Of a joint in which nothing slides.
    pub fn turning(self, only_turns: bool) -> Self {
        Self { only_turns, ..self }
    }

    /// Cuts every element at the ends of all regions on it.
    fn cut(hulls: [&BodyElements; 2], regions: &[PairRegion], places: &[JointLocus; 2]) -> Self {
        let parts = [0, 1].map(|side| ElementParts::of_body(hulls[side], side, regions));
        let mut touching = Vec::new();
        for region in regions {
            let [mine, others] =
                [0, 1].map(|side| parts[side].within(region.pair[side], region.shares[side]));
            for i in &mine {
                touching.extend(others.iter().map(|j| [*i, *j]));
            }
        }
        touching.sort_unstable();
        touching.dedup();
        let [first, second] = parts;
        Self {
            hulls: [
                BodyElements {
                    elements: first.elements,
                    ball: hulls[0].ball,
                },
                BodyElements {
                    elements: second.elements,
                    ball: hulls[1].ball,
                },
            ],
            touching,
            places: places.clone(),
            only_turns: false,
        }
    }
}

/// The region of two elements that touch at a joint.
struct PairRegion {
    pair: [usize; 2],
    /// The part of either within it, as shares of its length.
    shares: [[f64; 2]; 2],
}

impl PairRegion {
    /// Reaches so far that the parts of both beyond it keep `minimum` at the first pose, if doubling it helps.
    fn new(
        hulls: [&BodyElements; 2],
        pair: [usize; 2],
        places: &[JointLocus; 2],
        first_from_second: &Pose,
        minimum: f64,
    ) -> Self {
        let elements = [0, 1].map(|side| &hulls[side].elements[pair[side]]);
        let first = REACH * (thickness(elements[0]) + thickness(elements[1]));
        let is_clear = |reach: &f64| {
            let [mine, others] = [0, 1].map(|side| {
                let (near, beyond) = element_parts(elements[side], &places[side], *reach);
                std::iter::once(near).chain(beyond).collect::<Vec<_>>()
            });
            let others: Vec<Element> = others.iter().map(|e| e.moved(first_from_second)).collect();
            let far = |a: &Element, b: &Element| signed_distance(a, b).distance > minimum;
            let beside = |i: usize, j: usize| i + j == 0 || far(&mine[i], &others[j]);
            (0..mine.len()).all(|i| (0..others.len()).all(|j| beside(i, j)))
        };
        let mut reaches = (0..DOUBLINGS).map(|k| first * f64::from(1 << k));
        let reach = reaches.find(is_clear).unwrap_or(first);
        let shares = [0, 1].map(|side| {
            let shares = near_shares(elements[side], &places[side], reach);
            shares.unwrap_or([0.0, 1.0])
        });
        Self { pair, shares }
    }
}

/// The elements of a body, cut.
struct ElementParts {
    /// The first part of each keeps its number.
    elements: Vec<Element>,
    /// Of each part the element that it is of, and where it lies on it, as shares of its length.
    places: Vec<(usize, [f64; 2])>,
}

impl ElementParts {
    fn of_body(hull: &BodyElements, side: usize, regions: &[PairRegion]) -> Self {
        let whole = (0..hull.elements.len()).map(|k| (k, [0.0, 1.0]));
        let mut parts = Self {
            elements: hull.elements.clone(),
            places: whole.collect(),
        };
        for (k, element) in hull.elements.iter().enumerate() {
            let own = regions.iter().filter(|region| region.pair[side] == k);
            let mut cuts: Vec<f64> = own.flat_map(|region| region.shares[side]).collect();
            cuts.extend([0.0, 1.0]);
            cuts.sort_by(f64::total_cmp);
            cuts.dedup_by(|next, before| *next - *before <= SAME_CUT);
            if let Some(last) = cuts.last_mut() {
                *last = 1.0;
            }
            for (index, ends) in cuts.windows(2).enumerate().filter(|_| cuts.len() > 2) {
                let part = element_part(element, ends[0], ends[1]);
                let place = (k, [ends[0], ends[1]]);
                match index {
                    0 => (parts.elements[k], parts.places[k]) = (part, place),
                    _ => {
                        parts.elements.push(part);
                        parts.places.push(place);
                    }
                }
            }
        }
        parts
    }

    /// The parts of an element between two shares of its length.
    fn within(&self, element: usize, [low, high]: [f64; 2]) -> Vec<usize> {
        let places = self.places.iter().enumerate();
        let (low, high) = (low - SAME_CUT, high + SAME_CUT);
        let own =
            places.filter(|(_, (of, ends))| *of == element && ends[0] >= low && ends[1] <= high);
        own.map(|(part, _)| part).collect()
    }
}

/// Whether two elements meet near a joint: no farther from it than the region of these two alone reaches, that of the thinnest
/// extent of both. A thin bar may end at the far edge of a wide plate.
fn touches_near(
    hulls: [&BodyElements; 2],
    [i, j]: [usize; 2],
    places: &[JointLocus; 2],
    first_from_second: &Pose,
    minimum: f64,
) -> bool {
    let [first, second] = [&hulls[0].elements[i], &hulls[1].elements[j]];
    let reach = REACH * (thinnest(first) + thinnest(second));
    let (mine, _) = element_parts(first, &places[0], reach);
    let (other, _) = element_parts(second, &places[1], reach);
    let other = other.moved(first_from_second);
    if mesh::is_any([&mine, &other]) && mesh::one_inside(&mine.core, &other.core) {
        return true;
    }
    signed_distance(&mine, &other).distance <= minimum + TOUCH * thinnest(first)
}

/// Half of an element's smallest extent.
fn thinnest(element: &Element) -> f64 {
    match &element.core {
        Primitive::Box(b) => b.half.min_element() + element.radius,
        Primitive::Frustum(f) => (0.5 * f.length).min(f.radii[0].max(f.radii[1])) + element.radius,
        _ => thickness(element),
    }
}

/// Thickness of an element: half the cross-section of a long one, half the size of any other.
fn thickness(element: &Element) -> f64 {
    Spine::of(element).map_or_else(|| element.bounds().1, |spine| spine.thickness)
}
