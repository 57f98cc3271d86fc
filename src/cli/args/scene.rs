//! Which scene a verb is about.

use super::values::name_and_text;
use clap::Args;
use std::ffi::OsString;
use std::path::PathBuf;

/// Which scene, and what is changed in it.
#[derive(Clone, Debug, Args)]
pub struct SceneArgs {
    /// Name of a built-in scene, path of a scene file, or `-` for standard input.
    pub scene: OsString,
    /// Replace a parameter, NAME=FORMULA, or a chain, NAME="Tx(a) Rz(b)". May be repeated.
    #[arg(long = "param", value_name = "NAME=VALUE", value_parser = name_and_text)]
    pub parameters: Vec<(String, String)>,
    /// Replace the drive of an input: NAME=FORMULA, a number or a formula of `t`. May be repeated.
    #[arg(long = "input", value_name = "NAME=VALUE", value_parser = name_and_text)]
    pub inputs: Vec<(String, String)>,
    /// Replace the start value of an unknown, which chooses the assembly mode: NAME=VALUE. May be repeated.
    #[arg(long = "guess", value_name = "NAME=VALUE", value_parser = name_and_text)]
    pub guess: Vec<(String, String)>,
    /// Read the inputs from the rows of a CSV table (`-` for standard input) as spreadsheets write it, separated by `,`,
    /// `;` or tabs. Columns have the names of the inputs; a column `time` gives the instants, otherwise row k is at k
    /// seconds.
    #[arg(long = "input-table", alias = "inputs", value_name = "TABLE.csv")]
    pub table: Option<PathBuf>,
    /// Also allow files in or below this folder: mesh files, which otherwise must be in or below the scene's own folder.
    /// May be repeated.
    #[arg(long = "allow-files", value_name = "DIR")]
    pub allowed: Vec<PathBuf>,
    /// Start from assembly K in the list of `mechanim modes` at the start of the drive, or from the one with this branch
    /// signature (such as `+-`), instead of the start values.
    #[arg(long, value_name = "K", conflicts_with = "guess", value_parser = mode_choice, allow_hyphen_values = true)]
    pub mode: Option<ModeChoice>,
}

/// An assembly mode by its place in the table, or by its branch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ModeChoice {
    /// Counted from 1.
    Number(usize),
    /// A sign per block.
    Signature(String),
}

fn mode_choice(text: &str) -> Result<ModeChoice, String> {
    if !text.is_empty() && text.chars().all(|c| c == '+' || c == '-') {
        return Ok(ModeChoice::Signature(text.to_owned()));
    }
    match text.parse::<usize>() {
        Ok(number) if number > 0 => Ok(ModeChoice::Number(number)),
        _ => Err("a number of the table, counted from 1, or a signature such as `+-`".to_owned()),
    }
}
