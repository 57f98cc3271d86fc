//! Distances and depths beside parry's, for all pairs of the convex solids that both have. Where the two differ by more
//! than parry's own tolerance, a slow search with 31 digits says who is right.
//!
//! `MECHANIM_PAIRS` sets the number of pairs.

use crate::slow_distance::{known, size};
use crate::solids::parry::Peer;
use crate::solids::{Random, element};
use mechanim::distance::pair::signed_distance;
use mechanim::math::Pose;
use mechanim::model::shape::Solid;
use std::collections::BTreeMap;

const KINDS: [&str; 6] = ["sphere", "capsule", "cylinder", "cone", "box", "half-space"];

/// Pairs unless the environment says otherwise.
const PAIRS: usize = 100_000;

/// What is allowed of ours where the reference decides, as a part of the pair's extent.
const ALLOWED: f64 = 1e-12;

/// Differences that parry's iterations leave: they stop at about the root of the machine's precision, of the extent.
const NEAR: f64 = 1e-7;

/// Largest share of the pairs that may differ by more.
const MOST: f64 = 0.02;

fn solid(random: &mut Random, kind: usize) -> Solid {
    let (from, to) = (random.vector(2.0), random.vector(2.0));
    let radius = random.range(0.05, 1.0);
    match kind {
        0 => Solid::Sphere {
            centre: from,
            radius,
        },
        1 => Solid::Capsule { from, to, radius },
        2 => Solid::Cylinder { from, to, radius },
        3 => Solid::Cone {
            from,
            to,
            radius_from: radius,
            radius_to: 0.0,
        },
        4 => Solid::Box {
            centre: from,
            size: to.abs() + 0.1,
        },
        _ => Solid::HalfSpace {
            point: from,
            normal: to.normalize(),
            size: 1.0,
        },
    }
}

/// What was found of a pair of kinds.
#[derive(Default, Debug)]
struct StartResults {
    pairs: usize,
    overlapping: usize,
    /// Pairs for which parry finds nothing.
    silent: usize,
    /// Pairs that differ by more than [`NEAR`]; all of them were judged.
    judged: usize,
    /// Largest difference of the two, as a part of the extent.
    farthest: f64,
}

fn compare(tally: &mut StartResults, random: &mut Random, [i, j]: [usize; 2]) {
    let solids = [solid(random, i), solid(random, j)];
    let reach = if random.unit() < 0.5 { 1.0 } else { 4.0 };
    let poses = [Pose::IDENTITY, random.pose(reach)];
    let [a, b] = [0, 1].map(|k| element(solids[k].clone()).moved(&poses[k]));
    let [p, q] = [0, 1].map(|k| Peer::new(&solids[k], &poses[k]).unwrap());
    let (ours, extent) = (signed_distance(&a, &b).distance, size(&a, &b));
    tally.pairs += 1;
    tally.overlapping += usize::from(ours < 0.0);
    let theirs = p.distance(&q);
    tally.silent += usize::from(theirs.is_none());
    let off = theirs.map_or(f64::INFINITY, |theirs| (theirs - ours).abs() / extent);
    tally.farthest = tally.farthest.max(if off.is_finite() { off } else { 0.0 });
    if off > NEAR {
        tally.judged += 1;
        let truth = known(&a, &b);
        assert!(
            truth.misses(ours) <= ALLOWED * extent,
            "{} and {}: {ours} and parry's {theirs:?}, {truth:?}\n{solids:?} {poses:?}",
            KINDS[i],
            KINDS[j]
        );
    }
}

#[test]
fn parry_agrees_or_is_off_itself() {
    let count = std::env::var("MECHANIM_PAIRS").map_or(PAIRS, |text| text.parse().unwrap());
    let kinds: Vec<[usize; 2]> = (0..6)
        .flat_map(|i| (i..6).map(move |j| [i, j]))
        .filter(|pair| *pair != [5, 5])
        .collect();
    let mut tallies: BTreeMap<[usize; 2], StartResults> = BTreeMap::new();
    for k in 0..count {
        let pair = kinds[k % kinds.len()];
        compare(
            tallies.entry(pair).or_default(),
            &mut Random(k as u64),
            pair,
        );
    }
    for ([i, j], t) in &tallies {
        println!(
            "{:>10} {:<10} {:>6} pairs, {:>5} overlap, differ by up to {:.1e}; judged {:>5}, parry finds nothing {}",
            KINDS[*i], KINDS[*j], t.pairs, t.overlapping, t.farthest, t.judged, t.silent
        );
    }
    let sum = |of: fn(&StartResults) -> usize| tallies.values().map(of).sum::<usize>();
    assert_eq!(sum(|t| t.pairs), count);
    assert!(sum(|t| t.overlapping) > count / 5, "{tallies:?}");
    assert!(
        (sum(|t| t.judged) as f64) < MOST * count as f64,
        "{tallies:?}"
    );
}
