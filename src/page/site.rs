//! The front page of a folder of pages: every mechanism with its picture, its result and a link to its page.

use super::article::Article;
use super::document::whole_text;
use super::markup::{escaped, state_class};
use crate::export::png_indexed::encode_indexed;
use base64::prelude::{BASE64_STANDARD, Engine};
use image::imageops::{FilterType, resize};
use std::fmt::Write;

/// Size of a picture on the front page.
const SMALL: [u32; 2] = [320, 240];

/// A mechanism on the front page.
#[derive(Clone, Debug)]
pub struct SiteEntry {
    /// Name of the file of its page, in the same folder.
    pub file: String,
    /// One line about it; may be empty.
    pub description: String,
    title: String,
    result: String,
    class: &'static str,
    picture: Option<Vec<u8>>,
}

impl SiteEntry {
    /// The entry of an article whose page is `file`.
    pub fn new(article: &Article, file: &str, description: &str) -> Self {
        Self {
            file: file.to_owned(),
            description: description.to_owned(),
            title: article.title.clone(),
            result: article.result.clone(),
            class: state_class(article.status),
            picture: article.still.as_deref().and_then(small_picture),
        }
    }
}

fn small_picture(png: &[u8]) -> Option<Vec<u8>> {
    let whole = image::load_from_memory(png).ok()?.to_rgba8();
    let small = resize(&whole, SMALL[0], SMALL[1], FilterType::Triangle);
    let mut out = Vec::new();
    encode_indexed(&small, &mut out).ok()?;
    Some(out)
}

/// The front page.
pub fn site_text(title: &str, entries: &[SiteEntry]) -> String {
    let mut body = format!("<h1>{}</h1>\n<ul class=\"gallery\">\n", escaped(title));
    for entry in entries {
        // A picture next to its title needs no description.
        let picture = entry.picture.as_ref().map_or_else(String::new, |png| {
            let [width, height] = SMALL;
            format!(
                "<img width=\"{width}\" height=\"{height}\" alt=\"\" src=\"data:image/png;base64,{}\">",
                BASE64_STANDARD.encode(png)
            )
        });
        let _ = writeln!(
            body,
            "<li><a href=\"{}\">{picture}<bdi>{}</bdi></a><p>{}</p><p class=\"{}\">{}</p></li>",
            escaped(&entry.file),
            escaped(&entry.title),
            escaped(&entry.description),
            entry.class,
            escaped(&entry.result),
        );
    }
    body.push_str("</ul>\n");
    whole_text(title, &body)
}
