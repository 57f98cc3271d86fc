//! The texts inside a picture file.

use crate::diag::shown_text;

/// What a PNG of a scene says of itself: its title, the program, the scene's source, and what is changed in it.
pub fn picture_texts(title: &str, source: &str, changes: &[String]) -> Vec<(String, String)> {
    let changes = changes.join(" ");
    let texts = [
        ("Title", title),
        ("Software", concat!("mechanim ", env!("CARGO_PKG_VERSION"))),
        ("Source", source),
        ("Comment", &changes),
    ];
    let said = texts.into_iter().filter(|(_, text)| !text.is_empty());
    said.map(|(keyword, text)| (keyword.to_owned(), shown_text(text).into_owned()))
        .collect()
}
