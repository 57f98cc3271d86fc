//! Axes of one panel: their limits, the area within its cell, grid, tick marks and numbers.

use super::chart::Panel;
use super::headings::{Heading, Words};
use super::layout::{Ruler, Sizes};
use super::primitive::{DrawnPrimitive, LineStyle, Rect, TextAnchor};
use super::scale::{Scale, ScaleKind, value_limits};
use super::theme::ChartTheme;
use super::ticks::{Ticks, scale_ticks};

/// Pixels between two numbers of the vertical axis, in heights of the capitals.
const ROOM_Y: f64 = 2.8;

/// Pixels a number of the horizontal axis takes at least, in heights of the capitals.
const ROOM_X: f64 = 6.5;

/// The smallest height that an area keeps when words are placed above it, in heights of the capitals.
const WORDLESS: f64 = 9.0;

/// Smallest side of an area in pixels: in a picture that is too small, sizes must not become negative.
const SMALLEST_AREA: f64 = 8.0;

/// The properties of a panel that depend on its size.
pub struct AxesFrame {
    /// Where values are drawn.
    pub area: Rect,
    /// Values to pixels from left to right.
    pub x: Scale,
    /// Values to pixels from bottom to top.
    pub y: Scale,
    x_ticks: Ticks,
    y_ticks: Ticks,
    heading: Heading,
    words: Words,
    corner: [f64; 2],
}

/// Widest number of the vertical axis in pixels, with its tick: the room left of the area.
pub fn left_room(panel: &Panel, cell: &Rect, ruler: &Ruler, sizes: &Sizes) -> f64 {
    let area = Rect {
        left: cell.left + 5.0 * sizes.text,
        top: cell.top + 3.0 * sizes.text,
        right: cell.right,
        bottom: cell.bottom - 5.0 * sizes.text,
    };
    let (_, y) = panel_scales(panel, &area);
    let list = scale_ticks(&y, most_y(&area, sizes), &panel.y.unit).list;
    let widest = list
        .iter()
        .map(|t| ruler.width(&t.text, sizes.text))
        .fold(0.0, f64::max);
    widest + sizes.tick + sizes.gap
}

impl AxesFrame {
    /// Lays out `panel` in `cell` with `left` pixels for the numbers of the vertical axis and the given words
    /// (place on the axis, text) above the area.
    pub fn new(
        panel: &Panel,
        cell: &Rect,
        left: f64,
        words: &[(f64, String)],
        ruler: &Ruler,
        sizes: &Sizes,
    ) -> Self {
        let below = sizes.tick + sizes.gap + sizes.line(sizes.text) + sizes.text + 1.5 * sizes.gap;
        let mut area = Rect {
            left: (cell.left + left).round(),
            top: cell.top + sizes.line(sizes.text),
            right: (cell.right - 2.0 * sizes.text).round(),
            bottom: (cell.bottom - below).round(),
        };
        area.right = area.right.max(area.left + SMALLEST_AREA);
        area.bottom = area.bottom.max(area.top + SMALLEST_AREA);
        let (x, y) = panel_scales(panel, &area);
        let factor = scale_ticks(&y, most_y(&area, sizes), &panel.y.unit).factor;
        let wide = cell.right - cell.left;
        let heading = Heading::new(panel, panel.y.heading(factor), wide, ruler, sizes);
        let free = area.bottom - cell.top - heading.height(sizes) - WORDLESS * sizes.text;
        let words = Words::new(words, &x, free, ruler, sizes);
        let above = heading.height(sizes) + words.height(sizes) + 0.5 * sizes.gap;
        area.top = (cell.top + above).round().min(area.bottom - SMALLEST_AREA);
        let (x, y) = panel_scales(panel, &area);
        let mut y_ticks = scale_ticks(&y, most_y(&area, sizes), &panel.y.unit);
        y_ticks.list.retain(|t| y.holds_about(t.value));
        let x_ticks = x_ticks(panel, &x, &area, ruler, sizes);
        // The heading was made with the power of ten for a slightly different height.
        let heading = Heading::new(panel, panel.y.heading(y_ticks.factor), wide, ruler, sizes);
        Self {
            area,
            x,
            y,
            x_ticks,
            y_ticks,
            heading,
            words,
            corner: [cell.left, cell.top],
        }
    }

    /// Grid lines: below everything else.
    pub fn draw_grid(&self, sizes: &Sizes, theme: &ChartTheme, list: &mut Vec<DrawnPrimitive>) {
        let stroke = LineStyle::solid(theme.grid, sizes.hair);
        for x in tick_places(&self.x_ticks, &self.x) {
            list.push(hair_line([x, self.area.top], [x, self.area.bottom], stroke));
        }
        for y in tick_places(&self.y_ticks, &self.y) {
            list.push(hair_line([self.area.left, y], [self.area.right, y], stroke));
        }
    }

    /// Axes, tick marks, numbers, labels, legend, words.
    pub fn draw_axes(
        &self,
        panel: &Panel,
        sizes: &Sizes,
        theme: &ChartTheme,
        list: &mut Vec<DrawnPrimitive>,
    ) {
        let (area, stroke) = (&self.area, LineStyle::solid(theme.axis, sizes.hair));
        // Both axes as one line, on whole pixels.
        let corners = [
            [snap_pixel(area.left), snap_pixel(area.top)],
            [snap_pixel(area.left), snap_pixel(area.bottom)],
            [snap_pixel(area.right), snap_pixel(area.bottom)],
        ];
        list.push(DrawnPrimitive::Line {
            points: corners.to_vec(),
            stroke,
            name: String::new(),
        });
        // Ticks and numbers below and to the left of the area.
        for (tick, x) in self
            .x_ticks
            .list
            .iter()
            .zip(tick_places(&self.x_ticks, &self.x))
        {
            list.push(hair_line(
                [x, area.bottom],
                [x, area.bottom + sizes.tick],
                stroke,
            ));
            let at = [x, area.bottom + sizes.tick + sizes.gap + sizes.text];
            list.push(number_label(
                at,
                &tick.text,
                TextAnchor::Middle,
                sizes,
                theme,
            ));
        }
        for (tick, y) in self
            .y_ticks
            .list
            .iter()
            .zip(tick_places(&self.y_ticks, &self.y))
        {
            list.push(hair_line(
                [area.left - sizes.tick, y],
                [area.left, y],
                stroke,
            ));
            let at = [area.left - sizes.tick - sizes.gap, y + 0.5 * sizes.text];
            list.push(number_label(at, &tick.text, TextAnchor::End, sizes, theme));
        }
        // The horizontal axis is named below, everything else above the area.
        let label = panel.x.heading(self.x_ticks.factor);
        let baseline = area.bottom + sizes.tick + sizes.gap + sizes.line(sizes.text) + sizes.text;
        let at = [0.5 * (area.left + area.right), baseline];
        list.push(number_label(at, &label, TextAnchor::Middle, sizes, theme));
        self.heading.draw(panel, self.corner, sizes, theme, list);
        self.words.draw(area, sizes, theme, list);
    }
}

/// Scales of both axes over `area`.
fn panel_scales(panel: &Panel, area: &Rect) -> (Scale, Scale) {
    let shades = panel.shades.iter().flat_map(|s| [s.from, s.to]);
    let events = panel.events.iter().map(|e| e.x);
    let x = panel.points().map(|p| p[0]).chain(shades).chain(events);
    let mut x = value_limits(panel.x.scale, x, panel.x.tight);
    let mut y = value_limits(panel.y.scale, panel.points().map(|p| p[1]), panel.y.tight);
    let is_linear = panel.x.scale == ScaleKind::Linear && panel.y.scale == ScaleKind::Linear;
    if panel.equal && is_linear {
        let unit = ((x[1] - x[0]) / area.width()).max((y[1] - y[0]) / area.height());
        x = widen_range(x, unit * area.width());
        y = widen_range(y, unit * area.height());
    }
    let scale = |kind, [low, high]: [f64; 2], start, end| Scale {
        kind,
        low,
        high,
        start,
        end,
    };
    (
        scale(panel.x.scale, x, area.left, area.right),
        scale(panel.y.scale, y, area.bottom, area.top),
    )
}

/// A range of the given length about the same middle.
fn widen_range([low, high]: [f64; 2], length: f64) -> [f64; 2] {
    let middle = 0.5 * (low + high);
    [middle - 0.5 * length, middle + 0.5 * length]
}

fn most_y(area: &Rect, sizes: &Sizes) -> usize {
    (area.height() / (ROOM_Y * sizes.text))
        .floor()
        .clamp(2.0, 12.0) as usize
}

/// The largest number of labels that fit next to each other.
fn x_ticks(panel: &Panel, x: &Scale, area: &Rect, ruler: &Ruler, sizes: &Sizes) -> Ticks {
    let mut most = (area.width() / (ROOM_X * sizes.text))
        .floor()
        .clamp(2.0, 16.0) as usize;
    loop {
        let mut found = scale_ticks(x, most, &panel.x.unit);
        found.list.retain(|t| x.holds_about(t.value));
        let mut end = f64::NEG_INFINITY;
        let crowded = found.list.iter().any(|tick| {
            let half = 0.5 * ruler.width(&tick.text, sizes.text);
            let Some(middle) = x.pixel(tick.value).filter(|_| half > 0.0) else {
                return false;
            };
            let touches = middle - half < end + 1.5 * sizes.gap;
            end = middle + half;
            touches
        });
        if !crowded || most <= 2 {
            return found;
        }
        most -= 1;
    }
}

impl Scale {
    /// Whether a tick lies on the axis, within rounding.
    fn holds_about(&self, value: f64) -> bool {
        let (low, high) = (
            self.start.min(self.end) - 0.01,
            self.start.max(self.end) + 0.01,
        );
        self.pixel(value).is_some_and(|p| (low..=high).contains(&p))
    }
}

fn tick_places<'a>(ticks: &'a Ticks, scale: &'a Scale) -> impl Iterator<Item = f64> + 'a {
    ticks
        .list
        .iter()
        .map(|t| snap_pixel(scale.pixel(t.value).unwrap_or(scale.start)))
}

/// The middle of a pixel: lines one pixel wide are crisp there.
fn snap_pixel(pixel: f64) -> f64 {
    pixel.floor() + 0.5
}

fn hair_line(from: [f64; 2], to: [f64; 2], stroke: LineStyle) -> DrawnPrimitive {
    DrawnPrimitive::Line {
        points: vec![from, to],
        stroke,
        name: String::new(),
    }
}

fn number_label(
    at: [f64; 2],
    text: &str,
    anchor: TextAnchor,
    sizes: &Sizes,
    theme: &ChartTheme,
) -> DrawnPrimitive {
    DrawnPrimitive::Text {
        at,
        text: text.to_owned(),
        size: sizes.text,
        anchor,
        colour: theme.text,
    }
}
