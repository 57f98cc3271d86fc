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
mod section;
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
    #[arg(long, alias = "color", global = true, value_enum, default_value_t = ColourChoice::Auto)]
    pub colour: ColourChoice,
    /// Limits on what the run may use, such as time=10s,memory=512M,samples=1M,pairs=10k,triangles=1M,pixels=8M,poster=200M,film=1G,message=64K;
    /// they can only be tighter than those of the variable MECHANIM_LIMITS.
    #[arg(long, global = true, value_name = "NAME=AMOUNT,…", value_parser = Limits::parse)]
    pub limits: Option<Limits>,
    /// Print errors only, no report and no warnings. Requested files and lists are still written.
    #[arg(long, short, global = true)]
    pub quiet: bool,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 a check failed or could not prove what it was asked to, or it is undecided whether a pose exists; \
2 bad usage, bad scene, or a limit exceeded; 3 no usable graphics adapter; 4 the motion does not reach its end; 70 internal error; 130 interrupted.";

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
    /// Check closure, proofs, measures and clearances (over the whole motion, or of one given pose).
    Check(CheckArgs),
    /// Write all results of scenes as one HTML page: verdict, mechanism, motion in 3-D, curves, limits, clearances, proofs.
    Report(ReportArgs),
    /// Compare two versions of a scene on one HTML page: pictures, answers, curves, clearances.
    Compare(CompareArgs),
    /// Write a folder of HTML pages with a front page, live ones where the engine is available.
    Site(SiteArgs),
    /// List the assemblies that close at the same inputs, searched from many starts.
    Modes(ModesArgs),
    /// Plot outputs, coordinates and their derivatives against input or time (SVG, PDF or PNG).
    Plot(PlotArgs),
    /// Draw the kinematic diagram: links, joint symbols, dimensions, angles, loops (SVG, PDF or PNG).
    Draw(DrawArgs),
    /// Write the matrices of chains and loops, symbolic and numeric (text, JSON, LaTeX or HTML).
    Show(ShowArgs),
    /// Measure time per pose against true error for several solvers (table, JSON, CSV, chart).
    Accuracy(AccuracyArgs),
    /// Assemble PNG frames into an animation.
    Encode(EncodeArgs),
    /// Compare two pictures, two animations or two folders of pictures.
    Diff(DiffArgs),
    /// Draw a list of pictures and compare them with their golden files.
    Snapshot(SnapshotArgs),
    /// Rank the dimensions by the derivatives of the study's measures.
    Sensitivity(SensitivityArgs),
    /// Tolerance analysis of the study's measures: linear sums, random pieces and proved bounds.
    Tolerance(ToleranceArgs),
    /// Prove bands of motion and measures for all dimensions within tolerance.
    Enclose(EncloseArgs),
    /// Decompose a planar linkage into dyads: matrices, velocity table, ranges of its coefficients.
    Dyads(DyadsArgs),
    /// Solve a linkage's velocity equations in intervals: random trials, formal solutions, cubes, the exact set.
    Intervals(IntervalsArgs),
    /// Minimise the study's objective over its design variables.
    Optimise(OptimiseArgs),
    /// Search for dimensions from many starts, prove the best ones, and compare scenes of one task.
    Synthesise(SynthesiseArgs),
    /// Solve many designs of a scene, one row each: measures, values or checks over ranges of parameters (CSV, JSON lines, map).
    Sweep(SweepArgs),
    /// Share a sweep or tolerance study among machines: units that can be stopped and resumed, and merge to the same bytes.
    Study {
        /// What to do with it.
        #[command(subcommand)]
        command: StudyCommand,
    },
    /// Start a scene of your own from a built-in one, with a comment above every section.
    New(NewArgs),
    /// List the built-in scenes, or print one.
    Scenes {
        /// Name of the scene whose file is printed.
        name: Option<String>,
    },
    /// Print versions, graphics adapters and drivers for bug reports.
    Info {
        /// Write the report as JSON to this file (`-` for standard output).
        #[arg(long, value_name = "FILE")]
        json: Option<PathBuf>,
    },
    /// Print a completion script for a shell.
    Completions {
        /// bash, zsh, fish, elvish or powershell.
        shell: clap_complete::Shell,
    },
    /// Print the JSON Schema with which editors complete and check a file.
    Schema {
        /// Which file.
        #[arg(value_enum)]
        file: SchemaArg,
    },
    /// Write manual pages, one for each verb, into a folder.
    Manual {
        /// An existing folder.
        folder: PathBuf,
    },
}
