//! Parts of machines in a scene: the solids that each stands for, and what is said of mistakes in them.

use mechanim::diag::Source;
use mechanim::model::shape::Solid;
use mechanim::scene::{Overrides, Scene, load_scene};

fn source(shape: &str) -> Source {
    let text = format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 1\n\n[parameters]\nw = 6\n\n[inputs]\np = \"t\"\n\n\
         [chains]\nA = \"Rz(p)\"\n\n[[bodies]]\nname = \"a\"\nframe = \"A\"\nshapes = [\n  {{ {shape} }},\n]\n"
    );
    Source {
        name: "parts.toml".to_owned(),
        text,
    }
}

fn solids(shape: &str) -> Vec<Solid> {
    let scene: Scene = load_scene(&source(shape), &Overrides::default())
        .unwrap_or_else(|e| panic!("{shape}: {:#?}", e.diagnostics));
    let shapes = scene.mechanism.bodies[0].shapes.iter();
    shapes.map(|shape| shape.solid.clone()).collect()
}

fn cylinder(from: [f64; 3], to: [f64; 3], radius: f64) -> Solid {
    Solid::Cylinder {
        from: from.into(),
        to: to.into(),
        radius,
    }
}

fn cuboid(centre: [f64; 3], size: [f64; 3]) -> Solid {
    let written = format!("box = {{ center = {centre:?}, size = {size:?} }}");
    solids(&written).remove(0)
}

#[test]
fn parts_are_the_solids_that_the_document_says() {
    let table: [(&str, Vec<Solid>); 5] = [
        (
            "rod = { from = [0, 0, 1], to = [50, 0, 1], radius = 3, eye = 5, width = \"w - 2\" }",
            vec![
                Solid::Capsule {
                    from: [0.0, 0.0, 1.0].into(),
                    to: [50.0, 0.0, 1.0].into(),
                    radius: 3.0,
                },
                cylinder([0.0, 0.0, -1.0], [0.0, 0.0, 3.0], 5.0),
                cylinder([50.0, 0.0, -1.0], [50.0, 0.0, 3.0], 5.0),
            ],
        ),
        (
            "fork = { radius = 10, gap = 42, depth = 40, thickness = 8 }",
            vec![
                cylinder([0.0, 0.0, 21.0], [0.0, 0.0, 29.0], 10.0),
                cuboid([-20.0, 0.0, 25.0], [40.0, 20.0, 8.0]),
                cylinder([0.0, 0.0, -21.0], [0.0, 0.0, -29.0], 10.0),
                cuboid([-20.0, 0.0, -25.0], [40.0, 20.0, 8.0]),
                cuboid([-44.0, 0.0, 0.0], [8.0, 20.0, 58.0]),
            ],
        ),
        (
            "pin = { radius = 4, length = \"10*w\", head = 7 }",
            vec![
                cylinder([0.0, 0.0, -30.0], [0.0, 0.0, 30.0], 4.0),
                cylinder([0.0, 0.0, 30.0], [0.0, 0.0, 32.0], 7.0),
                cylinder([0.0, 0.0, -30.0], [0.0, 0.0, -32.0], 7.0),
            ],
        ),
        (
            "bearing = { radius = 20, width = 30, height = 100 }",
            vec![
                cylinder([0.0, 0.0, -15.0], [0.0, 0.0, 15.0], 20.0),
                cuboid([0.0, -57.5, 0.0], [24.0, 85.0, 24.0]),
                cuboid([0.0, -96.0, 0.0], [80.0, 8.0, 30.0]),
                cylinder([28.0, -98.0, 0.0], [28.0, -87.0, 0.0], 5.0),
                cylinder([-28.0, -98.0, 0.0], [-28.0, -87.0, 0.0], 5.0),
            ],
        ),
        (
            "lathe = { profile = [[0, 12], [8, 12], [8, \"w\"], [66, 3]] }",
            vec![
                cylinder([0.0, 0.0, 0.0], [0.0, 0.0, 8.0], 12.0),
                Solid::Cone {
                    from: [0.0, 0.0, 8.0].into(),
                    to: [0.0, 0.0, 66.0].into(),
                    radius_from: 6.0,
                    radius_to: 3.0,
                },
            ],
        ),
    ];
    for (shape, expected) in table {
        let found = solids(shape);
        // Factors such as 0.1 are rounded.
        let near = |a: &Solid, b: &Solid| {
            let numbers = |solid: &Solid| {
                let text = format!("{solid:?}");
                let parts = text.split(|c: char| !(c.is_ascii_digit() || "-.e".contains(c)));
                parts.filter_map(|p| p.parse().ok()).collect::<Vec<f64>>()
            };
            let (a, b) = (numbers(a), numbers(b));
            a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| (a - b).abs() < 1e-12 * 100.0)
        };
        assert_eq!(found.len(), expected.len(), "{shape}: {found:#?}");
        for (found, expected) in found.iter().zip(&expected) {
            let same = std::mem::discriminant(found) == std::mem::discriminant(expected);
            assert!(
                same && near(found, expected),
                "{shape}: {found:?} {expected:?}"
            );
        }
    }
}

#[test]
fn what_is_wrong_in_a_part_is_said_at_its_place() {
    let table = [
        (
            "fork = { radius = 10, gap = 42, depth = 40 }",
            "needs `thickness`",
        ),
        ("pin = { radius = 4, length = \"ww\", head = 7 }", "ww"),
        (
            "pin = { radius = -4, length = 20, head = 7 }",
            "must be positive",
        ),
        ("lathe = { profile = [[0, 12]] }", "two places"),
        ("lathe = { profile = [[0, 2], [0, 4]] }", "two places"),
        ("fork = {}, pin = {}", "only one solid"),
    ];
    for (shape, said) in table {
        let source = source(shape);
        let error = load_scene(&source, &Overrides::default()).unwrap_err();
        let found = error
            .diagnostics
            .sorted()
            .into_iter()
            .find(|d| d.message.contains(said));
        let found = found.unwrap_or_else(|| panic!("{shape}: {:#?}", error.diagnostics));
        let span = found.span.clone().unwrap();
        let [line, _] = source.line_and_column(span.start);
        assert_eq!(line, 17, "{shape}: {span:?}");
    }
}
