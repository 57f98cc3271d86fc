//! Steps on the way from one value to another: twice as long after one that was taken, half as long after one that was
//! refused.

/// A way, how far it has been gone, and the next step.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// How far the way has been gone.
    pub here: f64,
    end: f64,
    step: f64,
    smallest: f64,
}

impl Steps {
    /// From `start` to `end`, either way; steps are given up when they come below `smallest`.
    pub fn new(start: f64, end: f64, first: f64, smallest: f64) -> Self {
        Self {
            here: start,
            end,
            step: first,
            smallest,
        }
    }

    /// Whether the end has been reached.
    pub fn is_done(&self) -> bool {
        self.here == self.end
    }

    /// Where the next step leads: the end itself, not a sum, where it reaches that far.
    pub fn target(&self) -> f64 {
        if self.step >= (self.end - self.here).abs() {
            self.end
        } else {
            self.here + (self.end - self.here).signum() * self.step
        }
    }

    /// The step to [`target`](Self::target) was taken.
    pub fn take(&mut self) {
        let next = self.target();
        self.step = (2.0 * (next - self.here).abs()).max(self.smallest);
        self.here = next;
    }

    /// It was refused.
    pub fn refuse(&mut self) {
        self.step = 0.5 * (self.target() - self.here).abs();
    }

    /// Whether the next step is too small to get anywhere.
    pub fn is_stuck(&self) -> bool {
        let way = (self.end - self.here).signum() * self.step;
        !self.is_done() && (self.step < self.smallest || self.here + way == self.here)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall at 0.6: the steps get there to the smallest one, and the end is met exactly where there is none.
    #[test]
    fn steps_double_and_halve_and_end_at_the_end() {
        for (start, end) in [(0.0, 1.0), (1.0, -0.1)] {
            let mut steps = Steps::new(start, end, 0.3, 1e-6);
            while !steps.is_done() {
                assert!(!steps.is_stuck());
                steps.take();
            }
            assert_eq!(steps.here, end);
        }
        let mut steps = Steps::new(0.0, 1.0, 1.0, 1e-6);
        while !steps.is_stuck() {
            if steps.target() <= 0.6 {
                steps.take();
            } else {
                steps.refuse();
            }
        }
        assert!((0.6 - 2e-6..=0.6).contains(&steps.here), "{}", steps.here);
    }
}
