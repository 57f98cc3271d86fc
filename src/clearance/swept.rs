//! The volume that a body sweeps over the motion, enclosed by a mesh: in the world or relative to another body.
//!
//! Between the poses of a list no point of the body is farther from its position at one of them than the step, bounded
//! as for clearances. Let f be the distance from the body at the nearest pose of the list: in the swept volume f is at
//! most the step. The mesh is the level surface of f, interpolated on tetrahedra, at the step plus the interpolation
//! error. f is a distance and has the Lipschitz constant 1, from which both bounds follow.

use super::motion::ProvedMotion;
use super::relative::RelativeChain;
use super::sweep::slack_of_poses;
use crate::distance::bodies::BodyElements;
use crate::distance::mesh;
use crate::distance::pair::signed_distance;
use crate::distance::primitive::{Element, Primitive};
use crate::geometry::Mesh;
use crate::math::Pose;
use crate::model::chain::Chain;
use glam::{DVec3, IVec3};
use std::collections::HashMap;

/// The step between poses, in cells.
const STEP: f64 = 0.25;

/// Interpolation in a tetrahedron of a cell may be off by the radius of the sphere through the
/// corners of the cell: half its diagonal.
const HALF_DIAGONAL: f64 = 0.866_025_403_784_438_7;

/// Maximum number of poses in the list; a coarser mesh needs fewer.
const MOST_POSES: usize = 200_000;

/// Maximum number of halvings of an interval for one pose.
const MOST_HALVINGS: u32 = 40;

/// Tetrahedra of a cell by the numbers of its corners (bits for x, y, z): the six around the diagonal.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];

/// A mesh around the volume that a body sweeps.
#[derive(Clone, Debug)]
pub struct Swept {
    /// The surface, in the scene's unit, in the world's or the other body's frame.
    pub mesh: Mesh,
    /// The mesh encloses the swept volume, and no point of it is farther from that volume than this.
    pub within: f64,
    /// The motion between the samples is proved, not estimated.
    pub is_certified: bool,
}

/// Why there is no mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SweptError {
    /// A body without shapes.
    #[error("the body has no shapes")]
    NoShapes,
    /// A half-space.
    #[error("a half-space is unbounded")]
    Endless,
    /// Parts of the motion are not known.
    #[error("the motion could not be followed everywhere")]
    Gaps,
    /// The motion is too long for the cells.
    #[error("the motion needs more than 200000 poses at this fineness: ask for fewer cells")]
    TooLong,
}

impl Swept {
    /// Of a body over a motion, as seen from another body or from the world, with `cells` cells along the longest side.
    ///
    /// # Errors
    /// Bodies without shapes or without end, motions with gaps or with too many poses.
    pub fn new(
        motion: &ProvedMotion,
        body: usize,
        seen_from: Option<usize>,
        cells: u32,
    ) -> Result<Self, SweptError> {
        let bodies = &motion.system.mechanism().bodies;
        let hull = BodyElements::new(&bodies[body]).ok_or(SweptError::NoShapes)?;
        if !hull.ball.1.is_finite() {
            return Err(SweptError::Endless);
        }
        if !motion.gaps.is_empty() {
            return Err(SweptError::Gaps);
        }
        let world = Chain::default();
        let from = seen_from.map_or(&world, |k| &bodies[k].world_from_body);
        let chain = RelativeChain::new(from, &bodies[body].world_from_body);
        let coarse: Vec<Pose> = motion.poses().map(|pose| chain.pose(pose)).collect();
        let size = extent(&coarse, hull.ball);
        let cell = size / f64::from(cells);
        let poses = poses(motion, &chain, &hull, STEP * cell)?;
        let reach = hull.ball.0.length() + hull.ball.1;
        let extent = chain.longest(motion.poses()) + reach;
        let rounding = slack_of_poses(motion, &chain, extent);
        let field = Field {
            hull: &hull,
            poses,
            cell,
            level: (STEP + HALF_DIAGONAL) * cell + rounding,
        };
        Ok(Self {
            mesh: field.surface(),
            // From the level back to a pose of the list, from there to one of the motion, and what interpolating may add.
            within: 2.0 * ((STEP + HALF_DIAGONAL) * cell + rounding),
            is_certified: motion.is_certified(),
        })
    }
}

/// The longest side of a box around a ball at some poses.
fn extent(poses: &[Pose], (centre, radius): (DVec3, f64)) -> f64 {
    let centres = || poses.iter().map(|pose| pose.transform_point(centre));
    let low = centres().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
    let high = centres().reduce(DVec3::max).unwrap_or(DVec3::ZERO);
    (high - low).max_element() + 2.0 * radius
}

/// Poses such that the body is always within `step` of its position at one of them.
fn poses(
    motion: &ProvedMotion,
    chain: &RelativeChain,
    hull: &BodyElements,
    step: f64,
) -> Result<Vec<Pose>, SweptError> {
    let alone = motion.alone().into_iter();
    let mut list: Vec<Pose> = alone
        .map(|k| chain.pose(&motion.instants[k].arguments))
        .collect();
    for stretch in &motion.stretches[..motion.roots] {
        // Halved in time until between two poses no point moves farther than a step.
        let mut open = vec![(0.0, 1.0, 0)];
        while let Some((s, half, depth)) = open.pop() {
            let moved = chain.around(&stretch.arguments, s, half);
            if moved.distance(hull.ball) <= step {
                list.push(moved.pose);
            } else if list.len() + open.len() < MOST_POSES && depth < MOST_HALVINGS {
                let half = 0.5 * half;
                open.extend([s - half, s + half].map(|s| (s, half, depth + 1)));
            } else {
                return Err(SweptError::TooLong);
            }
        }
    }
    Ok(list)
}

/// The distance from a body at the nearest of many poses.
struct Field<'a> {
    hull: &'a BodyElements,
    poses: Vec<Pose>,
    cell: f64,
    level: f64,
}

impl Field<'_> {
    /// From the body at one pose; zero in a mesh.
    fn off_pose(&self, pose: &Pose, point: DVec3) -> f64 {
        let local = pose.inverse().transform_point(point);
        let probe = Element {
            core: Primitive::Point(local),
            radius: 0.0,
            shape: 0,
        };
        let of = |element: &Element| {
            let near = signed_distance(element, &probe).distance;
            match near > 0.0 && mesh::is_any([element, &probe]) {
                true if mesh::one_inside(&element.core, &probe.core) => 0.0,
                _ => near,
            }
        };
        self.hull
            .elements
            .iter()
            .map(of)
            .fold(f64::INFINITY, f64::min)
    }

    /// The level surface.
    fn surface(&self) -> Mesh {
        let centres = || {
            self.poses
                .iter()
                .map(|pose| pose.transform_point(self.hull.ball.0))
        };
        // A box of cells around everything that is swept, as a power of two.
        let low = centres().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
        let high = centres().reduce(DVec3::max).unwrap_or(DVec3::ZERO);
        let margin = DVec3::splat(self.hull.ball.1 + self.level + self.cell);
        let (low, high) = (low - margin, high + margin);
        let across = ((high - low).max_element() / self.cell).ceil() as i32;
        let side = across
            .max(1)
            .cast_unsigned()
            .next_power_of_two()
            .cast_signed();
        let mut surface = Surface {
            field: self,
            low,
            mesh: Mesh::default(),
            values: HashMap::new(),
            cuts: HashMap::new(),
        };
        let all: Vec<u32> = (0..self.poses.len() as u32).collect();
        // The octree looks only where the surface can be.
        surface.look(IVec3::ZERO, side, &all);
        surface.finish()
    }
}

/// The surface so far.
struct Surface<'a> {
    field: &'a Field<'a>,
    low: DVec3,
    mesh: Mesh,
    /// At the corners of cells.
    values: HashMap<IVec3, f64>,
    /// Vertices on the edges between two corners.
    cuts: HashMap<[IVec3; 2], u32>,
}

impl Surface<'_> {
    fn place(&self, corner: IVec3) -> DVec3 {
        self.low + corner.as_dvec3() * self.field.cell
    }

    /// Looks at a cube of cells, in which some of the poses may be the nearest, and cuts it where the surface may be.
    fn look(&mut self, at: IVec3, side: i32, near: &[u32]) {
        let field = self.field;
        let half = 0.5 * f64::from(side) * field.cell;
        let centre = self.place(at) + DVec3::splat(half);
        let radius = 2.0 * HALF_DIAGONAL * half;
        let of = |k: &u32| (field.off_pose(&field.poses[*k as usize], centre), *k);
        let distances: Vec<(f64, u32)> = near.iter().map(of).collect();
        // The body changes its distance by no more than the cell's radius: does its surface pass through the cell?
        let least = distances
            .iter()
            .map(|(d, _)| *d)
            .fold(f64::INFINITY, f64::min);
        if (least - field.level).abs() > radius {
            return;
        }
        // Poses that cannot be the nearest anywhere in the cell are not needed for its parts.
        let nearer = distances.iter().filter(|(d, _)| *d <= least + 2.0 * radius);
        let near: Vec<u32> = nearer.map(|(_, k)| *k).collect();
        if side == 1 {
            self.cut_cell(at, &near);
            return;
        }
        let half = side / 2;
        for k in 0..8 {
            self.look(at + corner(k) * half, half, &near);
        }
    }

    fn value(&mut self, at: IVec3, near: &[u32]) -> f64 {
        let place = self.place(at);
        let field = self.field;
        *self.values.entry(at).or_insert_with(|| {
            let poses = near.iter().map(|k| &field.poses[*k as usize]);
            let all = poses.map(|pose| field.off_pose(pose, place));
            all.fold(f64::INFINITY, f64::min) - field.level
        })
    }

    /// The triangles of one cell.
    fn cut_cell(&mut self, at: IVec3, near: &[u32]) {
        let corners: [IVec3; 8] = std::array::from_fn(|k| at + corner(k));
        let values = corners.map(|c| self.value(c, near));
        // Marching tetrahedra: each is cut in a triangle, in a quadrangle, or not at all.
        for tetrahedron in TETRAHEDRA {
            let (inner, outer): (Vec<usize>, Vec<usize>) =
                tetrahedron.into_iter().partition(|k| values[*k] < 0.0);
            let mut cut =
                |i: usize, o: usize| self.vertex([corners[i], corners[o]], [values[i], values[o]]);
            let ring: Vec<u32> = match (inner.as_slice(), outer.as_slice()) {
                ([i], [a, b, c]) => vec![cut(*i, *a), cut(*i, *b), cut(*i, *c)],
                ([a, b, c], [o]) => vec![cut(*a, *o), cut(*b, *o), cut(*c, *o)],
                ([i, j], [a, b]) => vec![cut(*i, *a), cut(*i, *b), cut(*j, *b), cut(*j, *a)],
                _ => continue,
            };
            // The cut faces from the corners inside to those outside.
            let middle = |list: &[usize]| {
                let sum: DVec3 = list.iter().map(|k| corners[*k].as_dvec3()).sum();
                sum / list.len() as f64
            };
            let outward = middle(&outer) - middle(&inner);
            self.add(&ring, outward);
        }
    }

    /// A vertex where the values change their sign.
    fn vertex(&mut self, ends: [IVec3; 2], [inner, outer]: [f64; 2]) -> u32 {
        if let Some(known) = self.cuts.get(&ends) {
            return *known;
        }
        let share = inner / (inner - outer);
        let [a, b] = ends.map(|end| self.place(end));
        let vertex = self.mesh.push_vertex(a.lerp(b, share), DVec3::ZERO);
        self.cuts.insert(ends, vertex);
        vertex
    }

    /// One or two triangles, counter-clockwise as seen from outside.
    fn add(&mut self, ring: &[u32], outward: DVec3) {
        for k in 1..ring.len() - 1 {
            let corners = [ring[0], ring[k], ring[k + 1]];
            let [a, b, c] = corners.map(|i| self.mesh.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            let is_outward = normal.dot(outward) >= 0.0;
            let triangle = if is_outward {
                corners
            } else {
                [corners[0], corners[2], corners[1]]
            };
            self.mesh.triangles.push(triangle);
            let normal = if is_outward { normal } else { -normal };
            corners
                .into_iter()
                .for_each(|i| self.mesh.normals[i as usize] += normal);
        }
    }

    fn finish(mut self) -> Mesh {
        self.mesh
            .normals
            .iter_mut()
            .for_each(|n| *n = n.normalize_or_zero());
        self.mesh
    }
}

/// Corner `k` of a cell of side one.
fn corner(k: usize) -> IVec3 {
    let bit = |shift: usize| ((k >> shift) & 1) as i32;
    IVec3::new(bit(0), bit(1), bit(2))
}
