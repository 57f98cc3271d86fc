//! The file: policy, style, articles, data, scripts.

use super::article::Article;
use super::engine::PackedEngine;
use super::markup::{Cell, Section, Table, escaped, script_json, state_class};
use super::packing::packed_text;
use base64::prelude::{BASE64_STANDARD, Engine};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::fmt::Write;

/// How the page looks.
const STYLE: &str = include_str!("web/report.css");

/// The 3-D view, then the controls of the page; in this order, since the second uses the first.
const SCRIPTS: [&str; 2] = [include_str!("web/viewer.js"), include_str!("web/report.js")];

/// Unpacks what a live page holds, and runs the scripts among it. The worker contains a copy.
const UNPACK: &str = include_str!("web/unpack.js");

/// The type of an element whose text is packed.
const PACKED: &str = "application/octet-stream";

/// The controls of a live page; after the others.
const LIVE: &str = include_str!("web/live.js");

/// Contains the engine; the page creates a worker from it.
const WORKER: &str = concat!(
    include_str!("web/assemble.js"),
    include_str!("web/worker.js")
);

/// The whole file. `title` is used if the page contains several mechanisms; with an `engine`, live articles can be
/// moved.
pub fn page_text(title: &str, articles: &[Article], engine: Option<&PackedEngine>) -> String {
    let title = match articles {
        [only] => only.title.as_str(),
        _ => title,
    };
    let scripts: Vec<&str> = match engine {
        None => SCRIPTS.to_vec(),
        Some(_) => [&SCRIPTS[..], &[LIVE]].concat(),
    };
    let mut out = page_head(title, &scripts, engine.is_some());
    let depth = match articles {
        [_] => 2,
        _ => {
            out.push_str(&overview_links(title, articles));
            3
        }
    };
    for (index, article) in articles.iter().enumerate() {
        write_article(&mut out, index, article, depth);
    }
    write_end(&mut out, articles, &scripts, engine);
    out
}

/// A page of words, pictures and links only.
pub(super) fn whole_text(title: &str, body: &str) -> String {
    format!(
        "{}{body}<footer>Made by mechanim {}.</footer>\n</main>\n</body>\n</html>\n",
        page_head(title, &[], false),
        env!("CARGO_PKG_VERSION"),
    )
}

/// The page of two versions of one scene: their pictures side by side, led by either slider, and `sections` below them.
pub(super) fn linked_text(articles: &[Article; 2], sections: &[Section]) -> String {
    let [old, new] = articles;
    let title = match old.title == new.title {
        true => new.title.clone(),
        false => format!("{} → {}", old.title, new.title),
    };
    let mut out = page_head(&title, &SCRIPTS, false);
    let _ = write!(
        out,
        "<h1><bdi>{}</bdi>: two versions</h1>\n<div class=\"pair\" data-linked>\n",
        escaped(&title)
    );
    for (index, (word, article)) in [("Old", old), ("New", new)].into_iter().enumerate() {
        let titled = Article {
            title: format!("{word}: {}", article.title),
            ..article.clone()
        };
        write_article(&mut out, index, &titled, 3);
    }
    out.push_str("</div>\n<div data-part=\"compared\">\n");
    for section in sections {
        write_section(&mut out, section, 2);
    }
    out.push_str("</div>\n");
    write_end(&mut out, articles, &SCRIPTS, None);
    out
}

/// An element that is not seen: data, or a script.
struct HeldElement<'a> {
    id: &'a str,
    kind: &'a str,
    text: &'a str,
}

impl<'a> HeldElement<'a> {
    fn script(id: &'a str, text: &'a str) -> Self {
        let kind = "text/javascript";
        Self { id, kind, text }
    }

    fn write(&self, out: &mut String) {
        let id = match self.id {
            "" => String::new(),
            id => format!(" id=\"{id}\""),
        };
        let _ = writeln!(
            out,
            "<script type=\"{}\"{id}>{}</script>",
            self.kind, self.text
        );
    }
}

/// All elements as one text, which the script that unpacks makes elements again.
fn packed_elements(held: &[HeldElement]) -> Option<String> {
    let listed = held
        .iter()
        .map(|element| json!({"id": element.id, "type": element.kind, "text": element.text}));
    packed_text(Value::from_iter(listed).to_string().as_bytes()).ok()
}

/// The footer, the data, the engine, the scripts. A live page holds them packed.
fn write_end(
    out: &mut String,
    articles: &[Article],
    scripts: &[&str],
    engine: Option<&PackedEngine>,
) {
    let _ = writeln!(
        out,
        "<footer>Made by mechanim {}. This file needs no network.</footer>\n</main>",
        env!("CARGO_PKG_VERSION"),
    );
    let data = articles.iter().map(|article| article.data.clone());
    let data = script_json(&data.collect());
    let element = |id, kind, text| HeldElement { id, kind, text };
    let mut held = vec![element("data", "application/json", &data)];
    held.extend(engine.map(|_| element("worker", "text/plain", WORKER)));
    held.extend(scripts.iter().map(|text| HeldElement::script("", text)));
    let packed = engine.and_then(|engine| Some((engine, packed_elements(&held)?)));
    if let Some((engine, packed)) = &packed {
        held = vec![
            element("engine", PACKED, &engine.text),
            element("packed", PACKED, packed),
            HeldElement::script("unpack", UNPACK),
        ];
    }
    held.iter().for_each(|element| element.write(out));
    out.push_str("</body>\n</html>\n");
}

/// A policy that allows only what is written here: no text of a scene can become script or style, and nothing is
/// requested from any address. A live page may also compile its engine, in a worker that it creates itself.
fn content_policy(scripts: &[&str], is_live: bool) -> String {
    let hash = |text: &str| format!("'sha256-{}'", BASE64_STANDARD.encode(Sha256::digest(text)));
    let unpack = is_live.then_some(&UNPACK);
    let scripts = unpack.into_iter().chain(scripts);
    let mut allowed: Vec<String> = scripts.map(|script| hash(script)).collect();
    let mut workers = "";
    if is_live {
        allowed.push("'wasm-unsafe-eval'".to_owned());
        workers = " worker-src blob:;";
    }
    if allowed.is_empty() {
        allowed.push("'none'".to_owned());
    }
    format!(
        "default-src 'none'; img-src data:; style-src {}; script-src {};{workers} base-uri 'none'; form-action 'none'",
        hash(STYLE),
        allowed.join(" "),
    )
}

fn page_head(title: &str, scripts: &[&str], is_live: bool) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<link rel=\"icon\" href=\"data:,\">\n<style>{STYLE}</style>\n</head>\n<body{}>\n<main>\n",
        content_policy(scripts, is_live),
        escaped(title),
        if is_live { " class=\"is-live\"" } else { "" },
    )
}

/// All mechanisms with their results, as links to their articles.
fn overview_links(title: &str, articles: &[Article]) -> String {
    let mut out = format!("<h1>{}</h1>\n<ul>\n", escaped(title));
    for (index, article) in articles.iter().enumerate() {
        let _ = writeln!(
            out,
            "<li><a href=\"#scene-{}\"><bdi>{}</bdi></a>: {}</li>",
            index + 1,
            escaped(&article.title),
            escaped(&article.result),
        );
    }
    out.push_str("</ul>\n");
    out
}

fn write_article(out: &mut String, index: usize, article: &Article, depth: usize) {
    let title = depth - 1;
    let _ = write!(
        out,
        "<article id=\"scene-{}\">\n<h{title}><bdi data-part=\"title\">{}</bdi></h{title}>\n<p class=\"faint\"><bdi>{}</bdi></p>\n\
         <p class=\"verdict {}\" data-part=\"verdict\">{}</p>\n",
        index + 1,
        escaped(&article.title),
        escaped(&article.source),
        state_class(article.status),
        escaped(&article.result),
    );
    if let Some(still) = &article.still {
        match article.is_live() {
            false => write_view(out, article, still),
            true => {
                out.push_str("<div class=\"workbench\">\n");
                write_view(out, article, still);
                out.push_str("<div class=\"bench\" data-part=\"bench\" hidden></div>\n</div>\n");
            }
        }
    }
    let _ = writeln!(
        out,
        "<div data-part=\"sections\">\n{}</div>",
        sections_text(article, depth)
    );
    out.push_str("</article>\n");
}

/// Everything below the picture.
pub(super) fn sections_text(article: &Article, depth: usize) -> String {
    let mut out = String::new();
    for section in &article.sections {
        write_section(&mut out, section, depth);
    }
    out
}

/// The picture, the canvas over it, and the time controls. Everything that needs the script is hidden until it runs.
fn write_view(out: &mut String, article: &Article, still: &[u8]) {
    let title = escaped(&article.title);
    let canvas = match article.has_view() {
        false => String::new(),
        true => format!(
            "<canvas data-part=\"canvas\" hidden tabindex=\"0\" role=\"img\" aria-label=\"3-D view of {title}: arrow keys rotate it, plus and minus zoom, Home resets it\"></canvas>"
        ),
    };
    let _ = write!(
        out,
        "<figure>\n<div class=\"stage\"><img class=\"still\" data-part=\"still\" alt=\"{title} at the start of its motion\" src=\"data:image/png;base64,{}\">{canvas}</div>\n\
         <p class=\"faint\" data-part=\"note\"{}>{}</p>\n\
         <div class=\"controls\" data-live hidden><button type=\"button\" data-part=\"play\">Play</button>\
         <input type=\"range\" min=\"0\" max=\"0\" value=\"0\" step=\"1\" aria-label=\"Time\" data-part=\"slider\"><output data-part=\"clock\"></output>\
         <button type=\"button\" data-part=\"reset\"{}>Reset view</button></div>\n\
         <p class=\"live faint\" data-live hidden><span data-part=\"caption\" aria-live=\"polite\"></span> {}</p>\n",
        BASE64_STANDARD.encode(still),
        if article.note.is_some() {
            ""
        } else {
            " hidden"
        },
        escaped(article.note.as_deref().unwrap_or_default()),
        if canvas.is_empty() { " disabled" } else { "" },
        match canvas.is_empty() {
            true => String::new(),
            false => format!(
                "<span data-part=\"hint\">{} to rotate, with Shift or two fingers to move; pinch, or use the wheel with Ctrl, to zoom. Click a curve to select a time.</span>",
                match article.is_live() {
                    true => "Drag a link to pull it; drag beside it",
                    false => "Drag",
                }
            ),
        },
    );
    out.push_str("<noscript><p class=\"faint\">Scripts are disabled: the picture does not move; everything else is here.</p></noscript>\n");
    let mut now = Table::new(
        "Values at the time of the slider",
        &["quantity", "value:", "unit"],
    );
    now.rows = article
        .values
        .iter()
        .enumerate()
        .map(|(k, (name, unit))| vec![Cell::text(name), Cell::Live(k), Cell::text(unit)])
        .collect();
    let mut section = Section::default();
    section.table(&now);
    for block in section.blocks {
        let _ = writeln!(out, "<div class=\"live\" data-live hidden>{block}</div>");
    }
    out.push_str("</figure>\n");
}

fn write_section(out: &mut String, section: &Section, depth: usize) {
    if section.blocks.is_empty() {
        return;
    }
    let _ = writeln!(
        out,
        "<section>\n<h{depth}>{}</h{depth}>",
        escaped(&section.heading)
    );
    for block in &section.blocks {
        out.push_str(block);
        out.push('\n');
    }
    out.push_str("</section>\n");
}
