//! `mechanim manual`: manual pages made from the argument table.

use crate::cli::args::Cli;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::export::{Output, Target};
use clap::{Command, CommandFactory};
use clap_mangen::Man;
use std::path::Path;

/// Runs the verb.
pub fn write_manual(folder: &Path) -> Result<Outcome, Failure> {
    let mut program = Cli::command();
    program.build();
    write_page(folder, &program, "mechanim")?;
    for verb in program.get_subcommands() {
        let name = format!("mechanim-{}", verb.get_name());
        write_page(folder, verb, &name)?;
    }
    Ok(Outcome::Done)
}

fn write_page(folder: &Path, command: &Command, name: &str) -> Result<(), Failure> {
    let mut page = Vec::new();
    Man::new(command.clone()).render(&mut page)?;
    let mut target = Box::new(Target::create(&folder.join(format!("{name}.1")))?);
    target.emit(&page)?;
    Ok(target.commit()?)
}
