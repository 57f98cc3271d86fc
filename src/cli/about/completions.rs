//! `mechanim completions`: a completion script made from the argument table.

use crate::cli::args::Cli;
use crate::cli::term::outcome::{Failure, Outcome};
use clap::CommandFactory;
use clap_complete::{Shell, generate};
use std::io::Write;

/// Runs the verb.
pub fn print_completions(shell: Shell) -> Result<Outcome, Failure> {
    // Into memory first: the generator panics where a write fails, and a broken pipe should not.
    let mut script = Vec::new();
    generate(shell, &mut Cli::command(), "mechanim", &mut script);
    let mut out = std::io::stdout().lock();
    out.write_all(&script)?;
    out.flush()?;
    Ok(Outcome::Done)
}
