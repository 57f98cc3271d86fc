//! The requirements of a check, and the answer to every question: the one value from which exit code, text, JSON and
//! JUnit follow.

use serde_json::{Value, json};

/// The requirements on a motion in addition to the scene's own limits.
#[derive(Clone, Copy, Debug)]
pub struct CheckRequirements {
    /// Largest closure error, relative to the mechanism's size.
    pub closure: f64,
    /// Whether every pose must be proved.
    pub poses: bool,
    /// Whether the motion between the samples must be proved, too.
    pub motion: bool,
    /// Whether pairs of bodies with an estimated bound pass.
    pub estimates: bool,
    /// Whether scenes without a judged pair pass.
    pub empty: bool,
    /// Pairs within this length of their minimum are near.
    pub band: Option<f64>,
}

impl CheckRequirements {
    /// Default limit of closure errors: far above rounding, far below anything that can be built.
    pub const CLOSURE: f64 = 1e-9;
}

/// The answer to a question; worse ones are greater.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Status {
    /// Not requested, or not applicable.
    Skipped,
    /// Yes.
    Passed,
    /// Undecided: a requested proof is missing, or there was nothing to examine.
    NotProved,
    /// No.
    Failed,
    /// Poses are missing.
    NotClosed,
    /// The scene cannot be read, or not be checked as requested.
    Unreadable,
}

impl Status {
    /// The word used in reports.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Skipped => "skipped",
            Self::Passed => "passed",
            Self::NotProved => "not proved",
            Self::Failed => "failed",
            Self::NotClosed => "not closed over the whole motion",
            Self::Unreadable => "cannot be checked",
        }
    }
}

/// One question.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// What it is about: [`MOTION`], [`PROOF`], [`MEASURES`], [`CLEARANCE`], [`SCENE`].
    pub group: &'static str,
    /// The subject: a measure, a pair of bodies.
    pub name: String,
    /// The answer.
    pub status: Status,
    /// Values, limits, reasons.
    pub text: String,
    /// Time of the answer in seconds, if measured.
    pub seconds: Option<f64>,
    /// Line of the scene that it is about, if it is about one.
    pub line: Option<usize>,
}

/// Group of the cases about closing.
pub const MOTION: &str = "motion";
/// Group of the cases about certificates.
pub const PROOF: &str = "proof";
/// Group of the measures.
pub const MEASURES: &str = "measures";
/// Group of the pairs of bodies.
pub const CLEARANCE: &str = "clearance";
/// Group of the only case of a scene that cannot be checked.
pub const SCENE: &str = "scene";

impl Case {
    /// An answer without a time.
    pub fn new(group: &'static str, name: &str, status: Status, text: impl Into<String>) -> Self {
        Self {
            group,
            name: name.to_owned(),
            status,
            text: text.into(),
            seconds: None,
            line: None,
        }
    }

    /// The same with the seconds it took.
    pub fn taking(self, seconds: f64) -> Self {
        Self {
            seconds: Some(seconds),
            ..self
        }
    }
}

/// Most names of cases in the result of a report.
const MOST_NAMES: usize = 4;

/// All questions of one check.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Title of the scene.
    pub title: String,
    /// Every question with its answer.
    pub cases: Vec<Case>,
}

impl Verdict {
    /// The verdict on a scene that cannot be checked, why, and the line of the first mistake.
    pub fn unreadable(source: &str, why: String, line: Option<usize>) -> Self {
        let case = Case {
            line,
            ..Case::new(SCENE, "can be checked", Status::Unreadable, why)
        };
        Self {
            title: source.to_owned(),
            cases: vec![case],
        }
    }

    /// The worst answer; [`Status::Passed`] without questions.
    pub fn result(&self) -> Status {
        worst_status(self.cases.iter())
    }

    /// The worst answer of one group.
    pub fn result_of(&self, group: &str) -> Status {
        worst_status(self.cases.iter().filter(|case| case.group == group))
    }

    /// The result in words, with the names of the cases that did not pass: `failed: crank / rod; not proved: poses`.
    pub fn sentence(&self) -> String {
        let bad = [
            Status::Unreadable,
            Status::NotClosed,
            Status::Failed,
            Status::NotProved,
        ];
        let parts = bad.into_iter().filter_map(|status| self.names(status));
        let parts: Vec<String> = parts.collect();
        match parts.is_empty() {
            true => Status::Passed.word().to_owned(),
            false => parts.join("; "),
        }
    }

    /// A bad answer with the names of all its cases.
    fn names(&self, status: Status) -> Option<String> {
        let cases = self.cases.iter().filter(|case| case.status == status);
        let names: Vec<&str> = cases.map(|case| case.name.as_str()).collect();
        // Only the motion itself can be open, and only the scene itself unreadable.
        if names.is_empty() || status >= Status::NotClosed {
            return (!names.is_empty()).then(|| status.word().to_owned());
        }
        let shown = names[..names.len().min(MOST_NAMES)].join(", ");
        let more = match names.len().saturating_sub(MOST_NAMES) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        Some(format!("{}: {shown}{more}", status.word()))
    }

    /// All cases for the JSON report.
    pub fn json(&self) -> Value {
        let case = |case: &Case| {
            json!({
                "group": case.group,
                "name": case.name,
                "status": case.status.word(),
                "text": case.text,
            })
        };
        self.cases.iter().map(case).collect()
    }
}

/// A verdict of a run that may be about several scenes.
#[derive(Clone, Copy, Debug)]
pub struct SceneVerdict<'a> {
    /// Where the scene is from.
    pub source: &'a str,
    /// What was found.
    pub verdict: &'a Verdict,
    /// What the check took.
    pub seconds: f64,
}

fn worst_status<'c>(cases: impl Iterator<Item = &'c Case>) -> Status {
    let all = cases.map(|case| case.status);
    all.fold(Status::Passed, Status::max)
}
