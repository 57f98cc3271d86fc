//! Whether meshes cut each other, and how far. Meshes have no depth. Instead one body is shifted by a length in many directions,
//! or its shapes are made smaller so that their points move as far: what separates the bodies moves every point out of the other one, so that none
//! of them is deeper in it. If nothing does, the bodies count as cut. A pin that fits its bore is parted by none of the shifts,
//! but a smaller one is free.

use super::contact::BETWEEN_SAMPLES;
use super::motion::ProvedMotion;
use super::sweep::{Least, PairSweep};
use crate::distance::bodies::{BodyElements, LeftOut, enclosed_shell, nearest_bodies};
use crate::distance::mesh::is_any;
use crate::math::Pose;
use glam::DVec3;
use std::cell::OnceCell;

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
const DIRECTIONS: usize = 14;

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
        self.do_meet(self.sweep.hulls, pose)
    }

    fn do_meet(&self, [first, second]: [&BodyElements; 2], pose: &Pose) -> bool {
        let found = nearest_bodies(first, second, pose, &self.others);
        found.is_some_and(|f| f.proximity.distance <= 0.0)
            || enclosed_shell(first, second, pose, &self.others).is_some()
    }

    /// The looks for cuts that are deeper than a length.
    pub fn beyond(&self, length: f64) -> DeepCuts<'_> {
        DeepCuts {
            cuts: self,
            length,
            smaller: [const { OnceCell::new() }; 2],
        }
    }

    /// The first of some solved poses at which a mesh is cut deeper than a length.
    pub fn first(&self, motion: &ProvedMotion, instants: &[usize], length: f64) -> Option<usize> {
        let deep = self.beyond(length);
        let mut instants = instants.iter().copied();
        instants.find(|k| deep.are_cut(&self.sweep.relative(motion, *k)))
    }
}

/// Looks for cuts that are deeper than a length.
pub(super) struct DeepCuts<'c> {
    cuts: &'c MeshCuts<'c>,
    length: f64,
    /// Both bodies made smaller by half of it, once they are needed.
    smaller: [OnceCell<BodyElements>; 2],
}

impl DeepCuts<'_> {
    /// Whether the bodies are in each other, and nothing that moves their points by no more than the length parts them.
    pub fn are_cut(&self, pose: &Pose) -> bool {
        let hulls = self.cuts.sweep.hulls;
        let half = 0.5 * self.length;
        self.cuts.are_met(pose)
            && self.meet_shifted(hulls, pose, self.length)
            && [0, 1].into_iter().all(|side| {
                let smaller = self.smaller[side].get_or_init(|| hulls[side].smaller(half));
                let mut hulls = hulls;
                hulls[side] = smaller;
                self.cuts.do_meet(hulls, pose) && self.meet_shifted(hulls, pose, half)
            })
    }

    /// Whether bodies are in each other after every shift of a length.
    fn meet_shifted(&self, hulls: [&BodyElements; 2], pose: &Pose, length: f64) -> bool {
        directions().into_iter().all(|direction| {
            let mut moved = *pose;
            moved.translation += direction * length;
            self.cuts.do_meet(hulls, &moved)
        })
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

    /// Whether a mesh is cut at a solved time: the bodies meet, and nothing small parts them, which it would if they just
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
        let at_first = |length: &f64| !cuts.beyond(*length).are_cut(&first);
        let parted = (0..DOUBLINGS).map(|k| growth * f64::from(1_u32 << k));
        let parted = std::iter::once(0.0).chain(parted).find(at_first)?;
        // What parts the meshes at the first pose is allowed, with some slack for other directions.
        let allowed = SLANT * parted + growth;
        let deep = cuts.beyond(allowed);
        let is_deeper = |pose: Pose| deep.are_cut(&pose);
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
