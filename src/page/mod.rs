//! A report as one HTML file that works offline: it fetches nothing and runs only its own scripts, whose digests are in
//! its Content Security Policy. Takes values and returns text; solves only what the page shows in addition to a check.

mod article;
mod checked;
mod clearance;
mod comparison;
mod curves;
mod document;
mod engine;
mod frames;
pub mod live;
mod markup;
mod mechanism;
mod model;
mod packing;
mod quantities;
mod site;
mod still;
mod wasm_parts;

pub use article::{Article, article_of, article_without_motion};
pub use checked::CheckedMotion;
pub use comparison::{Version, comparison_text};
pub use document::page_text;
pub use engine::PackedEngine;
pub use site::{SiteEntry, site_text};
