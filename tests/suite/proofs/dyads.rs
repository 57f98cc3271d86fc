//! The formulas of the source on dyads: its printed numbers, and those computed for its mechanism.

use mechanim::intervals::Kaucher;
use mechanim::intervals::dyad::{
    Dyad, conjugate_coefficients, exact_ranges, j_matrices, naive_ranges, printed_ranges,
    tied_cube, velocity_system,
};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;

/// Points 0 to 10 of the mechanism at the start; 9 and 10 are fixed.
const POINTS: [[f64; 2]; 11] = [
    [185.0, 180.0],
    [130.0, 205.0],
    [15.0, 120.0],
    [-15.0, 30.0],
    [-35.0, -35.0],
    [120.0, 10.0],
    [100.0, -110.0],
    [255.0, -100.0],
    [210.0, 55.0],
    [305.0, 35.0],
    [0.0, 0.0],
];

/// Their velocities for a crank that turns by one radian a second.
const VELOCITIES: [[f64; 2]; 11] = [
    [1.427881086484795, -15.219787068799338],
    [-3.1757142707092547, -25.347696854626246],
    [-4.554938928170707, -23.481687023943103],
    [-30.000000000000007, -15.000000000000004],
    [35.0, -35.0],
    [32.73232951540435, -27.189134997503874],
    [38.77945080765942, -28.196988546213056],
    [37.8650709235195, -14.024100342044258],
    [-5.609640136817703, -26.645790649884088],
    [0.0, 0.0],
    [0.0, 0.0],
];

fn dyads() -> Vec<Dyad> {
    let list = [
        (7, [8, 9]),
        (6, [7, 4]),
        (5, [6, 1]),
        (4, [5, 10]),
        (3, [4, 10]),
        (2, [3, 8]),
        (1, [2, 8]),
        (0, [1, 5]),
    ];
    list.map(|(point, ends)| Dyad { point, ends }).to_vec()
}

fn degrees(lo: f64, hi: f64) -> Kaucher {
    Kaucher::new(lo * PI / 180.0, hi * PI / 180.0)
}

#[test]
fn the_printed_ranges_are_exact_and_interval_arithmetic_is_wider() {
    let whole = degrees(0.0, 360.0);
    for (delta, one, two) in [
        (
            [10.0, 170.0],
            [-2.379385241572, 3.379385241572],
            5.715026151381,
        ),
        (
            [190.0, 350.0],
            [-2.379385241572, 3.379385241572],
            5.715026151381,
        ),
        ([30.0, 150.0], [-0.5, 1.5], 1.866025403784),
        (
            [45.0, 135.0],
            [-0.207106781187, 1.207106781187],
            1.207106781187,
        ),
        (
            [5.0, 175.0],
            [-5.236856622835, 6.236856622835],
            11.451882774216,
        ),
    ] {
        let delta = degrees(delta[0], delta[1]);
        let [i1, i2, i3, i4] = exact_ranges(delta).unwrap();
        for (found, wanted) in [(i1, one), (i4, one), (i2, [-two, two]), (i3, [-two, two])] {
            assert!((found.lo - wanted[0]).abs() < 1e-11, "{found:?} {wanted:?}");
            assert!((found.hi - wanted[1]).abs() < 1e-11, "{found:?} {wanted:?}");
        }
        let naive = naive_ranges(whole, delta).unwrap();
        for (wide, exact) in naive.iter().zip([i1, i2, i3, i4]) {
            assert!(exact.is_in(*wide), "{exact:?} {wide:?}");
        }
    }
    let naive = naive_ranges(whole, degrees(10.0, 170.0)).unwrap();
    assert!(
        naive.iter().all(|k| (k.hi - 5.758770483144).abs() < 1e-9),
        "{naive:?}"
    );
    // As printed, with tangents: nothing at all.
    assert_eq!(
        printed_ranges(whole, degrees(10.0, 170.0)).lo,
        f64::NEG_INFINITY
    );
    assert_eq!(exact_ranges(degrees(170.0, 190.0)), None);
}

#[test]
fn matrices_are_projectors_and_their_conjugates_are_those_of_the_velocity_polygon() {
    for (place, wanted) in [
        (0, [0.43942134, -1.51356239, -0.16274864, 0.56057866]),
        (2, [1.44444444, 8.66666667, -0.07407407, -0.44444444]),
        (5, [0.1, 0.3, 0.3, 0.9]),
    ] {
        let dyad = dyads()[place];
        let far = dyad.ends.map(|k| POINTS[k]);
        let [first, second] = j_matrices(POINTS[dyad.point], far).unwrap();
        for (a, b) in first.iter().zip(wanted) {
            assert!((a - b).abs() < 5e-9, "{first:?} {wanted:?}");
        }
        let [a, b, c, d] = first;
        assert!((a + d - 1.0).abs() < 1e-15 && (a * d - b * c).abs() < 1e-14);
        let unit = [1.0, 0.0, 0.0, 1.0];
        assert!((0..4).all(|k| (first[k] + second[k] - unit[k]).abs() < 1e-14));
        // Bars turned by a quarter: what positions have.
        let turned = |p: [f64; 2]| [-p[1], p[0]];
        let [quarter, _] = j_matrices(turned(POINTS[dyad.point]), far.map(turned)).unwrap();
        let conjugate = conjugate_coefficients(first);
        assert!(
            (0..4).all(|k| (quarter[k] - conjugate[k]).abs() < 1e-14),
            "{quarter:?} {conjugate:?}"
        );
    }
    assert_eq!(j_matrices([1.0, 0.0], [[0.0, 0.0], [3.0, 0.0]]), None);
}

#[test]
fn the_system_of_the_table_has_columns_from_8_to_1() {
    let unknowns = [8, 7, 6, 5, 4, 3, 2, 1];
    let (rows, sides) = velocity_system(&POINTS, &dyads(), &unknowns, (0, VELOCITIES[0])).unwrap();
    let matrix = DMatrix::from_fn(16, 16, |i, j| rows[i][j]);
    let side = DVector::from_vec(sides);
    let singular = matrix.singular_values();
    assert!((singular.max() / singular.min() - 144.7429).abs() < 1e-3);
    assert!((matrix.determinant().abs() - 8.262062).abs() < 1e-5);
    let found = matrix.lu().solve(&side).unwrap();
    for (k, point) in unknowns.iter().enumerate() {
        for axis in 0..2 {
            let off = (found[2 * k + axis] - VELOCITIES[*point][axis]).abs();
            assert!(off < 1e-12, "v{point}: {off:e}");
        }
    }
}

#[test]
fn cubes_of_tied_velocities_are_certified() {
    for (least, wanted) in [
        (1.0, 0.2322129),
        (2.0, 0.1866301),
        (3.0, 0.1427376),
        (5.0, 0.0596197),
        (6.0, 0.0202142),
    ] {
        let found = tied_cube(&VELOCITIES, &[0, 9, 10], &dyads(), f64::to_radians(least));
        assert!((found - wanted).abs() < 1e-6, "{least}: {found}");
    }
    // Bars 5-6 and 5-1 are 6.53 degrees apart.
    assert_eq!(
        tied_cube(&VELOCITIES, &[0, 9, 10], &dyads(), f64::to_radians(10.0)),
        0.0
    );
}
