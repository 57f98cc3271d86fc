//! A report as one HTML file that opens from a disk: nothing is fetched, and nothing runs but the file's own script, whose
//! digest its policy names. Values in, text out; nothing is solved but what the page shows beside a check.

mod article;
mod checked;
mod clearance;
mod curves;
mod document;
mod frames;
mod markup;
mod mechanism;
mod model;
mod still;

pub use article::{Article, article_of, article_without_motion};
pub use checked::Checked;
pub use document::page_text;
