//! The plan of a study: the work, the number of items, and their division.

use super::error::PartsError;
use serde_json::{Value, json};
use std::ops::Range;
use std::path::Path;

/// Version of the plan's document.
const SCHEMA: &str = "mechanim-study/1";

/// The program that writes and reads parts. Numbers of different versions are never mixed.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Maximum number of units: each is a file.
pub const MOST_UNITS: u64 = 100_000;

/// Content of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PartContent {
    /// The numbers of every item.
    Items,
    /// The combined numbers of all its items, whose meaning is defined elsewhere.
    Sums,
}

impl PartContent {
    const WORDS: [(Self, &'static str); 2] = [(Self::Items, "items"), (Self::Sums, "sums")];

    fn word(self) -> &'static str {
        let known = Self::WORDS.iter().find(|(keeps, _)| *keeps == self);
        known.map_or("", |(_, word)| word)
    }
}

/// The plan of a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StudyPlan {
    /// The verb.
    pub verb: String,
    /// Its arguments without the scene, which are parsed again when a unit is run.
    pub arguments: Vec<String>,
    /// Name of the scene in messages; its text lies beside the plan.
    pub scene: String,
    /// The folder of the scene's meshes.
    pub meshes: String,
    /// Digest of all that the numbers depend on.
    pub identity: String,
    /// The program that planned it.
    pub version: String,
    /// Number of items.
    pub items: u64,
    /// Items of a unit; the last one may have fewer.
    pub unit: u64,
    /// Content of its parts.
    pub keeps: PartContent,
    /// Numbers of an item, or of a part that keeps sums.
    pub width: u64,
}

impl StudyPlan {
    /// Number of units.
    pub fn units(&self) -> u64 {
        self.items.div_ceil(self.unit)
    }

    /// The items of unit `index`.
    pub fn items_of(&self, index: u64) -> Range<u64> {
        let first = index * self.unit;
        first..self.items.min(first + self.unit)
    }

    /// Numbers of a part with this many items.
    pub fn numbers(&self, items: u64) -> u64 {
        match self.keeps {
            PartContent::Items => items * self.width,
            PartContent::Sums => self.width,
        }
    }

    /// The document stored in the folder.
    pub fn document(&self) -> Value {
        json!({
            "schema": SCHEMA,
            "verb": self.verb,
            "scene": self.scene,
            "meshes": self.meshes,
            "arguments": self.arguments,
            "identity": self.identity,
            "version": self.version,
            "items": self.items,
            "items_of_a_unit": self.unit,
            "units": self.units(),
            "keeps": self.keeps.word(),
            "numbers": self.width,
        })
    }

    /// Reads this document.
    pub(super) fn read(path: &Path, text: &str) -> Result<Self, PartsError> {
        let bad = |why: String| PartsError::BadPlan {
            path: path.to_owned(),
            why,
        };
        let document: Value = serde_json::from_str(text).map_err(|e| bad(e.to_string()))?;
        if document["schema"] != SCHEMA {
            return Err(bad(format!("is not a plan of the kind {SCHEMA}")));
        }
        let word = |name: &str| {
            let value = document[name].as_str().map(str::to_owned);
            value.ok_or_else(|| bad(format!("`{name}` is not a text")))
        };
        let number = |name: &str| {
            let value = document[name].as_u64().filter(|n| *n > 0);
            value.ok_or_else(|| bad(format!("`{name}` is not a positive whole number")))
        };
        let arguments = document["arguments"].as_array().into_iter().flatten();
        let arguments = arguments.map(|a| a.as_str().map(str::to_owned));
        let plan = Self {
            verb: word("verb")?,
            arguments: arguments
                .collect::<Option<_>>()
                .ok_or_else(|| bad("`arguments` are not texts".to_owned()))?,
            scene: word("scene")?,
            meshes: word("meshes")?,
            identity: word("identity")?,
            version: word("version")?,
            items: number("items")?,
            unit: number("items_of_a_unit")?,
            keeps: kept_items(&document)
                .ok_or_else(|| bad("`keeps` is not a known word".to_owned()))?,
            width: number("numbers")?,
        };
        let bytes = plan.items.checked_mul(plan.width);
        if bytes.and_then(|numbers| numbers.checked_mul(8)).is_none() || plan.units() > MOST_UNITS {
            let why = format!("has more than {MOST_UNITS} units, or numbers without end");
            return Err(bad(why));
        }
        if plan.version != VERSION {
            return Err(PartsError::Foreign {
                path: path.to_owned(),
                why: format!(
                    "planned by version {} of the program, this is {VERSION}: numbers of two versions are not mixed",
                    plan.version
                ),
            });
        }
        Ok(plan)
    }
}

fn kept_items(document: &Value) -> Option<PartContent> {
    let word = document["keeps"].as_str()?;
    let known = PartContent::WORDS.iter().find(|(_, other)| *other == word);
    known.map(|(keeps, _)| *keeps)
}
