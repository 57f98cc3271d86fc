//! Whether meshes cut each other, and how far. Meshes have no depth. Instead one body is shifted by a length in many directions:
//! if none of the shifts separates the bodies, they overlap by more than that length.

use super::contact::BETWEEN_SAMPLES;
use super::motion::ProvedMotion;
use super::sweep::{Least, PairSweep};
use crate::distance::bodies::{BodyElements, LeftOut, enclosed_shell, nearest_bodies};
use crate::distance::mesh::is_any;
use crate::math::Pose;
use glam::DVec3;

/// Bodies that touch are parted by a shift of this many lengths of the pair, in one of many directions: far more than rounding.
const CUT: f64 = 1e-6;

/// Bodies in contact are parted by a shift of this share of how near to touching they should be proved to stay, so that the
/// proof has the rest for how they move.
const PARTING: f64 = 0.25;

/// A shift in one of the directions parts bodies that a shorter one in the best direction does, if it is this many times as
/// long: no direction is farther from one of them than the edge of a cube from its corner.
const SLANT: f64 = 1.25;

/// How often a shift is doubled until it parts what meets at the first pose.
const DOUBLINGS: u32 = 16;

/// Directions along the edges and the diagonals of a cube.
pub const DIRECTIONS: usize = 14;

fn directions() -> [DVec3; DIRECTIONS] {
    let sign = |k: usize, bit: usize| if k & bit == 0 { -1.0 } else { 1.0 };
    std::array::from_fn(|k| match k.checked_sub(8) {
        None => DVec3::new(sign(k, 1), sign(k, 2), sign(k, 4)).normalize_or_zero(),
        Some(k) => DVec3::AXES[k / 2] * sign(k, 1),
    })
}

/// Two bodies by the pairs of their elements that have a mesh: whether others touch says nothing of these.
pub(super) struct MeshCuts<'s> {
    sweep: &'s PairSweep<'s>,
    /// All other pairs of elements.
    others: LeftOut,
}

impl MeshCuts<'_> {
    /// Whether the bodies are in each other.
    pub fn are_met(&self, pose: &Pose) -> bool {
        let [first, second] = self.sweep.hulls;
        let found = nearest_bodies(first, second, pose, &self.others);
        found.is_some_and(|f| f.proximity.distance <= 0.0)
            || enclosed_shell(first, second, pose, &self.others).is_some()
    }

    /// Whether the bodies are in each other, and no shift as long as this parts them.
    pub fn are_cut_beyond(&self, pose: &Pose, shift: f64) -> bool {
        let mut shifts = std::iter::once(DVec3::ZERO).chain(directions().map(|n| n * shift));
        shifts.all(|shift| {
            let mut moved = *pose;
            moved.translation += shift;
            self.are_met(&moved)
        })
    }

    /// The first of some solved poses at which a mesh is cut: no shift of this length parts the bodies.
    pub fn first(&self, motion: &ProvedMotion, instants: &[usize], shift: f64) -> Option<usize> {
        let mut instants = instants.iter().copied();
        instants.find(|k| self.are_cut_beyond(&self.sweep.relative(motion, *k), shift))
    }
}

impl PairSweep<'_> {
    /// What cuts may be looked for among; nothing without a mesh.
    pub(super) fn mesh_cuts(&self) -> Option<MeshCuts<'_>> {
        let [first, second] = self.hulls;
        if !self.hulls.iter().any(|hull| hull.has_mesh()) {
            return None;
        }
        let pairs = BodyElements::pairs_of(self.hulls, |_| true);
        let is_other = |[i, j]: &[usize; 2]| {
            !is_any([&first.elements[*i], &second.elements[*j]])
                || self.left_out.contains(&[*i, *j])
        };
        Some(MeshCuts {
            sweep: self,
            others: pairs.filter(is_other).collect(),
        })
    }

    /// Whether a mesh is cut at a solved time: the bodies meet, and no small shift parts them, which it would if they just
    /// touched.
    pub(super) fn is_mesh_cut(&self, motion: &ProvedMotion, time: f64) -> bool {
        let all = 0..motion.instants.len();
        let at_time: Vec<usize> = all.filter(|k| motion.instants[*k].time == time).collect();
        let cuts = self.mesh_cuts();
        cuts.is_some_and(|cuts| cuts.first(motion, &at_time, CUT * self.extent).is_some())
    }

    /// The shift that parts bodies in contact, a mesh among what meets.
    pub(super) fn parting_shift(&self, motion: &ProvedMotion) -> f64 {
        PARTING * BETWEEN_SAMPLES * self.contact_scale(motion) + self.pose_slack()
    }

    /// A pose at which meshes are farther in each other than at the first one, by more than `growth`: it is looked for at every
    /// sample and in the middle of every stretch. `None` also where nothing parts them at the first pose.
    pub(super) fn cut_deeper(&self, motion: &mut ProvedMotion, growth: f64) -> Option<Least> {
        let cuts = self.mesh_cuts()?;
        let first = self.relative(motion, motion.assembled()?);
        let at_first = |shift: &f64| !cuts.are_cut_beyond(&first, *shift);
        let parted = (0..DOUBLINGS).map(|k| growth * f64::from(1_u32 << k));
        let parted = std::iter::once(0.0).chain(parted).find(at_first)?;
        // What parts the meshes at the first pose is allowed, with some slack for other directions.
        let allowed = SLANT * parted + growth;
        let is_deeper = |pose: Pose| cuts.are_cut_beyond(&pose, allowed);
        let samples = motion.samples.iter().copied();
        let found = samples
            .into_iter()
            .find(|k| is_deeper(self.relative(motion, *k)));
        let middle = |root: &usize| {
            let arguments = &motion.stretches[*root].arguments;
            is_deeper(self.chain.around(arguments, 0.0, 0.0).pose)
        };
        let instant = match found {
            Some(instant) => instant,
            None => {
                let root = (0..motion.roots).find(middle)?;
                motion.pose_at(root, 0.0)?
            }
        };
        self.sampled(motion, &[instant], None)
    }
}
