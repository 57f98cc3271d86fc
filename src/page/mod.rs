//! A report as one HTML file that opens from a disk: nothing is fetched, and nothing runs but the file's own script, whose
//! digest its policy names. Values in, text out; nothing is solved but what the page shows beside a check.

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
mod quantities;
mod site;
mod still;

pub use article::{Article, article_of, article_without_motion};
pub use checked::Checked;
pub use comparison::{Version, comparison_text};
pub use document::page_text;
pub use engine::PackedEngine;
pub use site::{Entry, site_text};
