//! Step control from one value to another: steps double after an accepted step and halve after a rejected
//! one.

use std::cell::Cell;
use std::rc::Rc;

/// Initial and largest budget of steps: a hundred thousand turns from one sample to the next.
const MOST_STEPS: usize = 2_000_000;

/// Steps added for every sample: many times what one needs, so that a motion as a whole is bounded, however many samples
/// it has.
const STEPS_OF_SAMPLE: usize = 1_000;

/// Steps added for every radian that an input turns between two samples: three times what a crank needs.
const STEPS_OF_RADIAN: f64 = 20.0;

/// How often the turns of a motion may refill its budget: some two hundred thousand turns in all, about ten seconds for a
/// small mechanism.
const REFILLS_BY_TURNS: usize = 2;

/// The same two numbers for mechanisms whose steps are so expensive that they would take hours.
const FEWEST_STEPS: usize = 500;
const FEWEST_OF_SAMPLE: usize = 50;

/// The number of steps that a motion may still take, in either direction and for any purpose: it bounds the run time.
#[derive(Clone, Debug)]
pub struct StepBudget {
    left: Rc<Cell<usize>>,
    /// Steps taken so far.
    taken: Rc<Cell<usize>>,
    /// What turns may still add.
    by_turns: Rc<Cell<usize>>,
    most: usize,
    of_sample: usize,
}

impl StepBudget {
    /// For steps that each cost as much as `cost` steps of a small mechanism.
    pub fn of_cost(cost: usize) -> Self {
        let most = (MOST_STEPS / cost.max(1)).max(FEWEST_STEPS);
        Self {
            left: Rc::new(Cell::new(most)),
            taken: Rc::default(),
            by_turns: Rc::new(Cell::new(REFILLS_BY_TURNS * most)),
            most,
            of_sample: (STEPS_OF_SAMPLE / cost.max(1)).max(FEWEST_OF_SAMPLE),
        }
    }

    /// So many steps and no more, however many samples there are.
    pub fn of_steps(most: usize) -> Self {
        Self {
            left: Rc::new(Cell::new(most)),
            taken: Rc::default(),
            by_turns: Rc::default(),
            most,
            of_sample: 0,
        }
    }

    /// Steps taken so far.
    pub fn taken(&self) -> usize {
        self.taken.get()
    }

    /// Takes one, if there is one.
    pub fn take(&self) -> bool {
        self.take_all(1)
    }

    /// Takes `count` steps if there are that many; otherwise the rest of the budget is spent.
    pub fn take_all(&self, count: usize) -> bool {
        let left = self.left.get();
        self.left.set(left.saturating_sub(count));
        self.taken.set(self.taken.get() + count.min(left));
        left >= count
    }

    /// Spends what is left if so many steps are more than that.
    pub fn spend_if_short(&self, least: f64) {
        if least > self.left.get() as f64 {
            self.left.set(0);
        }
    }

    /// Whether none is left.
    pub fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    /// Adds those of another sample, before which an input turns by so many radians; they are asked for only if it matters.
    pub fn refill(&self, turned: impl FnOnce() -> f64) {
        let left = self.left.get() + self.of_sample;
        let missing = self.most.saturating_sub(left);
        let of_turns = match missing {
            0 => 0,
            _ => (STEPS_OF_RADIAN * turned()) as usize,
        };
        let of_turns = of_turns.min(missing).min(self.by_turns.get());
        self.by_turns.set(self.by_turns.get() - of_turns);
        self.left.set((left + of_turns).min(self.most));
    }
}

/// Steps from one value to another: the progress and the next step.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    /// The progress.
    pub here: f64,
    end: f64,
    step: f64,
    smallest: f64,
}

impl Steps {
    /// From `start` to `end`, in either direction; steps below `smallest` are given up.
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

    /// What scouts take is gone for their tracker, too, and samples do not pile steps up.
    #[test]
    fn a_budget_is_shared_and_bounded() {
        let budget = StepBudget::of_cost(1);
        let scout = budget.clone();
        for _ in 0..3 {
            budget.refill(|| 0.0);
        }
        assert_eq!(
            (0..2 * MOST_STEPS).filter(|_| scout.take()).count(),
            MOST_STEPS
        );
        assert!(budget.is_spent());
        budget.refill(|| 0.0);
        assert_eq!(
            (0..MOST_STEPS).filter(|_| budget.take()).count(),
            STEPS_OF_SAMPLE
        );
        // Turns need steps; no number of them brings more than there are at first.
        for (turned, steps) in [
            (1e3, 21_000),
            (f64::INFINITY, MOST_STEPS),
            (f64::NAN, STEPS_OF_SAMPLE),
        ] {
            budget.refill(|| turned);
            assert_eq!((0..2 * MOST_STEPS).filter(|_| budget.take()).count(), steps);
        }
    }

    /// However many samples are far apart: turns fill up so often, and no more.
    #[test]
    fn turns_are_bounded_in_all() {
        let budget = StepBudget::of_cost(1);
        let mut taken = 0;
        for _ in 0..50 {
            taken += (0..2 * MOST_STEPS).filter(|_| budget.take()).count();
            budget.refill(|| f64::INFINITY);
        }
        assert!(taken > REFILLS_BY_TURNS * MOST_STEPS);
        assert!(taken <= (1 + REFILLS_BY_TURNS) * MOST_STEPS + 50 * STEPS_OF_SAMPLE);
    }

    /// Dear steps are fewer, and what costs more than is left takes all.
    #[test]
    fn dear_steps_are_fewer() {
        let budget = StepBudget::of_cost(usize::MAX);
        assert!(budget.take_all(FEWEST_STEPS - 1));
        assert!(!budget.take_all(2));
        assert!(budget.is_spent());
        budget.refill(|| 0.0);
        assert_eq!(
            (0..MOST_STEPS).filter(|_| budget.take()).count(),
            FEWEST_OF_SAMPLE
        );
    }

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
