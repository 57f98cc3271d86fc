//! The argument table: names, help texts, ranges that need no scene. Nothing is done here.

pub mod board;
pub mod charts;
pub mod dyads;
pub mod enclose;
pub mod files;
pub mod groups;
pub mod motion;
pub mod report;
pub mod scene;
pub mod study;
pub mod sweep;
pub mod values;
pub mod view;

use crate::limits::Limits;
use board::{DrawArgs, ShowArgs};
use charts::{AccuracyArgs, PlotArgs};
use clap::{Parser, Subcommand, ValueEnum};
use dyads::{DyadsArgs, IntervalsArgs};
use enclose::EncloseArgs;
use files::{DiffArgs, EncodeArgs, NewArgs, SnapshotArgs};
use motion::{CheckArgs, ModesArgs, RenderArgs, SolveArgs};
use report::{CompareArgs, ReportArgs, SiteArgs};
use std::path::PathBuf;
use study::{OptimiseArgs, SensitivityArgs, SynthesiseArgs, ToleranceArgs};
use sweep::{StudyCommand, SweepArgs};
use values::ColourChoice;

/// Exact motion, checks and pictures of spatial mechanisms, from their equations, without a display.
#[derive(Debug, Parser)]
#[command(name = "mechanim", version, max_term_width = 100, after_help = EXIT_CODES)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
    /// When to colour messages; NO_COLOR is respected.
    #[arg(long, global = true, value_enum, default_value_t = ColourChoice::Auto)]
    pub color: ColourChoice,
    /// Limits of what the run may use, such as time=10s,memory=512M,samples=1M,pairs=10k,triangles=1M,pixels=8M,film=1G,message=64K;
    /// they can only tighten those of the variable MECHANIM_LIMITS.
    #[arg(long, global = true, value_name = "NAME=AMOUNT,…", value_parser = Limits::parse)]
    pub limits: Option<Limits>,
    /// Print errors only, no report and no warnings. What is asked for by name (a file, `-`, a list) is still written.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 a check failed or could not prove what it was asked to, or a motion was given up undecided; \
2 bad usage, bad scene, or a limit exceeded; 3 no usable graphics adapter; 4 the motion does not close all the way; 70 internal error; 130 interrupted.";

/// `mechanim schema`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum SchemaArg {
    Scene,
    Snapshots,
}

/// The verbs.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Draw the motion into an animation, a still, a sequence of frames or raw video; or write it as a 3-D model.
    Render(RenderArgs),
    /// Solve the motion and write every coordinate with its proof (CSV or JSON).
    Solve(SolveArgs),
    /// Check loop closure, proofs, measures and clearances over the whole motion, or judge a given pose.
    Check(CheckArgs),
    /// Write what is known of scenes as one HTML page: verdict, mechanism, motion in 3-D, curves, limits, clearances, proofs.
    Report(ReportArgs),
    /// Compare two versions of a scene on one HTML page: pictures, answers, curves, clearances.
    Compare(CompareArgs),
    /// Write a folder of pages with a front page, live where their engine is at hand.
    Site(SiteArgs),
    /// List the assemblies that close at given inputs, searched from many starts.
    Modes(ModesArgs),
    /// Plot outputs, coordinates and their derivatives against input or time (SVG or PNG).
    Plot(PlotArgs),
    /// Draw the kinematic diagram: links, signs of joints, dimensions, angles, loops (SVG, PDF or PNG).
    Draw(DrawArgs),
    /// Write the matrices of chains and loops, with symbols and as numbers (text, JSON, LaTeX or HTML).
    Show(ShowArgs),
    /// Measure time per pose against true error for many ways along the motion (table, JSON, CSV, chart).
    Accuracy(AccuracyArgs),
    /// Assemble PNG frames made elsewhere into an animation.
    Encode(EncodeArgs),
    /// Compare two pictures, two animations or two folders of pictures.
    Diff(DiffArgs),
    /// Draw a list of pictures and compare them with their golden files.
    Snapshot(SnapshotArgs),
    /// Derivatives of the study's measures by every dimension, ranked.
    Sensitivity(SensitivityArgs),
    /// Tolerance analysis of the study's measures: linear sums, random pieces and proved bounds.
    Tolerance(ToleranceArgs),
    /// Prove bands that the motion and its measures keep for all dimensions within their tolerances.
    Enclose(EncloseArgs),
    /// Take a planar linkage apart into dyads: their matrices, the table of the velocities, ranges of its coefficients.
    Dyads(DyadsArgs),
    /// Intervals for the directions of a linkage's bars: random trials, formal solutions, cubes, the exact set.
    Intervals(IntervalsArgs),
    /// Minimise the study's objective over its design variables.
    Optimise(OptimiseArgs),
    /// Search for dimensions from many starts, prove the best ones, and compare scenes of one task.
    Synthesise(SynthesiseArgs),
    /// Solve many designs of a scene, one row each: measures, values or checks over ranges of parameters (CSV, JSON lines, map).
    Sweep(SweepArgs),
    /// Cut a sweep into units that any number of machines do, stopped and resumed at will, and put together to the same bytes.
    Study {
        /// What to do with it.
        #[command(subcommand)]
        command: StudyCommand,
    },
    /// Write a scene of your own that begins as a built-in one, with a comment above every section.
    New(NewArgs),
    /// List the built-in scenes, or print one.
    Scenes {
        /// Name of the scene whose file is printed.
        name: Option<String>,
    },
    /// Versions, graphics adapters and drivers, for bug reports.
    Info {
        /// Write the report as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Print a completion script for a shell.
    Completions {
        /// bash, zsh, fish, elvish or powershell.
        shell: clap_complete::Shell,
    },
    /// Print the JSON Schema of a kind of file, with which editors complete and check it.
    Schema {
        /// Which file.
        #[arg(value_enum)]
        file: SchemaArg,
    },
    /// Write manual pages, one for every verb, into a folder.
    Manual {
        /// The folder, which must exist.
        folder: PathBuf,
    },
}
