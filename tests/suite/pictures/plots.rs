//! Plots: what is drawn is the motion, nothing is drawn where there is none, and the files can be read.

use crate::driven::{Driven, solve};
use crate::program::Workspace;
use mechanim::charts::motion::motion_chart;
use mechanim::diag::Source;
use mechanim::plot::playhead::playhead_marks;
use mechanim::plot::primitive::DrawnPrimitive;
use mechanim::plot::raster::ChartPainter;
use mechanim::plot::{
    Axis, Chart, ChartTheme, Drawing, Panel, PlotSeries, ScaleKind, draw_chart, svg, usual_size,
};
use mechanim::scene::{Overrides, load_scene};
use proptest::prelude::*;

/// A crank that is longer than its rod by default cannot turn: no pose between 48.59° and 131.41°.
fn crank(r: f64, l: f64) -> String {
    format!(
        r#"
title = "crank <{r}> & rod"
units = {{ length = "mm", angle = "deg" }}
duration = 4
[parameters]
r = {r}
L = {l}
[inputs]
phi = "90*t"
[loops]
A = "Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) Tx(-h)"
[guess]
h = {h}
[outputs]
stroke = "h"
[[plots]]
title = "Stroke"
x = "phi"
y = ["stroke", "pin = r*cos(phi)", "d(stroke, phi)", "d(stroke, phi, 2)"]
marks = [[180, 0]]
lines = [[0, 0, 360, 0]]
"#,
        h = r + l
    )
}

fn charted(text: &str, samples: usize) -> Chart {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    let scene = load_scene(&source, &Overrides::default())
        .unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let last = (samples - 1) as f64;
    let times: Vec<f64> = (0..samples)
        .map(|k| scene.actuation.duration * k as f64 / last)
        .collect();
    let trajectory = solve(&scene, &times).unwrap();
    motion_chart(
        &scene.system().unwrap(),
        &scene.actuation,
        &scene.plots,
        &trajectory,
    )
}

fn drawn(chart: &Chart) -> Drawing {
    draw_chart(chart, usual_size(chart), ChartTheme::LIGHT)
}

/// One element of an XML document.
#[derive(Debug, PartialEq)]
struct Element {
    name: String,
    attributes: Vec<(String, String)>,
    text: String,
}

impl Element {
    fn get(&self, name: &str) -> &str {
        let found = self.attributes.iter().find(|(n, _)| n == name);
        &found.unwrap_or_else(|| panic!("no {name} in {self:?}")).1
    }
}

/// The elements of an XML document in the order in which they close; fails where the document is not well formed.
fn elements(mut text: &str) -> Vec<Element> {
    let (mut open, mut closed): (Vec<Element>, Vec<Element>) = (Vec::new(), Vec::new());
    while let Some(start) = text.find('<') {
        let before = &text[..start];
        assert!(!before.contains('>'), "a bare `>` in {before:?}");
        let entities = ["&amp;", "&lt;", "&gt;", "&quot;"];
        let count: usize = entities.iter().map(|e| before.matches(e).count()).sum();
        assert_eq!(before.matches('&').count(), count, "{before:?}");
        if let Some(element) = open.last_mut() {
            element.text.push_str(before.trim());
        }
        let end = text.find('>').expect("every tag ends");
        let tag = &text[start + 1..end];
        text = &text[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            let element = open.pop().expect("a begin for every end");
            assert_eq!(element.name, name);
            closed.push(element);
            continue;
        }
        let (body, is_empty) = tag.strip_suffix('/').map_or((tag, false), |b| (b, true));
        let (name, mut rest) = body.split_once(' ').unwrap_or((body, ""));
        let mut attributes: Vec<(String, String)> = Vec::new();
        while let Some((key, after)) = rest.split_once("=\"") {
            let (value, after) = after.split_once('"').expect("every value ends");
            let key = key.trim().to_owned();
            assert!(
                attributes.iter().all(|(k, _)| *k != key),
                "{key} twice in {tag}"
            );
            attributes.push((key, value.to_owned()));
            rest = after;
        }
        assert_eq!(rest.trim(), "", "in {tag}");
        let element = Element {
            name: name.to_owned(),
            attributes,
            text: String::new(),
        };
        if is_empty {
            closed.push(element)
        } else {
            open.push(element)
        }
    }
    assert!(open.is_empty() && text.trim().is_empty());
    closed
}

fn corners(points: &str) -> Vec<[f64; 2]> {
    let pairs = points.split(' ').map(|pair| pair.split_once(',').unwrap());
    pairs
        .map(|(x, y)| [x.parse().unwrap(), y.parse().unwrap()])
        .collect()
}

/// The curves of an SVG document: name and corners.
fn curves(document: &str) -> Vec<(String, Vec<[f64; 2]>)> {
    let all = elements(document);
    // The title closes right before its line.
    let pairs = all
        .windows(2)
        .filter(|w| w[1].name == "polyline" && w[0].name == "title");
    pairs
        .map(|w| (w[0].text.clone(), corners(w[1].get("points"))))
        .collect()
}

fn distance(p: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let length = (d[0] * d[0] + d[1] * d[1]).max(1e-30);
    let share = ((d[0] * e[0] + d[1] * e[1]) / length).clamp(0.0, 1.0);
    (e[0] - share * d[0]).hypot(e[1] - share * d[1])
}

fn distance_to_curve(p: [f64; 2], curve: &[[f64; 2]]) -> f64 {
    let pieces = curve.windows(2).map(|w| distance(p, w[0], w[1]));
    pieces.fold(f64::INFINITY, f64::min)
}

#[test]
fn curves_in_the_svg_are_the_closed_form() {
    let (r, l) = (40.0, 80.0);
    let chart = charted(&crank(r, l), 361);
    assert!(chart.notes.is_empty(), "{:?}", chart.notes);
    let drawing = drawn(&chart);
    let document = svg::write_svg(&drawing);
    let all = elements(&document);
    let svg = all.last().unwrap();
    assert_eq!(svg.name, "svg");
    assert_eq!(
        svg.get("viewBox"),
        format!("0 0 {} {}", drawing.size[0], drawing.size[1])
    );
    assert!(
        all.iter()
            .any(|e| e.name == "title" && e.text == "crank &lt;40&gt; &amp; rod")
    );
    assert!(
        all.iter()
            .any(|e| e.name == "desc" && e.text.contains("against φ [deg]"))
    );
    let stroke = move |p: f64| r * p.cos() + (l * l - (r * p.sin()).powi(2)).sqrt();
    let first = move |p: f64| {
        -r * p.sin() - r * r * p.sin() * p.cos() / (l * l - (r * p.sin()).powi(2)).sqrt()
    };
    let step = 1e-5;
    let degree = 1f64.to_radians();
    type Form = Box<dyn Fn(f64) -> f64>;
    let expected: [(&str, usize, Form); 4] = [
        ("stroke", 0, Box::new(stroke)),
        ("pin", 0, Box::new(move |p| r * p.cos())),
        ("dstroke/dφ", 1, Box::new(move |p| first(p) * degree)),
        (
            "d²stroke/dφ²",
            2,
            Box::new(move |p| (first(p + step) - first(p - step)) / (2.0 * step) * degree * degree),
        ),
    ];
    let found = curves(&document);
    for (name, panel, value) in expected {
        let (_, curve) = found
            .iter()
            .find(|(n, _)| n == name)
            .unwrap_or_else(|| panic!("no {name}"));
        let area = drawing.areas[panel];
        for [x, y] in curve {
            let phi = area.x.value(*x).to_radians();
            let should = area.y.pixel(value(phi)).unwrap();
            assert!(
                (y - should).abs() < 0.5,
                "{name} at {phi}: {y} for {should}"
            );
        }
        // The whole turn, edge to edge.
        assert!((curve[0][0] - area.rect.left).abs() < 0.01);
        assert!((curve[curve.len() - 1][0] - area.rect.right).abs() < 0.01);
    }
    let units: Vec<&str> = chart.panels.iter().map(|p| p.y.unit.as_str()).collect();
    assert_eq!(units, ["mm", "mm/deg", "mm/deg²"]);
}

#[test]
fn no_gap_without_a_word() {
    let chart = charted(&crank(80.0, 60.0), 361);
    let panel = &chart.panels[0];
    let shades: Vec<(f64, f64)> = panel.shades.iter().map(|s| (s.from, s.to)).collect();
    let dead = (0.75f64).asin().to_degrees();
    assert_eq!(shades.len(), 2);
    for (shade, [from, to]) in shades
        .iter()
        .zip([[dead, 180.0 - dead], [180.0 + dead, 360.0 - dead]])
    {
        assert!(
            (shade.0 - from).abs() < 1.01 && (shade.1 - to).abs() < 1.01,
            "{shade:?}"
        );
    }
    assert!(panel.shades.iter().all(|s| s.word == "no pose"));
    for pair in panel.series[0].points.windows(2) {
        if let [Some(a), Some(b)] = pair {
            assert!(b[0] - a[0] < 1.01, "a line across a gap");
        }
    }
    // Every sample lies on the curve or in a hatched range.
    for (k, x) in panel.samples.iter().enumerate() {
        let hatched = shades.iter().any(|(from, to)| (*from..=*to).contains(x));
        assert!(panel.series[0].points[k].is_some() || hatched, "{x}");
    }
    assert!(
        panel
            .events
            .iter()
            .any(|e| e.label.starts_with("ends at 48.5904 deg")),
        "{:?}",
        panel.events
    );
    assert!(
        chart
            .notes
            .iter()
            .any(|n| n.contains("samples have no pose")),
        "{:?}",
        chart.notes
    );
    let document = svg::write_svg(&drawn(&chart));
    let words = elements(&document);
    let count = words
        .iter()
        .filter(|e| e.name == "text" && e.text == "no pose")
        .count();
    assert_eq!(count, 2 * chart.panels.len());
}

#[test]
fn against_time_and_along_a_path_gaps_are_named_too() {
    let text = crank(80.0, 60.0);
    let by_time = charted(&text.replace("x = \"phi\"", "x = \"time\""), 181);
    assert_eq!(by_time.panels[0].x.heading(0), "time [s]");
    assert_eq!(by_time.panels[0].shades.len(), 2);
    let path = charted(
        &text.replace("x = \"phi\"", "x = \"alpha\"\nequal = true"),
        181,
    );
    assert!(path.panels[0].shades.is_empty());
    assert!(
        path.notes
            .iter()
            .any(|n| n.contains("samples have no pose"))
    );
}

#[test]
fn pixels_show_the_curve_where_it_is() {
    let chart = charted(&crank(40.0, 80.0), 361);
    for (theme, size) in [
        (ChartTheme::LIGHT, usual_size(&chart)),
        (ChartTheme::DARK, [1600, 1500]),
    ] {
        let drawing = draw_chart(&chart, size, theme);
        let picture = ChartPainter::default().picture(&drawing);
        assert_eq!(picture.dimensions(), (size[0], size[1]));
        assert_eq!(
            picture,
            ChartPainter::default().picture(&drawing),
            "the same bytes again"
        );
        let [r, g, b, _] = theme.colour(0);
        let near = |x: f64, y: f64| {
            let pixel = picture.get_pixel(x as u32, y as u32).0;
            (0..3).all(|k| pixel[k].abs_diff([r, g, b][k]) < 60)
        };
        for (panel, area) in chart.panels.iter().zip(&drawing.areas) {
            let points: Vec<_> = panel.series[0].points.iter().flatten().collect();
            for point in points.iter().step_by(20) {
                let [x, y] = area.pixel(**point).unwrap();
                let inside = x + 1.0 < area.rect.right && y + 1.0 < area.rect.bottom;
                assert!(
                    !inside || near(x, y),
                    "{x} {y} is {:?}",
                    picture.get_pixel(x as u32, y as u32)
                );
            }
        }
    }
}

#[test]
fn the_playhead_stands_on_the_curves() {
    let chart = charted(&crank(40.0, 80.0), 5);
    let drawing = drawn(&chart);
    let marks = playhead_marks(&chart, &drawing, 1);
    let circles: Vec<[f64; 2]> = marks
        .iter()
        .filter_map(|m| match m {
            DrawnPrimitive::Circle { centre, .. } => Some(*centre),
            _ => None,
        })
        .collect();
    assert_eq!(circles.len(), 4);
    // At a quarter turn: stroke √(80² - 40²), pin 0.
    let area = drawing.areas[0];
    for (circle, value) in circles.iter().zip([(80f64 * 80.0 - 1600.0).sqrt(), 0.0]) {
        assert!((area.x.value(circle[0]) - 90.0).abs() < 1e-9);
        assert!((area.y.value(circle[1]) - value).abs() < 1e-9);
    }
    let blocked = charted(&crank(80.0, 60.0), 5);
    let marks = playhead_marks(&blocked, &drawn(&blocked), 1);
    assert!(
        marks
            .iter()
            .all(|m| matches!(m, DrawnPrimitive::Line { .. })),
        "no dot without a pose"
    );
    assert_eq!(marks.len(), blocked.panels.len());
}

#[test]
fn texts_do_not_overlap() {
    for (r, l) in [(40.0, 80.0), (80.0, 60.0)] {
        let chart = charted(&crank(r, l), 361);
        for size in [usual_size(&chart), [480, 700], [1600, 900], [2400, 1800]] {
            let drawing = draw_chart(&chart, size, ChartTheme::LIGHT);
            let boxes: Vec<[f64; 4]> = drawing.primitives.iter().filter_map(extent).collect();
            for (k, a) in boxes.iter().enumerate() {
                assert!(
                    a[0] > -1.0 && a[1] < f64::from(size[0]) + 1.0,
                    "cut off at {size:?}: {a:?}"
                );
                for b in &boxes[..k] {
                    let apart = a[1] < b[0] || b[1] < a[0] || a[3] < b[2] || b[3] < a[2];
                    assert!(apart, "{size:?}: {a:?} {b:?}");
                }
            }
        }
    }
}

/// Left, right, top, bottom of a text.
fn extent(primitive: &DrawnPrimitive) -> Option<[f64; 4]> {
    use mechanim::plot::primitive::TextAnchor;
    use mechanim::render::text::{FontFace, set_text};
    let DrawnPrimitive::Text {
        at,
        text,
        size,
        anchor,
        ..
    } = primitive
    else {
        return None;
    };
    let wide = set_text(&FontFace::new(), text, *size).width;
    let left = match anchor {
        TextAnchor::Start => at[0],
        TextAnchor::Middle => at[0] - 0.5 * wide,
        TextAnchor::End => at[0] - wide,
    };
    Some([left, left + wide, at[1] - size, at[1]])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]
    #[test]
    fn every_point_lies_on_its_curve(
        values in proptest::collection::vec((-1e3f64..1e3, -12.0f64..12.0), 2..300),
        log in any::<bool>(),
        width in 200u32..2000,
    ) {
        let y = |e: f64| if log { 10f64.powf(e) } else { e };
        let points: Vec<[f64; 2]> = values.iter().map(|(x, e)| [*x, y(*e)]).collect();
        let scale = if log { ScaleKind::Log } else { ScaleKind::Linear };
        let chart = Chart {
            panels: vec![Panel {
                y: Axis { scale, ..Axis::default() },
                series: vec![PlotSeries {
                    name: "random".into(),
                    points: points.iter().copied().map(Some).collect(),
                    ..PlotSeries::default()
                }],
                ..Panel::default()
            }],
            ..Chart::default()
        };
        let drawing = draw_chart(&chart, [width, 300], ChartTheme::LIGHT);
        let found = curves(&svg::write_svg(&drawing));
        prop_assert_eq!(found.len(), 1);
        for point in points {
            let pixel = drawing.areas[0].pixel(point).unwrap();
            prop_assert!(distance_to_curve(pixel, &found[0].1) < 0.5);
        }
    }
}

#[test]
fn the_program_writes_what_is_asked() {
    let w = Workspace::new();
    w.write("ok.toml", crank(40.0, 80.0));
    w.write("blocked.toml", crank(80.0, 60.0));
    w.run(&["plot", "ok.toml", "--out", "a.svg"])
        .exits(0)
        .prints_nothing()
        .says_nothing();
    let run = w
        .run(&["plot", "ok.toml", "--out", "-", "--only", "Stroke"])
        .exits(0);
    elements(&run.text());
    assert_eq!(run.stdout, std::fs::read(w.path("a.svg")).unwrap());
    w.run(&[
        "plot",
        "blocked.toml",
        "--out",
        "b.png",
        "--theme",
        "dark",
        "--size",
        "900x700",
    ])
    .exits(4)
    .says(&["samples have no pose"]);
    let picture = image::open(w.path("b.png")).unwrap();
    assert_eq!((picture.width(), picture.height()), (900, 700));
    let asked = [
        "plot", "ok.toml", "--out", "-", "--x", "phi", "--y", "h, alpha", "--order", "2", "--per",
        "phi",
    ];
    let run = w.run(&asked).exits(0);
    let names: Vec<String> = curves(&run.text())
        .into_iter()
        .map(|(name, _)| name)
        .collect();
    // Panels in the order of their units: mm and its derivatives, degrees and theirs.
    assert_eq!(names, ["h", "α", "dh/dφ", "dα/dφ", "d²h/dφ²", "d²α/dφ²"]);
}

#[test]
fn what_cannot_be_plotted_is_said() {
    let w = Workspace::new();
    w.write("ok.toml", crank(40.0, 80.0));
    for (arguments, words) in [
        (
            &["--out", "a.eps"][..],
            &["unknown kind of plot", ".svg, .pdf and .png"][..],
        ),
        (
            &["--out", "a.svg", "--y", "hh"],
            &["`hh` is not defined", "did you mean `h`"],
        ),
        (
            &["--out", "a.svg", "--y", "d(h, alpha)"],
            &["`alpha` is not an input"],
        ),
        (
            &["--out", "a.svg", "--only", "Strok"],
            &["no plot `Strok`", "`Stroke`"],
        ),
        (&["--out", "a.svg", "--x", "phi"], &["--y"]),
        (&["--out", "nowhere/a.svg"], &["nowhere"]),
        (&["--out", "ok.toml"], &["unknown kind of plot"]),
    ] {
        let all = [&["plot", "ok.toml"], arguments].concat();
        w.run(&all).exits(2).prints_nothing().says(words);
        assert!(!w.path("a.svg").exists());
    }
}

#[test]
fn a_panel_moves_with_the_animation() {
    let w = Workspace::new();
    w.write("ok.toml", crank(40.0, 80.0));
    w.write("blocked.toml", crank(80.0, 60.0));
    let frame = |at: &str, out: &str, panel: &str| {
        let arguments = [
            "render",
            "ok.toml",
            "--at",
            at,
            "--out",
            out,
            "--size",
            "640x480",
            "--renderer",
            "cpu",
            panel,
        ];
        w.run(&arguments).exits(0);
        image::open(w.path(out)).unwrap().to_rgba8()
    };
    let (early, late) = (
        frame("0.5", "a.png", "--panel"),
        frame("2.5", "b.png", "--panel=Stroke"),
    );
    assert_eq!(early.dimensions(), (640, 480));
    // The marker is a vertical line, darker than what was there, in the chart's part only: below the animation.
    let differs = |x: u32| (300..480).any(|y| early.get_pixel(x, y) != late.get_pixel(x, y));
    let columns: Vec<u32> = (0..640).filter(|x| differs(*x)).collect();
    assert!(!columns.is_empty() && columns.len() < 60, "{columns:?}");
    assert!(
        columns[0] < 200 && columns[columns.len() - 1] > 300,
        "{columns:?}"
    );
    assert_eq!(
        early,
        frame("0.5", "c.png", "--panel"),
        "the same bytes again"
    );
    let blocked = [
        "render",
        "blocked.toml",
        "--panel",
        "--at",
        "1",
        "--out",
        "d.png",
        "--renderer",
        "cpu",
    ];
    w.run(&blocked).exits(4);
    w.run(&["render", "ok.toml", "--panel=Strok", "--out", "e.png"])
        .exits(2)
        .says(&["no plot `Strok`"]);
}

/// Where there is nothing to plot, and where a curve has no value, the program says so; the file is written.
#[test]
fn empty_plots_and_curves_are_told() {
    let w = Workspace::new();
    let body =
        "[[bodies]]\nname = \"A\"\nframe = \"Rz(u)\"\nshapes = [{ sphere = { radius = 1 } }]\n";
    for (u, outputs, said) in [
        (
            "0.3",
            "",
            "nothing is drawn: the scene has no outputs, traced points or unknowns",
        ),
        (
            "\"t\"",
            "",
            "nothing is drawn: the scene has no outputs, traced points or unknowns",
        ),
        (
            "\"t\"",
            "[outputs]\nq = \"0*sqrt(-1 - u^2)\"\n",
            "the curve `q` is not drawn: it has no value at any sample",
        ),
        ("\"t\"", "[outputs]\nq = \"2*u\"\n", ""),
        ("0.3", "[outputs]\nq = \"2*u\"\n", ""),
    ] {
        w.write(
            "scene.toml",
            format!("duration = 1\n[inputs]\nu = {u}\n{outputs}{body}"),
        );
        let run = w.run(&["plot", "scene.toml", "--out", "p.svg"]).exits(0);
        assert!(run.stderr.contains(said), "{u} {outputs}: {}", run.stderr);
        assert_eq!(
            run.stderr.contains("drawn"),
            !said.is_empty(),
            "{u} {outputs}: {}",
            run.stderr
        );
        assert!(w.path("p.svg").exists());
    }
}

/// A drive that turns far from sample to sample is not drawn as it is: the picture says so, and how many samples are enough.
#[test]
fn coarse_samples_are_told() {
    for (turns, samples, enough) in [
        (1, 25, None),
        (0, 3, None),
        (1, 9, Some(81_u64)),
        (360, 361, Some(25_992)),
        (359, 361, Some(25_920)),
    ] {
        let text = crank(40.0, 80.0).replace("90*t", &format!("{}*t", 90 * turns));
        let notes = charted(&text, samples).notes;
        let note = notes
            .iter()
            .find_map(|note| note.split("--samples ").nth(1));
        let told = note.and_then(|rest| rest.split(' ').next()?.parse::<u64>().ok());
        // Rounding of the angles may add one.
        let is_near = |enough: u64| told.is_some_and(|told| told.abs_diff(enough) <= 1);
        let holds = enough.map_or(told.is_none(), is_near);
        assert!(holds, "{turns} turns: {notes:?}");
    }
}
