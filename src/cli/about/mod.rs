//! The verbs about the program itself: scenes, info, completions.

pub mod completions;
pub mod info;
pub mod manual;
pub mod scenes;
pub mod schema;
