//! Shared properties of round solids: number of segments, and orientation.

use crate::math::Pose;
use glam::{DMat3, DVec3};

/// Fewest segments around a circle: in a picture of a few pixels an octagon still looks round.
pub const MIN_SEGMENTS: u32 = 8;
/// Most segments around a circle; at 256 the chord error is below 8e-5 of the radius.
pub const MAX_SEGMENTS: u32 = 256;
/// Bits kept of a unit vector's components computed with the platform's sine and cosine, whose last bits differ between
/// platforms. 2^-26 is far below any tessellation error and far above those bits.
const SETTLE: f64 = (1u64 << 26) as f64;

/// Segments around a circle of `radius` so that its chords stay within `tolerance`; a multiple of 4, so
/// that the extreme points along the axes are vertices.
pub fn segment_count(radius: f64, tolerance: f64) -> u32 {
    let share = tolerance / radius;
    if !is_positive(share) {
        return MAX_SEGMENTS;
    }
    let half_angle = libm::acos((1.0 - share).max(0.0));
    let count = (std::f64::consts::PI / half_angle).min(f64::from(MAX_SEGMENTS));
    (count.ceil() as u32)
        .next_multiple_of(4)
        .clamp(MIN_SEGMENTS, MAX_SEGMENTS)
}

/// Whether a number is a valid length: positive and not NaN.
pub fn is_positive(length: f64) -> bool {
    length > 0.0
}

/// A unit vector without the bits that differ between platforms.
pub fn settle_direction(direction: DVec3) -> DVec3 {
    ((direction * SETTLE).round() / SETTLE).normalize_or_zero()
}

/// Rotation whose third column is `axis`; the columns map parry's (z, x, y), because its round shapes have y as their
/// axis.
pub fn upright_frame(axis: DVec3) -> DMat3 {
    Pose::from_z_axis(axis).rotation
}
