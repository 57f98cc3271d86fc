//! Interval linear systems: the test systems of the literature, every number of them.

use mechanim::intervals::auxiliary::{AuxiliaryPlan, auxiliary_solutions};
use mechanim::intervals::centre::{best_centre, centre_radius, tolerance_at};
use mechanim::intervals::formal::{Formal, formal_solution};
use mechanim::intervals::hull::{SolutionHull, solution_hull};
use mechanim::intervals::regular::{positive_share, spectral_bound};
use mechanim::intervals::system::{SolutionSet, SystemError, TernaryAnswer};
use mechanim::intervals::{IntervalSystem, Kaucher, Quantifier};

type Ends = [f64; 2];

fn system(a: &[&[Ends]], b: &[Ends]) -> IntervalSystem {
    let rows: Vec<Vec<Ends>> = a.iter().map(|row| row.to_vec()).collect();
    IntervalSystem::any(&rows, b).unwrap()
}

/// Barth and Nuding.
fn s1() -> IntervalSystem {
    system(
        &[&[[2.0, 4.0], [-2.0, 1.0]], &[[-1.0, 2.0], [2.0, 4.0]]],
        &[[-2.0, 2.0]; 2],
    )
}

/// Hansen.
fn s2() -> IntervalSystem {
    let a = [[[2.0, 3.0], [0.0, 1.0]], [[1.0, 2.0], [2.0, 3.0]]];
    system(&[&a[0], &a[1]], &[[0.0, 120.0], [60.0, 240.0]])
}

fn s3() -> IntervalSystem {
    IntervalSystem {
        b: vec![Kaucher::new(0.0, 9.0), Kaucher::new(2.0, 12.0)],
        ..s2()
    }
}

/// Neumaier.
fn s4(diagonal: f64) -> IntervalSystem {
    let row = |i: usize| -> Vec<Ends> {
        let entry = |j: usize| if i == j { [diagonal; 2] } else { [0.0, 2.0] };
        (0..3).map(entry).collect()
    };
    let rows: Vec<Vec<Ends>> = (0..3).map(row).collect();
    IntervalSystem::new(&rows, &[[-1.0, 1.0]; 3]).unwrap()
}

fn s5() -> IntervalSystem {
    let a = [[[2.0, 4.0], [-1.0, 1.0]], [[-1.0, 1.0], [2.0, 4.0]]];
    system(&[&a[0], &a[1]], &[[3.0, 3.5]; 2])
}

fn near(found: &[Kaucher], wanted: &[Ends], tolerance: f64) {
    assert_eq!(found.len(), wanted.len());
    for (k, [lo, hi]) in found.iter().zip(wanted) {
        let off = (k.lo - lo).abs().max((k.hi - hi).abs());
        assert!(off <= tolerance, "{found:?} against {wanted:?}");
    }
}

fn hull_is(system: &IntervalSystem, kind: &SolutionSet, wanted: &[Ends]) {
    match solution_hull(system, kind) {
        SolutionHull::Box(found) => near(&found, wanted, 1e-9),
        other => panic!("{kind:?}: {other:?}"),
    }
}

#[test]
fn hulls_of_all_kinds_are_those_of_the_literature() {
    let (united, tolerable, controllable) = (
        SolutionSet::United,
        SolutionSet::Tolerable,
        SolutionSet::Controllable,
    );
    hull_is(&s1(), &united, &[[-4.0, 4.0]; 2]);
    hull_is(&s1(), &tolerable, &[[-0.5, 0.5]; 2]);
    assert_eq!(solution_hull(&s1(), &controllable), SolutionHull::Empty);
    hull_is(&s2(), &united, &[[-120.0, 90.0], [-60.0, 240.0]]);
    hull_is(&s2(), &tolerable, &[[0.0, 36.0], [12.0, 80.0]]);
    hull_is(&s3(), &united, &[[-6.0, 8.0], [-7.0, 12.0]]);
    hull_is(&s3(), &tolerable, &[[0.0, 3.0], [-1.0 / 3.0, 4.0]]);
    hull_is(&s4(3.5), &united, &[[-30.0 / 17.0, 30.0 / 17.0]; 3]);
    hull_is(
        &s4(6.0),
        &united,
        &[[-0.357142857142857, 0.357142857142857]; 3],
    );
    hull_is(&s5(), &united, &[[5.0 / 18.0, 3.5]; 2]);
    hull_is(&s5(), &controllable, &[[4.0 / 9.0, 3.0]; 2]);
    assert_eq!(solution_hull(&s5(), &tolerable), SolutionHull::Empty);
    // A singular matrix lets the set run away.
    let line = system(&[&[[-1.0, 1.0]]], &[[1.0, 2.0]]);
    assert_eq!(solution_hull(&line, &united), SolutionHull::Unbounded(0));
}

#[test]
fn one_unknown_by_hand() {
    let of = |b: Ends| system(&[&[[1.0, 2.0]]], &[b]);
    let all = [
        SolutionSet::United,
        SolutionSet::Tolerable,
        SolutionSet::Controllable,
    ];
    let (narrow, wide) = (of([3.0, 4.0]), of([3.0, 8.0]));
    hull_is(&narrow, &all[0], &[[1.5, 4.0]]);
    assert_eq!(solution_hull(&narrow, &all[1]), SolutionHull::Empty);
    hull_is(&narrow, &all[2], &[[2.0, 3.0]]);
    hull_is(&wide, &all[0], &[[1.5, 8.0]]);
    hull_is(&wide, &all[1], &[[3.0, 4.0]]);
    assert_eq!(solution_hull(&wide, &all[2]), SolutionHull::Empty);
    for (x, kind, answer) in [
        (1.5, 0, TernaryAnswer::Yes),
        (1.4999, 0, TernaryAnswer::No),
        (4.0001, 0, TernaryAnswer::No),
        (2.5, 2, TernaryAnswer::Yes),
        (3.5, 2, TernaryAnswer::No),
        (3.5, 1, TernaryAnswer::No),
    ] {
        assert_eq!(narrow.holds_point(&[x], &all[kind]), answer, "{x} {kind}");
    }
    assert_eq!(wide.holds_point(&[3.5], &all[1]), TernaryAnswer::Yes);
}

/// A x ∈ b for all of the first column and some of the second, by sampling of both.
#[test]
fn any_mask_means_what_its_quantifiers_say() {
    use Quantifier::{All, Some};
    let system = s2();
    let mask = SolutionSet::Mask(vec![vec![All, Some]; 2], vec![Some; 2]);
    let parts = |k: Kaucher| (0..=20).map(move |i| k.lo + (k.hi - k.lo) * f64::from(i) / 20.0);
    let mut seen = [0; 2];
    for i in 0..40 {
        for j in 0..40 {
            let x = [f64::from(i) * 4.03 - 60.0, f64::from(j) * 7.01 - 60.0];
            // Rows are apart: for every a₁ there must be an a₂ with a₁ x + a₂ y in b.
            let by_hand = system.a.iter().zip(&system.b).all(|(row, b)| {
                parts(row[0]).all(|a| {
                    let ends = [row[1].lo, row[1].hi].map(|c| a * x[0] + c * x[1]);
                    ends[0].min(ends[1]) <= b.hi && ends[0].max(ends[1]) >= b.lo
                })
            });
            let found = system.holds_point(&x, &mask);
            assert_eq!(found == TernaryAnswer::Yes, by_hand, "{x:?}");
            seen[usize::from(by_hand)] += 1;
        }
    }
    assert!(seen.iter().all(|n| *n > 50), "{seen:?}");
}

fn solved(system: &IntervalSystem, tau: f64) -> (Vec<Kaucher>, usize, Vec<usize>) {
    match formal_solution(system, tau) {
        Formal::Solved { x, steps, improper } => (x, steps, improper),
        other => panic!("{other:?}"),
    }
}

#[test]
fn formal_solutions_are_those_of_the_literature() {
    let third = 1.0 / 3.0;
    for (system, plain, dual) in [
        (s1(), vec![[-third, third]; 2], vec![[-1.0, 1.0]; 2]),
        (
            s2(),
            vec![[0.0, 120.0 / 7.0], [30.0, 480.0 / 7.0]],
            vec![[-12.0, 60.0], [24.0, 90.0]],
        ),
        (
            s3(),
            vec![[0.0, 15.0 / 7.0], [1.0, 18.0 / 7.0]],
            vec![[-0.4, 4.5], [0.8, 3.75]],
        ),
        (
            s4(3.5),
            vec![[-2.0 / 15.0, 2.0 / 15.0]; 3],
            vec![[-2.0 / 7.0, 2.0 / 7.0]; 3],
        ),
        (
            s4(6.0),
            vec![[-0.1, 0.1]; 3],
            vec![[-1.0 / 6.0, 1.0 / 6.0]; 3],
        ),
    ] {
        for (of_a, wanted, kind) in [
            (false, plain, SolutionSet::Tolerable),
            (true, dual, SolutionSet::United),
        ] {
            let (x, _, improper) = solved(&system.dual(of_a, false), 1.0);
            near(&x, &wanted, 1e-9);
            assert!(improper.is_empty());
            // A little inside of it the box is proved to lie in its set.
            let inside: Vec<Kaucher> = x
                .iter()
                .map(|k| Kaucher::new(k.lo + 1e-9 * k.radius(), k.hi - 1e-9 * k.radius()))
                .collect();
            assert_eq!(system.holds_box(&inside, &kind), TernaryAnswer::Yes);
        }
    }
    let (x, _, improper) = solved(&s5().dual(true, true), 1.0);
    near(&x, &[[0.7, 1.85]; 2], 1e-9);
    assert!(improper.is_empty());
    let (x, _, improper) = solved(&s5(), 1.0);
    near(&x, &[[1.85, 0.7]; 2], 1e-9);
    assert_eq!(improper, [0, 1], "said, and not hidden");
}

#[test]
fn the_system_of_seven_unknowns_takes_the_known_steps() {
    let rows: [[Ends; 7]; 7] = [
        [
            [4.0, 6.0],
            [-9.0, 0.0],
            [0.0, 12.0],
            [2.0, 3.0],
            [5.0, 9.0],
            [-23.0, -9.0],
            [15.0, 23.0],
        ],
        [
            [0.0, 1.0],
            [6.0, 10.0],
            [-1.0, 1.0],
            [-1.0, 3.0],
            [-5.0, 1.0],
            [1.0, 15.0],
            [-3.0, -1.0],
        ],
        [
            [0.0, 3.0],
            [-20.0, -9.0],
            [12.0, 77.0],
            [-6.0, 30.0],
            [0.0, 3.0],
            [-18.0, 1.0],
            [0.0, 1.0],
        ],
        [
            [-4.0, 1.0],
            [-1.0, 1.0],
            [-3.0, 1.0],
            [3.0, 5.0],
            [5.0, 9.0],
            [1.0, 2.0],
            [1.0, 4.0],
        ],
        [
            [0.0, 3.0],
            [0.0, 6.0],
            [0.0, 20.0],
            [-1.0, 5.0],
            [8.0, 14.0],
            [-6.0, 1.0],
            [10.0, 17.0],
        ],
        [
            [-7.0, -2.0],
            [1.0, 2.0],
            [7.0, 14.0],
            [-3.0, 1.0],
            [0.0, 2.0],
            [3.0, 5.0],
            [-2.0, 1.0],
        ],
        [
            [-1.0, 5.0],
            [-3.0, 2.0],
            [0.0, 8.0],
            [1.0, 11.0],
            [-5.0, 10.0],
            [2.0, 7.0],
            [6.0, 82.0],
        ],
    ];
    let side = [
        [-10.0, 95.0],
        [35.0, 14.0],
        [-6.0, 2.0],
        [30.0, 7.0],
        [4.0, 95.0],
        [-6.0, 46.0],
        [-2.0, 65.0],
    ];
    let wanted = [
        [-1.224743176, 0.5054298767],
        [18.26444337, -9.517504103],
        [-0.02818650587, 1.160755219],
        [16.40769577, -14.4555342],
        [-1.343565273, 3.98821848],
        [-3.528938521, 4.543458368],
        [5.430862368, -0.6740083868],
    ];
    let rows: Vec<&[Ends]> = rows.iter().map(|row| &row[..]).collect();
    let system = system(&rows, &side);
    for (tau, known) in [(1.0, 8_usize), (0.8, 21), (0.5, 53)] {
        let (x, steps, improper) = solved(&system, tau);
        near(&x, &wanted, 5e-9);
        assert_eq!(improper, [1, 3, 6]);
        assert!(
            steps.abs_diff(known) <= 1,
            "{steps} at {tau}, known {known}"
        );
    }
}

#[test]
fn cubes_about_centres_are_those_of_the_literature() {
    for (system, most, at, radius) in [
        (s1(), 2.0, vec![0.0, 0.0], 1.0 / 3.0),
        (
            s2(),
            32.727272727,
            vec![16.363636364, 38.181818182],
            6.545454545,
        ),
        (
            s3(),
            2.909090909,
            vec![1.454545455, 1.727272727],
            0.581818182,
        ),
        (s4(3.5), 1.0, vec![0.0; 3], 0.133333333),
        (s4(6.0), 1.0, vec![0.0; 3], 0.1),
    ] {
        let (t, found) = best_centre(&system).unwrap();
        assert!((found - most).abs() < 1e-8, "{found} {most}");
        let off = t
            .iter()
            .zip(&at)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        assert!(off < 1e-8, "{t:?}");
        assert!((tolerance_at(&system, &t) - most).abs() < 1e-8);
        let r = centre_radius(&system, &t, &SolutionSet::Tolerable).unwrap();
        assert!((r - radius).abs() < 1e-8, "{r} {radius}");
        let cube =
            |r: f64| -> Vec<Kaucher> { t.iter().map(|t| Kaucher::new(t - r, t + r)).collect() };
        assert_eq!(
            system.holds_box(&cube(r * 0.999_999), &SolutionSet::Tolerable),
            TernaryAnswer::Yes
        );
        // The cube in the united set is proved as well.
        let wide = centre_radius(&system, &t, &SolutionSet::United).unwrap();
        assert!(wide >= r);
        let corner: Vec<f64> = t.iter().map(|t| t + 0.999_999 * wide).collect();
        assert_eq!(
            system.holds_point(&corner, &SolutionSet::United),
            TernaryAnswer::Yes
        );
    }
    assert_eq!(
        centre_radius(&s1(), &[0.0; 2], &SolutionSet::Controllable),
        None
    );
}

#[test]
fn auxiliary_systems_say_which_plans_hold() {
    // The formal solution for the tolerable set of S5 is improper; with a wider right side it is proper, and not proved
    // for the system as it stands.
    let plans = [(1.0, 1.0), (0.5, 1.0), (1.0, 12.0), (0.1, 1.0)];
    let plans = plans.map(|(of_a, of_b)| AuxiliaryPlan { of_a, of_b });
    let tried = auxiliary_solutions(&s5(), &SolutionSet::Tolerable, &plans, 1.0);
    assert!(tried.iter().all(|t| t.holds == TernaryAnswer::Open));
    // Of the united set narrower systems have narrower solutions, which hold.
    let tried = auxiliary_solutions(&s2(), &SolutionSet::United, &plans, 1.0);
    assert!(tried[..2].iter().any(|t| t.holds == TernaryAnswer::Yes));
    let SolutionHull::Box(around) = solution_hull(&s2(), &SolutionSet::United) else {
        panic!("no hull");
    };
    for t in tried.iter().filter(|t| t.holds == TernaryAnswer::Yes) {
        let Formal::Solved { x, .. } = &t.formal else {
            panic!("{t:?}");
        };
        let slack = |k: &Kaucher| Kaucher::new(k.lo - 1e-9, k.hi + 1e-9);
        assert!(x.iter().zip(&around).all(|(x, h)| x.is_in(slack(h))));
    }
}

#[test]
fn regularity_is_proved_or_refuted() {
    assert!(spectral_bound(&s5()) < 1.0);
    assert!(spectral_bound(&s4(6.0)) < 1.0);
    // ± b in every entry: the middle is the identity, and the matrix [[0, 1], [1, 0]] has the other sign.
    let mixed = system(
        &[&[[-1.0, 3.0], [-1.5, 1.5]], &[[-1.5, 1.5], [-1.0, 3.0]]],
        &[[0.0, 1.0]; 2],
    );
    assert!(spectral_bound(&mixed) > 1.0);
    let mut state = 0x1_2345_u64;
    let share = positive_share(&mixed, 2000, || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1u64 << 53) as f64
    });
    assert!((0.2..0.95).contains(&share), "{share}");
}

#[test]
fn what_is_ill_posed_is_refused() {
    let wrong = IntervalSystem::new(
        &[vec![[1.0, 2.0], [3.0, 2.0]], vec![[1.0, 1.0], [1.0, 1.0]]],
        &[[0.0, 1.0]; 2],
    );
    assert_eq!(wrong, Err(SystemError::Improper { row: 1 }));
    let wrong = IntervalSystem::new(
        &[vec![[1.0, 2.0]], vec![[1.0, 1.0], [1.0, 1.0]]],
        &[[0.0, 1.0]; 2],
    );
    assert_eq!(wrong, Err(SystemError::Shape));
    // Zero in every pivot.
    let singular = system(
        &[&[[1.0, 1.0], [2.0, 2.0]], &[[2.0, 2.0], [4.0, 4.0]]],
        &[[1.0, 1.0]; 2],
    );
    assert_eq!(
        formal_solution(&singular, 1.0),
        Formal::Singular { steps: 0 }
    );
}
