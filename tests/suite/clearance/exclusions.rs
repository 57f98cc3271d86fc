//! What a scene leaves out of a check: pairs, shapes of pairs, depths; and what it asks of many pairs at once.

use crate::driven::{check, even_times, knots, solve};
use crate::program::Workspace;
use mechanim::clearance::check::{ClearanceReport, Judgement};
use mechanim::diag::Source;
use mechanim::scene::{Overrides, Scene, load_scene};

/// A block with a post at its end, and a slider with a pin that runs 1 deep in the block and a nose that comes near the post.
fn scene(nose: f64, rules: &str) -> String {
    format!(
        "title = \"slot\"\nduration = 2\nunits = {{ length = \"mm\", angle = \"rad\" }}\n\
         [inputs]\nx = \"10*sin(3*t)\"\nw = \"0*t\"\n\
         [[bodies]]\nname = \"block\"\nshapes = [{{ box = {{ size = [40, 10, 10] }} }}, {{ sphere = {{ center = [40, 0, 30], radius = 2 }} }}]\n\
         [[bodies]]\nname = \"slider one\"\nframe = \"Tx(x) Ry(w) Rz(w)\"\nshapes = [{{ sphere = {{ center = [0, 0, 6], radius = 2 }} }}, \
         {{ capsule = {{ from = [0, 0, 30], to = [{nose}, 0, 30], radius = 1 }} }}]\n\
         [[bodies]]\nname = \"slider two\"\nframe = \"Ty(50) Tx(2*x) Ry(w) Rz(w)\"\nshapes = [{{ sphere = {{ radius = 1 }} }}]\n\
         [clearance]\nminimum = 0.5\n{rules}\n"
    )
}

fn open(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn report(text: &str) -> ClearanceReport {
    let scene = open(text);
    let times = knots(&scene, &even_times(&scene, 30));
    check(&scene, &solve(&scene, &times).unwrap(), 1e-2)
}

fn ignore(more: &str) -> String {
    format!("ignore = [{{ pair = [\"block\", \"slider one\"], reason = \"slot\"{more} }}]")
}

/// Of block and the first slider: what the judged part came to.
fn judged(report: &ClearanceReport) -> Option<&Judgement> {
    let found = report.judged.iter().find(|p| p.pair == [0, 1]);
    found.map(|p| &p.judgement)
}

/// The nose reaches to 10 + nose + 1; the post begins at 38.
#[test]
fn shapes_are_left_out_alone() {
    for (nose, judgement) in [
        (20.0, Judgement::Passed),
        (26.6, Judgement::Failed),
        (28.0, Judgement::Failed),
    ] {
        for (names, shapes) in [
            ("\"block\", \"slider one\"", "[[1, 1]]"),
            ("\"slider one\", \"block\"", "[[1, 1], [1, 1]]"),
        ] {
            let rules =
                format!("ignore = [{{ pair = [{names}], shapes = {shapes}, reason = \"slot\" }}]");
            let report = report(&scene(nose, &rules));
            assert_eq!(judged(&report), Some(&judgement), "{nose} {names}");
            let excluded = report.excluded.iter().find(|p| p.pair == [0, 1]).unwrap();
            assert!((excluded.least.distance + 1.0).abs() < 1e-9, "{excluded:?}");
        }
        // As a whole pair the nose is left out, too.
        let whole = report(&scene(nose, &ignore("")));
        assert_eq!(judged(&whole), None);
        // The other shapes are no help.
        let other = report(&scene(nose, &ignore(", shapes = [[2, 2]]")));
        assert_eq!(judged(&other), Some(&Judgement::Failed));
    }
}

#[test]
fn a_depth_is_allowed_down_to_a_limit() {
    for (down_to, is_kept) in [
        ("-1.5", true),
        ("-1.001", true),
        ("-0.999", false),
        ("-0.5", false),
        ("0", false),
    ] {
        for shapes in ["", ", shapes = [[1, 1]]"] {
            let report = report(&scene(
                10.0,
                &ignore(&format!("{shapes}, down_to = {down_to}")),
            ));
            assert_eq!(report.is_kept(), is_kept, "{down_to}{shapes}: {report:#?}");
            assert!(is_kept || report.judged[0].judgement == Judgement::Failed);
            assert_eq!(report.excluded.iter().any(|p| p.pair == [0, 1]), is_kept);
        }
    }
}

#[test]
fn many_pairs_have_a_minimum_by_pattern() {
    let rules = |minimum: f64| {
        format!(
            "{}\npairs = [{{ pair = [\"slider *\", \"block\"], minimum = {minimum} }}]",
            ignore("")
        )
    };
    // The second slider passes at 50 - 1 from the block's middle, 5 thick.
    for (minimum, judgement) in [(43.9, Judgement::Passed), (44.1, Judgement::Failed)] {
        let report = report(&scene(10.0, &rules(minimum)));
        let found = report.judged.iter().find(|p| p.pair == [0, 2]).unwrap();
        assert_eq!(found.judgement, judgement, "{found:?}");
        assert_eq!(found.minimum, minimum);
        // A pair that is ignored by its names stays so.
        assert_eq!(judged(&report), None);
    }
}

#[test]
fn wrong_entries_are_refused() {
    let w = Workspace::new();
    for (entry, words) in [
        (", shapes = [[3, 1]]", "`block` has no shape 3"),
        (", shapes = [[1, 0]]", "`slider one` has no shape 0"),
        (", shapes = []", "`shapes` is empty"),
        (", down_to = 1", "`down_to` must not be positive"),
    ] {
        w.write("bad.toml", scene(10.0, &ignore(entry)));
        w.run(&["check", "bad.toml"]).says(&[words]);
    }
}

#[test]
fn estimates_and_empty_checks_pass_only_on_request() {
    let w = Workspace::new();
    let all = "ignore = [{ pair = [\"*\", \"*\"], reason = \"none\" }]";
    w.write("empty.toml", scene(10.0, all));
    w.run(&["check", "empty.toml"]).exits(1);
    let text = w
        .run(&["check", "empty.toml", "--allow-empty"])
        .exits(0)
        .text();
    assert!(text.contains("0 pairs judged"), "{text}");
}
