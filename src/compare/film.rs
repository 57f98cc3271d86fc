//! Comparison of two rows of pictures, frame by frame: pixels, names, times, how often they play.

use super::{Comparison, Difference, LADDER, compare_rows};
use crate::import::{FilmFrame, FramePicture, ImportError, Plays, natural_order};
use std::cmp::Ordering;
use std::path::Path;

/// Delays that differ by less than this, in seconds, are equal: both were whole ticks of their file's clock.
const SAME_DELAY: f64 = 1e-6;

/// What may differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AllowedDifference {
    /// Levels that a channel may be off.
    pub tolerance: u8,
    /// Pixels of a picture that may be off by more.
    pub pixels: u64,
}

/// What came of one frame.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameVerdict {
    /// Both films have it.
    Both(Comparison),
    /// Only the first has it.
    OnlyInA,
    /// Only the second has it.
    OnlyInB,
}

/// One frame of the report.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameReport {
    /// Name of the file in a folder; empty elsewhere.
    pub name: String,
    /// What came of it.
    pub verdict: FrameVerdict,
    /// Seconds it is shown in both, where they differ.
    pub seconds: Option<[f64; 2]>,
}

/// How two films differ.
#[derive(Clone, Debug, PartialEq)]
pub struct FilmReport {
    /// What was allowed.
    pub allowed: AllowedDifference,
    /// Every frame, in order.
    pub frames: Vec<FrameReport>,
    /// How often they play, where that differs.
    pub plays: Option<[Option<Plays>; 2]>,
    /// Number of the frame that differs most; `None` if no frame is in both.
    pub worst: Option<usize>,
    /// Its two pictures, if they are to be kept.
    pub worst_pictures: Option<[FramePicture; 2]>,
}

impl FilmReport {
    /// Whether the frame `index` is within tolerance, its time included.
    pub fn passes(&self, index: usize) -> bool {
        let frame = &self.frames[index];
        let pixels = match &frame.verdict {
            FrameVerdict::Both(comparison) => comparison.is_within(self.allowed.pixels),
            FrameVerdict::OnlyInA | FrameVerdict::OnlyInB => false,
        };
        pixels && frame.seconds.is_none()
    }

    /// Numbers of the frames that do not pass.
    pub fn failing(&self) -> Vec<usize> {
        (0..self.frames.len())
            .filter(|k| !self.passes(*k))
            .collect()
    }

    /// Whether everything is within tolerance.
    pub fn is_same(&self) -> bool {
        self.plays.is_none() && self.failing().is_empty()
    }

    /// Pixels of all frames that are off by more than each level of [`LADDER`].
    pub fn ladder(&self) -> [u64; LADDER.len()] {
        let mut sum = [0; LADDER.len()];
        for difference in self.frames.iter().filter_map(FrameReport::difference) {
            for (sum, over) in sum.iter_mut().zip(difference.over_ladder) {
                *sum += over;
            }
        }
        sum
    }
}

impl FrameReport {
    /// The difference of the two pictures, if both are there and of one size.
    pub fn difference(&self) -> Option<&Difference> {
        match &self.verdict {
            FrameVerdict::Both(Comparison::SameSize(difference)) => Some(difference),
            _ => None,
        }
    }
}

/// Compares two films: frames of the same name in folders, of the same number elsewhere. Holds two pictures of
/// animations at a time, and two more where the worst ones are to be kept, however long they are; of files no more than rows.
///
/// Errors: the first that a film reports.
pub fn compare_films(
    a: impl Iterator<Item = Result<FilmFrame, ImportError>>,
    b: impl Iterator<Item = Result<FilmFrame, ImportError>>,
    plays: [Option<Plays>; 2],
    allowed: AllowedDifference,
    keeps_worst: bool,
) -> Result<FilmReport, ImportError> {
    let mut report = FilmReport {
        allowed,
        frames: Vec::new(),
        plays: (plays[0] != plays[1]).then_some(plays),
        worst: None,
        worst_pictures: None,
    };
    let (mut a, mut b) = (a.peekable(), b.peekable());
    let mut badness = None;
    loop {
        let order = match (a.peek(), b.peek()) {
            (None, None) => return Ok(report),
            (Some(_), None) => Ordering::Less,
            (None, Some(_)) => Ordering::Greater,
            (Some(Ok(left)), Some(Ok(right))) => {
                natural_order(Path::new(&left.name), Path::new(&right.name))
            }
            // The error is returned when the frame is read.
            (Some(_), Some(_)) => Ordering::Equal,
        };
        let left = if order.is_le() {
            a.next().transpose()?
        } else {
            None
        };
        let right = if order.is_ge() {
            b.next().transpose()?
        } else {
            None
        };
        match (left, right) {
            (Some(left), Some(right)) => {
                let frame = compare_frames(&left, &right, allowed.tolerance)?;
                let bad = verdict_rank(&frame.verdict);
                if badness.is_none_or(|most| bad > most) {
                    badness = Some(bad);
                    report.worst = Some(report.frames.len());
                    report.worst_pictures = keeps_worst.then_some([left.picture, right.picture]);
                }
                report.frames.push(frame);
            }
            (Some(only), None) => report.frames.push(lone_frame(only, FrameVerdict::OnlyInA)),
            (None, Some(only)) => report.frames.push(lone_frame(only, FrameVerdict::OnlyInB)),
            (None, None) => return Ok(report),
        }
    }
}

fn compare_frames(
    left: &FilmFrame,
    right: &FilmFrame,
    tolerance: u8,
) -> Result<FrameReport, ImportError> {
    let differs = (left.seconds - right.seconds).abs() > SAME_DELAY;
    let found = compare_rows(left.picture.rows()?, right.picture.rows()?, tolerance)?;
    Ok(FrameReport {
        name: left.name.clone(),
        verdict: FrameVerdict::Both(found),
        seconds: differs.then_some([left.seconds, right.seconds]),
    })
}

fn lone_frame(frame: FilmFrame, verdict: FrameVerdict) -> FrameReport {
    FrameReport {
        name: frame.name,
        verdict,
        seconds: None,
    }
}

/// How bad a pair is: another size first, then pixels over the tolerance, then the worst level.
fn verdict_rank(verdict: &FrameVerdict) -> (bool, u64, u8) {
    match verdict {
        FrameVerdict::Both(Comparison::SameSize(d)) => (false, d.over, d.worst),
        _ => (true, 0, 0),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use image::{Rgba, RgbaImage};

    fn film(frames: &[(&str, u8, f64)]) -> Vec<Result<FilmFrame, ImportError>> {
        let frame = |(name, level, seconds): &(&str, u8, f64)| FilmFrame {
            name: (*name).to_owned(),
            picture: FramePicture::Held(RgbaImage::from_pixel(3, 2, Rgba([*level, 0, 0, 255]))),
            seconds: *seconds,
        };
        frames.iter().map(|f| Ok(frame(f))).collect()
    }

    fn report(a: &[(&str, u8, f64)], b: &[(&str, u8, f64)], tolerance: u8) -> FilmReport {
        let allowed = AllowedDifference {
            tolerance,
            pixels: 0,
        };
        let plays = [Some(Plays::Forever); 2];
        compare_films(
            film(a).into_iter(),
            film(b).into_iter(),
            plays,
            allowed,
            true,
        )
        .unwrap()
    }

    #[test]
    fn the_worst_frame_and_the_sums_are_found() {
        let a = [("", 10, 0.1), ("", 10, 0.1), ("", 10, 0.1)];
        let b = [("", 10, 0.1), ("", 13, 0.1), ("", 12, 0.1)];
        let strict = report(&a, &b, 0);
        assert_eq!((strict.failing(), strict.is_same()), (vec![1, 2], false));
        assert_eq!(strict.ladder(), [12, 12, 6, 0, 0, 0, 0, 0]);
        assert_eq!(strict.worst, Some(1));
        assert!(report(&a, &b, 3).is_same());
        assert!(report(&a, &a, 0).is_same());
    }

    #[test]
    fn another_time_and_another_number_of_frames_fail() {
        let a = [("", 10, 0.1), ("", 10, 0.1)];
        let late = report(&a, &[("", 10, 0.1), ("", 10, 0.11)], 255);
        assert_eq!(late.failing(), [1]);
        assert_eq!(late.frames[1].seconds, Some([0.1, 0.11]));
        let long = report(&a[..1], &a, 255);
        assert_eq!(long.frames[1].verdict, FrameVerdict::OnlyInB);
        assert!(!long.is_same());
        let short = report(&a, &a[..1], 255);
        assert_eq!(short.frames[1].verdict, FrameVerdict::OnlyInA);
    }

    #[test]
    fn files_of_folders_are_matched_by_name() {
        let a = [("f1", 1, 0.0), ("f2", 2, 0.0), ("f10", 10, 0.0)];
        let b = [("f2", 2, 0.0), ("f3", 3, 0.0), ("f10", 10, 0.0)];
        let report = report(&a, &b, 0);
        let names: Vec<&str> = report.frames.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["f1", "f2", "f3", "f10"]);
        assert_eq!(report.failing(), [0, 2]);
    }

    #[test]
    fn a_film_that_plays_another_number_of_times_is_another() {
        let allowed = AllowedDifference {
            tolerance: 255,
            pixels: 0,
        };
        let frames = || film(&[("", 1, 0.1)]).into_iter();
        let plays = [Some(Plays::Forever), Some(Plays::Times(1))];
        let report = compare_films(frames(), frames(), plays, allowed, true).unwrap();
        assert!(!report.is_same() && report.failing().is_empty());
    }
}
