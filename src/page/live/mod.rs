//! The requests of a live page while its reader moves sliders and edits the text: a scene that is changed and followed
//! from its present pose, with requests and answers as JSON. Compiled to WebAssembly by `bindings/web`, but independent
//! of browsers.

mod answers;
mod assemblies;
mod films;
mod following;
mod hand;
mod pulling;
mod requirements;
mod scenes;
mod session;
mod sliders;
mod start;

pub use crate::page::engine::STAMP;
pub use requirements::LiveRequirements;
pub use scenes::PageScenes;
pub use start::LiveStart;
