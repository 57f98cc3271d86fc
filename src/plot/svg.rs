//! A drawing as SVG text: real texts, one element per line, names for the curves.

use super::drawing::Drawing;
use super::primitive::{DrawnPrimitive, LineStyle, TextAnchor};
use super::theme::Colour;
use crate::diag::xml_text;
use crate::numbers::decimal::trimmed;
use std::fmt::Write;

/// Height of the capitals in sizes of the font, for the preferred font.
const CAPITALS_PER_EM: f64 = 0.714;

/// Fonts in order of preference.
const FAMILY: &str = "Noto Sans, Open Sans, DejaVu Sans, Helvetica, Arial, sans-serif";

/// The drawing as a complete SVG document.
pub fn write_svg(drawing: &Drawing) -> String {
    document(drawing, |primitives, text| {
        for primitive in primitives {
            write_element(primitive, text);
            text.push('\n');
        }
    })
}

/// The document around the elements that are written.
fn document(drawing: &Drawing, write: impl Fn(&[DrawnPrimitive], &mut String)) -> String {
    let [width, height] = drawing.size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"title desc\" \
         font-family=\"{FAMILY}\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n"
    );
    let _ = writeln!(
        text,
        "<title id=\"title\">{}</title>",
        xml_text(&drawing.title)
    );
    let _ = writeln!(
        text,
        "<desc id=\"desc\">{}</desc>",
        xml_text(&drawing.description)
    );
    write(&drawing.primitives, &mut text);
    text.push_str("</svg>\n");
    text
}

/// The drawing as an element of a page, whose style determines the colours: `names` are the page's names for some of
/// them. `id` is the element's, and the prefix of those of its title and description.
pub fn write_inline(drawing: &Drawing, id: &str, names: &[(Colour, String)]) -> String {
    // Quotes are escaped in all texts of a scene, because some texts become attributes.
    let mut text = document(drawing, write_joined)
        .replace("\"title desc\"", &format!("\"{id}-title {id}-desc\""))
        .replace("id=\"title\"", &format!("id=\"{id}-title\""))
        .replace("id=\"desc\"", &format!("id=\"{id}-desc\""))
        .replacen("<svg ", &format!("<svg id=\"{id}\" "), 1);
    for ([r, g, b, _], name) in names {
        text = text.replace(
            &format!("\"#{r:02x}{g:02x}{b:02x}\""),
            &format!("\"{name}\""),
        );
    }
    text
}

/// The same with neighbouring lines of one style, such as those of a grid, as one path each.
fn write_joined(primitives: &[DrawnPrimitive], out: &mut String) {
    let style = |primitive: &DrawnPrimitive| match primitive {
        // Where lines that can be seen through cross, two of them are darker than one.
        DrawnPrimitive::Line { stroke, name, .. } if name.is_empty() && stroke.colour[3] == 255 => {
            Some(stroke_attributes(*stroke))
        }
        _ => None,
    };
    let is_one =
        |a: &DrawnPrimitive, b: &DrawnPrimitive| style(a).is_some_and(|own| style(b) == Some(own));
    for group in primitives.chunk_by(is_one) {
        match (group, style(&group[0])) {
            ([alone], _) => write_element(alone, out),
            (lines, Some(style)) => {
                let lines = lines.iter().filter_map(|line| match line {
                    DrawnPrimitive::Line { points, .. } => {
                        Some(format!("M{}", corner_list(points)))
                    }
                    _ => None,
                });
                let _ = write!(out, "<path d=\"{}\"{style}/>", lines.collect::<String>());
            }
            (others, None) => others.iter().for_each(|other| write_element(other, out)),
        }
        out.push('\n');
    }
}

// Writing to a String cannot fail.
fn write_element(primitive: &DrawnPrimitive, out: &mut String) {
    let _ = match primitive {
        DrawnPrimitive::Area { rect, fill } => write!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
            pixel_number(rect.left),
            pixel_number(rect.top),
            pixel_number(rect.width()),
            pixel_number(rect.height()),
            paint_attributes("fill", *fill)
        ),
        DrawnPrimitive::Line {
            points,
            stroke,
            name,
        } => write_line(points, *stroke, name, out),
        DrawnPrimitive::Region { points, fill } => write!(
            out,
            "<polygon points=\"{}\"{}/>",
            corner_list(points),
            paint_attributes("fill", *fill)
        ),
        DrawnPrimitive::Circle {
            centre,
            radius,
            fill,
            stroke,
        } => write!(
            out,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}{}/>",
            pixel_number(centre[0]),
            pixel_number(centre[1]),
            pixel_number(*radius),
            paint_attributes("fill", *fill),
            stroke_attributes(*stroke)
        ),
        DrawnPrimitive::Text {
            at,
            text,
            size,
            anchor,
            colour,
        } => write!(
            out,
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\"{}{}>{}</text>",
            pixel_number(at[0]),
            pixel_number(at[1]),
            pixel_number(size / CAPITALS_PER_EM),
            match anchor {
                TextAnchor::Start => "",
                TextAnchor::Middle => " text-anchor=\"middle\"",
                TextAnchor::End => " text-anchor=\"end\"",
            },
            paint_attributes("fill", *colour),
            xml_text(text)
        ),
    };
}

fn write_line(
    points: &[[f64; 2]],
    stroke: LineStyle,
    name: &str,
    out: &mut String,
) -> std::fmt::Result {
    write!(
        out,
        "<polyline points=\"{}\"{}",
        corner_list(points),
        stroke_attributes(stroke)
    )?;
    if name.is_empty() {
        out.write_str("/>")
    } else {
        write!(out, "><title>{}</title></polyline>", xml_text(name))
    }
}

fn corner_list(points: &[[f64; 2]]) -> String {
    let texts = points
        .iter()
        .map(|[x, y]| format!("{},{}", pixel_number(*x), pixel_number(*y)));
    texts.collect::<Vec<_>>().join(" ")
}

fn stroke_attributes(stroke: LineStyle) -> String {
    let mut text = paint_attributes("stroke", stroke.colour);
    let _ = write!(text, " stroke-width=\"{}\"", pixel_number(stroke.width));
    if let Some([dash, gap]) = stroke.dashes.lengths(stroke.width) {
        let dash = pixel_number(dash);
        let _ = write!(
            text,
            " stroke-dasharray=\"{dash} {}\" stroke-linecap=\"butt\"",
            pixel_number(gap)
        );
    }
    text
}

fn paint_attributes(attribute: &str, [r, g, b, a]: Colour) -> String {
    let mut text = format!(" {attribute}=\"#{r:02x}{g:02x}{b:02x}\"");
    if a < 255 {
        let opacity = pixel_number(f64::from(a) / 255.0);
        let _ = write!(text, " {attribute}-opacity=\"{opacity}\"");
    }
    text
}

/// Hundredths of a pixel are finer than any screen.
fn pixel_number(value: f64) -> String {
    trimmed(value, 2)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_pixels_in_hundredths() {
        for (value, text) in [
            (1.0, "1"),
            (0.125, "0.12"),
            (-0.001, "0"),
            (12.5, "12.5"),
            (100.0, "100"),
        ] {
            assert_eq!(pixel_number(value), text);
        }
    }
}
