//! Dimensions in a picture: extension lines, dimension lines with arrow heads, arcs of angles, and their values. They
//! are drawn over the bodies and follow the motion.

use super::fitting;
use super::value_text::{VALUE_SIZE, amount_text};
use crate::kinematics::results::trajectory::{ClosedPose, Trajectory};
use crate::math::{sin_cos, square_to};
use crate::model::mechanism::Kind;
use crate::model::shown_dimension::{DimensionEnd, DimensionKind, PlaceOf, ShownDimension};
use crate::render::{Camera, Frame, Label, LabelAnchor, OverlayStroke};
use crate::scene::Scene;
use glam::DVec3;
use std::f64::consts::TAU;

/// Radius of an arc over the motion's extent, where the scene gives none.
const RADIUS: f64 = 0.11;

/// Length of the sides of an angle relative to the radius of its arc.
const SIDES: f64 = 1.18;

/// Longest piece of an arc, in radians.
const PIECE: f64 = 0.07;

/// Half the width of lines, length of an arrow head, half its width, and how far an extension line reaches beyond its
/// dimension line, over the picture's height.
const HALF_LINE: f64 = 0.0013;
const HEAD: f64 = 0.022;
const HALF_HEAD: f64 = 0.0052;
const OVERSHOOT: f64 = 0.010;

/// Room between a line and its value, over the picture's height.
const GAP: f64 = 0.010;

/// Width of the halo in the background's colour that separates lines from bodies behind them, relative to the picture's
/// height.
const SEAM: f64 = 0.0022;

/// In a parallel view, a dimension is omitted if it, its extension lines or its arc are shorter than this fraction of
/// their true length.
const LEAST_TRUE: f64 = 0.5;

/// A line shorter than this many arrow heads has them outside.
const SHORT: f64 = 3.0;

/// An angle this little below zero is a zero that was rounded, not a full turn: poses are exact to far less.
const LEVEL: f64 = 1e-9;

/// Number of poses for which space is reserved for dimensions.
const LOOKS: usize = 48;

/// How a picture shows dimensions.
#[derive(Clone, Copy, Debug)]
pub struct DimensionLook {
    /// From where it is seen.
    pub camera: Camera,
    /// Size of the picture in pixels.
    pub size: [u32; 2],
    /// sRGB.
    pub background: [u8; 3],
    /// Extent of the motion.
    pub extent: f64,
    /// Size of lines and values over the usual one.
    pub enlarged: f64,
}

/// Points that the camera must hold.
pub fn held_points(scene: &Scene, trajectory: &Trajectory, extent: f64) -> Vec<DVec3> {
    let poses: Vec<_> = trajectory.poses().collect();
    let stride = poses.len().div_ceil(LOOKS).max(1);
    let looks = poses.iter().step_by(stride);
    let dimensions = &scene.view.dimensions;
    looks
        .flat_map(|pose| dimensions.iter().map(move |dimension| (pose, dimension)))
        .flat_map(
            |(pose, dimension)| match DrawnDimension::of(dimension, pose, extent) {
                Some(DrawnDimension::Length { line, .. }) => line.to_vec(),
                Some(DrawnDimension::Angle(arc)) => (0..=8)
                    .map(|k| arc.point(f64::from(k) / 8.0, 1.0))
                    .collect(),
                None => Vec::new(),
            },
        )
        .filter(|point| point.is_finite())
        .collect()
}

/// Colours of all dimensions.
pub fn flat_colours(scene: &Scene) -> impl Iterator<Item = [u8; 3]> + '_ {
    let dimensions = scene.view.dimensions.iter();
    dimensions.filter_map(|dimension| dimension.colour)
}

/// Adds the dimensions at a pose to `frame`.
pub fn add_dimensions(scene: &Scene, pose: &ClosedPose, look: DimensionLook, frame: &mut Frame) {
    for dimension in &scene.view.dimensions {
        let Some(measured) = DrawnDimension::of(dimension, pose, look.extent) else {
            continue;
        };
        if !look.camera.is_perspective() && !measured.is_true_in(&look.camera) {
            continue;
        }
        let colour = dimension.colour.unwrap_or(scene.view.theme.ink());
        let mut pen = DimensionPen {
            look,
            colour,
            frame: &mut *frame,
            strokes: Vec::new(),
        };
        let foot = match &measured {
            DrawnDimension::Length { ends, line } => pen.length(*ends, *line),
            DrawnDimension::Angle(arc) => pen.angle(arc),
        };
        pen.finish();
        if let Some(foot) = foot {
            let value = amount_text(
                &scene.mechanism,
                measured.kind(),
                measured.amount(),
                dimension.digits,
            );
            let text = dimension.text.as_deref().unwrap_or(ShownDimension::VALUE);
            pen.value(foot, text.replace(ShownDimension::VALUE, &value));
        }
    }
}

/// A dimension at a pose.
enum DrawnDimension {
    Length { ends: [DVec3; 2], line: [DVec3; 2] },
    Angle(Arc),
}

/// An arc about the vertex of an angle.
struct Arc {
    at: DVec3,
    /// Unit vectors: the first side, and square to it.
    sides: [DVec3; 2],
    radius: f64,
    angle: f64,
    directed: bool,
}

impl Arc {
    /// A point at `share` of the arc, `far` radii from the vertex.
    fn point(&self, share: f64, far: f64) -> DVec3 {
        let (sin, cos) = sin_cos(share * self.angle);
        self.at + (self.sides[0] * cos + self.sides[1] * sin) * (far * self.radius)
    }
}

impl DrawnDimension {
    /// `None` if it does not exist: an angle without sides.
    fn of(dimension: &ShownDimension, pose: &ClosedPose, extent: f64) -> Option<Self> {
        let ends = dimension.ends.map(|end| place(end, pose));
        let (at, axis, radius) = match dimension.kind {
            DimensionKind::Length { offset } => {
                let line = ends.map(|end| end + offset);
                return Some(Self::Length { ends, line });
            }
            DimensionKind::Angle { at, axis, radius } => (place(at, pose), axis, radius),
        };
        let [from, to] = ends.map(|end| end - at);
        let flat = |v: DVec3| axis.map_or(v, |axis| v - axis * v.dot(axis));
        let [from, to] = [flat(from), flat(to)];
        let (first, to) = (from.try_normalize()?, to.try_normalize()?);
        let second = match axis {
            Some(axis) => axis.cross(first),
            None => {
                let square = (to - first * to.dot(first)).try_normalize();
                square.unwrap_or_else(|| square_to(first, DVec3::Z).normalize_or(DVec3::X))
            }
        };
        let angle = libm::atan2(to.dot(second), to.dot(first));
        Some(Self::Angle(Arc {
            at,
            sides: [first, second],
            radius: radius.unwrap_or(RADIUS * extent),
            angle: match angle < -LEVEL {
                true => angle + TAU,
                false => angle.max(0.0),
            },
            directed: axis.is_some(),
        }))
    }

    /// Whether a parallel view shows it long enough to be read.
    fn is_true_in(&self, camera: &Camera) -> bool {
        let line_of_sight = camera.world_from_camera.rotation.z_axis;
        let is_long = |v: DVec3| {
            let flat = v - line_of_sight * v.dot(line_of_sight);
            flat.length() >= LEAST_TRUE * v.length()
        };
        match self {
            Self::Length { ends, line } => is_long(ends[1] - ends[0]) && is_long(line[0] - ends[0]),
            Self::Angle(arc) => {
                let normal = arc.sides[0].cross(arc.sides[1]);
                normal.dot(line_of_sight).abs() >= LEAST_TRUE
            }
        }
    }

    fn kind(&self) -> Kind {
        match self {
            Self::Length { .. } => Kind::Length,
            Self::Angle(_) => Kind::Angle,
        }
    }

    fn amount(&self) -> f64 {
        match self {
            Self::Length { ends, .. } => ends[0].distance(ends[1]),
            Self::Angle(arc) => arc.angle,
        }
    }
}

fn place(end: DimensionEnd, pose: &ClosedPose) -> DVec3 {
    match end.of {
        PlaceOf::Body(body) => pose.bodies[body].transform_point(end.point),
        PlaceOf::Trace(trace) => pose.traces[trace] + end.point,
        PlaceOf::World => end.point,
    }
}

/// Position of a value: a point of the line, and the direction away from it.
struct ValueFoot {
    world: DVec3,
    at: [f64; 2],
    away: [f64; 2],
}

struct DimensionPen<'a> {
    look: DimensionLook,
    colour: [u8; 3],
    frame: &'a mut Frame,
    /// Of this dimension.
    strokes: Vec<OverlayStroke>,
}

impl DimensionPen<'_> {
    fn tall(&self) -> f64 {
        f64::from(self.look.size[1]) * self.look.enlarged
    }

    fn on_screen(&self, point: DVec3) -> Option<[f64; 2]> {
        let [x, y, _] = self.look.camera.project(point, self.look.size)?;
        Some([x, y])
    }

    fn line(&mut self, ends: [[f64; 2]; 2]) {
        let half = (HALF_LINE * self.tall()).max(0.5);
        self.strokes.push(OverlayStroke {
            ends,
            half_widths: [half; 2],
            colour: self.colour,
        });
    }

    /// Draws the dimension, with a halo around it.
    fn finish(&mut self) {
        let seam = SEAM * self.tall();
        let seams = self.strokes.iter().map(|stroke| OverlayStroke {
            half_widths: stroke.half_widths.map(|half| half + seam),
            colour: self.look.background,
            ..*stroke
        });
        self.frame.strokes.extend(seams);
        self.frame.strokes.append(&mut self.strokes);
    }

    /// An arrow head with its tip at `tip`, pointing along `along`.
    fn head(&mut self, tip: [f64; 2], along: [f64; 2]) {
        let tall = self.tall();
        self.strokes.push(OverlayStroke {
            ends: [tip, moved(tip, along, -HEAD * tall)],
            half_widths: [0.0, HALF_HEAD * tall],
            colour: self.colour,
        });
    }

    fn length(&mut self, ends: [DVec3; 2], line: [DVec3; 2]) -> Option<ValueFoot> {
        let tall = self.tall();
        let [p, q] = [self.on_screen(ends[0])?, self.on_screen(ends[1])?];
        let [a, b] = [self.on_screen(line[0])?, self.on_screen(line[1])?];
        for (from, to) in [(p, a), (q, b)] {
            if let Some((along, far)) = direction(from, to)
                && far > 1.0
            {
                self.line([from, moved(to, along, OVERSHOOT * tall)]);
            }
        }
        let (along, far) = direction(a, b)?;
        let head = HEAD * tall;
        if far >= SHORT * head {
            self.line([moved(a, along, 0.5 * head), moved(b, along, -0.5 * head)]);
            self.head(b, along);
            self.head(a, along.map(|c| -c));
        } else {
            self.line([moved(a, along, -1.8 * head), moved(b, along, 1.8 * head)]);
            self.head(a, along);
            self.head(b, along.map(|c| -c));
        }
        let at = between(a, b);
        // Next to the line, on the side away from the measured part; otherwise above it.
        let side = [along[1], -along[0]];
        let off = direction(between(p, q), at).filter(|(_, far)| *far > 1.0);
        let wish = off.map_or([1e-3, -1.0], |(off, _)| off);
        let turn = if side[0] * wish[0] + side[1] * wish[1] < 0.0 {
            -1.0
        } else {
            1.0
        };
        Some(ValueFoot {
            world: 0.5 * (line[0] + line[1]),
            at,
            away: side.map(|c| c * turn),
        })
    }

    fn angle(&mut self, arc: &Arc) -> Option<ValueFoot> {
        let vertex = self.on_screen(arc.at)?;
        // The two sides, from the vertex to a little beyond the arc.
        for share in [0.0, 1.0] {
            let end = self.on_screen(arc.point(share, SIDES))?;
            self.line([vertex, end]);
        }
        // The arc as a polygon, and its length on the screen.
        let pieces = (arc.angle / PIECE).ceil().max(1.0) as usize;
        let shares = (0..=pieces).map(|k| k as f64 / pieces as f64);
        let points: Option<Vec<[f64; 2]>> = shares
            .map(|share| self.on_screen(arc.point(share, 1.0)))
            .collect();
        let points = points?;
        let drawn: f64 = points
            .windows(2)
            .filter_map(|pair| direction(pair[0], pair[1]))
            .map(|(_, far)| far)
            .sum();
        for pair in points.windows(2) {
            self.line([pair[0], pair[1]]);
        }
        let head = HEAD * self.tall();
        // Heads, if there is room for them: they point along the chord over their own length.
        if drawn > SHORT * head {
            let back = head / drawn;
            let tips: &[[f64; 2]] = if arc.directed {
                &[[1.0, 1.0 - back]]
            } else {
                &[[1.0, 1.0 - back], [0.0, back]]
            };
            for [tip, behind] in tips {
                let tip = self.on_screen(arc.point(*tip, 1.0))?;
                let behind = self.on_screen(arc.point(*behind, 1.0))?;
                if let Some((along, _)) = direction(behind, tip) {
                    self.head(tip, along);
                }
            }
        }
        // The value stands at the middle, away from the vertex.
        let world = arc.point(0.5, 1.0);
        let at = self.on_screen(world)?;
        let away = direction(vertex, at).map_or([0.0, -1.0], |(away, _)| away);
        Some(ValueFoot { world, at, away })
    }

    fn value(&mut self, foot: ValueFoot, text: String) {
        let size = VALUE_SIZE * self.tall();
        let extent = fitting::text_extent(&text, size);
        let reach = [0, 1].map(|c| 0.5 * extent[c] * foot.away[c].abs());
        let far = GAP * self.tall() + reach[0] + reach[1];
        let middle = moved(foot.at, foot.away, far);
        let Some(from) = self.on_screen(foot.world) else {
            return;
        };
        self.frame.labels.push(Label {
            text,
            anchor: LabelAnchor::Placed {
                point: foot.world,
                offset: [0, 1].map(|c| middle[c] - from[c]),
                line: false,
            },
            size,
            colour: self.colour,
            plate: false,
            yields: false,
        });
    }
}

fn moved(from: [f64; 2], along: [f64; 2], far: f64) -> [f64; 2] {
    [0, 1].map(|c| from[c] + along[c] * far)
}

fn between(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|c| 0.5 * (a[c] + b[c]))
}

/// Unit direction and distance from one point to another; `None` if they coincide.
fn direction(from: [f64; 2], to: [f64; 2]) -> Option<([f64; 2], f64)> {
    let off = [to[0] - from[0], to[1] - from[1]];
    let far = (off[0] * off[0] + off[1] * off[1]).sqrt();
    (far > 1e-9).then(|| (off.map(|c| c / far), far))
}
