//! `mechanim report`: the page says what `check` says, fits into a mail, asks for nothing and lets nothing of a scene act.
//! In a browser it is tested by `.ci/browsers`.

use crate::program::Workspace;
use mechanim::scene::builtin;

/// A page of a built-in scene is at most this large.
const MOST_BYTES: usize = 600_000;

/// A crank with hostile names: an end of the script, an event handler, a mark that turns the direction of writing.
pub(super) const HOSTILE: &str = "title = \"</script><img src=x onerror=alert(1)>\u{202e}txt\"\nunits = { length = \"mm\", angle = \"deg\" }\nduration = 2\n\
[inputs]\nphi = \"180*t\"\n[loops]\n\"A\" = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\nalpha = 0\nbeta = 0\n\
[[bodies]]\nname = \"<b onclick=alert(1)>\"\nframe = \"Rz(phi)\"\nshapes = [{ box = { size = [40, 8, 8] } }]\n\
[[bodies]]\nname = \"<!--<script>\"\nframe = \"Tx(h)\"\nshapes = [{ sphere = { radius = 5 } }]\n[clearance]\nminimum = 1\n";

fn page(w: &Workspace, scene: &str) -> String {
    String::from_utf8(w.read(scene)).unwrap()
}

/// The last line of `check`: `result` and what follows.
fn result_of(text: &str) -> String {
    let line = text.lines().rev().find(|line| line.starts_with("  result"));
    line.unwrap()
        .trim_start_matches("  result")
        .trim()
        .to_owned()
}

#[test]
fn every_built_in_scene_has_a_page_that_says_what_check_says() {
    let w = Workspace::new();
    for scene in builtin::ALL {
        let checked = w.run(&["check", scene.name]);
        let run = w.run(&["report", scene.name, "--out", "p.html", "--quiet"]);
        let run = run.exits(checked.code);
        assert!(run.stdout.is_empty());
        let text = page(&w, "p.html");
        assert!(
            text.len() <= MOST_BYTES,
            "{}: {} bytes",
            scene.name,
            text.len()
        );
        let result = result_of(&checked.text());
        assert!(
            text.contains(&format!("\">{result}</p>")),
            "{}: {result}",
            scene.name
        );
        let class = if checked.code == 0 { "passed" } else { "open" };
        assert!(
            text.contains(&format!("<p class=\"verdict {class}\" ")),
            "{}",
            scene.name
        );
        for part in [
            "data-part=\"canvas\"",
            "<h2>Mechanism</h2>",
            "<h2>Motion and its proof</h2>",
            "<h2>Curves</h2>",
        ] {
            assert!(text.contains(part), "{}: {part}", scene.name);
        }
        asks_for_nothing(&text);
    }
}

/// What stands before the scripts.
pub(super) fn markup_of(text: &str) -> &str {
    text.split("<script>").next().unwrap()
}

/// Nothing on the page is fetched, and nothing runs but what the policy names.
pub(super) fn asks_for_nothing(text: &str) {
    let policy = text
        .split("Content-Security-Policy\" content=\"")
        .nth(1)
        .unwrap();
    let policy = policy.split('"').next().unwrap();
    assert!(
        policy.starts_with("default-src 'none'; img-src data:; style-src 'sha256-"),
        "{policy}"
    );
    assert!(!policy.contains("unsafe"), "{policy}");
    assert_eq!(policy.matches("'sha256-").count(), 3, "{policy}");
    let markup = markup_of(text);
    for address in [" src=\"", " href=\""] {
        for place in markup.split(address).skip(1) {
            assert!(
                place.starts_with("data:") || place.starts_with('#'),
                "{address}{:.60}",
                place
            );
        }
    }
    // In tags only: a text may say what it likes. Attributes hold no `>`, which is escaped.
    for tag in markup
        .split('<')
        .skip(1)
        .filter_map(|tag| tag.split('>').next())
    {
        let name = tag.split_whitespace().next().unwrap_or_default();
        assert!(
            !["iframe", "object", "embed", "form", "base"].contains(&name),
            "<{tag}>"
        );
        let acts = tag.split('"').step_by(2).any(|word| {
            let word = word.trim_start();
            word.starts_with("on") || word.starts_with("style=")
        });
        assert!(!acts, "<{tag}>");
    }
    assert_eq!(text.matches("<script").count(), 3, "data and two scripts");
    assert_eq!(text.matches("</script>").count(), 3);
}

#[test]
fn names_of_a_scene_stay_texts() {
    let w = Workspace::new();
    w.write("hostile.toml", HOSTILE);
    w.run(&["report", "hostile.toml", "--out", "p.html"]);
    let text = page(&w, "p.html");
    asks_for_nothing(&text);
    assert!(!text.contains("<img src=x") && !text.contains("<b onclick") && !text.contains("<!--"));
    assert!(
        !text.contains('\u{202e}'),
        "a mark that turns the direction of writing"
    );
    assert!(
        text.contains("<bdi data-part=\"title\">&lt;/script&gt;&lt;img src=x onerror=alert(1)&gt;")
    );
    assert!(
        text.contains("&lt;b onclick=alert(1)&gt; / &lt;!--&lt;script&gt;"),
        "the pair of bodies"
    );
}

#[test]
fn several_scenes_share_a_page_and_its_worst_result() {
    let w = Workspace::new();
    w.write("a.toml", include_str!("../../../scenes/four-bar.toml"));
    w.write(
        "b.toml",
        include_str!("../../../scenes/four-bar.toml").replace("minimum = 0.5", "minimum = 50"),
    );
    let run = w.run(&["report", "?.toml", "--out", "all.html"]).exits(1);
    assert!(
        run.stderr.contains("all.html: 2 mechanisms"),
        "{}",
        run.stderr
    );
    let text = page(&w, "all.html");
    for part in [
        "<h1>2 mechanisms</h1>",
        "href=\"#scene-2\"",
        "id=\"scene-1\"",
        "id=\"chart-2-1\"",
        "<h3>Clearance</h3>",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert_eq!(text.matches("<p class=\"verdict passed\" ").count(), 1);
    assert_eq!(text.matches("<p class=\"verdict failed\" ").count(), 1);
    // What is only a word of the command line is shown, too.
    w.run(&["report", "none-*.toml", "--out", "p.html"])
        .exits(2)
        .says(&["no file matches `none-*.toml`"]);
}

#[test]
fn a_mechanism_that_does_not_close_has_a_page_that_says_so() {
    let w = Workspace::new();
    let scene = "units = { length = \"mm\" }\n[inputs]\nphi = 0\n[loops]\nA = \"Rz(phi) Tx(50) Rz(a) Tx(60) Rz(b) Tx(30) Rz(c) Tx(-150)\"\n";
    w.write("never.toml", scene);
    let code = w.run(&["check", "never.toml"]).code;
    assert_eq!(code, 4);
    w.run(&["report", "never.toml", "--out", "p.html"])
        .exits(code);
    let text = page(&w, "p.html");
    assert!(text.contains(
        "<p class=\"verdict failed\" data-part=\"verdict\">not closed over the whole motion</p>"
    ));
    asks_for_nothing(&text);
}

#[test]
fn pages_are_html_files_and_never_replace_a_scene() {
    let w = Workspace::new();
    w.write("page.html", include_str!("../../../scenes/four-bar.toml"));
    w.run(&["report", "page.html", "--out", "page.html"])
        .exits(2)
        .says(&["is an input of this command"]);
    w.run(&["report", "four-bar", "--out", "p.txt"])
        .exits(2)
        .says(&["`p.txt` is not an .html file"]);
    // The same scene gives the same bytes.
    w.run(&["report", "four-bar", "--out", "a.html"]).exits(0);
    let second = w.run(&["report", "four-bar", "--out", "-"]).exits(0);
    assert_eq!(second.stdout, w.read("a.html"));
}
