//! What a chart of a motion leaves out, and how it says so: ranges without values, and points far outside.

use crate::numbers::decimal::with_minus;
use crate::plot::chart::{Panel, Shade};
use crate::sorting::sort_by_number;

/// Values farther away than this many times the range of the middle nine tenths are not shown. Near a singular pose a
/// rate grows without bound and would flatten the rest of the curve.
const OUTLYING: f64 = 8.0;

/// Share of values at either end that do not count in that range.
const TAIL: f64 = 0.05;

/// Ranges of the axis over runs of samples without a pose or without a value, each up to the next sample that has
/// one; overlapping ones are joined.
pub(super) fn gap_shades(poseless: &[bool], valueless: &[bool], x: &[f64]) -> Vec<Shade> {
    let is_marked = |k: usize| poseless[k] || valueless[k];
    let mut ranges: Vec<Shade> = Vec::new();
    let mut k = 0;
    while k < x.len() {
        if !is_marked(k) {
            k += 1;
            continue;
        }
        let end = (k..x.len()).find(|j| !is_marked(*j)).unwrap_or(x.len());
        // At the very end of a motion rates have no value; that sample belongs to the range after it.
        let word = if poseless[k..end].contains(&true) {
            "no pose"
        } else {
            "no value"
        };
        let around = &x[k.saturating_sub(1)..(end + 1).min(x.len())];
        let finite = around.iter().copied().filter(|v| v.is_finite());
        let (from, to) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
        if from <= to {
            ranges.push(Shade {
                from,
                to,
                word: word.to_owned(),
            });
        }
        k = end;
    }
    sort_by_number(&mut ranges, |a| a.from);
    let mut shades: Vec<Shade> = Vec::new();
    for range in ranges {
        match shades.last_mut() {
            Some(last) if range.from <= last.to && range.word == last.word => {
                last.to = last.to.max(range.to);
            }
            _ => shades.push(range),
        }
    }
    shades
}

/// Removes points far outside the range of all others from a panel, and says so in a note.
pub(super) fn leave_out_outliers(panel: &mut Panel) -> Option<String> {
    let points = panel.series.iter().flat_map(|s| s.points.iter().flatten());
    let mut values: Vec<f64> = points.map(|p| p[1]).collect();
    values.sort_by(f64::total_cmp);
    let at = |share: f64| values[((values.len() - 1) as f64 * share).round() as usize];
    if values.len() < 20 {
        return None;
    }
    let (low, high) = (at(TAIL), at(1.0 - TAIL));
    let reach = OUTLYING * (high - low);
    let is_far = |v: f64| v < low - reach || v > high + reach;
    if high == low || !values.iter().any(|v| is_far(*v)) {
        return None;
    }
    let (mut count, mut largest) = (0, 0.0_f64);
    for point in panel.series.iter_mut().flat_map(|s| &mut s.points) {
        if let Some([_, v]) = *point
            && is_far(v)
        {
            (count, largest) = (count + 1, if v.abs() > largest.abs() { v } else { largest });
            *point = None;
        }
    }
    let names: Vec<&str> = panel.series.iter().map(|s| s.name.as_str()).collect();
    let points = if count == 1 {
        "1 point".to_owned()
    } else {
        format!("{count} points")
    };
    Some(format!(
        "{}: {points} beyond the picture, the farthest at {}",
        names.join(", "),
        with_minus(&format!("{largest:.3e}"))
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::chart::PlotSeries;

    #[test]
    fn runs_without_values_reach_to_their_neighbours() {
        let x = [0.0, 1.0, 2.0, 3.0, 2.5, 1.5, 0.5];
        let marked = [false, false, true, true, true, false, false];
        let none = [false; 7];
        let shade = |from: f64, to: f64, word: &str| Shade {
            from,
            to,
            word: word.to_owned(),
        };
        assert_eq!(gap_shades(&marked, &none, &x), [shade(1.0, 3.0, "no pose")]);
        assert_eq!(
            gap_shades(&none, &marked, &x),
            [shade(1.0, 3.0, "no value")]
        );
        assert_eq!(
            gap_shades(&[true; 7], &none, &x),
            [shade(0.0, 3.0, "no pose")]
        );
        assert!(gap_shades(&none, &none, &x).is_empty());
        // Both runs reach into each other on the axis: the motion comes back.
        let twice = [true, false, false, false, false, false, true];
        assert_eq!(gap_shades(&twice, &none, &x), [shade(0.0, 1.5, "no pose")]);
        let beside = [false, true, false, false, false, false, false];
        assert_eq!(
            gap_shades(&marked, &beside, &x),
            [shade(0.0, 3.0, "no pose")]
        );
    }

    #[test]
    fn only_lonely_giants_are_left_out() {
        let series = |values: Vec<f64>| Panel {
            series: vec![PlotSeries {
                name: "a".into(),
                points: values.into_iter().map(|v| Some([0.0, v])).collect(),
                ..PlotSeries::default()
            }],
            ..Panel::default()
        };
        let mut calm = series((0..100).map(|k| f64::from(k % 10)).collect());
        assert_eq!(leave_out_outliers(&mut calm), None);
        let mut wild = series(
            (0..100)
                .map(|k| if k == 7 { -1e9 } else { f64::from(k % 10) })
                .collect(),
        );
        let note = leave_out_outliers(&mut wild);
        assert!(note.is_some_and(|n| n.contains("1 point") && n.contains("−1.000e9")));
        // What a scene draws beside the curves is no part of them.
        calm.marks.push([0.0, 1e9]);
        assert_eq!(leave_out_outliers(&mut calm), None);
        assert_eq!(wild.series[0].points[7], None);
        assert_eq!(wild.points().count(), 99);
    }
}
