//! Exact motion, collision reports and pictures of spatial mechanisms, from their equations.
//!
//! A mechanism is written the way a lecture writes it: elementary transforms multiplied into chains, loops that must equal
//! the identity, inputs driven over time. A [`Scene`] is read from such a text. Solving it gives a [`Motion`]: poses that are
//! closed to rounding, each with its [`Certificate`]. A scene can be checked ([`Scene::check`]), which proves clearances
//! between bodies over the whole motion, and a motion can be drawn ([`Motion::film`]) without a window or a display.
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
//! | to | use |
//! |---|---|
//! | read a scene, change its parameters, drives and start values | [`Scene`] |
//! | solve a motion at chosen times | [`Scene::solve`], [`Samples`] |
//! | read values, rates, placements and proofs | [`Motion`], [`Pose`], [`Certificate`] |
//! | check a design | [`Scene::check`], [`Check`], [`PairClearance`] |
//! | ask what its dimensions do to its measures, and for better ones | [`Scene::study`], [`Study`] |
//! | draw it | [`Motion::film`], [`Film`] |
//! | list its assemblies | [`Scene::assemblies`], [`Assembly`] |
//!
//! The format of scenes is described in `docs/scene-format.md`. The `mechanim` program is built with the feature `cli`,
//! which is on by default; a library needs none of it: `default-features = false`. The modules of the engine are reachable
//! for the program, tests and benches, are not documented here, and may change in any release.

mod api;

/// The examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub use analysis::study::optimum::SearchMethod;
pub use analysis::tolerance::Distribution;
pub use api::{
    Assembly, Check, CheckOptions, Error, ErrorKind, Film, FilmFile, MeasureScatter, Motion,
    OptimiseOptions, Optimum, PairClearance, Placement, Pose, Quantity, Samples, Scene,
    Sensitivity, Study, Tolerance, ToleranceOptions,
};
pub use kinematics::results::certificate::{Certificate, Reason};

#[doc(hidden)]
pub mod analysis;
#[doc(hidden)]
pub mod charts;
#[doc(hidden)]
pub mod clearance;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[doc(hidden)]
pub mod compare;
#[doc(hidden)]
pub mod diag;
#[doc(hidden)]
pub mod diagram;
#[doc(hidden)]
pub mod distance;
#[doc(hidden)]
pub mod export;
#[doc(hidden)]
pub mod geometry;
#[doc(hidden)]
pub mod import;
#[doc(hidden)]
pub mod intervals;
#[doc(hidden)]
pub mod jobs;
#[doc(hidden)]
pub mod kinematics;
#[doc(hidden)]
pub mod limits;
#[doc(hidden)]
pub mod linalg;
#[doc(hidden)]
pub mod math;
#[doc(hidden)]
pub mod model;
#[doc(hidden)]
pub mod numbers;
#[doc(hidden)]
pub mod page;
#[doc(hidden)]
pub mod parts;
#[doc(hidden)]
pub mod pictures;
#[doc(hidden)]
pub mod plot;
#[doc(hidden)]
pub mod render;
#[doc(hidden)]
pub mod report;
#[doc(hidden)]
pub mod scene;
#[doc(hidden)]
pub mod snapshot;
#[doc(hidden)]
pub mod staging;
#[doc(hidden)]
pub mod sweep;
