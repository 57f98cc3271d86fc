//! A verdict as JUnit XML: one suite per scene, one case per question. A negative answer is a failure and an undecided
//! one an error, so that a green suite means exit code zero, and nothing else does.

use super::verdict::{Case, SceneVerdict, Status};
use crate::diag::xml_text;

/// The whole file, one suite for each scene.
pub fn to_junit(judged: &[SceneVerdict]) -> String {
    let all: Vec<&Case> = judged.iter().flat_map(|one| &one.verdict.cases).collect();
    let totals = suite_totals(&all, judged.iter().map(|one| one.seconds).sum());
    let are_many = judged.len() > 1;
    let suites: String = judged
        .iter()
        .map(|one| suite_element(one, are_many))
        .collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites {totals}>\n{suites}</testsuites>\n"
    )
}

/// The suite of a scene; of several scenes each is named with its file, since copies of a design have one title.
fn suite_element(one: &SceneVerdict, are_many: bool) -> String {
    let title = &one.verdict.title;
    let name = match are_many {
        true => format!("{title} ({})", one.source),
        false => title.clone(),
    };
    let all: Vec<&Case> = one.verdict.cases.iter().collect();
    let cases: String = all.iter().map(|case| case_element(case)).collect();
    format!(
        "  <testsuite name=\"{}\" {}>\n{cases}  </testsuite>\n",
        xml_text(&name),
        suite_totals(&all, one.seconds),
    )
}

/// Their numbers and their total time.
fn suite_totals(cases: &[&Case], seconds: f64) -> String {
    let count = |status: &[Status]| cases.iter().filter(|c| status.contains(&c.status)).count();
    format!(
        "tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"{}\" time=\"{seconds:.3}\"",
        cases.len(),
        count(&[Status::Failed, Status::NotClosed]),
        count(&[Status::NotProved, Status::Unreadable]),
        count(&[Status::Skipped]),
    )
}

fn case_element(case: &Case) -> String {
    let time = case.seconds.map(|s| format!(" time=\"{s:.3}\""));
    let head = format!(
        "    <testcase classname=\"{}\" name=\"{}\"{}>",
        xml_text(case.group),
        xml_text(&case.name),
        time.unwrap_or_default(),
    );
    let text = xml_text(&case.text);
    // Some readers show the attribute, others the text inside.
    let body = match case.status {
        Status::Passed => format!("<system-out>{text}</system-out>"),
        Status::Skipped => format!("<skipped message=\"{text}\"/>"),
        Status::NotProved => {
            format!("<error type=\"not-proved\" message=\"{text}\">{text}</error>")
        }
        Status::Unreadable => {
            format!("<error type=\"cannot-be-checked\" message=\"{text}\">{text}</error>")
        }
        Status::Failed => format!("<failure type=\"failed\" message=\"{text}\">{text}</failure>"),
        Status::NotClosed => {
            format!("<failure type=\"not-closed\" message=\"{text}\">{text}</failure>")
        }
    };
    format!("{head}{body}</testcase>\n")
}
