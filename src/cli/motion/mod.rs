//! The verbs on the motion of one scene: solve, render, plot, draw, show, modes.

pub mod certify;
pub mod draw;
pub mod event_messages;
pub mod models;
pub mod modes;
pub mod plot;
pub mod poster;
pub mod render;
pub mod show;
pub mod solve;
