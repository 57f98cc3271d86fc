//! Verdicts as Markdown: the summary of a CI job, with one line per scene and one for every question that did not pass.

use super::verdict::{SceneVerdict, Status};

/// Most lines about one scene.
const MOST_LINES: usize = 20;

/// The whole text.
pub fn to_markdown(judged: &[SceneVerdict]) -> String {
    let mut text = "| scene | mechanism | result | seconds |\n|---|---|---|---:|\n".to_owned();
    for one in judged {
        text.push_str(&format!(
            "| {} | {} | {} | {:.2} |\n",
            plain_cell(one.source),
            plain_cell(&one.verdict.title),
            plain_cell(&one.verdict.sentence()),
            one.seconds
        ));
    }
    for one in judged {
        let bad = one
            .verdict
            .cases
            .iter()
            .filter(|case| case.status > Status::Passed);
        let lines: Vec<String> = bad
            .map(|case| {
                format!(
                    "- **{}**: {}: {}\n",
                    case.status.word(),
                    plain_cell(&case.name),
                    plain_cell(&case.text)
                )
            })
            .collect();
        if lines.is_empty() {
            continue;
        }
        text.push_str(&format!(
            "\n### {}\n\n{}",
            plain_cell(one.source),
            lines[..lines.len().min(MOST_LINES)].concat()
        ));
        if lines.len() > MOST_LINES {
            text.push_str(&format!("- and {} more\n", lines.len() - MOST_LINES));
        }
    }
    text
}

/// A text without markup: a text of a scene cannot become a link, a picture or a column.
fn plain_cell(text: &str) -> String {
    let mut out = String::new();
    for c in crate::diag::shown_text(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '|' | '\\' | '`' | '*' | '_' | '[' | ']' | '!' | '#' | '~' => {
                out.push('\\');
                out.push(c);
            }
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::verdict::{Case, MEASURES, Verdict};

    #[test]
    fn texts_of_a_scene_stay_texts() {
        let verdict = Verdict {
            title: "![x](http://y) | <b>".to_owned(),
            cases: vec![Case::new(MEASURES, "a", Status::Failed, "3\n4")],
        };
        let text = to_markdown(&[SceneVerdict {
            source: "a.toml",
            verdict: &verdict,
            seconds: 1.0,
        }]);
        assert!(
            text.contains("\\!\\[x\\](http://y) \\| &lt;b&gt; | failed: a | 1.00 |"),
            "{text}"
        );
        assert!(
            text.contains("\n### a.toml\n\n- **failed**: a: 3"),
            "{text}"
        );
        assert_eq!(
            text.lines().filter(|line| line.starts_with('|')).count(),
            3,
            "{text}"
        );
    }
}
