//! The verbs that tell about the program: scenes, info, completions.

pub mod completions;
pub mod info;
pub mod manual;
pub mod scenes;
pub mod schema;
