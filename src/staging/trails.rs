//! Traced paths: growing with the motion, or with the last part fading into the background.

use crate::geometry::trace::trace_mesh;
use crate::kinematics::motion::sampling::is_cyclic;
use crate::kinematics::results::trajectory::Trajectory;
use crate::math::Pose;
use crate::model::view::Trails;
use crate::render::{Instance, StageMesh};
use crate::scene::Scene;
use glam::DVec3;
use std::ops::Range;

/// Radius of a trace in 480ths of the picture's height where the scene gives none, and its least in pixels.
pub const TRACE_RADIUS: f64 = 1.7;
pub const LEAST_RADIUS_PIXELS: f64 = 0.7;

/// Of a path that is still to be travelled: its radius over that of a trace, and its share of the trace's colour.
const AHEAD_RADIUS: f64 = 0.55;
const AHEAD_SHADE: f64 = 0.45;

/// Points of a trace nearer together than this, in pixels, are merged: many samples must not make minute steps.
const TRACE_STEP_PIXELS: f64 = 0.5;

/// Steps of all traces of a scene together, a kilobyte each: with more, points further apart are merged.
const MOST_STEPS: usize = 100_000;

/// How often that distance is doubled at most: to a million times the usual one.
const MOST_DOUBLINGS: usize = 20;

/// Sides of a trace's tube: it is a few pixels wide.
const TRACE_SIDES: u32 = 6;

/// Number of shades of a fading trail: few enough for a palette, enough to look continuous.
const SHADES: usize = 12;

/// Length of a fading trail over that of the motion where the scene gives none.
const LENGTH: f64 = 0.25;

/// A path as it is drawn from frame to frame.
pub struct TracePart {
    mesh: usize,
    /// The whole path, thin and pale: its mesh, number of triangles and colour.
    ahead: Option<(usize, u32, [u8; 3])>,
    /// Triangles up to each sample.
    triangles: Vec<u32>,
    /// Shades, from the oldest to the colour of the trace; one for a path that does not fade.
    shades: Vec<[u8; 3]>,
    /// Samples that a fading trail holds.
    length: usize,
    /// The path of a cyclic motion goes on at its start.
    closed: bool,
}

impl TracePart {
    /// The path at sample `index`.
    pub fn instances(&self, index: usize) -> Vec<Instance> {
        if self.shades.len() == 1 {
            let past = trace_piece(self.mesh, 0..self.triangles[index], self.shades[0]);
            let ahead = self.ahead;
            let ahead = ahead.map(|(mesh, count, shade)| trace_piece(mesh, 0..count, shade));
            return ahead.into_iter().chain([past]).collect();
        }
        let shades = self.shades.len();
        let bands = self.shades.iter().enumerate().flat_map(|(k, shade)| {
            // Samples before the present one at which the band ends and begins.
            let back = [shades - k, shades - k - 1].map(|n| n * self.length / shades);
            let ranges = self.between(index, back);
            ranges
                .into_iter()
                .map(|range| trace_piece(self.mesh, range, *shade))
        });
        bands.filter(|piece| !piece.triangles.is_empty()).collect()
    }

    /// Triangles from `back[0]` to `back[1]` samples before `index`, in two ranges across the start of a closed path.
    fn between(&self, index: usize, back: [usize; 2]) -> [Range<u32>; 2] {
        let count = self.triangles.len();
        let at = |samples: usize| index.checked_sub(samples);
        let end = |samples: usize| index + count - samples.min(count);
        let [from, to] = back.map(at);
        let none = || 0..0;
        match (from, to) {
            (Some(from), Some(to)) => [self.triangles[from]..self.triangles[to], none()],
            (None, _) if !self.closed => [0..to.map_or(0, |to| self.triangles[to]), none()],
            (None, Some(to)) => [
                self.triangles[end(back[0]).min(count - 1)]..self.all(),
                0..self.triangles[to],
            ],
            (_, None) => {
                let old = self.triangles[end(back[0]).min(count - 1)];
                [old..self.triangles[end(back[1]).min(count - 1)], none()]
            }
        }
    }

    /// Triangles of the whole path with the step from its end to its start.
    fn all(&self) -> u32 {
        let per_sample = self.triangles.len();
        self.triangles[per_sample - 1] + TRIANGLES_OF_LINK * u32::from(self.closed)
    }

    /// Colours it is drawn in.
    pub fn colours(&self) -> impl Iterator<Item = [u8; 3]> {
        let ahead = self.ahead.map(|(_, _, shade)| shade);
        self.shades.iter().copied().chain(ahead)
    }
}

/// Triangles of a path in its own colour.
pub fn trace_piece(mesh: usize, triangles: Range<u32>, colour: [u8; 3]) -> Instance {
    Instance {
        mesh,
        world_from_mesh: Pose::IDENTITY,
        colour,
        opacity: 1.0,
        triangles,
        casts_shadow: false,
        outline: None,
        flat: 1.0,
    }
}

/// Triangles of one step of a path.
const TRIANGLES_OF_LINK: u32 = 6 * TRACE_SIDES;

/// What trails are drawn with: how, the background they fade into, and the length of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct TrailLook {
    /// How.
    pub trails: Trails,
    /// sRGB.
    pub background: [u8; 3],
    /// In the scene's unit.
    pub pixel: f64,
    /// Height of the picture in pixels.
    pub height: f64,
}

/// One part per trace that is to be seen.
pub fn of_traces(
    scene: &Scene,
    trajectory: &Trajectory,
    look: TrailLook,
    meshes: &mut Vec<StageMesh>,
) -> Vec<TracePart> {
    let mechanism = &scene.mechanism;
    let count = trajectory.samples.len();
    // The number of samples that a fading trail holds; `None` if it keeps its colour.
    let fading = match look.trails {
        Trails::None => return Vec::new(),
        Trails::Whole | Trails::Grow => None,
        Trails::Fading(seconds) => {
            let share = seconds.map_or(LENGTH, |s| s / scene.actuation.duration);
            Some(((share * count as f64) as usize).clamp(SHADES.min(count), count))
        }
    };
    let complete = trajectory.samples.iter().all(|s| s.pose.is_some());
    // The trail of a cyclic motion goes on across its start.
    let cyclic = complete && count > 2 && is_cyclic(mechanism, &scene.actuation);
    let path = |index: usize| {
        let samples = trajectory.samples.iter();
        samples.map(move |s| s.pose.as_ref().map(|p| p.traces[index]))
    };
    let visible = mechanism.traces.iter().enumerate();
    let visible = visible.filter(|(_, trace)| trace.radius.is_none_or(|r| r > 0.0));
    let paths = visible.map(|(index, _)| path(index));
    // One least step for all traces, in pixels, so that many samples make no minute steps.
    let apart = least_step(paths, TRACE_STEP_PIXELS * look.pixel, MOST_STEPS);
    let mut parts = Vec::new();
    for (index, trace) in mechanism.traces.iter().enumerate() {
        let usual = (TRACE_RADIUS / 480.0 * look.height).max(LEAST_RADIUS_PIXELS);
        let radius = trace.radius.unwrap_or(usual * look.pixel);
        if radius <= 0.0 {
            continue;
        }
        let (mut kept, steps) = thin_trail(path(index), apart);
        let closed = cyclic && comes_round(&kept);
        if closed {
            kept.push(kept[0]);
        }
        // The whole path, thin and pale, below the part that has been travelled.
        let ahead = (look.trails == Trails::Whole).then(|| {
            let thin = (AHEAD_RADIUS * radius).max(LEAST_RADIUS_PIXELS * look.pixel);
            let path = trace_mesh(&kept, thin, TRACE_SIDES).mesh;
            let triangles = path.triangles.len() as u32;
            meshes.push(path.into());
            let shade = mixed_colour(look.background, trace.colour, AHEAD_SHADE);
            (meshes.len() - 1, triangles, shade)
        });
        // The path itself: a range of its triangles shows it up to a sample.
        let path = trace_mesh(&kept, radius, TRACE_SIDES);
        meshes.push(path.mesh.into());
        parts.push(TracePart {
            mesh: meshes.len() - 1,
            ahead,
            triangles: steps
                .iter()
                .map(|step| step * path.triangles_per_step)
                .collect(),
            shades: match fading {
                Some(_) => trail_shades(trace.colour, look.background),
                None => vec![trace.colour],
            },
            length: fading.unwrap_or(count),
            closed,
        });
    }
    parts
}

/// Whether a path ends about a step before its start: a point may move on though the drive comes round.
fn comes_round(points: &[Option<DVec3>]) -> bool {
    let step = |pair: &[Option<DVec3>]| Some(pair[0]?.distance(pair[1]?));
    let longest = points.windows(2).filter_map(step).fold(0.0, f64::max);
    let gap = points.first().zip(points.last());
    let gap = gap.and_then(|(first, last)| step(&[*last, *first]));
    gap.is_some_and(|gap| gap <= 2.0 * longest)
}

/// From nearly the background to the colour itself.
fn trail_shades(colour: [u8; 3], background: [u8; 3]) -> Vec<[u8; 3]> {
    let shade = |k: usize| mixed_colour(background, colour, (k + 1) as f64 / SHADES as f64);
    (0..SHADES).map(shade).collect()
}

/// `share` of the way from one colour to another.
fn mixed_colour(from: [u8; 3], to: [u8; 3], share: f64) -> [u8; 3] {
    std::array::from_fn(|c| {
        let [from, to] = [from[c], to[c]].map(f64::from);
        (from + (to - from) * share).round() as u8
    })
}

/// Doubles `apart` until the paths together keep at most `most` points.
fn least_step(
    paths: impl Iterator<Item = impl Iterator<Item = Option<DVec3>> + Clone> + Clone,
    mut apart: f64,
    most: usize,
) -> f64 {
    for _ in 0..MOST_DOUBLINGS {
        let kept = paths.clone().map(|path| thin_trail(path, apart).0.len());
        if kept.sum::<usize>() <= most {
            break;
        }
        apart *= 2.0;
    }
    apart
}

/// The points that are at least `apart` from the one kept before (one of every gap and the last point are always kept), and for
/// every point the number of steps between kept points up to it.
fn thin_trail(
    points: impl Iterator<Item = Option<DVec3>> + Clone,
    apart: f64,
) -> (Vec<Option<DVec3>>, Vec<u32>) {
    let last = points.clone().count().saturating_sub(1);
    let mut kept: Vec<Option<DVec3>> = Vec::new();
    let steps = points.enumerate().map(|(index, point)| {
        let near = match (kept.last(), point) {
            (Some(Some(a)), Some(b)) => a.distance(b) < apart,
            (Some(None), None) => true,
            _ => false,
        };
        if !near || index == last {
            kept.push(point);
        }
        kept.len() as u32 - 1
    });
    let steps = steps.collect();
    (kept, steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_points_are_thinned_and_gaps_and_ends_are_kept() {
        let x = |v: f64| Some(DVec3::new(v, 0.0, 0.0));
        let points = [x(0.0), x(0.1), x(0.6), x(0.7), None, x(0.7), x(0.8)];
        let (kept, steps) = thin_trail(points.into_iter(), 0.5);
        assert_eq!(kept, [x(0.0), x(0.6), None, x(0.7), x(0.8)]);
        assert_eq!(steps, [0, 0, 1, 1, 2, 3, 4]);
    }

    /// Many long paths keep their ends and no more points than all of them may have; few keep what can be seen.
    #[test]
    fn many_paths_take_longer_steps() {
        let path = |_| (0..1000).map(|k| (k % 300 < 250).then_some(DVec3::X * f64::from(k)));
        for (count, most) in [(3, 3000), (3, 300), (40, 1000)] {
            let apart = least_step((0..count).map(path), 0.5, most);
            let (kept, steps) = thin_trail(path(0), apart);
            assert!(count * kept.len() <= most, "{count} {apart}");
            assert_eq!(apart == 0.5, most == 3000);
            assert_eq!(steps[999] as usize + 1, kept.len());
            assert_eq!(kept.last(), Some(&Some(DVec3::X * 999.0)));
            assert_eq!(kept.iter().filter(|point| point.is_none()).count(), 3);
        }
    }
}
