//! `mechanim compare` and `mechanim site`: pages that keep the rules of reports and end as `check` does.

use super::report_pages::{HOSTILE, asks_for_nothing, markup_of};
use crate::program::Workspace;

const CRANK: &str = include_str!("../../../scenes/slider-crank.toml");

fn page(w: &Workspace, name: &str) -> String {
    String::from_utf8(w.read(name)).unwrap()
}

#[test]
fn two_versions_are_shown_side_by_side() {
    let w = Workspace::new();
    w.write("old.toml", CRANK);
    w.write("new.toml", CRANK.replace("L = 80", "L = 90"));
    let code = w.run(&["check", "new.toml", "--quiet"]).code;
    let run = w
        .run(&["compare", "old.toml", "new.toml", "--out", "c.html"])
        .exits(code);
    assert!(run.stderr.contains("old: passed; new: "), "{}", run.stderr);
    let text = page(&w, "c.html");
    asks_for_nothing(&text);
    for part in [
        "Old: Slider-crank",
        "New: Slider-crank",
        "data-linked",
        "<caption>Changed parameters</caption>",
        "<tr><td>L</td><td class=\"number\">80</td><td class=\"number\">90</td></tr>",
        "<h2>Values</h2>",
        "Dashed: the old version.",
        "h (old)",
        "<h2>Clearance</h2>",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert_eq!(text.matches("<canvas").count(), 2);
    // One camera for both.
    let cameras: Vec<&str> = text.split("\"camera\":{").skip(1).collect();
    assert_eq!(cameras.len(), 2);
    let of = |text: &str| text.split('}').next().unwrap().to_owned();
    assert_eq!(of(cameras[0]), of(cameras[1]));
    // The same again gives the same bytes.
    let again = w
        .run(&["compare", "old.toml", "new.toml", "--out", "-"])
        .exits(code);
    assert_eq!(again.stdout, w.read("c.html"));
}

#[test]
fn a_scene_that_is_the_same_has_no_other_answers() {
    let w = Workspace::new();
    w.run(&["compare", "four-bar", "four-bar", "--out", "c.html"])
        .exits(0);
    let text = page(&w, "c.html");
    assert!(text.contains("All checks have the same results, to the last digit shown."));
    assert!(!text.contains("<h2>Parameters</h2>"));
}

#[test]
fn versions_without_a_motion_are_compared_by_their_answers() {
    let w = Workspace::new();
    w.write("old.toml", CRANK);
    w.write(
        "new.toml",
        CRANK
            .replace("phi = \"2*pi*t/4\"", "phi = \"pi/2\"")
            .replace("L = 80", "L = 30"),
    );
    let code = w.run(&["check", "new.toml", "--quiet"]).code;
    assert!(code != 0);
    w.run(&["compare", "old.toml", "new.toml", "--out", "c.html"])
        .exits(code);
    let text = page(&w, "c.html");
    asks_for_nothing(&text);
    assert!(text.contains("<td class=\"state failed\">not closed over the whole motion</td>"));
    w.run(&["compare", "new.toml", "old.toml", "--out", "c.html"])
        .exits(0);
    w.run(&["compare", "old.toml", "none.toml", "--out", "d.html"])
        .exits(2);
    w.run(&["compare", "old.toml", "new.toml", "--out", "old.toml"])
        .exits(2);
    assert!(!w.path("d.html").exists());
}

#[test]
fn names_stay_texts_in_comparisons_and_front_pages() {
    let w = Workspace::new();
    w.write("hostile.toml", HOSTILE);
    w.run(&["compare", "hostile.toml", "hostile.toml", "--out", "c.html"]);
    let text = page(&w, "c.html");
    asks_for_nothing(&text);
    assert!(
        !text.contains("<img src=x") && !text.contains("<b onclick") && !text.contains('\u{202e}')
    );
    w.run(&[
        "site",
        "hostile.toml",
        "--out",
        "s",
        "--title",
        "<i>all</i>",
    ]);
    let text = page(&w, "s/index.html");
    assert!(!text.contains("<img src=x") && !text.contains("<i>") && !text.contains('\u{202e}'));
}

#[test]
fn a_site_has_a_page_for_every_scene() {
    let w = Workspace::new();
    w.write(
        "four-bar.toml",
        include_str!("../../../scenes/four-bar.toml"),
    );
    let run = w
        .run(&[
            "site",
            "four-bar",
            "slider-crank",
            "four-bar.toml",
            "--out",
            "s/t",
        ])
        .exits(0);
    assert!(
        run.stderr.contains("pages without sliders"),
        "{}",
        run.stderr
    );
    let index = page(&w, "s/t/index.html");
    for file in ["four-bar.html", "slider-crank.html", "four-bar-2.html"] {
        assert!(index.contains(&format!("<a href=\"{file}\">")), "{file}");
        asks_for_nothing(&page(&w, &format!("s/t/{file}")));
    }
    assert!(index.contains("<h1>3 mechanisms</h1>") && index.contains("script-src 'none'"));
    assert_eq!(index.matches("<img ").count(), 3);
    assert_eq!(index.matches("<script").count(), 0);
    assert_eq!(markup_of(&index), index);
    // Another engine than the program's own is no engine.
    w.write("other.wasm", "no");
    w.run(&["site", "four-bar", "--out", "u", "--wasm", "other.wasm"])
        .exits(2);
    let engine = [b"\0asm\x01\0\0\0", mechanim::page::live::STAMP.as_bytes()].concat();
    w.write("engine.wasm", engine);
    w.run(&["site", "four-bar", "--out", "u", "--wasm", "engine.wasm"])
        .exits(0);
    assert!(page(&w, "u/four-bar.html").contains("id=\"engine\""));
}
