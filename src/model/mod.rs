//! The mechanism as resolved: immutable, without names to look up or units to convert.

pub mod actuation;
pub mod camera_path;
pub mod carried;
pub mod chain;
pub mod clearance;
pub mod dimension;
pub mod distance;
pub mod drive;
pub mod expression;
pub mod fixed;
pub mod function;
pub mod joints;
pub mod measure;
pub mod mechanism;
pub mod notation;
pub mod outputs;
pub mod palette;
pub mod pattern;
pub mod plot;
pub mod printed;
pub mod shape;
pub mod study;
pub mod theme;
pub mod view;
pub mod view_change;
pub mod walk;
