//! Texts in markup: escaped, with invisible and control characters spelled out. Every text of a scene reaches the page
//! through this file.

use crate::diag::{shown_lines, xml_text};
use crate::report::verdict::Status;
use std::fmt::Write;

/// A text as contents or as an attribute in double quotes.
pub fn escaped(text: &str) -> String {
    xml_text(&shown_lines(text))
}

/// JSON inside a script element: nothing in it can end the element or open a comment.
pub fn script_json(value: &serde_json::Value) -> String {
    let text = value.to_string();
    text.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
}

/// Number of rows of a table that is shown at once, and of a longer one those shown before it is unfolded.
const MOST_SEEN: usize = 12;
const FIRST_SEEN: usize = 8;

/// A part of an article under a heading.
#[derive(Clone, Debug, Default)]
pub struct Section {
    /// Its heading.
    pub heading: String,
    /// Markup, each block complete.
    pub blocks: Vec<String>,
}

impl Section {
    /// An empty section.
    pub fn new(heading: &str) -> Self {
        Self {
            heading: heading.to_owned(),
            blocks: Vec::new(),
        }
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: &str) {
        self.blocks.push(format!("<p>{}</p>", escaped(text)));
    }

    /// Adds terms with their explanations; a term without a name belongs to the one before.
    pub fn terms(&mut self, terms: &[(String, String)]) {
        let mut out = String::from("<dl>");
        for (term, text) in terms {
            if !term.is_empty() {
                let _ = write!(out, "<dt>{}</dt>", escaped(term));
            }
            let _ = write!(out, "<dd>{}</dd>", escaped(text));
        }
        out.push_str("</dl>");
        self.blocks.push(out);
    }

    /// Adds a table, unless it is empty; the first rows of a long one are visible, the others are folded.
    pub fn table(&mut self, table: &Table) {
        if table.rows.is_empty() {
            return;
        }
        if table.rows.len() <= MOST_SEEN {
            return self.blocks.push(table.markup());
        }
        let (seen, folded) = table.rows.split_at(FIRST_SEEN);
        let part = |caption: String, rows: &[Vec<Cell>]| Table {
            caption,
            heads: table.heads.clone(),
            rows: rows.to_vec(),
        };
        let more = format!("{}: {} more", table.caption, folded.len());
        self.blocks.push(format!(
            "{}<details><summary>{} more</summary>{}</details>",
            part(table.caption.clone(), seen).markup(),
            folded.len(),
            part(more, folded).markup(),
        ));
    }
}

/// A cell of a table.
#[derive(Clone, Debug)]
pub enum Cell {
    /// Words.
    Text(String),
    /// A number, set to the right.
    Number(String),
    /// An answer, coloured by its status.
    State(Status, String),
    /// A value that follows the time slider: its number in the list of values.
    Live(usize),
    /// A button that shows a frame, and in it a pair of points by its index in the list of marks. `about` describes it
    /// for screen readers.
    Show {
        /// The frame.
        frame: usize,
        /// The mark.
        mark: Option<usize>,
        /// What the button is for.
        about: String,
    },
    /// Nothing.
    Empty,
}

impl Cell {
    /// Words.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// A number with its unit.
    pub fn number(text: impl Into<String>) -> Self {
        Self::Number(text.into())
    }

    fn markup(&self) -> String {
        match self {
            Self::Text(text) => format!("<td>{}</td>", escaped(text)),
            Self::Number(text) => format!("<td class=\"number\">{}</td>", escaped(text)),
            Self::State(status, text) => {
                format!(
                    "<td class=\"state {}\">{}</td>",
                    state_class(*status),
                    escaped(text)
                )
            }
            Self::Live(value) => format!("<td class=\"number\" data-value=\"{value}\">–</td>"),
            Self::Show { frame, mark, about } => {
                let mark = mark.map_or_else(String::new, |mark| format!(" data-mark=\"{mark}\""));
                format!(
                    "<td><button type=\"button\" data-live hidden data-frame=\"{frame}\"{mark} aria-label=\"show {}\">show</button></td>",
                    escaped(about)
                )
            }
            Self::Empty => "<td></td>".to_owned(),
        }
    }
}

/// Rows under headings.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// What it is a table of.
    pub caption: String,
    /// Headings of the columns; those that end with a colon head numbers.
    pub heads: Vec<String>,
    /// Rows, as long as the headings.
    pub rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(caption: impl Into<String>, heads: &[&str]) -> Self {
        Self {
            caption: caption.into(),
            heads: heads.iter().map(|head| (*head).to_owned()).collect(),
            rows: Vec::new(),
        }
    }

    fn markup(&self) -> String {
        // A scrolling box must be accessible by keyboard.
        let caption = escaped(&self.caption);
        let mut out = format!(
            "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\"><table><caption>{caption}</caption><thead><tr>"
        );
        for head in &self.heads {
            let _ = match head.strip_suffix(':') {
                Some(head) => write!(
                    out,
                    "<th scope=\"col\" class=\"number\">{}</th>",
                    escaped(head)
                ),
                None if head.is_empty() => write!(out, "<td></td>"),
                None => write!(out, "<th scope=\"col\">{}</th>", escaped(head)),
            };
        }
        out.push_str("</tr></thead><tbody>\n");
        for row in &self.rows {
            let cells: String = row.iter().map(Cell::markup).collect();
            let _ = writeln!(out, "<tr>{cells}</tr>");
        }
        out.push_str("</tbody></table></div>");
        out
    }
}

/// The class of an answer in the style.
pub fn state_class(status: Status) -> &'static str {
    match status {
        Status::Skipped => "faint",
        Status::Passed => "passed",
        Status::NotProved => "open",
        Status::Failed | Status::NotClosed | Status::Unreadable => "failed",
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use serde_json::json;

    #[test]
    fn no_text_becomes_markup() {
        let hostile = "</script><img src=x onerror=\"alert('1')\">&\u{202e}txt\u{0}";
        let text = escaped(hostile);
        assert!(
            !text.contains(['<', '>', '"', '\'', '\u{202e}', '\u{0}']),
            "{text}"
        );
        assert!(text.contains("&lt;/script&gt;&lt;img"), "{text}");
        let data = script_json(&json!({ "title": hostile, "more": "<!--<script>" }));
        assert!(!data.contains(['<', '>']), "{data}");
        let read: serde_json::Value = serde_json::from_str(&data).unwrap();
        assert_eq!(read["title"], hostile);
    }
}
