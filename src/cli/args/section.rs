//! The plane of `--section` and the factor of `--explode`.

use crate::model::section::{MOST_EXPLODED, SectionPlane};
use glam::DVec3;

/// `x=10`, `-x=10` or `0,0,10/0,1,1`.
pub fn section_plane(text: &str) -> Result<SectionPlane, String> {
    let wrong = || "write x=10, -x=10 or POINT/NORMAL, for example 0,0,10/0,1,1".to_owned();
    let plane = match text.split_once('/') {
        Some((point, normal)) => {
            let [point, normal] = [point, normal].map(three_numbers);
            SectionPlane::new(point.ok_or_else(wrong)?, normal.ok_or_else(wrong)?)
        }
        None => {
            let (axis, place) = text.split_once('=').ok_or_else(wrong)?;
            let (sign, axis) = match axis.trim().strip_prefix('-') {
                Some(axis) => (-1.0, axis),
                None => (1.0, axis),
            };
            let axes = ["x", "y", "z"].into_iter().zip(DVec3::AXES);
            let axis = axes.into_iter().find(|(name, _)| *name == axis.trim());
            let (_, axis) = axis.ok_or_else(wrong)?;
            let place: f64 = place.trim().parse().map_err(|_| wrong())?;
            SectionPlane::new(axis * place, axis * sign)
        }
    };
    plane.ok_or_else(|| "a plane needs finite numbers, and a normal with a direction".to_owned())
}

fn three_numbers(text: &str) -> Option<DVec3> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|part| part.trim().parse()).collect();
    <[f64; 3]>::try_from(numbers.ok()?).ok().map(DVec3::from)
}

/// How far bodies are moved apart.
pub fn explosion_factor(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(factor) if (0.0..=MOST_EXPLODED).contains(&factor) => Ok(factor),
        _ => Err(format!("between 0 and {MOST_EXPLODED}")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn planes_are_written_in_two_ways() {
        for (text, point, normal) in [
            ("x=10", DVec3::X * 10.0, DVec3::X),
            ("-y = -2.5", DVec3::Y * -2.5, DVec3::NEG_Y),
            ("1,2,3/0,0,-9", DVec3::new(1.0, 2.0, 3.0), DVec3::NEG_Z),
            ("0,0,0/0,1e-300,0", DVec3::ZERO, DVec3::Y),
        ] {
            let plane = section_plane(text).unwrap();
            assert_eq!((plane.point, plane.normal), (point, normal), "{text}");
        }
        for text in [
            "",
            "x",
            "w=1",
            "x=",
            "x=nan",
            "1,2/0,0,1",
            "0,0,0/0,0,0",
            "x=inf",
        ] {
            assert!(section_plane(text).is_err(), "{text}");
        }
    }
}
