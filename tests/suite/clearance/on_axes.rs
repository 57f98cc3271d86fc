//! A ball on the axis of a round solid: all ways out are as short, and the one that is told leads out square to the axis.

use crate::draws::Draws;
use glam::DVec3;
use mechanim::distance::mesh_tree::MeshTrees;
use mechanim::distance::pair::signed_distance;
use mechanim::distance::primitive::{Element, shape_elements};
use mechanim::math::Pose;
use mechanim::model::shape::{Shape, Solid};

/// How well points and normals are known.
const KNOWN: f64 = 1e-9;

fn element(solid: Solid) -> Element {
    let shape = Shape {
        solid,
        body_from_shape: Pose::IDENTITY,
        colour: [0; 3],
        opacity: 1.0,
    };
    shape_elements(&[shape], &mut MeshTrees::default()).remove(0)
}

/// Axes are unit vectors to rounding only, so that what is left of a way along them may be anything.
#[test]
fn the_way_out_from_an_axis_is_square_to_it() {
    let mut draws = Draws(5);
    let (radius, ball, ring) = (0.3, 0.05, 0.8);
    for round in 0..3000 {
        let any = DVec3::from_array([(); 3].map(|()| draws.number()));
        let axis = if round % 2 == 0 {
            any.normalize()
        } else {
            DVec3::AXES[round / 2 % 3]
        };
        let half = 1.0 + 4.0 * draws.share();
        let centre = axis * (draws.number() * (half - 2.0 * radius));
        let (from, to) = (-axis * half, axis * half);
        let sphere = element(Solid::Sphere {
            centre,
            radius: ball,
        });
        let cylinder = element(Solid::Cylinder { from, to, radius });
        let cone = element(Solid::Cone {
            from,
            to,
            radius_from: radius,
            radius_to: 0.5 * radius,
        });
        let torus = element(Solid::Torus {
            centre,
            axis,
            ring,
            tube: 0.1,
        });
        for (solid, name) in [(&cylinder, "cylinder"), (&cone, "cone"), (&torus, "torus")] {
            let found = signed_distance(solid, &sphere);
            let told = format!("{name} along {axis:?}: {found:?}");
            let [on, other] = found.points;
            // From the one point to the other along the normal, which is a unit vector.
            assert!((found.normal.length() - 1.0).abs() < KNOWN, "{told}");
            let way = other - on - found.normal * found.distance;
            assert!(way.length() < KNOWN, "{told}");
            let off_axis = (on - axis * on.dot(axis)).length();
            let slope = found.normal.dot(axis);
            match name {
                "cylinder" => {
                    assert!((found.distance + radius + ball).abs() < KNOWN, "{told}");
                    assert!(
                        (off_axis - radius).abs() < KNOWN && slope.abs() < KNOWN,
                        "{told}"
                    );
                }
                "cone" => {
                    let lean = 0.25 * radius / half;
                    assert!((slope - lean / lean.hypot(1.0)).abs() < KNOWN, "{told}");
                }
                _ => assert!(
                    (found.distance - (ring - 0.1 - ball)).abs() < KNOWN,
                    "{told}"
                ),
            }
        }
    }
}
