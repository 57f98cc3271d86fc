//! Where a joint is, and which part of a long shape is near it.

use crate::distance::primitive::{BoxCore, Element, Frustum, Primitive};
use crate::math::Pose;
use glam::DVec3;

/// A shape is on the joint's axis, or along it, to this part of its thickness.
const COAXIAL: f64 = 1e-9;

/// Shapes shorter than this many thicknesses are not cut.
const LONG: f64 = 2.0;

/// A shape whose sine to the joint's axis is below this one is carried away from it slowly: the region is longer on it, so that
/// it is as wide about the axis.
const STEEP: f64 = 0.5;

/// Below this sine a shape is nearly along the axis.
const SLANTED: f64 = 0.1;

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
    pub(super) fn turns_into_itself(&self, element: &Element) -> bool {
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

    /// The part of a long shape that is within `reach` of it.
    fn near_part(&self, spine: &Spine, reach: f64) -> NearPart {
        // Where the shape's middle line is nearest, how far that is, and how far the region reaches along the line.
        let (at, away, reach_along) = match self {
            Self::Anywhere => return NearPart::Whole,
            Self::Point(centre) => {
                let at = (*centre - spine.from).dot(spine.along);
                (at, centre.distance(spine.from + spine.along * at), reach)
            }
            Self::Lines(lines) => {
                let sine = |line: &[DVec3; 2]| line[1].cross(spine.along).length();
                let steepest = lines.iter().max_by(|p, q| sine(p).total_cmp(&sine(q)));
                let Some([origin, direction]) = steepest else {
                    return NearPart::None;
                };
                let across = direction.cross(spine.along);
                let arm = *origin - spine.from;
                if across.length() <= COAXIAL {
                    // Turning about the line carries nothing of the shape away from it.
                    let away = arm.cross(*direction).length();
                    return match away <= reach + spine.thickness {
                        true => NearPart::Whole,
                        false => NearPart::None,
                    };
                }
                // Nearest points of two lines.
                let at = -arm.cross(*direction).dot(across) / across.length_squared();
                let away = arm.dot(across).abs() / across.length();
                (
                    at,
                    away,
                    width_about(across.length(), reach, spine) / across.length(),
                )
            }
        };
        let low = ((at - reach_along) / spine.length).clamp(0.0, 1.0);
        let high = ((at + reach_along) / spine.length).clamp(0.0, 1.0);
        match low < high && away <= reach + spine.thickness {
            false => NearPart::None,
            true if [low, high] == [0.0, 1.0] => NearPart::Whole,
            true => NearPart::Shares([low, high]),
        }
    }
}

/// How far from a joint's axis the region reaches on a shape at this sine to it. On one that is steep it is as long as the reach,
/// on one along the axis as wide as the reach beside it, and between them it narrows.
fn width_about(sine: f64, reach: f64, spine: &Spine) -> f64 {
    let steep = reach * sine.max(STEEP);
    let beside = reach + spine.thickness;
    match sine < SLANTED {
        true => beside + (steep - beside) * (sine / SLANTED),
        false => steep,
    }
}

/// The part of a shape that is near a joint.
pub(super) enum NearPart {
    /// All of it.
    Whole,
    /// Between two shares of its length.
    Shares([f64; 2]),
    /// Nothing of it.
    None,
}

impl NearPart {
    /// Of an element; one that is not long is not cut.
    pub(super) fn of(element: &Element, place: &JointLocus, reach: f64) -> Self {
        Spine::of(element).map_or(Self::Whole, |spine| place.near_part(&spine, reach))
    }

    /// As shares of the length.
    pub(super) fn shares(&self) -> Option<[f64; 2]> {
        match self {
            Self::Whole => Some([0.0, 1.0]),
            Self::Shares(shares) => Some(*shares),
            Self::None => None,
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
pub(super) fn element_part(element: &Element, low: f64, high: f64) -> Element {
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

/// The part of an element within `reach` of a place, if there is one, and those beyond.
pub(super) fn element_parts(
    element: &Element,
    place: &JointLocus,
    reach: f64,
) -> (Option<Element>, Vec<Element>) {
    match NearPart::of(element, place, reach) {
        NearPart::Whole => (Some(element.clone()), Vec::new()),
        NearPart::None => (None, vec![element.clone()]),
        NearPart::Shares([low, high]) => {
            let mut beyond = Vec::new();
            beyond.extend((low > 0.0).then(|| element_part(element, 0.0, low)));
            beyond.extend((high < 1.0).then(|| element_part(element, high, 1.0)));
            (Some(element_part(element, low, high)), beyond)
        }
    }
}

/// Half of an element's smallest extent.
pub(super) fn thinnest(element: &Element) -> f64 {
    match &element.core {
        Primitive::Box(b) => b.half.min_element() + element.radius,
        Primitive::Frustum(f) => (0.5 * f.length).min(f.radii[0].max(f.radii[1])) + element.radius,
        _ => thickness(element),
    }
}

/// Thickness of an element: half the cross-section of a long one, half the size of any other.
pub(super) fn thickness(element: &Element) -> f64 {
    Spine::of(element).map_or_else(|| element.bounds().1, |spine| spine.thickness)
}
