//! The initial data of a live page: the text of its scene and the replaced values.

use super::requirements::LiveRequirements;
use crate::diag::Source;
use crate::page::article::Article;
use crate::scene::Overrides;
use serde_json::json;

/// A scene as the program has read it.
pub struct LiveStart<'a> {
    /// Its text.
    pub source: &'a Source,
    /// Replaced values: parameters and start values only.
    pub overrides: &'a Overrides,
    /// The options for its motion.
    pub asked: LiveRequirements,
    /// Name of the files that a reader saves, without an ending.
    pub file: &'a str,
}

impl Article {
    /// Makes the article live, if there is a motion. Its bodies are then made by the engine from the text: the page
    /// does not store them twice.
    pub fn enliven(&mut self, start: &LiveStart) {
        if self.still.is_none() {
            return;
        }
        let model = self.data["model"].take();
        self.data["live"] = json!({
            "source": start.source.name, "text": start.source.text, "file": start.file,
            "parameters": start.overrides.parameters, "guess": start.overrides.guess,
            "asked": start.asked.json(), "view": model.is_object(),
        });
    }

    /// Whether its bodies can be shown in space, by the page or by its engine.
    pub(in crate::page) fn has_view(&self) -> bool {
        self.data["model"].is_object() || self.data["live"]["view"] == true
    }

    /// Whether it can be moved.
    pub(in crate::page) fn is_live(&self) -> bool {
        self.data["live"].is_object()
    }
}
