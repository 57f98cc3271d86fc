//! Writes a drawing as a PDF of one page: lines as lines, texts in the standard fonts of every reader (Helvetica, and
//! Symbol for Greek), so that nothing is embedded.

use super::drawing::Drawing;
use super::pdf_text::{TextRun, text_runs, text_width};
use super::primitive::{DrawnPrimitive, LineStyle, TextAnchor};
use super::theme::Colour;
use crate::numbers::decimal::trimmed;
use std::fmt::Write;

/// Points of a pixel: 96 pixels are an inch, and 72 points.
const POINT: f64 = 0.75;

/// Height of Helvetica's capitals in sizes of the font.
const CAPITALS_PER_EM: f64 = 0.718;

/// Length of the control arm of a quarter circle's Bézier curve, relative to its radius.
const QUARTER: f64 = 0.552_284_75;

/// The drawing as a complete document. The same drawing gives the same bytes.
pub fn write_pdf(drawing: &Drawing) -> Vec<u8> {
    let size = drawing.size.map(f64::from);
    // Pixels become points, and y goes up: one matrix for everything.
    let mut page = Page::default();
    let _ = writeln!(
        page.content,
        "{} 0 0 {} 0 {} cm 1 J 1 j",
        point_number(POINT),
        point_number(-POINT),
        point_number(size[1] * POINT)
    );
    drawing
        .primitives
        .iter()
        .for_each(|p| page.draw_primitive(p));
    // Every opacity that occurs is a graphics state of its own.
    let states: String = page
        .opacities
        .iter()
        .map(|a| {
            let share = point_number(f64::from(*a) / 255.0);
            format!("/A{a} << /ca {share} /CA {share} >> ")
        })
        .collect();
    let [width, height] = size.map(|side| point_number(side * POINT));
    let face = |name: &str, encoding: &str| {
        format!("<< /Type /Font /Subtype /Type1 /BaseFont /{name}{encoding} >>")
    };
    // The objects refer to each other by their numbers, in this order from 1.
    let objects = [
        "<< /Type /Catalog /Pages 2 0 R >>".to_owned(),
        "<< /Type /Pages /Kids [3 0 R] /Count 1 >>".to_owned(),
        format!(
            "<< /Type /Page /Parent 2 0 R /MediaBox [0 0 {width} {height}] /Contents 4 0 R \
             /Resources << /Font << /H 5 0 R /S 6 0 R >> /ExtGState << {states}>> >> >>"
        ),
        format!(
            "<< /Length {} >>\nstream\n{}endstream",
            page.content.len(),
            page.content
        ),
        face("Helvetica", " /Encoding /WinAnsiEncoding"),
        face("Symbol", ""),
        format!(
            "<< /Title <{}> /Producer (mechanim) >>",
            utf16_hex(&drawing.title)
        ),
    ];
    numbered_document(&objects)
}

/// Objects with the table of their offsets.
fn numbered_document(objects: &[String]) -> Vec<u8> {
    let mut text = "%PDF-1.4\n".to_owned();
    let mut places = Vec::new();
    for (k, object) in objects.iter().enumerate() {
        places.push(text.len());
        let _ = writeln!(text, "{} 0 obj\n{object}\nendobj", k + 1);
    }
    let (table, count) = (text.len(), objects.len() + 1);
    let _ = write!(text, "xref\n0 {count}\n0000000000 65535 f \n");
    for place in places {
        let _ = writeln!(text, "{place:010} 00000 n ");
    }
    let _ = write!(
        text,
        "trailer\n<< /Size {count} /Root 1 0 R /Info {} 0 R >>\nstartxref\n{table}\n%%EOF\n",
        objects.len()
    );
    text.into_bytes()
}

/// The page while it grows.
#[derive(Default)]
struct Page {
    content: String,
    /// Opacities that occur, each once.
    opacities: Vec<u8>,
}

// Writing to a String cannot fail.
impl Page {
    fn draw_primitive(&mut self, primitive: &DrawnPrimitive) {
        // Each primitive is painted between saving and restoring the graphics state.
        match primitive {
            DrawnPrimitive::Area { rect, fill } => {
                self.begin_state(*fill, None);
                let [x, y, w, h] =
                    [rect.left, rect.top, rect.width(), rect.height()].map(point_number);
                let _ = writeln!(self.content, "{x} {y} {w} {h} re f Q");
            }
            DrawnPrimitive::Line { points, stroke, .. } => {
                self.begin_state(stroke.colour, Some(stroke));
                self.add_path(points);
                self.content.push_str("S Q\n");
            }
            DrawnPrimitive::Region { points, fill } => {
                self.begin_state(*fill, None);
                self.add_path(points);
                self.content.push_str("h f Q\n");
            }
            DrawnPrimitive::Circle {
                centre,
                radius,
                fill,
                stroke,
            } => {
                self.begin_state(*fill, None);
                self.add_round(*centre, *radius);
                self.content.push_str("f Q\n");
                self.begin_state(stroke.colour, Some(stroke));
                self.add_round(*centre, *radius);
                self.content.push_str("S Q\n");
            }
            DrawnPrimitive::Text {
                at,
                text,
                size,
                anchor,
                colour,
            } => {
                self.begin_state(*colour, None);
                self.add_text(*at, text, size / CAPITALS_PER_EM, *anchor);
                self.content.push_str("Q\n");
            }
        }
    }

    /// Saves the state and sets colours and line style.
    fn begin_state(&mut self, [r, g, b, a]: Colour, stroke: Option<&LineStyle>) {
        let [r, g, b] = [r, g, b].map(|code| point_number(f64::from(code) / 255.0));
        let operator = if stroke.is_some() { "RG" } else { "rg" };
        let _ = write!(self.content, "q {r} {g} {b} {operator} ");
        if a < 255 {
            if !self.opacities.contains(&a) {
                self.opacities.push(a);
            }
            let _ = write!(self.content, "/A{a} gs ");
        }
        let Some(stroke) = stroke else { return };
        let _ = write!(self.content, "{} w ", point_number(stroke.width));
        if let Some([dash, gap]) = stroke.dashes.lengths(stroke.width) {
            let _ = write!(
                self.content,
                "0 J [{} {}] 0 d ",
                point_number(dash),
                point_number(gap)
            );
        }
    }

    fn add_path(&mut self, points: &[[f64; 2]]) {
        for (k, [x, y]) in points.iter().enumerate() {
            let operator = if k == 0 { 'm' } else { 'l' };
            let _ = write!(
                self.content,
                "{} {} {operator} ",
                point_number(*x),
                point_number(*y)
            );
        }
    }

    /// A circle of four curves.
    fn add_round(&mut self, [x, y]: [f64; 2], r: f64) {
        let h = QUARTER * r;
        let _ = write!(
            self.content,
            "{} {} m ",
            point_number(x + r),
            point_number(y)
        );
        for [a, b, c] in [
            [[r, h], [h, r], [0.0, r]],
            [[-h, r], [-r, h], [-r, 0.0]],
            [[-r, -h], [-h, -r], [0.0, -r]],
            [[h, -r], [r, -h], [r, 0.0]],
        ] {
            for [dx, dy] in [a, b, c] {
                let _ = write!(
                    self.content,
                    "{} {} ",
                    point_number(x + dx),
                    point_number(y + dy)
                );
            }
            self.content.push_str("c ");
        }
    }

    fn add_text(&mut self, at: [f64; 2], text: &str, size: f64, anchor: TextAnchor) {
        let width = text_width(text) * size;
        let mut x = at[0]
            - match anchor {
                TextAnchor::Start => 0.0,
                TextAnchor::Middle => 0.5 * width,
                TextAnchor::End => width,
            };
        self.content.push_str("BT ");
        for TextRun {
            face,
            codes,
            width,
            scale,
            drop,
        } in text_runs(text)
        {
            let _ = write!(
                self.content,
                "/{face} {} Tf 1 0 0 -1 {} {} Tm <",
                point_number(size * scale),
                point_number(x),
                point_number(at[1] + drop * size)
            );
            for code in codes {
                let _ = write!(self.content, "{code:02x}");
            }
            self.content.push_str("> Tj ");
            x += width * size;
        }
        self.content.push_str("ET ");
    }
}

fn utf16_hex(text: &str) -> String {
    let codes = std::iter::once(0xfeff).chain(text.encode_utf16());
    codes.map(|code| format!("{code:04x}")).collect()
}

/// Thousandths are finer than the resolution of any printer.
fn point_number(value: f64) -> String {
    trimmed(value, 3)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::super::layout::Sizes;
    use super::super::theme::ChartTheme;
    use super::*;

    #[test]
    fn the_table_leads_to_every_object() {
        let drawing = Drawing {
            size: [200, 100],
            title: "β".to_owned(),
            description: String::new(),
            primitives: vec![
                DrawnPrimitive::Text {
                    at: [10.0, 20.0],
                    text: "φ₁ = 3 mm".to_owned(),
                    size: 8.0,
                    anchor: TextAnchor::Start,
                    colour: [0, 0, 0, 128],
                },
                DrawnPrimitive::Circle {
                    centre: [50.0, 50.0],
                    radius: 5.0,
                    fill: [255; 4],
                    stroke: LineStyle::solid([0, 0, 0, 255], 1.0),
                },
            ],
            areas: Vec::new(),
            theme: ChartTheme::LIGHT,
            sizes: Sizes::scaled(1.0),
        };
        let text = String::from_utf8(write_pdf(&drawing)).unwrap();
        let table = text.find("xref\n").unwrap();
        let entries: Vec<usize> = text[table..]
            .lines()
            .filter(|l| l.ends_with("n "))
            .map(|l| l[..10].parse().unwrap())
            .collect();
        assert_eq!(entries.len(), 7);
        for (k, place) in entries.iter().enumerate() {
            assert!(text[*place..].starts_with(&format!("{} 0 obj\n", k + 1)));
        }
        assert!(text.ends_with(&format!("startxref\n{table}\n%%EOF\n")));
        let length: usize = text
            .split("/Length ")
            .nth(1)
            .unwrap()
            .split(' ')
            .next()
            .unwrap()
            .parse()
            .unwrap();
        let begin = text.find("stream\n").unwrap() + 7;
        assert_eq!(text.find("endstream").unwrap() - begin, length);
        assert!(text.contains("/A128 << /ca 0.502") && text.contains("/S 11"));
    }
}
