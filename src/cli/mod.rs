//! The command line: which verb runs, and its exit code. The only room that prints.

pub mod about;
pub mod args;
mod check;
pub mod dyads;
pub mod files;
pub mod interrupt;
pub mod io;
pub mod motion;
pub mod open;
pub mod pictures;
pub mod program;
mod report;
mod rerun;
pub mod study;
mod term;
pub mod watch;

use about::{completions, info, manual, scenes, schema};
use args::groups::grouped_command;
use args::{Cli, Command};
use clap::{CommandFactory, FromArgMatches};
use dyads::{intervals, row};
use files::{diff, encode, new_scene, snapshot};
use motion::{draw, modes, plot, render, show, solve};
use rerun::run_again;
use std::any::TypeId;
use std::ffi::OsString;
use std::path::PathBuf;
use study::{accuracy, enclose, optimise, sensitivity, sweep, synthesise, tolerance, units};
pub use term::outcome::{Failure, Outcome};
use term::{Term, outcome};

/// The exit code of `run`, also where it panics: a fault of the program has its own code. Unwinding has removed
/// unfinished files by then.
pub fn run_guarded(run: impl FnOnce() -> i32 + std::panic::UnwindSafe) -> i32 {
    std::panic::catch_unwind(run).unwrap_or(outcome::INTERNAL)
}

/// Runs the program with the given arguments (the first is its own name) and returns its exit code.
pub fn run(arguments: impl IntoIterator<Item = OsString>) -> i32 {
    let matches = command_line().try_get_matches_from(arguments);
    let cli = match matches.and_then(|found| Cli::from_arg_matches(&found)) {
        Ok(cli) => cli,
        Err(error) => return usage_error(&error),
    };
    let term = Term::new(cli.colour, cli.quiet);
    if let Err(failure) = watch::begin_watch(cli.limits) {
        term.failure(&failure);
        return failure.code();
    }
    let result = match cli.command {
        Command::Render(args) => run_again(args.watch, (&args.scene, &[]), &term, || {
            render::run_render(&args, &term)
        }),
        Command::Solve(args) => solve::run_solve(&args, &term),
        Command::Check(args) => run_again(args.watch, (&args.scene, &args.more), &term, || {
            check::run_check(&args, &term)
        }),
        Command::Report(args) => run_again(args.watch, (&args.scene, &args.more), &term, || {
            report::run_report(&args, &term)
        }),
        Command::Compare(args) => report::compare::run_compare(&args, &term),
        Command::Site(args) => report::site::run_site(&args, &term),
        Command::Modes(args) => modes::run_modes(&args, &term),
        Command::Plot(args) => run_again(args.watch, (&args.scene, &[]), &term, || {
            plot::run_plot(&args, &term)
        }),
        Command::Draw(args) => draw::run_draw(&args, &term),
        Command::Show(args) => show::run_show(&args, &term),
        Command::Accuracy(args) => accuracy::run_accuracy(&args, &term),
        Command::Encode(args) => encode::run_encode(&args, &term),
        Command::Diff(args) => diff::run_diff(&args, &term),
        Command::Snapshot(args) => snapshot::run_snapshot(&args, &term),
        Command::Sensitivity(args) => sensitivity::run_sensitivity(&args, &term),
        Command::Tolerance(args) => tolerance::run_tolerance(&args, &term),
        Command::Enclose(args) => enclose::run_enclose(&args, &term),
        Command::Dyads(args) => row::run_dyads(&args, &term),
        Command::Intervals(args) => intervals::run_intervals(&args, &term),
        Command::Optimise(args) => optimise::run_optimise(&args, &term),
        Command::Synthesise(args) => synthesise::run_synthesise(&args, &term),
        Command::Sweep(args) => sweep::run_sweep(&args, &term),
        Command::Study { command } => units::run_study(&command, &term),
        Command::New(args) => new_scene::run_new(&args, &term),
        Command::Scenes { name } => scenes::print_scenes(name.as_deref()),
        Command::Info { json } => info::print_info(json.as_deref()),
        Command::Completions { shell } => completions::print_completions(shell),
        Command::Schema { file } => schema::print_schema(file),
        Command::Manual { folder } => manual::write_manual(&folder),
    };
    match result {
        Ok(outcome) => outcome.code(),
        Err(failure) => {
            if !failure.is_broken_pipe() {
                term.failure(&failure);
            }
            failure.code()
        }
    }
}

/// The arguments, with [`values_with_signs`] in all verbs.
fn command_line() -> clap::Command {
    grouped_command(Cli::command()).mut_subcommands(values_with_signs)
}

/// A negative number behind an option is its value, so that the option can say what it takes; where an option takes one
/// value that is neither any text nor a path, so is all that begins with a sign: `-1x3`, `-1,2`.
fn values_with_signs(verb: clap::Command) -> clap::Command {
    let takes_values = |arg: clap::Arg| {
        let is_option = arg.get_long().is_some() && arg.get_action().takes_values();
        let kind = arg.get_value_parser().type_id();
        let takes_any = [
            TypeId::of::<String>(),
            TypeId::of::<PathBuf>(),
            TypeId::of::<OsString>(),
        ];
        let takes_one = arg
            .get_num_args()
            .is_none_or(|number| number.min_values() == 1 && number.max_values() == 1);
        let has_form = takes_one && takes_any.iter().all(|any| kind != *any);
        let has_signs = arg.is_allow_hyphen_values_set() || (is_option && has_form);
        arg.allow_negative_numbers(is_option)
            .allow_hyphen_values(has_signs)
    };
    verb.mut_args(takes_values)
        .mut_subcommands(values_with_signs)
}

/// Prints help, version or a usage error where it belongs.
fn usage_error(error: &clap::Error) -> i32 {
    let text = error.render().to_string();
    let printed = match crate::diag::shown_lines(&text) {
        std::borrow::Cow::Borrowed(_) => error.print(),
        std::borrow::Cow::Owned(shown) => {
            std::io::Write::write_all(&mut std::io::stderr(), shown.as_bytes())
        }
    };
    // A reader that went away is no reason to fail, a full disk is.
    let is_lost = printed.is_err_and(|e| e.kind() != std::io::ErrorKind::BrokenPipe);
    if error.use_stderr() || is_lost {
        outcome::BAD_USAGE
    } else {
        outcome::DONE
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;

    /// The other codes are tested from outside, in `tests/suite/verbs/cli.rs`; no known input leads to this one.
    #[test]
    fn a_fault_of_the_program_has_its_own_code() {
        assert_eq!(run_guarded(|| 4), 4);
        assert_eq!(run_guarded(|| panic!("a planted fault")), 70);
        assert_eq!(Failure::Internal("planted".to_owned()).code(), 70);
    }
}
