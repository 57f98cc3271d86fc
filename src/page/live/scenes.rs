//! Receives the requests of a live page as JSON and answers them: one scene for each mechanism of the page.

use super::answers::Shapes;
use super::following::FollowEnd;
use super::pulling::Pull;
use super::requirements::LiveRequirements;
use super::session::{LiveError, LiveScene};
use crate::diag::Source;
use crate::scene::Overrides;
use glam::DVec3;
use serde_json::{Value, json};
use std::collections::HashMap;

/// The kinds of answers, as their first byte.
const TEXT: u8 = b'{';
const BYTES: u8 = b'=';

/// All scenes of a page.
#[derive(Default)]
pub struct PageScenes {
    scenes: HashMap<usize, LiveScene>,
}

/// An answer.
enum LiveAnswer {
    Text(Value),
    Bytes(Vec<u8>),
}

impl PageScenes {
    /// The answer to a request, `{"ask": WHAT, "number": SCENE, …}`: a JSON object, or `=` and the bytes of a file.
    pub fn answer(&mut self, question: &str) -> Vec<u8> {
        let answer = match serde_json::from_str::<Value>(question) {
            Ok(question) => self.answer_to(&question),
            Err(error) => Err(LiveError::Request(error.to_string())),
        };
        match answer.unwrap_or_else(|error| LiveAnswer::Text(error.json())) {
            LiveAnswer::Text(value) => {
                let text = value.to_string().into_bytes();
                debug_assert_eq!(text.first(), Some(&TEXT));
                text
            }
            LiveAnswer::Bytes(bytes) => [&[BYTES], &bytes[..]].concat(),
        }
    }

    fn answer_to(&mut self, question: &Value) -> Result<LiveAnswer, LiveError> {
        let number = question["number"].as_u64().unwrap_or(0) as usize;
        let word = |name: &str| question[name].as_str().unwrap_or_default();
        // A scene is opened first; every other request names an open one.
        if word("ask") == "open" {
            let scene = open_scene(number, question)?;
            // Another engine may have shown it already.
            let mut state = json!({});
            if question["shapes"] == true {
                state = scene.state(&Shapes::InView);
                state["sliders"] = scene.sliders();
            }
            self.scenes.insert(number, scene);
            return Ok(LiveAnswer::Text(state));
        }
        let scene = self.scenes.get_mut(&number);
        let scene =
            scene.ok_or_else(|| LiveError::Request(format!("scene {number} is not open")))?;
        let time = question["time"].as_f64().unwrap_or(0.0);
        // Requests that move the mechanism, then those for texts and pictures of it.
        let answer = match word("ask") {
            "move" => {
                let stopped = scene.move_to(word("name"), word("value"))?;
                LiveAnswer::Text(moved_state(scene, stopped.as_ref()))
            }
            "drive" => {
                let stopped = scene.drive(time, &named_numbers(&question["inputs"]))?;
                LiveAnswer::Text(moved_state(scene, stopped.as_ref()))
            }
            "pull" => {
                let stopped = scene.pull(time, &read_pull(question))?;
                LiveAnswer::Text(moved_state(scene, stopped.as_ref()))
            }
            "release" => {
                scene.hand = None;
                LiveAnswer::Text(moved_state(scene, None))
            }
            "assemble" => {
                let name = question["name"].as_str();
                scene.assemble(name.map(|name| (name, word("value"))))?;
                LiveAnswer::Text(moved_state(scene, None))
            }
            "choose" => {
                scene.choose(named_texts(&question["guess"]))?;
                LiveAnswer::Text(moved_state(scene, None))
            }
            "assemblies" => LiveAnswer::Text(scene.assemblies()?),
            "clearance" => LiveAnswer::Text(scene.clearance()?),
            "settle" => {
                let depth = question["depth"].as_u64().unwrap_or(2).clamp(1, 6) as usize;
                LiveAnswer::Text(scene.settled(depth)?)
            }
            "toml" => LiveAnswer::Text(json!({ "text": scene.text() })),
            "csv" => LiveAnswer::Bytes(scene.csv()),
            "picture" => LiveAnswer::Bytes(scene.picture(time, picture_size(question))?.into_raw()),
            "png" => LiveAnswer::Bytes(scene.png(time, picture_size(question))?),
            "gif" => LiveAnswer::Bytes(scene.gif(picture_size(question))?),
            other => return Err(LiveError::Request(format!("unknown request `{other}`"))),
        };
        Ok(answer)
    }
}

fn open_scene(number: usize, question: &Value) -> Result<LiveScene, LiveError> {
    let word = |name: &str| question[name].as_str().unwrap_or_default().to_owned();
    let source = Source {
        name: word("source"),
        text: word("text"),
    };
    let overrides = Overrides {
        parameters: named_texts(&question["parameters"]),
        guess: named_texts(&question["guess"]),
        ..Overrides::default()
    };
    LiveScene::open(
        number,
        source,
        overrides,
        LiveRequirements::read(&question["asked"]),
    )
}

/// The state after a move, and where the motion ended if it did not reach the target.
fn moved_state(scene: &mut LiveScene, stopped: Option<&FollowEnd>) -> Value {
    let changed = scene.reshaped();
    let mut state = scene.state(&Shapes::Changed(changed));
    if let Some(FollowEnd::Stopped { at, why }) = stopped {
        state["stopped"] = json!({ "at": at, "why": why });
    }
    state
}

/// `[[name, text], …]`
fn named_texts(value: &Value) -> Vec<(String, String)> {
    let list = value.as_array().into_iter().flatten();
    list.filter_map(|pair| Some((pair[0].as_str()?.to_owned(), pair[1].as_str()?.to_owned())))
        .collect()
}

/// `[[name, number], …]`
fn named_numbers(value: &Value) -> Vec<(String, f64)> {
    let list = value.as_array().into_iter().flatten();
    list.filter_map(|pair| Some((pair[0].as_str()?.to_owned(), pair[1].as_f64()?)))
        .collect()
}

fn read_pull(question: &Value) -> Pull {
    let number = |name: &str, k: usize| question[name][k].as_f64().unwrap_or(f64::NAN);
    let vector = |name: &str| DVec3::from_array([0, 1, 2].map(|k| number(name, k)));
    Pull {
        body: question["body"].as_u64().unwrap_or(u64::MAX) as usize,
        point: vector("point"),
        to: vector("to"),
        along: vector("along"),
    }
}

/// `[width, height]`, as `render` has it by default.
fn picture_size(question: &Value) -> [u32; 2] {
    let side = |k: usize, usual: u32| {
        let side = question["size"][k]
            .as_u64()
            .and_then(|n| u32::try_from(n).ok());
        side.unwrap_or(usual)
    };
    [side(0, 640), side(1, 480)]
}
