//! Answers to a live page: its motion while a slider moves, the whole article once it rests, errors with their
//! positions.

use super::session::{JudgedMotion, LiveError, LiveScene, Opened};
use super::sliders;
use crate::diag::{Diagnostic, SceneError, Severity};
use crate::kinematics::results::trajectory::Trajectory;
use crate::limits::LimitExceeded;
use crate::page::article::{
    Article, article_in_view, article_without_motion, frame_times, values_at,
};
use crate::page::checked::CheckedMotion;
use crate::page::document::sections_text;
use crate::page::frames::shown_trajectory;
use crate::page::markup::state_class;
use crate::page::model::{changed_shapes, motion_value, viewer_model};
use crate::page::still::view_of;
use crate::report::clearance::{clearance_cases, pair_sentence};
use crate::report::event_sentences::{event_sentence, gap_sentence};
use crate::report::proof::PoseProofs;
use crate::report::rounded::at_most;
use crate::report::sentences::counted_things;
use crate::report::verdict::{CLEARANCE, Status, Verdict};
use serde_json::{Value, json};

/// Most sentences about events on the way: more cannot be read while a slider moves.
const MOST_EVENTS: usize = 3;

/// What a page receives about the bodies' shapes in addition to their placements.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Shapes {
    /// Those of some bodies have changed.
    Changed(Vec<usize>),
    /// All are new, and so is the camera.
    InView,
}

impl LiveScene {
    /// What a page shows immediately: poses, values and their proof; also the shapes if they have changed.
    pub(super) fn state(&self, shapes: &Shapes) -> Value {
        let Opened {
            scene,
            system,
            motion,
        } = &self.now;
        let held = self.held();
        let shown = match &held {
            Some(held) => held.clone(),
            None => shown_trajectory(system, &scene.actuation, motion, None),
        };
        let mechanism = &scene.mechanism;
        let has_pose = shown.poses().next().is_some();
        let model = match shapes {
            Shapes::InView if has_pose => {
                let (camera, aspect) = view_of(scene, &shown);
                viewer_model(scene, (motion, &shown), Some((&camera, aspect))).ok()
            }
            Shapes::Changed(bodies) if has_pose && !bodies.is_empty() => {
                Some(changed_shapes(scene, bodies, self.extent))
            }
            _ => None,
        };
        let put = self.overrides.parameters.iter();
        json!({
            "times": frame_times(&shown),
            "values": values_at(mechanism, &shown),
            "motion": motion_value(mechanism, (&shown, &shown)),
            "model": model,
            "proof": self.proof(held.as_ref().unwrap_or(motion)),
            "parameters": put.map(|(name, text)| (name.clone(), json!(text))).collect::<serde_json::Map<_, _>>(),
            "guess": self.overrides.guess,
            "held": held.is_some(),
        })
    }

    /// The sliders and their targets.
    pub(super) fn sliders(&self) -> Value {
        let Opened { scene, motion, .. } = &self.now;
        json!({
            "title": scene.mechanism.title,
            "dimensions": sliders::dimensions(&self.text, &self.overrides, scene),
            "inputs": sliders::inputs(&scene.mechanism, motion),
            "version": env!("CARGO_PKG_VERSION"),
        })
    }

    /// The state of the poses as one line with its class, and the events on the way.
    fn proof(&self, motion: &Trajectory) -> Value {
        let Opened { scene, system, .. } = &self.now;
        let mechanism = &scene.mechanism;
        let proofs = PoseProofs::of(system, motion, self.asked.asked.poses);
        let closes = motion.closure_error() <= self.asked.asked.closure;
        let status = match motion.missing() {
            0 if closes => proofs.case(mechanism).status.max(Status::Passed),
            0 => Status::Failed,
            _ => Status::NotClosed,
        };
        let gaps = motion.gaps.iter().map(|gap| gap_sentence(mechanism, gap));
        let events = motion
            .events
            .iter()
            .map(|event| event_sentence(mechanism, event));
        json!({
            "class": state_class(status),
            "head": closing_line(motion),
            "text": proof_line(motion, &proofs.sentence(mechanism)),
            "events": gaps.chain(events).take(MOST_EVENTS).collect::<Vec<_>>(),
        })
    }

    /// The motion as it is judged, between its samples too, and its clearances.
    ///
    /// Errors: more than a run may use.
    fn judge(&mut self) -> Result<JudgedMotion, LimitExceeded> {
        if let Some(known) = self.judged.take() {
            return Ok(known);
        }
        let Opened { scene, system, .. } = &self.now;
        let times = self.asked.times(scene);
        let check = self.asked.check(scene, system, &times);
        let (motion, proved) = check.solve(&|| false)?;
        let clearances = match motion.poses().next() {
            Some(_) => check.clearances(&mut check.cover(&motion, proved), &|_, _| {})?,
            None => None,
        };
        Ok(JudgedMotion { motion, clearances })
    }

    /// The state of the poses, between the samples too, and the worst pair of bodies in words.
    ///
    /// Errors: more than a run may use.
    pub(super) fn clearance(&mut self) -> Result<Value, LiveError> {
        let judged = self.judge()?;
        let mechanism = self.mechanism();
        let worst = judged.clearances.as_ref().and_then(|found| {
            let pair = found.worst()?;
            let verdict = Verdict {
                title: mechanism.title.clone(),
                cases: clearance_cases(mechanism, found, self.asked.asked),
            };
            Some(json!({
                "class": state_class(verdict.result_of(CLEARANCE)),
                "text": pair_sentence(mechanism, pair),
            }))
        });
        let answer = json!({ "clearance": worst, "proof": self.proof(&judged.motion) });
        self.judged = Some(judged);
        Ok(answer)
    }

    /// The whole article, clearances and curves included, as `report` writes it, in the form that the page inserts. `depth` is
    /// that of its headings.
    ///
    /// Errors: more than a run may use.
    pub(super) fn settled(&mut self, depth: usize) -> Result<Value, LiveError> {
        let judged = self.judge()?;
        let article = self.article(&judged);
        self.judged = Some(judged);
        Ok(json!({
            "class": state_class(article.status),
            "result": article.result,
            "sections": sections_text(&article, depth),
            "data": article.data,
        }))
    }

    fn article(&self, JudgedMotion { motion, clearances }: &JudgedMotion) -> Article {
        let Opened { scene, system, .. } = &self.now;
        let times = self.asked.times(scene);
        let check = self.asked.check(scene, system, &times);
        if motion.poses().next().is_none() {
            let answer = check.without_pose(motion, None);
            return article_without_motion(&self.source().name, &answer.verdict);
        }
        let clearances = clearances.as_ref();
        let answer = check.answer(motion, &mut check.cover(motion, None), clearances, 0.0);
        let checked = CheckedMotion {
            source: &self.source().name,
            scene,
            system,
            trajectory: motion,
            clearances,
            answer: &answer,
        };
        article_in_view(&checked, self.number)
    }
}

/// The number of poses, and their closure error.
fn closing_line(motion: &Trajectory) -> String {
    let all = motion.samples.len();
    let posed = all - motion.missing();
    match posed {
        0 => "No pose was found".to_owned(),
        _ => format!(
            "{posed} of {}, closed to {}",
            counted_things(all, "pose"),
            at_most(motion.closure_error())
        ),
    }
}

/// Certificates, rank, singular value, condition and assembly of all poses.
fn proof_line(motion: &Trajectory, sentence: &str) -> String {
    let Some(first) = motion.poses().next() else {
        return String::new();
    };
    let sigma = motion
        .poses()
        .map(|p| p.sigma_min)
        .fold(f64::INFINITY, f64::min);
    let condition = motion.poses().map(|p| p.condition).fold(0.0, f64::max);
    let rank = motion.poses().map(|p| p.rank).min().unwrap_or(0);
    let mut branches: Vec<&str> = motion.poses().map(|p| &p.branch[..]).collect();
    branches.dedup();
    let branch = match branches[..] {
        [""] => String::new(),
        [one] => format!(", assembly {one}"),
        _ => ", the assembly changes".to_owned(),
    };
    format!(
        "Certificates: {sentence}. Rank {rank} of {}, smallest singular value {sigma:.2e}, condition at most {}{branch}.",
        first.unknowns.len(),
        at_most(condition),
    )
}

impl LiveError {
    /// As the page shows it: errors with their positions in the text, or one sentence.
    pub(super) fn json(&self) -> Value {
        match self {
            Self::Scene(error) => json!({ "mistakes": listed_mistakes(error) }),
            other => json!({ "mistakes": [{ "message": other.to_string(), "hints": [] }] }),
        }
    }
}

fn listed_mistakes(error: &SceneError) -> Vec<Value> {
    let source = &error.source_text;
    let place = |diagnostic: &Diagnostic| {
        let span = diagnostic.span.as_ref();
        // A replaced value has no position in the text.
        let span = span.filter(|span| span.start < source.text.len());
        span.map(|span| {
            let [line, column] = source.line_and_column(span.start);
            let units = |end: usize| source.text.get(..end).map(|t| t.encode_utf16().count());
            json!({ "line": line, "column": column, "from": units(span.start), "to": units(span.end) })
        })
    };
    let sorted = error.diagnostics.sorted();
    let wrong = sorted.iter().filter(|d| d.severity == Severity::Error);
    wrong
        .map(|d| json!({ "place": place(d), "message": d.message, "label": d.label, "hints": d.hints }))
        .collect()
}
