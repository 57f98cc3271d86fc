//! The result of a check, before anything is written.

use crate::cli::term::outcome::Failure;
use crate::report::closure;
use crate::report::verdict::Verdict;
use serde_json::{Value, json};

/// The findings of a check.
pub struct CheckAnswer {
    /// The lines of the text.
    pub text: String,
    /// The JSON report, if requested.
    pub document: Option<Value>,
    /// Source of the exit code and the JUnit file.
    pub verdict: Verdict,
    /// Shown instead of the text if there is nothing to report on.
    pub failure: Option<Failure>,
}

impl CheckAnswer {
    /// The answer to a scene with a loop that no pose closes.
    pub fn closes_nowhere(scene: &str, failure: Failure) -> Self {
        let verdict = Verdict {
            title: scene.to_owned(),
            cases: vec![closure::unclosed_case(&failure.to_string())],
        };
        Self::without_poses(verdict, failure)
    }

    /// The answer to a scene that cannot be checked.
    pub fn unreadable(scene: &str, failure: Failure) -> Self {
        let verdict = Verdict::unreadable(scene, failure.told(), failure.line());
        Self::without_poses(verdict, failure)
    }

    fn without_poses(verdict: Verdict, failure: Failure) -> Self {
        Self {
            text: String::new(),
            document: Some(json!({
                "schema": "mechanim-check/1",
                "title": verdict.title,
                "checks": verdict.json(),
                "result": verdict.result().word(),
            })),
            verdict,
            failure: Some(failure),
        }
    }
}
