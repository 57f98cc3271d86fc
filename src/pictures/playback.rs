//! Which sample each picture of a film shows: in order, back again, and held at its ends.

use crate::model::view::Playback;

/// The order in which samples are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlayOrder {
    first: usize,
    count: usize,
    /// Samples from one picture to the next.
    stride: usize,
    /// Pictures that repeat each end.
    held: usize,
    bounce: bool,
}

impl PlayOrder {
    /// `count` samples from `first` on, each once.
    pub fn plain(first: usize, count: usize) -> Self {
        Self {
            first,
            count,
            stride: 1,
            held: 0,
            bounce: false,
        }
    }

    /// The same of a motion whose intervals are divided into `stride` steps.
    pub fn divided(self, stride: usize) -> Self {
        Self { stride, ..self }
    }

    /// The first `count` of these samples.
    pub fn shortened(self, count: usize) -> Self {
        Self { count, ..self }
    }

    /// The same as a view plays it, at `fps` pictures a second; a single sample is one picture.
    pub fn played(self, playback: Playback, fps: f64) -> Self {
        if self.count < 2 {
            return self;
        }
        Self {
            held: (playback.pause * fps).round() as usize,
            bounce: playback.bounce,
            ..self
        }
    }

    /// Number of pictures.
    pub fn pictures(&self) -> usize {
        let back = match self.bounce {
            true => self.count.saturating_sub(2),
            false => 0,
        };
        self.count + 2 * self.held + back
    }

    /// The sample of a picture.
    pub fn sample(&self, picture: usize) -> usize {
        let last = self.count.saturating_sub(1);
        let forwards = picture.saturating_sub(self.held);
        let turned = forwards.saturating_sub(last + self.held);
        (self.first + forwards.min(last) - turned.min(last)) * self.stride
    }
}
