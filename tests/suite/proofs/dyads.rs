//! The formulas of the source on dyads: its printed numbers, and those computed for its mechanism.

use mechanim::analysis::dyads::{TrialOptions, Trials, run_trials};
use mechanim::analysis::tolerance::sorted_quantile;
use mechanim::intervals::Kaucher;
use mechanim::intervals::centre::{tolerable_radius, tolerance_at};
use mechanim::intervals::chain::{Directions, DyadChain};
use mechanim::intervals::dyad::{
    Dyad, conjugate_coefficients, corner_ranges, exact_ranges, j_matrices, naive_ranges,
    printed_ranges, tied_cube,
};
use mechanim::intervals::formal::{Formal, formal_solution, solved_numbers};
use mechanim::intervals::paving::{PavingWindow, pave_projection, pave_section};
use mechanim::intervals::peeling::peel_dyads;
use mechanim::intervals::regular::{determinant, spectral_bound};
use mechanim::intervals::sweep::{Projector, RowSweep, SolvedRow};
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

/// The bars as the source's equations have them.
const BARS: [[usize; 2]; 17] = [
    [7, 8],
    [7, 9],
    [6, 7],
    [6, 4],
    [5, 6],
    [5, 1],
    [4, 5],
    [4, 10],
    [3, 4],
    [3, 10],
    [2, 3],
    [2, 8],
    [1, 2],
    [1, 8],
    [0, 1],
    [0, 5],
    [8, 9],
];

fn chain() -> DyadChain {
    let peeled = peel_dyads(11, &[9, 10], &BARS).unwrap();
    DyadChain {
        points: POINTS.to_vec(),
        velocities: VELOCITIES.to_vec(),
        fixed: vec![9, 10],
        dyads: peeled.dyads,
        lever: peeled.levers[0],
    }
}

fn dyads() -> Vec<Dyad> {
    chain().dyads
}

#[test]
fn the_mechanism_comes_apart_as_the_source_has_it() {
    let wanted = [
        [7, 8, 9],
        [6, 7, 4],
        [5, 6, 1],
        [4, 5, 10],
        [3, 4, 10],
        [2, 3, 8],
        [1, 2, 8],
        [0, 1, 5],
    ];
    let found: Vec<[usize; 3]> = dyads()
        .iter()
        .map(|d| [d.point, d.ends[0], d.ends[1]])
        .collect();
    assert_eq!(found, wanted);
    assert_eq!(chain().lever, [8, 9]);
    assert_eq!(chain().unknowns(), [8, 7, 6, 5, 4, 3, 2, 1]);
    // In any order of the bars, and every bar belongs to one point.
    for turn in 1..17 {
        let mut bars = BARS.to_vec();
        bars.rotate_left(turn);
        assert_eq!(peel_dyads(11, &[9, 10], &bars).unwrap().dyads, dyads());
    }
    let angles = [(0, 143.4877), (2, 6.5266), (5, 90.0)];
    for (place, degrees) in angles {
        let angle = chain().angle(&dyads()[place]) * 180.0 / PI;
        assert!((angle - degrees).abs() < 5e-5, "{place}: {angle}");
    }
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
        let [i1, i2, i3, i4] = exact_ranges(whole, delta).unwrap();
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
    assert_eq!(exact_ranges(whole, degrees(170.0, 190.0)), None);
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
    let unknowns = chain().unknowns();
    let (rows, sides) = chain().velocity_system().unwrap();
    assert!((determinant(&rows).abs() - 8.262062).abs() < 1e-5);
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

#[test]
fn positions_solve_the_conjugate_system_and_not_the_printed_one() {
    let chain = chain();
    let off = |printed: bool| {
        let found = chain.conjugate_positions(printed).unwrap();
        let pairs = found.iter().zip(chain.unknowns());
        let apart = pairs.map(|(p, k)| {
            let [x, y] = [0, 1].map(|i| p[i] - POINTS[k][i]);
            x.hypot(y)
        });
        apart.fold(0.0, f64::max)
    };
    assert!(off(false) < 1e-9, "{}", off(false));
    assert!(off(true) > 10.0, "{}", off(true));
}

/// Numbers from -1 to 1.
fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

#[test]
fn ranges_over_boxes_of_directions_are_exact() {
    // Directions of both bars, and that of the first with the angle to the second.
    ranges_are_reached(corner_ranges, false);
    ranges_are_reached(exact_ranges, true);
}

fn ranges_are_reached(of: fn(Kaucher, Kaucher) -> Option<[Kaucher; 4]>, is_turned: bool) {
    let mut state = 0x5eed;
    for _ in 0..200 {
        let (a, d) = (
            PI * random(&mut state),
            0.5 * PI * (1.1 + random(&mut state)),
        );
        let wide = 0.1 * random(&mut state).abs();
        let turned = if is_turned { d } else { a + d };
        let first = Kaucher::new(a - wide, a + wide);
        let second = Kaucher::new(turned - wide, turned + wide);
        let Some(ranges) = of(first, second) else {
            assert!(d - 2.0 * wide <= 0.0 || d + 2.0 * wide >= PI, "{d} {wide}");
            continue;
        };
        let mut reached = [[f64::INFINITY, f64::NEG_INFINITY]; 4];
        for _ in 0..2000 {
            // Often at an end of both.
            let mut pick = |k: Kaucher| match random(&mut state) {
                x if x < -0.3 => k.lo,
                x if x > 0.3 => k.hi,
                _ => k.middle() + k.radius() * random(&mut state),
            };
            let (p, q) = (pick(first), pick(second));
            let q = if is_turned { p + q } else { q };
            let i = j_matrices([0.0; 2], [[-p.cos(), -p.sin()], [-q.cos(), -q.sin()]]);
            for (k, value) in i.unwrap()[0].iter().enumerate() {
                let slack = 1e-12 * (1.0 + value.abs());
                assert!(*value >= ranges[k].lo - slack && *value <= ranges[k].hi + slack);
                reached[k] = [reached[k][0].min(*value), reached[k][1].max(*value)];
            }
        }
        for (range, [lo, hi]) in ranges.iter().zip(reached) {
            // Extremes within the interval of the direction are met by chance only.
            let slack = 1e-4 * (1.0 + range.magnitude());
            assert!(
                lo - range.lo < slack && range.hi - hi < slack,
                "{range:?} {lo} {hi}"
            );
        }
    }
}

/// The spectral radius of |A⁻¹| times the largest deviations from A, A the matrix of the pose.
fn spectral_about_the_pose(chain: &DyadChain, by: f64) -> f64 {
    let system = chain
        .interval_system(Directions::Near(by), VELOCITIES[0], 0.0)
        .unwrap();
    let (rows, _) = chain.velocity_system().unwrap();
    let inverse = DMatrix::from_fn(16, 16, |i, j| rows[i][j])
        .try_inverse()
        .unwrap();
    let off = |i: usize, j: usize| {
        let a = system.a[i][j];
        (a.hi - rows[i][j]).max(rows[i][j] - a.lo)
    };
    let matrix = inverse.abs() * DMatrix::from_fn(16, 16, off);
    let mut x = DVector::repeat(16, 1.0);
    for _ in 0..500 {
        x = &matrix * x.clone() / x.norm();
    }
    x.norm()
}

#[test]
fn the_interval_system_is_as_regular_as_was_computed() {
    let chain = chain();
    for (degrees, about_pose, about_middle) in [
        (0.1, 0.226, 0.2201),
        (0.2, 0.464, 0.4413),
        (0.5, 1.27, 1.1234),
        (1.0, 3.03, 2.4052),
    ] {
        let by = f64::to_radians(degrees);
        let found = spectral_about_the_pose(&chain, by);
        assert!(
            (found / about_pose - 1.0).abs() < 3e-3,
            "{degrees}: {found}"
        );
        let system = chain.interval_system(Directions::Near(by), VELOCITIES[0], 0.0);
        let found = spectral_bound(&system.unwrap());
        assert!(
            (found / about_middle - 1.0).abs() < 1e-3,
            "{degrees}: {found}"
        );
    }
    // At 5 degrees the review has 54, from corners alone: bars 5-6 and 5-1 can be in line there, and the coefficients have no bound.
    let wide = Directions::Near(f64::to_radians(5.0));
    assert_eq!(chain.interval_system(wide, VELOCITIES[0], 0.0), None);
}

#[test]
fn formal_solutions_are_improper_or_not_found_and_say_so() {
    let chain = chain();
    let side = 0.05 * VELOCITIES[0][0].hypot(VELOCITIES[0][1]);
    for degrees in [0.1, 0.5, 1.0, 2.0] {
        let near = Directions::Near(f64::to_radians(degrees));
        let system = chain.interval_system(near, VELOCITIES[0], side).unwrap();
        for of_a in [false, true] {
            match formal_solution(&system.dual(of_a, false), 1.0) {
                Formal::Solved { improper, .. } => assert!(!improper.is_empty(), "{degrees}"),
                other => assert!(degrees > 1.0, "{degrees}: {other:?}"),
            }
        }
    }
    // The source's own ranges.
    let whole = Directions::Turned(degrees(10.0, 170.0));
    for (of_a, side) in [(false, 0.1), (true, 0.1), (false, 1.0), (true, 0.0)] {
        let system = chain.interval_system(whole, VELOCITIES[0], side).unwrap();
        let found = formal_solution(&system.dual(of_a, false), 1.0);
        assert_eq!(found, Formal::Singular { steps: 0 });
    }
}

#[test]
fn cubes_about_the_centre_are_as_large_as_was_computed() {
    let chain = chain();
    let side = 0.05 * VELOCITIES[0][0].hypot(VELOCITIES[0][1]);
    let centre: Vec<f64> = chain
        .unknowns()
        .into_iter()
        .flat_map(|k| VELOCITIES[k])
        .collect();
    for (degrees, wanted) in [(1e-4, 0.0370), (1e-3, 0.030)] {
        let near = Directions::Near(f64::to_radians(degrees));
        let system = chain.interval_system(near, VELOCITIES[0], side).unwrap();
        let found = tolerable_radius(&system, &centre);
        assert!((found / wanted - 1.0).abs() < 0.02, "{degrees}: {found}");
    }
    let near = Directions::Near(f64::to_radians(0.01));
    let system = chain.interval_system(near, VELOCITIES[0], side).unwrap();
    assert!(tolerance_at(&system, &centre) < 0.0);
    let whole = Directions::Turned(degrees(10.0, 170.0));
    let system = chain.interval_system(whole, [0.0; 2], 0.1).unwrap();
    let found = tolerable_radius(&system, &[0.0; 16]);
    assert!((found - 0.00521).abs() < 5e-6, "{found}");
}

/// The sweep along the row against the dense system, for random directions of all bars.
#[test]
fn trials_solve_the_same_system_as_elimination() {
    let chain = chain();
    let sweep = RowSweep::new(&chain).unwrap();
    let mut state = 0x7a1e;
    let (mut places, mut swept) = (Vec::new(), SolvedRow::default());
    let mut ratio = None;
    for _ in 0..200 {
        let mut projectors = Vec::new();
        let mut matrices = Vec::new();
        for _ in 0..8 {
            let (a, d) = (
                PI * random(&mut state),
                0.5 * PI * (1.0 + 0.8 * random(&mut state)),
            );
            let (s12, c12) = a.sin_cos();
            let (s13, c13) = (a + d).sin_cos();
            projectors.push(Projector {
                reads: [c12, s12],
                moves: [s13 / d.sin(), -c13 / d.sin()],
            });
            matrices.push(j_matrices([0.0; 2], [[-c12, -s12], [-c13, -s13]]).unwrap());
        }
        let mut values = vec![[0.0; 2]; 11];
        values[0] = [1.0, 0.5];
        let (rows, sides) = mechanim::intervals::dyad::dyad_system(
            &matrices,
            &chain.dyads,
            &chain.unknowns(),
            &values,
        );
        assert!(sweep.solve(&projectors, &values, &mut places, &mut swept));
        let solution = solved_numbers(&rows, &sides).unwrap();
        for (pair, point) in solution.chunks_exact(2).zip(chain.unknowns()) {
            for (a, b) in pair.iter().zip(swept.values[point]) {
                assert!((a - b).abs() < 1e-7 * (1.0 + a.abs()), "{a} {b}");
            }
        }
        let here = (determinant(&rows) / swept.determinant).signum();
        assert_eq!(*ratio.get_or_insert(here), here);
    }
}

#[test]
fn quantiles_of_trials_settle_and_do_not_depend_on_threads() {
    let asked = |count, threads| TrialOptions {
        directions: Directions::Turned(degrees(10.0, 170.0)),
        given: [1.0, 0.5],
        count,
        seed: 7,
        threads,
    };
    let trials = run_trials(&chain(), &asked(200_000, 2)).unwrap();
    for (speed, share) in [(2.0, 0.41), (5.0, 0.72), (10.0, 0.85), (50.0, 0.97)] {
        let found = trials.share_below(speed * 1.25_f64.sqrt());
        assert!((found - share).abs() < 0.01, "{speed}: {found}");
    }
    let sign = trials.same_sign.max(1.0 - trials.same_sign);
    assert!((sign - 0.56).abs() < 0.01, "{sign}");
    let few = run_trials(&chain(), &asked(5000, 1)).unwrap();
    assert_eq!(few, run_trials(&chain(), &asked(5000, 2)).unwrap());
    // Quantiles of few are those of many, largest values are not.
    let middle = |t: &Trials| sorted_quantile(&t.speeds, 0.5);
    assert!((middle(&few) / middle(&trials) - 1.0).abs() < 0.1);
    assert!(trials.speeds.last().unwrap() > &(5.0 * few.speeds.last().unwrap()));
}

/// A point with two fixed ends: it may be in exactly one of two circles, whose area is known.
#[test]
fn one_dyad_is_paved_as_two_circles_less_what_they_share() {
    let ends = [[0.0, 0.0], [2.0, 0.0]];
    let least = f64::to_radians(40.0);
    let chain = DyadChain {
        points: vec![[1.0, 0.1], ends[0], ends[1]],
        velocities: vec![[0.0; 2]; 3],
        fixed: vec![1, 2],
        dyads: vec![Dyad {
            point: 0,
            ends: [1, 2],
        }],
        lever: [0, 1],
    };
    let window = PavingWindow {
        least,
        reach: 5.0,
        halvings: 9,
    };
    let paving = pave_section(&chain, 0, window);
    // Radius 1 / sin, centres 1 / tan off the line.
    let (radius, off) = (1.0 / least.sin(), 1.0 / least.tan());
    let common = 2.0 * radius * radius * least - 2.0 * off;
    let area = 2.0 * (PI * radius * radius - common);
    let whole = 4.0 * window.reach * window.reach;
    let [inner, edge] = paving.shares().map(|share| share * whole);
    assert!(
        inner <= area && area <= inner + edge,
        "{inner} {area} {edge}"
    );
    assert!(edge < 0.2 * area, "{edge}");
    let mut state = 0xced1;
    for cell in paving.inner.iter().step_by(7) {
        let at = [0, 1].map(|i| cell.middle[i] + cell.half * random(&mut state));
        let inside = [off, -off].map(|y| (at[0] - 1.0).hypot(at[1] - y) <= radius);
        assert!(inside[0] != inside[1], "{cell:?}");
    }
    // With nothing else that moves the projection is the section.
    let projection = pave_projection(&chain, 0, window, 3, || random(&mut state));
    assert_eq!(projection, paving);
}

/// Places that keep all angles are never outside of a paved projection, and its inside has a place of the others for each.
#[test]
fn pavings_of_the_mechanism_hold_what_keeps_its_angles() {
    let chain = chain();
    let window = PavingWindow {
        least: f64::to_radians(5.0),
        reach: 12.0,
        halvings: 5,
    };
    let mut state = 0xbeef;
    let point = 5;
    let section = pave_section(&chain, point, window);
    let projection = pave_projection(&chain, point, window, 100, || random(&mut state));
    assert!(section.shares()[0] > 0.3 && projection.shares()[0] > section.shares()[0]);
    let apart = |points: &[[f64; 2]]| {
        let moved = DyadChain {
            points: points.to_vec(),
            ..chain.clone()
        };
        let angles = chain.dyads.iter().map(|d| moved.angle(d));
        angles.map(|a| a.min(PI - a)).fold(f64::INFINITY, f64::min)
    };
    let holds = |list: &[mechanim::intervals::paving::PavedSquare], p: [f64; 2]| {
        let inside = |i: usize, c: &mechanim::intervals::paving::PavedSquare| {
            (p[i] - c.middle[i]).abs() <= c.half * (1.0 + 1e-12)
        };
        list.iter().any(|c| inside(0, c) && inside(1, c))
    };
    let (mut kept, mut seen) = (0, 0);
    for _ in 0..4000 {
        let mut points = chain.points.clone();
        points[point] = [0, 1].map(|i| POINTS[point][i] + window.reach * random(&mut state));
        let alone = apart(&points) >= window.least;
        let known = holds(&section.inner, points[point]);
        assert!(!known || alone, "{:?}", points[point]);
        assert!(!alone || known || holds(&section.edge, points[point]));
        kept += usize::from(alone);
        for k in (0..9).filter(|k| *k != point) {
            points[k] = [0, 1].map(|i| POINTS[k][i] + window.reach * random(&mut state));
        }
        if apart(&points) >= window.least {
            let at = points[point];
            assert!(
                holds(&projection.inner, at) || holds(&projection.edge, at),
                "{at:?}"
            );
            seen += 1;
        }
    }
    assert!(kept > 1000 && seen > 100, "{kept} {seen}");
}
