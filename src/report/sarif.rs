//! Verdicts as SARIF 2.1.0, which code-hosting services show next to the files of a change: one result for every
//! question that did not pass.

use super::verdict::{CLEARANCE, Case, MEASURES, MOTION, PROOF, SCENE, SceneVerdict, Status};
use serde_json::{Value, json};

/// Explanations of the groups of questions, for readers of a result.
const RULES: [(&str, &str); 5] = [
    (MOTION, "All loops close over the whole motion."),
    (PROOF, "Every requested proof succeeds."),
    (MEASURES, "Measures keep their limits."),
    (
        CLEARANCE,
        "Bodies keep their minimum distance at every instant.",
    ),
    (SCENE, "The scene can be checked."),
];

/// The whole document.
pub fn to_sarif(judged: &[SceneVerdict]) -> Value {
    let rule = |(id, text): (&str, &str)| json!({ "id": id, "shortDescription": { "text": text } });
    let results: Vec<Value> = judged.iter().flat_map(results_of).collect();
    json!({
        "$schema": "https://json.schemastore.org/sarif-2.1.0.json",
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "mechanim",
                "version": env!("CARGO_PKG_VERSION"),
                "rules": RULES.map(rule),
            }},
            "results": results,
        }],
    })
}

fn results_of(one: &SceneVerdict) -> Vec<Value> {
    let cases = one.verdict.cases.iter();
    let bad = cases.filter(|case| case.status > Status::Passed);
    let message = |case: &Case| match case.status {
        Status::Unreadable => format!("{}: {}", case.status.word(), case.text),
        status => format!(
            "{}: {} {}: {}",
            one.verdict.title,
            case.name,
            status.word(),
            case.text
        ),
    };
    bad.map(|case| {
        let mut place = json!({ "artifactLocation": { "uri": relative_uri(one.source) } });
        if let Some(line) = case.line {
            place["region"] = json!({ "startLine": line });
        }
        json!({
            "ruleId": case.group,
            "level": if case.status == Status::NotProved { "warning" } else { "error" },
            "message": { "text": message(case) },
            "locations": [{ "physicalLocation": place }],
        })
    })
    .collect()
}

/// A path as a URI relative to the working directory.
fn relative_uri(path: &str) -> String {
    let mut out = String::new();
    for byte in path.replace('\\', "/").bytes() {
        match byte {
            b'/' | b'-' | b'.' | b'_' | b'~' => out.push(char::from(byte)),
            byte if byte.is_ascii_alphanumeric() => out.push(char::from(byte)),
            byte => out.push_str(&format!("%{byte:02X}")),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::report::verdict::Verdict;

    #[test]
    fn only_what_is_wrong_is_a_result() {
        let case = |status| Case::new(CLEARANCE, "a / b", status, "0.1 mm");
        let verdict = Verdict {
            title: "T".to_owned(),
            cases: vec![
                case(Status::Passed),
                case(Status::Skipped),
                case(Status::Failed),
                case(Status::NotProved),
            ],
        };
        let document = to_sarif(&[SceneVerdict {
            source: "a b\\c.toml",
            verdict: &verdict,
            seconds: 0.0,
        }]);
        let results = document["runs"][0]["results"].as_array().unwrap();
        let levels: Vec<&Value> = results.iter().map(|r| &r["level"]).collect();
        assert_eq!(levels, ["error", "warning"]);
        let place = &results[0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"];
        assert_eq!(place, "a%20b/c.toml");
        let rules = document["runs"][0]["tool"]["driver"]["rules"]
            .as_array()
            .unwrap();
        assert!(rules.iter().any(|rule| rule["id"] == results[0]["ruleId"]));
    }
}
