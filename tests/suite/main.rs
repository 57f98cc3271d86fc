//! All tests from outside in one program, so that one build serves them. `cargo test --release --test suite gate::` runs
//! one file of them. What changes or counts something of the whole process stands apart: `tests/allocations.rs`, and
//! `tests/gpu_parity.rs`, which needs a graphics adapter.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

// What the tests share.
mod dense;
mod draws;
mod driven;
mod frames;
mod judge;
mod nets;
mod program;
mod reference;
mod slow_distance;
mod snapshot;
mod solids;

// The tests.
mod classical;
mod clearance;
mod documents;
mod house;
mod motion;
mod pictures;
mod proofs;
mod structure;
mod study;
mod sweep;
mod verbs;
