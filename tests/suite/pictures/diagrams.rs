//! Kinematic diagrams: what a scene writes stands on the sheet once, and no label covers another.

use glam::DVec3;
use mechanim::diagram::labels::overlap;
use mechanim::diagram::scheme::Scheme;
use mechanim::diagram::sheet::{DiagramParts, DiagramSheet, SheetOptions, draw_sheet};
use mechanim::diagram::walk::scheme_at;
use mechanim::kinematics::motion::continuation::solve_motion;
use mechanim::kinematics::structure::system::System;
use mechanim::model::notation::unsigned_text;
use mechanim::plot::primitive::DrawnPrimitive;
use mechanim::plot::theme::ChartTheme;
use mechanim::plot::{pdf, svg};
use mechanim::render::camera::ViewDirection;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::staging::quantity_names::written_names;
use std::collections::BTreeSet;
use std::sync::Arc;

fn scene(name: &str) -> Scene {
    let source = builtin::find_builtin(name).unwrap();
    let overrides = Overrides {
        notation: true,
        ..Overrides::default()
    };
    load_scene(&source, &overrides).unwrap()
}

/// The scheme a sixth into the drive, where nothing lies on anything else.
fn scheme(scene: &Scene) -> Scheme {
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
    let at = scene.actuation.duration / 6.0;
    let times: Vec<f64> = (0..=20).map(|k| at * f64::from(k) / 20.0).collect();
    let motion = solve_motion(&system, &scene.actuation, &times);
    let sample = motion.samples.iter().rfind(|s| s.pose.is_some()).unwrap();
    let pose = sample.pose.as_ref().unwrap();
    let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
    let notation = scene.notation.as_ref().unwrap();
    scheme_at(&scene.mechanism, notation, &coordinates)
}

fn options(scene: &Scene, shown: DiagramParts) -> SheetOptions {
    let direction = ViewDirection {
        azimuth: scene.view.azimuth,
        elevation: scene.view.elevation,
        up: DVec3::Z,
    };
    let mechanism = &scene.mechanism;
    SheetOptions {
        axes: None,
        spatial_axes: direction.axes(),
        width: 1200,
        theme: ChartTheme::LIGHT,
        shown,
        title: mechanism.title.clone(),
        length_unit: mechanism.length_unit.clone(),
        angle_unit: (
            mechanism.angle_unit.name.clone(),
            mechanism.angle_unit.radians.number(),
        ),
    }
}

fn sheet(name: &str, shown: DiagramParts) -> DiagramSheet {
    let scene = scene(name);
    draw_sheet(&scheme(&scene), &options(&scene, shown))
}

/// All texts of a sheet.
fn texts(sheet: &DiagramSheet) -> Vec<String> {
    let texts = sheet.drawing.primitives.iter().filter_map(|p| match p {
        DrawnPrimitive::Text { text, .. } => Some(text.clone()),
        _ => None,
    });
    texts.collect()
}

/// How often a quantity stands on a sheet: as a label, or with its value in the lines below.
fn count(sheet: &DiagramSheet, name: &str) -> usize {
    let written = written_names(name);
    let labels = sheet.labels.iter().filter(|l| l.text == written).count();
    let values = sheet.notes.iter().flat_map(|note| note.split([':', ',']));
    labels
        + values
            .filter(|part| part.trim().starts_with(&format!("{written} = ")))
            .count()
}

#[test]
fn every_dimension_of_the_gearshift_stands_on_its_sheet_once() {
    let source = builtin::find_builtin("gearshift").unwrap();
    let section = source.text.split("[parameters]").nth(1).unwrap();
    let section = section.split("\n[").next().unwrap();
    let names: Vec<&str> = section
        .lines()
        .filter_map(|l| Some(l.split_once('=')?.0.trim()))
        .collect();
    assert_eq!(names.len(), 22);
    let sheet = sheet("gearshift", DiagramParts::USUAL);
    for name in names {
        assert_eq!(count(&sheet, name), 1, "{name}: {:?}", sheet.notes);
    }
    // Coordinates of single axes have an arc or a line, those of joints about a point are listed.
    let all = texts(&sheet).join(" ; ");
    for k in 1..=18 {
        let name = written_names(&format!("a{k}"));
        let words = all.split([' ', ',', ';']).filter(|word| *word == name);
        assert_eq!(words.count(), 1, "{name}");
    }
    for letter in ["A", "B", "C", "1", "8", "p", "φ", "M"] {
        assert_eq!(
            sheet.labels.iter().filter(|l| l.text == letter).count(),
            1,
            "{letter}"
        );
    }
}

/// Also in all other scenes, those of surfaces included.
#[test]
fn every_named_constant_of_a_loop_stands_on_its_sheet_once() {
    let mut all = 0;
    for item in builtin::ALL {
        let scene = scene(item.name);
        let notation = scene.notation.as_ref().unwrap();
        let surfaces = notation
            .contacts
            .iter()
            .flat_map(|c| &c.sides)
            .map(|side| &side.frame);
        let factors = notation
            .loops
            .iter()
            .chain(surfaces)
            .flat_map(|chain| &chain.factors);
        let names: BTreeSet<&str> = factors
            .filter(|f| f.is_dimension)
            .map(|f| unsigned_text(&f.text))
            .collect();
        let sheet = draw_sheet(&scheme(&scene), &options(&scene, DiagramParts::USUAL));
        for name in &names {
            assert_eq!(
                count(&sheet, name),
                1,
                "{}: {name} {:?}",
                item.name,
                sheet.notes
            );
        }
        all += names.len();
    }
    assert!(all > 150, "{all}");
}

#[test]
fn no_label_covers_another_in_any_scene() {
    let mut everything = DiagramParts::USUAL;
    (everything.frames, everything.values) = (true, true);
    let mut vectors = DiagramParts::USUAL;
    vectors.vectors = true;
    for item in builtin::ALL {
        let scene = scene(item.name);
        let scheme = scheme(&scene);
        for shown in [DiagramParts::USUAL, everything, vectors] {
            let sheet = draw_sheet(&scheme, &options(&scene, shown));
            let labels = &sheet.labels;
            assert!(labels.len() > 4, "{}", item.name);
            let [width, height] = sheet.drawing.size.map(f64::from);
            for (k, label) in labels.iter().enumerate() {
                let own = label.bounds;
                assert!(
                    own.left >= 0.0 && own.top >= 0.0 && own.right <= width && own.bottom <= height
                );
                for other in &labels[..k] {
                    assert!(
                        !overlap(&own, &other.bounds),
                        "{}: {} and {}",
                        item.name,
                        label.text,
                        other.text
                    );
                }
            }
            let left_out = sheet.notes.iter().find(|n| n.starts_with("without room"));
            assert_eq!(left_out, None, "{}", item.name);
        }
    }
}

#[test]
fn links_are_numbered_as_lectures_do_and_planes_are_seen_from_the_front() {
    for (name, links, is_plane) in [
        ("slider-crank", 4, true),
        ("four-bar", 4, true),
        ("dyads", 8, true),
        ("feeder", 4, true),
        ("gearshift", 8, false),
        ("seven-r", 7, false),
    ] {
        let scheme = scheme(&scene(name));
        let mut numbers: Vec<usize> = scheme.links.iter().map(|l| l.number).collect();
        numbers.sort_unstable();
        assert_eq!(numbers, (1..=links).collect::<Vec<_>>(), "{name}");
        assert_eq!(scheme.links[0].number, 1);
        assert_eq!(scheme.normal().is_some(), is_plane, "{name}");
    }
    // Lengths are what the scene says, wherever they are drawn.
    for length in scheme(&scene("four-bar")).lengths {
        let wanted = [
            ("crank", 35.0),
            ("coupler", 95.0),
            ("rocker", 80.0),
            ("ground", 105.0),
            ("ex", 50.0),
            ("ey", 45.0),
        ];
        let wanted = wanted.iter().find(|(name, _)| *name == length.name);
        let Some((_, wanted)) = wanted else {
            panic!("{}", length.name)
        };
        assert!((length.from.distance(length.to) - wanted).abs() < 1e-9);
    }
}

/// The same drawing in every format; what they look like is compared with `docs/figures`.
#[test]
fn diagrams_have_the_same_texts_in_every_format() {
    for name in ["slider-crank", "four-bar", "gearshift", "seven-r"] {
        let sheet = sheet(name, DiagramParts::USUAL);
        let text = svg::write_svg(&sheet.drawing);
        let page = String::from_utf8(pdf::write_pdf(&sheet.drawing)).unwrap();
        assert_eq!(page.matches("BT ").count(), text.matches("<text ").count());
        assert!(page.ends_with("%%EOF\n"));
    }
}

/// A bar is a link of its own between pins, as long as its scene says; the coordinates of free points are no sliders.
#[test]
fn bars_are_links_from_pin_to_pin() {
    let scene = scene("dyads-bars");
    let scheme = scheme(&scene);
    let shown: Vec<_> = scheme.links.iter().filter(|link| link.is_shown).collect();
    // The frame, the crank and sixteen bars.
    assert_eq!(shown.len(), 18);
    let mut bars = 0;
    for (index, link) in scheme.links.iter().enumerate().filter(|(_, l)| l.is_shown) {
        let own = scene
            .mechanism
            .bars
            .iter()
            .find(|bar| link.names.contains(&bar.name));
        let Some(length) = own.and_then(|bar| bar.length) else {
            continue;
        };
        let [from, to] = link.paths[0][..] else {
            panic!("{:?} is bent", link.names)
        };
        assert!(
            (from.distance(to) - length).abs() < 1e-9 * length,
            "{:?}",
            link.names
        );
        // A joint at either end.
        for end in [from, to] {
            let is_there = |j: &&mechanim::diagram::scheme::SchemeJoint| {
                j.links.contains(&index) && j.at.distance(end) < 1e-9 * scheme.size
            };
            assert!(
                scheme.joints.iter().any(|j| is_there(&j)),
                "{:?}",
                link.names
            );
        }
        bars += 1;
    }
    assert_eq!(bars, 16);
    let kinds: BTreeSet<_> = scheme.joints.iter().map(|j| j.kind.words()).collect();
    assert_eq!(kinds, BTreeSet::from(["revolute joint"]));
    assert!(scheme.normal().is_some() && scheme.loops.is_empty());
    let sheet = draw_sheet(&scheme, &options(&scene, DiagramParts::USUAL));
    for text in [&scene.notation.as_ref().unwrap().bar_lengths[0].text, "p0"] {
        assert_eq!(count(&sheet, text), 1, "{text}");
    }
}

/// What a formula with kinks moves, as the pieces of a rope that leave their drum, no joint moves: it is a picture.
#[test]
fn only_what_joints_move_is_in_a_diagram() {
    for item in builtin::ALL {
        let scene = scene(item.name);
        let scheme = scheme(&scene);
        let shown = scheme.links.iter().filter(|link| link.is_shown);
        let mut numbers: Vec<usize> = shown.map(|link| link.number).collect();
        numbers.sort_unstable();
        assert_eq!(
            numbers,
            (1..=numbers.len()).collect::<Vec<_>>(),
            "{}",
            item.name
        );
        let sheet = draw_sheet(&scheme, &options(&scene, DiagramParts::USUAL));
        let mut drawn: Vec<usize> = texts(&sheet)
            .iter()
            .filter_map(|t| t.parse().ok())
            .collect();
        drawn.sort_unstable();
        assert_eq!(drawn, numbers, "{}", item.name);
        // Lists are folded between their items.
        assert!(
            !svg::write_svg(&sheet.drawing).contains(">·"),
            "{}",
            item.name
        );
    }
    let links = scheme(&scene("rope-drum")).links;
    let names: Vec<String> = links
        .into_iter()
        .filter(|l| l.is_shown)
        .flat_map(|l| l.names)
        .collect();
    assert_eq!(names.len(), 3, "{names:?}");
}
