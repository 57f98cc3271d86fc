//! `mechanim manual`: manual pages made from the argument table.

use crate::cli::args::Cli;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::{Output, PendingFile};
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use std::path::Path;

/// Runs the verb.
pub fn write_manual(folder: &Path) -> Result<Outcome, Failure> {
    // The verb `help` shows these pages; it has none of its own.
    let mut program = without_help(Cli::command());
    program.build();
    write_pages(folder, &program, "mechanim")?;
    Ok(Outcome::Done)
}

fn without_help(command: Command) -> Command {
    command
        .disable_help_subcommand(true)
        .mut_subcommands(without_help)
}

/// The page of a verb and those of its subcommands.
fn write_pages(folder: &Path, command: &Command, name: &str) -> Result<(), Failure> {
    write_page(folder, command, name)?;
    let mut verbs = command.get_subcommands();
    verbs.try_for_each(|verb| write_pages(folder, verb, &format!("{name}-{}", verb.get_name())))
}

fn write_page(folder: &Path, command: &Command, name: &str) -> Result<(), Failure> {
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page)?;
    let mut target = Box::new(PendingFile::create(&folder.join(format!("{name}.1")))?);
    target.emit(&page)?;
    Ok(target.commit()?)
}
