//! Milliseconds of what a live page asks of its engine: a move of a slider, and the article once it rests.
//!
//! `cargo bench --bench live [-- SCENE…]`. The same engine, compiled to WebAssembly, runs in the reader's browser.

use mechanim::page::live::PageScenes;
use mechanim::scene::builtin;
use serde_json::{Value, json};
use std::time::Instant;

/// Moves of a slider, to and fro.
const MOVES: usize = 60;

/// How far a slider is moved, as a share of its value.
const REACH: f64 = 0.004;

/// Scenes that pages are judged by.
const SCENES: [&str; 5] = [
    "gearshift",
    "torus-torus",
    "sphere-torus",
    "twin-steer",
    "seven-r",
];

/// The milliseconds of a question, and its answer.
fn asked(scenes: &mut PageScenes, question: &Value) -> (f64, Vec<u8>) {
    let text = question.to_string();
    let begun = Instant::now();
    let answer = scenes.answer(&text);
    (begun.elapsed().as_secs_f64() * 1e3, answer)
}

fn measure(name: &str) -> Option<()> {
    let source = builtin::find_builtin(name)?;
    let mut scenes = PageScenes::default();
    let open = json!({ "ask": "open", "text": source.text, "source": source.name, "shapes": true });
    let (opened, answer) = asked(&mut scenes, &open);
    let state: Value = serde_json::from_slice(&answer).ok()?;
    let slider = state["sliders"]["dimensions"].get(0)?;
    let (slider, at) = (slider["name"].as_str()?, slider["value"].as_f64()?);
    let mut taken: Vec<f64> = Vec::with_capacity(MOVES);
    let mut longest = 0;
    for k in 0..MOVES {
        let value = at * (1.0 + REACH * (k as f64 / 7.0).sin());
        let question = json!({ "ask": "move", "name": slider, "value": value.to_string() });
        let (milliseconds, answer) = asked(&mut scenes, &question);
        taken.push(milliseconds);
        longest = longest.max(answer.len());
    }
    taken.sort_by(f64::total_cmp);
    // The clearances and the curves, once nothing moves.
    let (settled, _) = asked(&mut scenes, &json!({ "ask": "settle" }));
    println!(
        "{name:14} {slider:8} {opened:7.1} {:7.1} {settled:8.1} {longest:9}",
        taken[MOVES / 2]
    );
    Some(())
}

fn report(name: &str) {
    if measure(name).is_none() {
        println!("{name}: no scene with a slider");
    }
}

fn main() {
    let names: Vec<String> = std::env::args()
        .skip(1)
        .filter(|a| !a.starts_with('-'))
        .collect();
    println!("scene          slider   open ms  move ms  rest ms  bytes of a move");
    match names.is_empty() {
        true => SCENES.iter().for_each(|name| report(name)),
        false => names.iter().for_each(|name| report(name)),
    }
}
