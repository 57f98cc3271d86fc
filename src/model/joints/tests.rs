//! Joints of small scenes.
#![allow(clippy::unwrap_used, clippy::panic)]
