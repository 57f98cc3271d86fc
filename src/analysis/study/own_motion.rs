//! The poses of pieces along their own motions: next to a dead centre or a change point the poses of the file's values have no way
//! to them, though they move.

use super::track_poses::{Evaluator, Rejection, TrackPoses, is_one_pose};

impl Evaluator<'_> {
    /// The poses of a piece: as [`approach`](Self::approach), or along the piece's own motion, if one of its poses is next to a
    /// known one. Next to a dead centre others of the known ones may have no way to the piece's, though the piece moves.
    ///
    /// # Errors
    /// The pose at which the way ends, if the piece has no whole motion in the same assembly either.
    pub fn piece(
        &mut self,
        track_poses: &TrackPoses,
        values: &[f64],
    ) -> Result<TrackPoses, Rejection> {
        let rejection = match track_poses.behind_singular {
            Some(behind) => {
                let (track, pose) = self.family.place_of(behind);
                Rejection::NotReached { track, pose }
            }
            None => match self.approach(track_poses, values) {
                Ok(reached) => return Ok(reached),
                Err(rejection) => rejection,
            },
        };
        let near = self.next_to_known(track_poses, values);
        let start = near.as_ref();
        let start = start.and_then(|(index, near)| self.led_back(track_poses, *index, near));
        // Where all known poses lie behind the singular one, the start values alone say where the piece begins.
        if near.is_none() && track_poses.behind_singular != Some(0) {
            return Err(rejection);
        }
        let poses = self.own_motion(values, start).ok_or(rejection.clone())?;
        let is_that = near
            .is_none_or(|(index, near)| is_one_pose(self.family.mechanism(), &poses[index], &near));
        // Behind a singular pose a piece may be on either side of it.
        let compared = match track_poses.behind_singular {
            Some(_) => 0,
            None => poses.len(),
        };
        let mut pairs = poses.iter().enumerate().take(compared);
        let is_there = |(k, pose): (usize, &Vec<f64>)| {
            let (signs, _) = self.side(pose);
            track_poses.has_side(k, &signs)
        };
        match is_that && pairs.all(is_there) {
            true => Ok(track_poses.approached(values.to_vec(), poses)),
            false => Err(rejection),
        }
    }

    /// A pose of a piece that is one step from a known, regular one, before all of them pass a singular pose.
    fn next_to_known(
        &mut self,
        track_poses: &TrackPoses,
        values: &[f64],
    ) -> Option<(usize, Vec<f64>)> {
        let known = track_poses.values.iter().zip(values);
        let change: Vec<f64> = known.map(|(a, b)| b - a).collect();
        // Steps begin from known sensitivities.
        let count = track_poses.sensitivities().map_or(0, <[_]>::len);
        let count = track_poses.behind_singular.map_or(count, |k| k.min(count));
        let mut regular = (0..count).filter(|k| !track_poses.is_singular(*k));
        regular.find_map(|k| Some((k, self.pose(track_poses, k, &change, values)?)))
    }

    /// All poses along the motion of a piece, from these start values, if there are some; `None` if it has none as a whole.
    fn own_motion(&self, values: &[f64], start: Option<Vec<f64>>) -> Option<Vec<Vec<f64>>> {
        let mut own = self.family.with_start(values);
        if let Some(start) = start {
            own.actuation.guess = start;
        }
        let poses = own.assembled().and_then(|family| family.whole_motion());
        poses.filter(|_| !self.is_cancelled())
    }

    /// The unknowns of a piece at the start of the drive, from its pose `index`: back along the track, then straight on.
    fn led_back(
        &mut self,
        track_poses: &TrackPoses,
        index: usize,
        near: &[f64],
    ) -> Option<Vec<f64>> {
        let family = self.family;
        let first = family.mechanism().unknowns.len();
        let driven = first..first + family.own_inputs();
        let track = family.ranges().find(|poses| poses.contains(&index))?;
        let before = (track.start..index).rev();
        let before = before.map(|k| track_poses.poses[k][driven.clone()].to_vec());
        let start = family.actuation.inputs_at(0.0);
        let places = before.chain([start[..driven.len()].to_vec()]);
        let mut pose = near.to_vec();
        for place in places {
            let (from, variables) = (&pose[driven.clone()], &pose[driven.end..]);
            let inputs = |part: f64| {
                let pairs = from.iter().zip(&place);
                let moved = pairs.map(|(a, b)| a + (b - a) * part);
                moved.chain(variables.iter().copied()).collect()
            };
            pose = self.group.solver.followed(&pose[..first], inputs)?;
        }
        pose.truncate(first);
        Some(pose)
    }
}
