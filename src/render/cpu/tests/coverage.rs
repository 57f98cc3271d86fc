//! Which pixels a surface covers, and which surface is seen there.

use super::*;

#[test]
fn a_ball_covers_its_disc() {
    let radius = 20.0;
    let ball = mesh_of(
        &Shape::Sphere {
            centre: DVec3::ZERO,
            radius,
        },
        1e-6,
    );
    // The outline is the regular polygon of the equator.
    let exact = 128.0 * radius * radius * (std::f64::consts::TAU / 256.0).sin();
    let mut seed = 7;
    for (samples, within) in [(16, 1.2), (8, 3.0), (4, 6.0), (2, 9.0), (1, 14.0)] {
        let mut worst = 0.0f64;
        for _ in 0..5 {
            let mut ball_there = instance(0, BLACK);
            let offset = DVec3::new(noise(&mut seed), noise(&mut seed), 0.0);
            ball_there.world_from_mesh = Pose::from_translation(offset);
            let image = draw(
                flat_stage([64, 64], samples, vec![ball.clone()]),
                vec![ball_there],
            );
            let curve = ToneCurve::shared();
            let area: f64 = image
                .pixels()
                .map(|p| 1.0 - f64::from(curve.decode(p.0[0])))
                .sum();
            worst = worst.max((area - exact).abs());
        }
        assert!(worst < within, "{samples} samples: {worst} pixels off");
    }
}

#[test]
fn a_half_covered_pixel_is_half_the_light() {
    // Edges through pixel middles: half of the samples of every pattern but the single one.
    for samples in [2, 4, 8, 16] {
        let left = rectangle([-100.0, -100.0], [0.5, 100.0], 0.0);
        let image = draw(
            flat_stage([8, 8], samples, vec![left]),
            vec![instance(0, BLACK)],
        );
        let row: Vec<u8> = (0..8).map(|x| image.get_pixel(x, 3).0[0]).collect();
        assert_eq!(row, [0, 0, 0, 0, 188, 255, 255, 255], "{samples}");
    }
}

#[test]
fn the_nearer_surface_is_seen_in_any_order() {
    let stage = || {
        let far = rectangle([-9.0, -9.0], [9.0, 9.0], -3.0);
        let near = rectangle([-9.0, -9.0], [9.0, 9.0], 2.0);
        flat_stage([4, 4], 4, vec![far, near])
    };
    let (red, green) = ([200, 0, 0], [0, 180, 0]);
    for order in [[0, 1], [1, 0]] {
        let instances = order.map(|k| instance(k, if k == 0 { red } else { green }));
        let image = draw(stage(), instances.to_vec());
        assert!(image.pixels().all(|p| p.0[..3] == green));
    }
}

#[test]
fn translucent_layers_blend_in_linear_light() {
    let curve = ToneCurve::shared();
    let far = rectangle([-9.0, -9.0], [9.0, 9.0], -3.0);
    let near = rectangle([-9.0, -9.0], [9.0, 9.0], 2.0);
    let (first, second) = ([200, 40, 90], [20, 180, 250]);
    let layer = |mesh, colour, opacity| Instance {
        opacity,
        ..instance(mesh, colour)
    };
    let expected = [0, 1, 2].map(|k| {
        let below = 0.7 * 1.0 + 0.3 * curve.decode(first[k]);
        curve.encode(0.4 * below + 0.6 * curve.decode(second[k]))
    });
    for samples in [1, 2, 4, 8, 16] {
        let layers = [layer(0, first, 0.3), layer(1, second, 0.6)];
        for instances in [layers.to_vec(), layers.iter().rev().cloned().collect()] {
            let stage = flat_stage([5, 5], samples, vec![far.clone(), near.clone()]);
            let image = draw(stage, instances);
            for pixel in image.pixels() {
                for k in 0..3 {
                    assert!(
                        pixel.0[k].abs_diff(expected[k]) <= 1,
                        "{pixel:?} {expected:?}"
                    );
                }
            }
        }
    }
    // What is behind an opaque surface does not show, whatever its opacity.
    let hidden = vec![layer(0, first, 0.5), instance(1, second)];
    let image = draw(flat_stage([5, 5], 4, vec![far, near]), hidden);
    assert!(image.pixels().all(|p| p.0[..3] == second));
}

/// Two veils that cross: on either side of where they meet another one is in front, whatever their order.
#[test]
fn translucent_bodies_may_cross() {
    let curve = ToneCurve::shared();
    let (red, blue) = ([230, 20, 20], [20, 20, 230]);
    let mut slanted = rectangle([-9.0, -9.0], [9.0, 9.0], 0.0);
    for place in &mut slanted.positions {
        place.z = place.x;
    }
    let level = rectangle([-9.0, -9.0], [9.0, 9.0], 0.0);
    let veil = |mesh, colour| Instance {
        opacity: 0.5,
        ..instance(mesh, colour)
    };
    let over = |near: [u8; 3], far: [u8; 3]| {
        [0, 1, 2].map(|k| {
            let below = 0.5 + 0.5 * curve.decode(far[k]);
            curve.encode(0.5 * below + 0.5 * curve.decode(near[k]))
        })
    };
    for samples in [1, 4, 16] {
        for order in [[(0, red), (1, blue)], [(1, blue), (0, red)]] {
            let stage = flat_stage([12, 8], samples, vec![slanted.clone(), level.clone()]);
            let image = draw(stage, order.map(|(mesh, c)| veil(mesh, c)).to_vec());
            for (x, _, pixel) in image.enumerate_pixels() {
                let expected = if x >= 6 {
                    over(red, blue)
                } else {
                    over(blue, red)
                };
                for (found, expected) in pixel.0.iter().zip(expected) {
                    // Two layers, each rounded to the 8 bits of a sample.
                    assert!(found.abs_diff(expected) <= 2, "{x} {pixel:?}");
                }
            }
        }
    }
}

#[test]
fn shared_edges_have_no_cracks_and_no_overlap() {
    let half = ToneCurve::shared().encode(0.5);
    let cases = [
        (sheet(60, 60.0, 1), [90, 70]),
        (sheet(7, 60.0, 2), [90, 70]),
        (sheet(3, 500.0, 3), [90, 70]),
        (sheet(2, 2_000.0, 4), [300, 70]),
        (sheet(2, 30_000.0, 5), [90, 70]),
        (sheet(2, 1e6, 6), [64, 64]),
        (sheet(1, 1e9, 7), [33, 65]),
    ];
    for (mesh, size) in cases {
        for samples in [1, 2, 4, 8, 16] {
            let veil = Instance {
                opacity: 0.5,
                ..instance(0, BLACK)
            };
            let image = draw(flat_stage(size, samples, vec![mesh.clone()]), vec![veil]);
            let wrong = image.pixels().filter(|p| p.0[0] != half).count();
            assert_eq!(wrong, 0, "{} triangles, {samples}", mesh.triangles.len());
        }
    }
}

#[test]
fn a_plane_through_the_eye_is_cut_without_cracks() {
    // The sheet passes under the eye, from far behind it to far in front: all below the horizon is it.
    let mut stage = flat_stage([64, 48], 4, vec![sheet(5, 3000.0, 8)]);
    stage.camera = Camera {
        world_from_camera: Pose::from_translation(DVec3::new(3.0, -4.0, 2.0))
            * Pose::from_axis_rotation(0, std::f64::consts::FRAC_PI_2),
        projection: Projection::Perspective { fov_y: 0.9 },
        near: 0.01,
        far: 1e4,
    };
    let veil = Instance {
        opacity: 0.5,
        ..instance(0, BLACK)
    };
    let image = draw(stage, vec![veil]);
    let half = ToneCurve::shared().encode(0.5);
    for (_, y, pixel) in image.enumerate_pixels() {
        match y {
            0..=22 => assert_eq!(pixel.0[0], 255),
            25.. => assert_eq!(pixel.0[0], half),
            _ => {}
        }
    }
}
