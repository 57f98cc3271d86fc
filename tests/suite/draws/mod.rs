//! Random numbers that are the same at every run.

/// A linear congruential generator, which starts from its seed; the high bits are given out.
pub struct Draws(pub u64);

impl Draws {
    /// A number in -1..1.
    pub fn number(&mut self) -> f64 {
        2.0 * self.share() - 1.0
    }

    /// A number in 0..1.
    pub fn share(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A whole number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        (self.share() * count as f64) as usize % count
    }
}
