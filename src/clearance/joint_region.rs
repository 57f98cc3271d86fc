//! The region of a joint: the parts of two bodies' shapes that touch there, and no other parts.
//!
//! A long shape that is held by a joint is cut into the part that is near the joint and the parts that are not, so that only
//! the near parts of two shapes are left out of a check. A bar that folds onto its neighbour far from their pin is seen.

use super::joint_locus::{JointLocus, NearPart, element_part, element_parts, thickness, thinnest};
use crate::distance::bodies::BodyElements;
use crate::distance::mesh;
use crate::distance::pair::signed_distance;
use crate::distance::primitive::Element;
use crate::math::Pose;

/// The region reaches this many thicknesses of both shapes from the joint: two equal bars leave it, and are judged, where
/// the angle between them is below 29 degrees.
const REACH: f64 = 2.0;

/// Shapes that touch at a joint may come deeper into each other than at the first pose by this part of the thinner one: the
/// least way that parts two shapes changes as they turn.
const GROWTH: f64 = 0.05;

/// How often the region is doubled until the parts outside of it are clear of each other at the first pose.
const DOUBLINGS: u32 = 3;

/// Cuts of a shape that are closer than this share of its length are one.
const SAME_CUT: f64 = 1e-9;

/// Shapes touch where they miss each other by this part of their thickness, or of their balls' radius.
pub(super) const TOUCH: f64 = 1e-9;

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
            let [(near, mine), (other, others)] =
                [0, 1].map(|side| element_parts(elements[side], &places[side], *reach));
            let far = |a: &Element, b: &Element| {
                signed_distance(a, &b.moved(first_from_second)).distance > minimum
            };
            // All pairs of parts but the two near ones.
            let of_mine = mine
                .iter()
                .all(|a| others.iter().chain(&other).all(|b| far(a, b)));
            of_mine && near.iter().all(|a| others.iter().all(|b| far(a, b)))
        };
        let mut reaches = (0..DOUBLINGS).map(|k| first * f64::from(1 << k));
        let reach = reaches.find(is_clear).unwrap_or(first);
        let shares = [0, 1].map(|side| {
            let near = NearPart::of(elements[side], &places[side], reach);
            near.shares().unwrap_or([0.0, 0.0])
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
    let (Some(mine), Some(other)) = (mine, other) else {
        return false;
    };
    let other = other.moved(first_from_second);
    if mesh::is_any([&mine, &other]) && mesh::one_inside(&mine.core, &other.core) {
        return true;
    }
    signed_distance(&mine, &other).distance <= minimum + TOUCH * thinnest(first)
}
