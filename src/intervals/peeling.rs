//! Decomposes a planar chain of bars into dyads: every point keeps two of its bars, a lever one.
//!
//! Points are removed in their order. A point with more than two bars left keeps those that others need least, and
//! leaves the rest to the points with the highest numbers, as long as every bar still finds a point (a matching of bars
//! and points). The assignment of bars to points is a choice: every such sequence of dyads has the same velocities.

use super::dyad::Dyad;
use crate::sorting::sort_by_key;

/// A chain as a sequence of dyads.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Peeled {
    /// The last one is removed first: its point carries no bar of another.
    pub dyads: Vec<Dyad>,
    /// A moving point and the fixed one that its only own bar leads to.
    pub levers: Vec<[usize; 2]>,
}

/// Why a chain cannot be decomposed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoDyads {
    /// More than two bars per point.
    #[error(
        "{bars} bars on {points} moving points: dyads have two a point, and levers leave it free to move"
    )]
    TooManyBars {
        /// Number of bars.
        bars: usize,
        /// Number of moving points.
        points: usize,
    },
    /// Fewer points are connected to fixed ones than levers are needed.
    #[error("{needed} levers are needed, and {found} points have a bar to a fixed one")]
    FewLevers {
        /// Degrees of freedom of the bars.
        needed: usize,
        /// Points that could be levers.
        found: usize,
    },
    /// Some part has more bars than its points can take.
    #[error("the bars around a point are more than two for every point there")]
    Crowded {
        /// A point of that part.
        point: usize,
    },
}

/// Decomposes a chain. Bars connect two points of `0..points`, not both `fixed`.
///
/// # Errors
/// Chains that do not consist of dyads and levers.
pub fn peel_dyads(points: usize, fixed: &[usize], bars: &[[usize; 2]]) -> Result<Peeled, NoDyads> {
    let moving: Vec<usize> = (0..points).filter(|p| !fixed.contains(p)).collect();
    let free = (2 * moving.len()).checked_sub(bars.len());
    let too_many = NoDyads::TooManyBars {
        bars: bars.len(),
        points: moving.len(),
    };
    let free = free.ok_or(too_many)?;
    let levers = chosen_levers(&moving, fixed, bars, free)?;
    let mut room = vec![0_usize; points];
    moving.iter().for_each(|p| room[*p] = 2);
    let mut owner: Vec<Option<usize>> = vec![None; bars.len()];
    for (lever, bar) in &levers {
        // Its own bar is all that it keeps.
        room[*lever] = 0;
        owner[*bar] = Some(*lever);
    }
    if let Err(point) = all_find_room(bars, &owner, &room) {
        return Err(NoDyads::Crowded { point });
    }
    let mut dyads: Vec<Dyad> = Vec::new();
    for &point in &moving {
        if levers.iter().any(|(lever, _)| *lever == point) {
            continue;
        }
        let (kept, left) = kept_bars(point, bars, &owner, &room);
        for bar in kept {
            owner[bar] = Some(point);
        }
        // The other bars are left to their other ends.
        for bar in left {
            owner[bar] = Some(other_end(bars[bar], point));
        }
        room[point] = 0;
        for k in moving.iter().filter(|k| **k > point) {
            let own = owner.iter().filter(|o| **o == Some(*k)).count();
            room[*k] = if room[*k] > 0 { 2 - own.min(2) } else { 0 };
        }
    }
    for &point in &moving {
        let own = bars.iter().zip(&owner).filter(|(_, o)| **o == Some(point));
        let ends: Vec<usize> = own.map(|(bar, _)| other_end(*bar, point)).collect();
        if let [a, b] = ends[..] {
            dyads.push(Dyad {
                point,
                ends: [a, b],
            });
        }
    }
    dyads.reverse();
    let levers: Vec<[usize; 2]> = (levers.iter())
        .map(|(lever, bar)| [*lever, other_end(bars[*bar], *lever)])
        .collect();
    order_ends(&mut dyads, &levers, fixed);
    Ok(Peeled { dyads, levers })
}

fn other_end(bar: [usize; 2], point: usize) -> usize {
    if bar[0] == point { bar[1] } else { bar[0] }
}

/// As many levers as the chain has degrees of freedom, each with its bar: the points with the highest numbers that are
/// connected to fixed ones.
fn chosen_levers(
    moving: &[usize],
    fixed: &[usize],
    bars: &[[usize; 2]],
    needed: usize,
) -> Result<Vec<(usize, usize)>, NoDyads> {
    let to_fixed = |point: usize| {
        let own = |bar: &&[usize; 2]| bar.contains(&point);
        let is_lever = |bar: &&[usize; 2]| own(bar) && fixed.contains(&other_end(**bar, point));
        bars.iter().position(|bar| is_lever(&bar))
    };
    let all: Vec<(usize, usize)> = (moving.iter().rev())
        .filter_map(|p| Some((*p, to_fixed(*p)?)))
        .collect();
    match all.get(..needed) {
        Some(levers) => Ok(levers.to_vec()),
        None => Err(NoDyads::FewLevers {
            needed,
            found: all.len(),
        }),
    }
}

/// The bars that a point keeps, and those that it leaves to their other ends.
fn kept_bars(
    point: usize,
    bars: &[[usize; 2]],
    owner: &[Option<usize>],
    room: &[usize],
) -> (Vec<usize>, Vec<usize>) {
    let is_open = |bar: &usize| owner[*bar].is_none() && bars[*bar].contains(&point);
    let mut kept: Vec<usize> = (0..bars.len()).filter(is_open).collect();
    // Those of the highest other ends are left first.
    sort_by_key(&mut kept, |bar| {
        std::cmp::Reverse(other_end(bars[*bar], point))
    });
    let (mut left, mut next) = (Vec::new(), 0);
    let mut given = owner.to_vec();
    let mut rooms = room.to_vec();
    while kept.len() > room[point] && next < kept.len() {
        let bar = kept[next];
        let other = other_end(bars[bar], point);
        let before = (given.clone(), rooms.clone());
        if rooms[other] > 0 {
            given[bar] = Some(other);
            rooms[other] -= 1;
            if all_find_room(bars, &given, &rooms).is_ok() {
                kept.remove(next);
                left.push(bar);
                continue;
            }
        }
        (given, rooms) = before;
        next += 1;
    }
    (kept, left)
}

/// Whether all bars without an owner find a point with room: a matching by augmenting paths. Otherwise a point of the
/// part that has too many.
fn all_find_room(
    bars: &[[usize; 2]],
    owner: &[Option<usize>],
    room: &[usize],
) -> Result<(), usize> {
    let mut held: Vec<Vec<usize>> = vec![Vec::new(); room.len()];
    for bar in (0..bars.len()).filter(|bar| owner[*bar].is_none()) {
        let mut seen = vec![false; room.len()];
        if !find_room(bar, bars, room, &mut held, &mut seen) {
            return Err(bars[bar][0]);
        }
    }
    Ok(())
}

/// Assigns a bar to one of its ends, reassigning others if necessary.
fn find_room(
    bar: usize,
    bars: &[[usize; 2]],
    room: &[usize],
    held: &mut [Vec<usize>],
    seen: &mut [bool],
) -> bool {
    for end in bars[bar] {
        if std::mem::replace(&mut seen[end], true) {
            continue;
        }
        if held[end].len() < room[end] {
            held[end].push(bar);
            return true;
        }
        for place in 0..held[end].len() {
            if find_room(held[end][place], bars, room, held, seen) {
                held[end][place] = bar;
                return true;
            }
        }
    }
    false
}

/// The end that the dyad before carries stands first, a fixed one last, else the higher number first.
fn order_ends(dyads: &mut [Dyad], levers: &[[usize; 2]], fixed: &[usize]) {
    let mut before = levers.last().map(|lever| lever[0]);
    for dyad in dyads {
        let rank = |end: usize| {
            let is_fixed = fixed.contains(&end);
            (Some(end) != before, is_fixed, std::cmp::Reverse(end))
        };
        sort_by_key(&mut dyad.ends, |end| rank(*end));
        before = Some(dyad.point);
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn rows(peeled: &Peeled) -> Vec<[usize; 3]> {
        let row = |d: &Dyad| [d.point, d.ends[0], d.ends[1]];
        peeled.dyads.iter().map(row).collect()
    }

    /// Crank pin 0, rocker pin 1, a coupler point 2, pivots 3 and 4.
    #[test]
    fn a_four_bar_is_two_dyads_and_a_lever() {
        let bars = [[0, 3], [0, 1], [1, 4], [0, 2], [1, 2]];
        let peeled = peel_dyads(5, &[3, 4], &bars).unwrap();
        assert_eq!(peeled.levers, [[1, 4]]);
        assert_eq!(rows(&peeled), [[2, 1, 0], [0, 1, 3]]);
    }

    #[test]
    fn what_is_no_row_of_dyads_is_refused() {
        // A truss that cannot move and has a bar too many.
        let crowded = [[0, 2], [0, 3], [0, 1], [1, 2], [1, 3]];
        assert_eq!(
            peel_dyads(4, &[2, 3], &crowded),
            Err(NoDyads::TooManyBars { bars: 5, points: 2 })
        );
        // A truss with a bar too many beside a free point.
        let uneven = [[0, 2], [0, 3], [0, 1], [1, 2], [1, 3], [4, 3]];
        let found = peel_dyads(5, &[2, 3], &uneven);
        assert!(matches!(found, Err(NoDyads::Crowded { .. })), "{found:?}");
        // A triangle that floats.
        let floating = [[0, 1], [1, 2], [2, 0]];
        assert_eq!(
            peel_dyads(4, &[3], &floating),
            Err(NoDyads::FewLevers {
                needed: 3,
                found: 0
            })
        );
    }
}
