//! Sums of lists against plain loops.

#![allow(clippy::unwrap_used)]

use super::*;
use crate::numbers::form_room::FormRoom;

/// Numbers between -1 and 1.
fn random(state: &mut u64, count: usize) -> Vec<f64> {
    let mut next = || {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

fn assert_near(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() < 1e-13, "{a} {b}");
    }
}

#[test]
fn sums_of_lists_are_those_of_plain_loops() {
    let mut state = 0x1157;
    for length in [0, 1, 7, 8, 9, 31, 40, 100] {
        let (a, b) = (
            random(&mut state, length),
            random(&mut state, length / 2 + 3),
        );
        let size: f64 = a.iter().map(|value| value.abs()).sum();
        assert!((long_sum_of_magnitudes(&a) - size).abs() < 1e-12);
        let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
        let end = length.max(b.len()) + 5;
        let both: Vec<f64> = (0..end)
            .map(|k| 0.3 * at(&a, k) - 2.0 * at(&b, k))
            .collect();
        let mut sum = vec![f64::NAN; end];
        set_to_two(&mut sum, (0.3, &a), (-2.0, &b));
        assert_near(&sum, &both);
        let mut sum = Vec::new();
        add_long_list(&mut sum, 0.3, &a);
        add_long_list(&mut sum, -2.0, &b);
        assert_near(&sum, &both[..length.max(b.len())]);
    }
}

#[test]
fn combinations_are_those_of_plain_loops() {
    let mut state = 0xc0de;
    for (count, terms, length) in [(1, 1, 3), (5, 3, 8), (4, 12, 21), (13, 7, 40)] {
        let lists: Vec<Vec<f64>> = (0..terms)
            .map(|k| random(&mut state, length.max(2 + k) - k.min(2)))
            .collect();
        let lists: Vec<&[f64]> = lists.iter().map(Vec::as_slice).collect();
        let longest = lists.iter().map(|list| list.len()).max().unwrap();
        let factors = random(&mut state, count * terms);
        for are_unset in [false, true] {
            let start = if are_unset { f64::NAN } else { 0.5 };
            let mut sums = vec![vec![start; longest]; count];
            let mut places: Vec<&mut [f64]> = sums.iter_mut().map(Vec::as_mut_slice).collect();
            add_combinations(&mut places, &factors, &lists, are_unset);
            for (i, sum) in sums.iter().enumerate() {
                let at = |place: usize| {
                    let terms = lists.iter().zip(&factors[i * terms..]);
                    let known = if are_unset { 0.0 } else { 0.5 };
                    known
                        + terms
                            .filter_map(|(list, factor)| Some(factor * list.get(place)?))
                            .sum::<f64>()
                };
                assert_near(sum, &(0..longest).map(at).collect::<Vec<_>>());
            }
        }
    }
}

#[test]
fn products_of_slopes_are_symmetric() {
    let mut state = 0x5e7;
    for span in [1, 3, 8, 9, 16, 22, 34] {
        let pairs: Vec<[Vec<f64>; 2]> = (0..3)
            .map(|k| [span, span - k % span].map(|length| random(&mut state, length)))
            .collect();
        let mut expected = vec![0.0; packed_length(span)];
        let at = |list: &[f64], k: usize| list.get(k).copied().unwrap_or(0.0);
        for [x, y] in &pairs {
            for l in 0..span {
                expected[FormRoom::place(l, l)] += at(x, l) * at(y, l);
                for k in 0..l {
                    expected[FormRoom::place(k, l)] += at(x, k) * at(y, l) + at(y, k) * at(x, l);
                }
            }
        }
        let mut one_by_one = vec![0.0; packed_length(span)];
        for [x, y] in &pairs {
            let (x, y) = (in_lanes(x, -1.0, span), in_lanes(y, -1.0, span));
            add_symmetric_product(&mut one_by_one, &x, &y, span);
        }
        assert_near(&one_by_one, &expected);
        let mut together = vec![0.0; packed_length(span)];
        let [x, y] = [0, 1].map(|side| {
            let lists: Vec<&[f64]> = pairs.iter().map(|pair| &pair[side][..]).collect();
            FactorLists::new(lists.into_iter(), span)
        });
        assert_eq!((x.span(), y.span()), (span, span));
        add_symmetric_products(&mut together, &x, &y);
        assert_near(&together, &expected);
    }
}
