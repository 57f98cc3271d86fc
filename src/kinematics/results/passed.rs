//! The poses through which a motion was followed between two samples.

/// Most numbers kept for one motion, 32 MB: two hundred thousand poses of a linkage of twenty unknowns.
const MOST_NUMBERS: usize = 4_000_000;

/// Closed poses that a motion was followed through, in the order of time: proofs between two samples start from them, and
/// nothing is proved of them. Beyond a limit no more are kept.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct PassedPoses {
    /// Seconds.
    times: Vec<f64>,
    /// The unknowns of all of them, one pose after the other: radians, or the scene's length unit.
    unknowns: Vec<f64>,
}

impl PassedPoses {
    /// Keeps a pose that is later than all others, if there is room for it.
    pub fn keep(&mut self, time: f64, unknowns: &[f64]) {
        let is_later = self.times.last().is_none_or(|last| *last < time);
        if is_later && self.times.len() + self.unknowns.len() + unknowns.len() < MOST_NUMBERS {
            self.times.push(time);
            self.unknowns.extend_from_slice(unknowns);
        }
    }

    /// Forgets the last pose if it is not before this time.
    pub fn forget_from(&mut self, time: f64) {
        let count = self.unknowns.len() / self.times.len().max(1);
        if self.times.pop_if(|last| *last >= time).is_some() {
            self.unknowns.truncate(count * self.times.len());
        }
    }

    /// Of two poses, one before a time and one after it, and those between them: the last one before the time and the first
    /// one after it. Poses are given by their time and unknowns.
    pub fn nearest<'p>(
        &'p self,
        time: f64,
        [a, b]: [(f64, &'p [f64]); 2],
    ) -> [(f64, &'p [f64]); 2] {
        let before = self.times.partition_point(|t| *t < time);
        let after = self.times.partition_point(|t| *t <= time);
        let count = self.unknowns.len() / self.times.len().max(1);
        let pose = |k: usize| {
            let time = *self.times.get(k)?;
            Some((time, &self.unknowns[k * count..(k + 1) * count]))
        };
        let before = before.checked_sub(1).and_then(pose);
        [
            before.filter(|pose| pose.0 > a.0).unwrap_or(a),
            pose(after).filter(|pose| pose.0 < b.0).unwrap_or(b),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::PassedPoses;

    #[test]
    fn poses_are_found_by_their_time() {
        let mut passed = PassedPoses::default();
        for (time, x) in [(0.1, 1.0), (0.3, 3.0), (0.2, 2.0), (0.4, 4.0)] {
            passed.keep(time, &[x, -x]);
        }
        passed.forget_from(0.5);
        let ends = [(0.0, &[0.0, 0.0][..]), (1.0, &[10.0, -10.0][..])];
        let times = |time: f64, ends| passed.nearest(time, ends).map(|pose| pose.0);
        assert_eq!(times(0.3, ends), [0.1, 0.4]);
        assert_eq!(times(0.05, ends), [0.0, 0.1]);
        assert_eq!(
            times(0.35, [(0.32, ends[0].1), (0.39, ends[1].1)]),
            [0.32, 0.39]
        );
        assert_eq!(passed.nearest(0.5, ends)[0], (0.4, &[4.0, -4.0][..]));
        passed.forget_from(0.4);
        assert_eq!(
            passed.nearest(0.35, ends),
            [(0.3, &[3.0, -3.0][..]), ends[1]]
        );
        assert_eq!(PassedPoses::default().nearest(0.5, ends), ends);
    }
}
