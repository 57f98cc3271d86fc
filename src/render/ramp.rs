//! The shades of one colour under the lights, which a palette must contain.

use super::colour::ToneCurve;
use super::look::{self, ALL_OPEN, Rim, Surroundings};

/// Number of colours of a ramp. Between neighbours the light changes by less than the eye can distinguish in a small
/// area.
const STEPS: usize = 12;

/// Greatest tilt of a surface's normal against the line of sight, towards the key light and away from it, in radians.
const TILT: f64 = 1.4;

/// sRGB colours of a surface of `colour` (sRGB) from its side towards the key light to the one away from it.
pub fn shaded_ramp(colour: [u8; 3], rim: Rim) -> Vec<[u8; 3]> {
    let curve = ToneCurve::shared();
    let around = Surroundings {
        up: [0.0, 1.0, 0.0],
        rim,
    };
    let albedo = curve.decode_rgb(colour);
    let [x, y, _] = look::KEY_DIRECTION.map(f64::from);
    let length = libm::hypot(x, y);
    let steps = (0..STEPS).map(|step| {
        let tilt = TILT * (1.0 - 2.0 * step as f64 / (STEPS - 1) as f64);
        let (sin, cos) = crate::math::sin_cos(tilt);
        let normal = [x / length * sin, y / length * sin, cos].map(|n| n as f32);
        let lit = look::shade_surface(normal, [0.0, 0.0, 1.0], &around, albedo, 0.0, ALL_OPEN);
        lit.map(|c| curve.encode(c))
    });
    steps.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ramp_goes_from_light_to_dark_and_keeps_its_hue() {
        let ramp = shaded_ramp([0xe5, 0x14, 0x1e], Rim::DARK);
        assert_eq!(ramp.len(), STEPS);
        let brightest = ramp.iter().map(|c| c[0]).max();
        assert!(brightest >= Some(0xe5) && ramp[STEPS - 1][0] < 0x90);
        assert!(ramp.iter().all(|[r, g, b]| r > g && r > b));
    }
}
