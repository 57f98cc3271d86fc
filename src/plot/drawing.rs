//! A chart as a list of primitives: ranges without values, grid, events, curves, axes, in this order.

pub use super::area::PanelArea;
use super::chart::{Chart, Panel};
use super::curves::draw_curves;
use super::frame::{AxesFrame, left_room};
use super::layout::{ChartLayout, Ruler, Sizes};
use super::primitive::{DrawnPrimitive, LineStyle, Rect, TextAnchor};
use super::theme::{ChartTheme, Dashes};
use crate::sorting::sort_by_number;

/// Largest distance of a hatching's lines from each other, in heights of the capitals.
const HATCH: f64 = 1.4;

/// Pixels by which adjacent tiles of a map overlap.
const SEAM: f64 = 0.5;

/// Opacity of a band and of a line of a cloud, of 255: overlapping ones add up.
const BAND_OPACITY: u8 = 46;
const CLOUD_OPACITY: u8 = 40;

/// A chart laid out.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// Pixels.
    pub size: [u32; 2],
    /// Title and description, for readers who do not see the picture.
    pub title: String,
    /// One sentence.
    pub description: String,
    /// From back to front.
    pub primitives: Vec<DrawnPrimitive>,
    /// Where values are, one per panel.
    pub areas: Vec<PanelArea>,
    /// Colours.
    pub theme: ChartTheme,
    /// Lengths.
    pub sizes: Sizes,
}

/// Lays `chart` out in `size` pixels.
pub fn draw_chart(chart: &Chart, size: [u32; 2], theme: ChartTheme) -> Drawing {
    let sizes = Sizes::new(chart, size);
    let (ruler, layout) = (Ruler::default(), ChartLayout::new(chart, size, &sizes));
    let mut drawing = Drawing {
        size,
        title: chart.title.clone(),
        description: chart.description.clone(),
        primitives: Vec::new(),
        areas: Vec::new(),
        theme,
        sizes,
    };
    let list = &mut drawing.primitives;
    list.push(DrawnPrimitive::Area {
        rect: Rect {
            left: 0.0,
            top: 0.0,
            right: f64::from(size[0]),
            bottom: f64::from(size[1]),
        },
        fill: theme.background,
    });
    let mut text = |y: f64, text: &str, size: f64, colour| {
        list.push(DrawnPrimitive::Text {
            at: [layout.left, y],
            text: text.to_owned(),
            size,
            anchor: TextAnchor::Start,
            colour,
        });
    };
    if !chart.title.is_empty() {
        text(layout.title, &chart.title, sizes.title, theme.text);
    }
    for (note, y) in chart.notes.iter().zip(&layout.notes) {
        text(*y, note, sizes.small, theme.faint_text);
    }
    let rooms: Vec<f64> = chart
        .panels
        .iter()
        .zip(&layout.cells)
        .map(|(panel, cell)| left_room(panel, cell, &ruler, &sizes))
        .collect();
    for (k, (panel, cell)) in chart.panels.iter().zip(&layout.cells).enumerate() {
        // Panels above each other begin at the same place.
        let column = rooms
            .iter()
            .skip(k % layout.columns)
            .step_by(layout.columns);
        let left = column.copied().fold(0.0, f64::max);
        let words = panel_words(panel, cell.width() - left, &ruler, &sizes);
        let frame = AxesFrame::new(panel, cell, left, &words, &ruler, &sizes);
        let area = PanelArea {
            rect: frame.area,
            x: frame.x,
            y: frame.y,
        };
        draw_shades(
            panel,
            &area,
            &ruler,
            &drawing.sizes,
            &theme,
            &mut drawing.primitives,
        );
        frame.draw_grid(&sizes, &theme, &mut drawing.primitives);
        draw_tiles(panel, &area, &mut drawing.primitives);
        draw_spread(panel, &area, &sizes, &theme, &mut drawing.primitives);
        draw_events(panel, &area, &sizes, &theme, &mut drawing.primitives);
        draw_marks(panel, &area, &sizes, &theme, &mut drawing.primitives);
        frame.draw_axes(panel, &sizes, &theme, &mut drawing.primitives);
        draw_curves(panel, &area, &sizes, &theme, &mut drawing.primitives);
        draw_words(panel, &area, &sizes, &theme, &mut drawing.primitives);
        drawing.areas.push(area);
    }
    drawing
}

/// The words above an area: those of events, and those of ranges too narrow for them.
fn panel_words(panel: &Panel, width: f64, ruler: &Ruler, sizes: &Sizes) -> Vec<(f64, String)> {
    let values = panel.points().map(|p| p[0]);
    let ends = panel.shades.iter().flat_map(|s| [s.from, s.to]);
    let (low, high) = values
        .chain(ends)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| {
            (l.min(v), h.max(v))
        });
    // Ranges without values come first: the others are also marked by lines.
    let mut words: Vec<(f64, String)> = Vec::new();
    for shade in &panel.shades {
        let share = (shade.to - shade.from).abs() / (high - low);
        let fits = share * width > ruler.width(&shade.word, sizes.small) + 3.0 * sizes.gap;
        if !fits {
            words.push((0.5 * (shade.from + shade.to), shade.word.clone()));
        }
    }
    let mut events: Vec<(f64, String)> = panel
        .events
        .iter()
        .map(|e| (e.x, e.label.clone()))
        .collect();
    sort_by_number(&mut events, |a| a.0);
    words.extend(events);
    words.dedup_by(|a, b| a.0 == b.0 && a.1 == b.1);
    words
}

/// The rectangles of a map; each extends a little under the next, so that no seam is visible.
fn draw_tiles(panel: &Panel, area: &PanelArea, list: &mut Vec<DrawnPrimitive>) {
    for tile in &panel.tiles {
        let (Some([left, bottom]), Some([right, top])) =
            (area.pixel(tile.from), area.pixel(tile.to))
        else {
            continue;
        };
        let rect = Rect {
            left,
            top: (top - SEAM).max(area.rect.top),
            right: (right + SEAM).min(area.rect.right),
            bottom,
        };
        let fill = tile.fill;
        list.push(DrawnPrimitive::Area { rect, fill });
    }
}

/// Hatched ranges with their words.
fn draw_shades(
    panel: &Panel,
    area: &PanelArea,
    ruler: &Ruler,
    sizes: &Sizes,
    theme: &ChartTheme,
    list: &mut Vec<DrawnPrimitive>,
) {
    for shade in &panel.shades {
        let (Some(a), Some(b)) = (area.x.pixel(shade.from), area.x.pixel(shade.to)) else {
            continue;
        };
        let middle = 0.5 * (a + b);
        // A single missing sample must be visible too.
        let half = (0.5 * (a - b).abs()).max(0.5 * sizes.curve);
        let rect = Rect {
            left: (middle - half).max(area.rect.left),
            right: (middle + half).min(area.rect.right),
            ..area.rect
        };
        let fill = theme.shade;
        list.push(DrawnPrimitive::Area { rect, fill });
        hatch_rect(&rect, sizes, theme, list);
        let wide = ruler.width(&shade.word, sizes.small);
        if wide + 2.0 * sizes.gap < rect.width() {
            let y = rect.top + 0.5 * rect.height();
            let pad = sizes.gap;
            let plate = Rect {
                left: middle - 0.5 * wide - pad,
                right: middle + 0.5 * wide + pad,
                top: y - 0.5 * sizes.small - pad,
                bottom: y + 0.5 * sizes.small + pad,
            };
            list.push(DrawnPrimitive::Area { rect: plate, fill });
            list.push(DrawnPrimitive::Text {
                at: [middle, y + 0.5 * sizes.small],
                text: shade.word.clone(),
                size: sizes.small,
                anchor: TextAnchor::Middle,
                colour: theme.faint_text,
            });
        }
    }
}

/// Lines rising to the right, cut at the edges of `rect`; lines of neighbouring ranges continue each other.
fn hatch_rect(rect: &Rect, sizes: &Sizes, theme: &ChartTheme, list: &mut Vec<DrawnPrimitive>) {
    let pitch = HATCH * sizes.text;
    let stroke = LineStyle::solid(theme.hatch, sizes.hair);
    let first = ((rect.left + rect.top) / pitch).ceil() as i64;
    let last = ((rect.right + rect.bottom) / pitch).floor() as i64;
    for k in first..=last {
        let sum = k as f64 * pitch;
        let left = rect.left.max(sum - rect.bottom);
        let right = rect.right.min(sum - rect.top);
        if right > left {
            list.push(DrawnPrimitive::Line {
                points: vec![[left, sum - left], [right, sum - right]],
                stroke,
                name: String::new(),
            });
        }
    }
}

/// Bands and clouds.
fn draw_spread(
    panel: &Panel,
    area: &PanelArea,
    sizes: &Sizes,
    theme: &ChartTheme,
    list: &mut Vec<DrawnPrimitive>,
) {
    let [r, g, b, _] = theme.colour(0);
    let pixels = |points: &[[f64; 2]]| -> Vec<[f64; 2]> {
        points.iter().filter_map(|p| area.pixel(*p)).collect()
    };
    for band in &panel.bands {
        let (mut points, back) = (pixels(&band.lower), pixels(&band.upper));
        points.extend(back.into_iter().rev());
        let fill = [r, g, b, BAND_OPACITY];
        list.push(DrawnPrimitive::Region { points, fill });
    }
    let stroke = LineStyle::solid([r, g, b, CLOUD_OPACITY], 0.8 * sizes.hair);
    for points in &panel.cloud {
        list.push(DrawnPrimitive::Line {
            points: pixels(points),
            stroke,
            name: String::new(),
        });
    }
}

fn draw_events(
    panel: &Panel,
    area: &PanelArea,
    sizes: &Sizes,
    theme: &ChartTheme,
    list: &mut Vec<DrawnPrimitive>,
) {
    let stroke = LineStyle {
        colour: theme.event,
        width: sizes.hair,
        dashes: Dashes::Long,
    };
    for event in &panel.events {
        if let Some(x) = area.x.pixel(event.x) {
            list.push(DrawnPrimitive::Line {
                points: vec![[x, area.rect.top], [x, area.rect.bottom]],
                stroke,
                name: String::new(),
            });
        }
    }
}

/// Words beside their points, away from the middle of the area.
fn draw_words(
    panel: &Panel,
    area: &PanelArea,
    sizes: &Sizes,
    theme: &ChartTheme,
    list: &mut Vec<DrawnPrimitive>,
) {
    let middle = 0.5 * (area.rect.top + area.rect.bottom);
    for word in &panel.words {
        let Some([x, y]) = area.pixel(word.at) else {
            continue;
        };
        let down = y > middle;
        let shift = if down {
            sizes.gap + sizes.heading
        } else {
            -sizes.gap
        };
        list.push(DrawnPrimitive::Text {
            at: [x, y + shift],
            text: word.text.clone(),
            size: sizes.heading,
            anchor: TextAnchor::Middle,
            colour: theme.text,
        });
    }
}

fn draw_marks(
    panel: &Panel,
    area: &PanelArea,
    sizes: &Sizes,
    theme: &ChartTheme,
    list: &mut Vec<DrawnPrimitive>,
) {
    let stroke = LineStyle {
        dashes: Dashes::Long,
        ..LineStyle::solid(theme.mark, 1.2 * sizes.hair)
    };
    for [from, to] in &panel.lines {
        if let (Some(from), Some(to)) = (area.pixel(*from), area.pixel(*to)) {
            list.push(DrawnPrimitive::Line {
                points: vec![from, to],
                stroke,
                name: String::new(),
            });
        }
    }
    for mark in &panel.marks {
        if let Some(centre) = area.pixel(*mark) {
            list.push(DrawnPrimitive::Circle {
                centre,
                radius: 2.2 * sizes.curve,
                fill: theme.background,
                stroke: LineStyle::solid(theme.mark, 1.3 * sizes.hair),
            });
        }
    }
}
