//! Default colours of bodies, chosen so that they can be distinguished, also without full colour vision.

/// sRGB, in the order in which they are given out.
pub const BODIES: [[u8; 3]; 8] = [
    [0x2f, 0x6d, 0xb3],
    [0xe0, 0x7b, 0x10],
    [0x8f, 0xb7, 0x5f],
    [0xc8, 0x39, 0x2f],
    [0x7a, 0x3f, 0x86],
    [0x8f, 0xd0, 0xcf],
    [0xe8, 0xc3, 0x3c],
    [0x7b, 0x84, 0x94],
];

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::model::theme::Theme;
    use crate::render::colour::ToneCurve;
    use crate::scene::{Overrides, builtin, load_scene};

    /// Least distance in Oklab of two bodies' colours, for any eye below; a just noticeable difference is about 0.02.
    const LEAST: f64 = 0.06;

    /// What eyes without one kind of cone see of linear red, green and blue: Machado, Oliveira and Fernandes, A
    /// physiologically-based model for simulation of color vision deficiency (IEEE TVCG 15, 2009), severity 1; the
    /// first are full colour vision.
    const EYES: [(&str, [[f64; 3]; 3]); 4] = [
        (
            "all cones",
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        ),
        (
            "protanopia",
            [
                [0.152286, 1.052583, -0.204868],
                [0.114503, 0.786281, 0.099216],
                [-0.003882, -0.048116, 1.051998],
            ],
        ),
        (
            "deuteranopia",
            [
                [0.367322, 0.860646, -0.227968],
                [0.280085, 0.672501, 0.047413],
                [-0.011820, 0.042940, 0.968881],
            ],
        ),
        (
            "tritanopia",
            [
                [1.255528, -0.076749, -0.178779],
                [-0.078411, 0.930809, 0.147602],
                [0.004733, 0.691367, 0.303900],
            ],
        ),
    ];

    fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
    }

    /// Oklab (Ottosson, 2020) of linear sRGB.
    fn oklab(linear: [f64; 3]) -> [f64; 3] {
        let cones = times(
            &[
                [0.4122214708, 0.5363325363, 0.0514459929],
                [0.2119034982, 0.6806995451, 0.1073969566],
                [0.0883024619, 0.2817188376, 0.6299787005],
            ],
            linear.map(|c| c.clamp(0.0, 1.0)),
        );
        times(
            &[
                [0.2104542553, 0.7936177850, -0.0040720468],
                [1.9779984951, -2.4285922050, 0.4505937099],
                [0.0259040371, 0.7827717662, -0.8086757660],
            ],
            cones.map(f64::cbrt),
        )
    }

    /// Perceived distance of two sRGB colours.
    fn distance(eye: &[[f64; 3]; 3], a: [u8; 3], b: [u8; 3]) -> f64 {
        let seen = |c: [u8; 3]| oklab(times(eye, ToneCurve::shared().decode_rgb(c).map(f64::from)));
        let (a, b) = (seen(a), seen(b));
        (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
    }

    /// The two nearest different colours for the eye that distinguishes them least.
    fn nearest(colours: &[[u8; 3]]) -> (f64, String) {
        let mut least = (f64::INFINITY, String::new());
        for (name, eye) in &EYES {
            for (k, a) in colours.iter().enumerate() {
                for b in colours[..k].iter().filter(|b| *b != a) {
                    let apart = distance(eye, *a, *b);
                    if apart < least.0 {
                        least = (apart, format!("{a:02x?} {b:02x?} {name}"));
                    }
                }
            }
        }
        least
    }

    #[test]
    fn colours_of_bodies_are_told_apart_by_every_eye() {
        let (apart, which) = nearest(&BODIES);
        assert!(apart >= LEAST, "{which}: {apart:.3}");
        for theme in [Theme::Light, Theme::Dark] {
            for (colour, (name, eye)) in
                BODIES.iter().flat_map(|c| EYES.iter().map(move |e| (c, e)))
            {
                let apart = distance(eye, *colour, theme.background());
                assert!(
                    apart >= 2.0 * LEAST,
                    "{colour:02x?} on {theme:?}, {name}: {apart:.3}"
                );
            }
        }
    }

    #[test]
    fn bodies_of_the_built_in_scenes_are_told_apart_by_every_eye() {
        for name in builtin::ALL.map(|scene| scene.name) {
            let scene =
                load_scene(&builtin::find_builtin(name).unwrap(), &Overrides::default()).unwrap();
            let bodies = scene.mechanism.bodies.iter();
            // A body's own colour is that of its first solid.
            let colours = bodies.filter_map(|body| Some(body.shapes.first()?.colour));
            let (apart, which) = nearest(&colours.collect::<Vec<_>>());
            assert!(apart >= LEAST, "{name}: {which}: {apart:.3}");
        }
    }
}
