//! Pictures of a solved scene, put together from views, captions and plots.

pub mod frames;
pub mod playback;
pub mod texts;
