//! Weighted clustering of a few thousand colours. Deterministic: fixed order, no random start.

use super::nearest_colour::PalettePoints;
use crate::sorting::{sort_by, sort_by_key};

/// A colour in the space of the metric, with the number of pixels it stands for.
#[derive(Clone, Copy, Debug)]
pub struct ColourPoint {
    /// Coordinates.
    pub at: [f32; 3],
    /// Weight, positive.
    pub weight: f32,
}

/// Assigns every point to one of at most `clusters` clusters: splits by largest squared error, then `steps`
/// rounds of k-means. Returns one cluster number a point; every number below the greatest occurs.
pub fn cluster_points(points: &[ColourPoint], clusters: usize, steps: usize) -> Vec<u8> {
    let clusters = clusters.clamp(1, 256);
    let mut centres = split_boxes(points, clusters);
    let mut owners = vec![0; points.len()];
    for _ in 0..steps {
        assign_owners(points, &centres, &mut owners);
        let errors = update_centres(points, &owners, &mut centres);
        move_idle(points, &owners, &errors, &mut centres);
    }
    assign_owners(points, &centres, &mut owners);
    compact_owners(&mut owners);
    owners
}

/// A box of the splitting stage: a range of the index list and the squared error within.
struct BoxPart {
    from: usize,
    to: usize,
    error: f64,
    axis: usize,
    mean: [f64; 3],
}

/// Starting centres: the part with the largest squared error is cut at its mean along its longest spread.
fn split_boxes(points: &[ColourPoint], clusters: usize) -> Vec<[f32; 3]> {
    let mut order: Vec<usize> = (0..points.len()).collect();
    let mut parts = vec![measure_box(points, &order, 0, points.len())];
    while parts.len() < clusters {
        let worst = parts
            .iter()
            .enumerate()
            .fold(None, |best: Option<(usize, f64)>, (i, p)| match best {
                Some((_, error)) if error >= p.error => best,
                _ => Some((i, p.error)),
            });
        let Some((worst, error)) = worst else { break };
        if error <= 0.0 {
            break;
        }
        let part = parts.swap_remove(worst);
        let Some(slice) = order.get_mut(part.from..part.to) else {
            break;
        };
        let cut = part.mean[part.axis];
        // A stable order by side keeps the result independent of the sort's internals.
        sort_by_key(slice, |&i| f64::from(points[i].at[part.axis]) > cut);
        let low = slice.partition_point(|&i| f64::from(points[i].at[part.axis]) <= cut);
        if low == 0 || low == slice.len() {
            parts.push(BoxPart { error: 0.0, ..part });
            continue;
        }
        let middle = part.from + low;
        parts.push(measure_box(points, &order, part.from, middle));
        parts.push(measure_box(points, &order, middle, part.to));
    }
    parts.iter().map(|p| p.mean.map(|c| c as f32)).collect()
}

/// Mean, squared error and axis of greatest spread of a range.
fn measure_box(points: &[ColourPoint], order: &[usize], from: usize, to: usize) -> BoxPart {
    let members = || order[from..to].iter().map(|&i| &points[i]);
    let total: f64 = members()
        .map(|p| f64::from(p.weight))
        .sum::<f64>()
        .max(f64::MIN_POSITIVE);
    let mut mean = [0.0; 3];
    for point in members() {
        for (sum, x) in mean.iter_mut().zip(point.at) {
            *sum += f64::from(point.weight) * f64::from(x) / total;
        }
    }
    let mut spread = [0.0; 3];
    for point in members() {
        for axis in 0..3 {
            let d = f64::from(point.at[axis]) - mean[axis];
            spread[axis] += f64::from(point.weight) * d * d;
        }
    }
    let axis = (0..3).fold(0, |best, a| if spread[a] > spread[best] { a } else { best });
    let error = if to - from < 2 {
        0.0
    } else {
        spread.iter().sum()
    };
    BoxPart {
        from,
        to,
        error,
        axis,
        mean,
    }
}

fn assign_owners(points: &[ColourPoint], centres: &[[f32; 3]], owners: &mut [u8]) {
    let nearest = PalettePoints::new(centres);
    for (point, owner) in points.iter().zip(owners) {
        *owner = nearest.find(point.at);
    }
}

/// Moves every centre to the mean of its points; returns each cluster's (weight, squared error).
fn update_centres(
    points: &[ColourPoint],
    owners: &[u8],
    centres: &mut [[f32; 3]],
) -> Vec<(f64, f64)> {
    let mut sums = vec![([0.0f64; 3], 0.0f64); centres.len()];
    for (point, &owner) in points.iter().zip(owners) {
        let (sum, weight) = &mut sums[usize::from(owner)];
        for (sum, x) in sum.iter_mut().zip(point.at) {
            *sum += f64::from(point.weight) * f64::from(x);
        }
        *weight += f64::from(point.weight);
    }
    for (centre, (sum, weight)) in centres.iter_mut().zip(&sums) {
        if *weight > 0.0 {
            *centre = sum.map(|s| (s / weight) as f32);
        }
    }
    let mut errors: Vec<(f64, f64)> = sums.iter().map(|s| (s.1, 0.0)).collect();
    for (point, &owner) in points.iter().zip(owners) {
        let centre = centres[usize::from(owner)];
        errors[usize::from(owner)].1 +=
            f64::from(point.weight) * f64::from(squared_distance(point.at, centre));
    }
    errors
}

/// Puts centres without points on the farthest-off point of the clusters with the largest errors.
fn move_idle(
    points: &[ColourPoint],
    owners: &[u8],
    errors: &[(f64, f64)],
    centres: &mut [[f32; 3]],
) {
    let idle: Vec<usize> = (0..centres.len()).filter(|&c| errors[c].0 <= 0.0).collect();
    if idle.is_empty() {
        return;
    }
    let mut worst: Vec<usize> = (0..centres.len()).collect();
    sort_by(&mut worst, |&a, &b| errors[b].1.total_cmp(&errors[a].1));
    for (&target, &source) in idle.iter().zip(&worst) {
        let cost = |i: usize| points[i].weight * squared_distance(points[i].at, centres[source]);
        let members = (0..points.len()).filter(|&i| usize::from(owners[i]) == source);
        let farthest = members.max_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        if let Some(point) = farthest {
            centres[target] = points[point].at;
        }
    }
}

/// Renumbers the clusters so that there are no gaps, in the order of their numbers.
fn compact_owners(owners: &mut [u8]) {
    let mut used = [false; 256];
    owners.iter().for_each(|&o| used[usize::from(o)] = true);
    let mut number = [0u8; 256];
    let mut next = 0u8;
    for (slot, used) in number.iter_mut().zip(used) {
        *slot = next;
        next = next.wrapping_add(u8::from(used));
    }
    owners.iter_mut().for_each(|o| *o = number[usize::from(*o)]);
}

fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let d: [f32; 3] = std::array::from_fn(|i| a[i] - b[i]);
    d[0] * d[0] + d[1] * d[1] + d[2] * d[2]
}
