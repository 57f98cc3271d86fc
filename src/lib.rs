//! Exact motion, proved clearances and pictures of spatial mechanisms, computed from their loop equations.
//!
//! A mechanism is described as in a textbook: products of elementary transforms form chains, closed loops equal the
//! identity, and inputs are driven over time. A [`Scene`] is read from such a description. Solving it gives a
//! [`Motion`], a sequence of poses that are closed to rounding, each with a [`Certificate`]. [`Scene::check`] proves
//! clearances between bodies over the whole motion. [`Motion::film`] draws the motion without a window or a display.
//!
//! ```
//! use mechanim::{Certificate, Samples, Scene};
//!
//! // A built-in scene; Scene::open reads a file, Scene::parse a text.
//! let scene = Scene::builtin("slider-crank")?.with_parameter("L", 120)?;
//! let motion = scene.solve(Samples::Even(36))?;
//! for pose in motion.poses() {
//!     let Certificate::Certified { error_bound, .. } = pose.certificate() else { continue };
//!     println!("{:.3} s: h = {:.12} mm, off by at most {error_bound:.0e}", pose.time(), pose.value("h")?);
//! }
//! // Do all loops close, and do all bodies keep their distance, proved for every instant?
//! println!("{}", scene.check(&Default::default())?.text());
//! // motion.film().write("slider-crank.gif")?;
//! # Ok::<(), mechanim::Error>(())
//! ```
//!
//! # Overview
//!
//! | to | use |
//! |---|---|
//! | read a scene, change its parameters, drives and start values | [`Scene`] |
//! | solve a motion at chosen times | [`Scene::solve`], [`Samples`] |
//! | read values, rates, placements and proofs | [`Motion`], [`Pose`], [`Certificate`] |
//! | check a design | [`Scene::check`], [`Check`], [`PairClearance`] |
//! | analyse the influence of dimensions, and optimise them | [`Scene::study`], [`Study`], [`study`] |
//! | draw it | [`Motion::film`], [`Film`] |
//! | list its assembly modes | [`Scene::assemblies`], [`Assembly`] |
//!
//! # Write a mechanism
//!
//! A scene is a TOML text. Undefined names are the unknowns; loops must equal the identity.
//!
//! ```
//! let text = r#"
//! duration = 4
//! [inputs]
//! phi = "2*pi*t/4"
//! [loops]
//! A = "Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)"
//! [guess]
//! h = 100
//! "#;
//! let scene = mechanim::Scene::parse("slider", text)?;
//! let motion = scene.solve(mechanim::Samples::At(vec![0.5]))?;
//! assert!((motion.values("h")?[0] - 103.117418982941).abs() < 1e-11);
//! # Ok::<(), mechanim::Error>(())
//! ```
//!
//! # Draw it
//!
//! A film renders on all cores without a display; the file name determines the format.
//!
//! ```no_run
//! let motion = mechanim::Scene::builtin("gearshift")?.solve(mechanim::Samples::Frames)?;
//! motion.film().size(640, 480).write("gearshift.gif")?;
//! # Ok::<(), mechanim::Error>(())
//! ```
//!
//! # Vary it
//!
//! A study analyses how the measures of a scene depend on its dimensions: derivatives, tolerances, optimal values.
//!
//! ```
//! let study = mechanim::Scene::builtin("gearshift")?.study().vary(&["L4", "L5d"]);
//! let slope = study.sensitivity()?.derivative("S_23", "L4")?;
//! assert!(slope.is_finite());
//! # Ok::<(), mechanim::Error>(())
//! ```
//!
//! # Units, errors, threads
//!
//! Lengths are in the scene's own unit, angles in radians or degrees as chosen in the scene, times in seconds. If a
//! scene has errors, the [`Error`] lists all of them with file, line, column and hints. A pose that does not exist is
//! not an error: see [`Motion::is_whole`]. Scenes and motions can be shared between threads, and results do not depend
//! on the number of threads.
//!
//! # Features
//!
//! `cli` builds the `mechanim` program, and `gpu` the wgpu renderer. Both are enabled by default; as a library the
//! crate needs neither (`default-features = false`), and the modules of the engine are then private. `cli` enables the
//! feature `engine`, which opens these modules to the program, its tests and benches. They are not documented here and
//! may change in any release. `docs/scene-format.md` describes the format of scenes.

// Code that only the program uses is unused in a library without features.
#![cfg_attr(not(feature = "engine"), allow(dead_code, unused_imports))]

mod api;

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use api::{
    Assembly, Check, CheckOptions, Error, ErrorKind, Film, Motion, PairClearance, Pose, Quantity,
    Samples, Scene, Study,
};
pub use kinematics::results::certificate::{Certificate, Reason};

/// Options and results of a [`Study`].
pub mod study {
    pub use crate::analysis::study::optimum::SearchMethod;
    pub use crate::analysis::tolerance::Distribution;
    pub use crate::api::{
        Enclosure, MeasureScatter, OptimiseOptions, Optimum, Sensitivity, Tolerance,
        ToleranceOptions,
    };
}

// The rooms of the engine: open to the program, private in a bare library.

#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod analysis;
#[cfg(not(feature = "engine"))]
mod analysis;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod charts;
#[cfg(not(feature = "engine"))]
mod charts;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod clearance;
#[cfg(not(feature = "engine"))]
mod clearance;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod compare;
#[cfg(not(feature = "engine"))]
mod compare;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod diag;
#[cfg(not(feature = "engine"))]
mod diag;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod diagram;
#[cfg(not(feature = "engine"))]
mod diagram;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod distance;
#[cfg(not(feature = "engine"))]
mod distance;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod export;
#[cfg(not(feature = "engine"))]
mod export;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod geometry;
#[cfg(not(feature = "engine"))]
mod geometry;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod import;
#[cfg(not(feature = "engine"))]
mod import;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod intervals;
#[cfg(not(feature = "engine"))]
mod intervals;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod jobs;
#[cfg(not(feature = "engine"))]
mod jobs;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod kinematics;
#[cfg(not(feature = "engine"))]
mod kinematics;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod limits;
#[cfg(not(feature = "engine"))]
mod limits;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod linalg;
#[cfg(not(feature = "engine"))]
mod linalg;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod math;
#[cfg(not(feature = "engine"))]
mod math;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod model;
#[cfg(not(feature = "engine"))]
mod model;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod numbers;
#[cfg(not(feature = "engine"))]
mod numbers;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod page;
#[cfg(not(feature = "engine"))]
mod page;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod parts;
#[cfg(not(feature = "engine"))]
mod parts;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod pictures;
#[cfg(not(feature = "engine"))]
mod pictures;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod plot;
#[cfg(not(feature = "engine"))]
mod plot;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod render;
#[cfg(not(feature = "engine"))]
mod render;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod report;
#[cfg(not(feature = "engine"))]
mod report;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod scene;
#[cfg(not(feature = "engine"))]
mod scene;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod snapshot;
#[cfg(not(feature = "engine"))]
mod snapshot;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod sorting;
#[cfg(not(feature = "engine"))]
mod sorting;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod staging;
#[cfg(not(feature = "engine"))]
mod staging;
#[cfg(feature = "engine")]
#[doc(hidden)]
pub mod sweep;
#[cfg(not(feature = "engine"))]
mod sweep;
mod weld;
