//! A drawing as SVG text: real texts, one element per line, names for the curves.

use super::drawing::Drawing;
use super::primitive::{Anchor, Primitive, Stroke};
use super::theme::Colour;
use std::fmt::Write;

/// Height of the capitals in sizes of the font, for the face that is asked for first.
const CAPITALS_PER_EM: f64 = 0.714;

/// Faces to use, the first that is there.
const FAMILY: &str = "Noto Sans, Open Sans, DejaVu Sans, Helvetica, Arial, sans-serif";

/// The drawing as a complete SVG document.
pub fn write(drawing: &Drawing) -> String {
    let [width, height] = drawing.size;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" role=\"img\" aria-labelledby=\"title desc\" \
         font-family=\"{FAMILY}\" fill=\"none\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n"
    );
    let _ = writeln!(
        text,
        "<title id=\"title\">{}</title>",
        escaped(&drawing.title)
    );
    let _ = writeln!(
        text,
        "<desc id=\"desc\">{}</desc>",
        escaped(&drawing.description)
    );
    for primitive in &drawing.primitives {
        element(primitive, &mut text);
        text.push('\n');
    }
    text.push_str("</svg>\n");
    text
}

// Writing to a String cannot fail.
fn element(primitive: &Primitive, out: &mut String) {
    let _ = match primitive {
        Primitive::Area { rect, fill } => write!(
            out,
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"{}/>",
            number(rect.left),
            number(rect.top),
            number(rect.width()),
            number(rect.height()),
            paint("fill", *fill)
        ),
        Primitive::Line {
            points,
            stroke,
            name,
        } => line(points, *stroke, name, out),
        Primitive::Region { points, fill } => write!(
            out,
            "<polygon points=\"{}\"{}/>",
            corners(points),
            paint("fill", *fill)
        ),
        Primitive::Circle {
            centre,
            radius,
            fill,
            stroke,
        } => write!(
            out,
            "<circle cx=\"{}\" cy=\"{}\" r=\"{}\"{}{}/>",
            number(centre[0]),
            number(centre[1]),
            number(*radius),
            paint("fill", *fill),
            outline(*stroke)
        ),
        Primitive::Text {
            at,
            text,
            size,
            anchor,
            colour,
        } => write!(
            out,
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\"{}{}>{}</text>",
            number(at[0]),
            number(at[1]),
            number(size / CAPITALS_PER_EM),
            match anchor {
                Anchor::Start => "",
                Anchor::Middle => " text-anchor=\"middle\"",
                Anchor::End => " text-anchor=\"end\"",
            },
            paint("fill", *colour),
            escaped(text)
        ),
    };
}

fn line(points: &[[f64; 2]], stroke: Stroke, name: &str, out: &mut String) -> std::fmt::Result {
    write!(
        out,
        "<polyline points=\"{}\"{}",
        corners(points),
        outline(stroke)
    )?;
    if name.is_empty() {
        out.write_str("/>")
    } else {
        write!(out, "><title>{}</title></polyline>", escaped(name))
    }
}

fn corners(points: &[[f64; 2]]) -> String {
    let texts = points
        .iter()
        .map(|[x, y]| format!("{},{}", number(*x), number(*y)));
    texts.collect::<Vec<_>>().join(" ")
}

fn outline(stroke: Stroke) -> String {
    let mut text = paint("stroke", stroke.colour);
    let _ = write!(text, " stroke-width=\"{}\"", number(stroke.width));
    if let Some([dash, gap]) = stroke.dashes.lengths(stroke.width) {
        let dash = number(dash);
        let _ = write!(
            text,
            " stroke-dasharray=\"{dash} {}\" stroke-linecap=\"butt\"",
            number(gap)
        );
    }
    text
}

fn paint(attribute: &str, [r, g, b, a]: Colour) -> String {
    let mut text = format!(" {attribute}=\"#{r:02x}{g:02x}{b:02x}\"");
    if a < 255 {
        let opacity = number(f64::from(a) / 255.0);
        let _ = write!(text, " {attribute}-opacity=\"{opacity}\"");
    }
    text
}

/// Hundredths of a pixel are finer than any screen.
fn number(value: f64) -> String {
    let text = format!("{value:.2}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" {
        "0".to_owned()
    } else {
        short.to_owned()
    }
}

/// Characters of a text that XML would read, and those it forbids.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_cannot_break_the_document() {
        assert_eq!(
            escaped("a<b & \"c\"\u{0}\n>"),
            "a&lt;b &amp; &quot;c&quot;  &gt;"
        );
    }

    #[test]
    fn numbers_are_short() {
        for (value, text) in [
            (1.0, "1"),
            (0.125, "0.12"),
            (-0.001, "0"),
            (12.5, "12.5"),
            (100.0, "100"),
        ] {
            assert_eq!(number(value), text);
        }
    }
}
