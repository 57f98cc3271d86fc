//! Charts of a search: the paths of its start beside those of its result.

use crate::plot::chart::{Chart, Panel, PlotSeries, PointWord, SeriesStyle};

/// The chart of the result with the curves of the start behind it, dashed; both are charts of the same plots.
pub fn start_and_result(start: Chart, result: Chart) -> Chart {
    let panels = start.panels.into_iter().zip(result.panels);
    Chart {
        panels: panels
            .map(|(start, result)| joined_panel(start, result))
            .collect(),
        ..result
    }
}

fn joined_panel(start: Panel, result: Panel) -> Panel {
    let is_alone = result.series.len() == 1;
    let named = |series: PlotSeries, when: &str, style| PlotSeries {
        name: match is_alone {
            true => when.to_owned(),
            false => format!("{}, {when}", series.name),
        },
        style,
        ..series
    };
    let before = start
        .series
        .into_iter()
        .map(|s| named(s, "start", SeriesStyle::Dashed));
    let after = result
        .series
        .into_iter()
        .map(|s| named(s, "result", SeriesStyle::Line));
    Panel {
        series: before.chain(after).collect(),
        ..result
    }
}

/// Labels the points of a panel's last curve at these instants.
pub fn name_places(panel: &mut Panel, times: &[f64], words: &[(f64, String)]) {
    let Some(curve) = panel.series.last() else {
        return;
    };
    let nearest = |time: f64| {
        let off = |k: &usize| (times[*k] - time).abs();
        (0..times.len()).min_by(|a, b| off(a).total_cmp(&off(b)))
    };
    let places = words.iter().filter_map(|(time, text)| {
        let at = curve.points.get(nearest(*time)?).copied().flatten()?;
        Some(PointWord {
            at,
            text: text.clone(),
        })
    });
    panel.words = places.collect();
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_start_is_dashed_and_gates_have_their_names() {
        let chart = |x: f64| Chart {
            panels: vec![Panel {
                series: vec![PlotSeries {
                    name: "M.x".to_owned(),
                    points: vec![Some([x, 0.0]), None, Some([x, 2.0])],
                    ..PlotSeries::default()
                }],
                ..Panel::default()
            }],
            ..Chart::default()
        };
        let mut both = start_and_result(chart(1.0), chart(5.0));
        let panel = &mut both.panels[0];
        name_places(
            panel,
            &[0.0, 1.0, 2.0],
            &[(1.9, "R".to_owned()), (1.0, "N".to_owned())],
        );
        let names: Vec<&str> = panel.series.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(names, ["start", "result"]);
        assert_eq!(panel.series[0].style, SeriesStyle::Dashed);
        assert_eq!(
            panel.words.len(),
            1,
            "where there is no pose there is no gate"
        );
        assert_eq!(panel.words[0].at, [5.0, 2.0]);
    }
}
