//! Many designs: rows, units of a study, and what is left of runs that were stopped or killed.

mod abreast;
mod bad_designs;
mod kills;
mod pieces;
mod rows;
mod submits;
mod units;

use crate::program::{Run, Workspace};

/// A sweep of 448 rows over two parameters, which takes about a tenth of a second.
pub const SWEEP: &str =
    "four-bar --design grid:crank=20..50:16,ex=0..90:28 --outputs K.x,K.y --samples 12";

/// Runs a line of words.
pub fn run(space: &Workspace, line: &str) -> Run {
    space.run(&words(line))
}

pub fn words(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// The cells of a CSV table, row by row, the header first.
pub fn cells(bytes: &[u8]) -> Vec<Vec<String>> {
    let text = std::str::from_utf8(bytes).unwrap();
    let row = |line: &str| line.split(',').map(str::to_owned).collect();
    text.lines().map(row).collect()
}

/// The column called `name`.
pub fn column(table: &[Vec<String>], name: &str) -> Vec<String> {
    let place = table[0].iter().position(|head| head == name).expect(name);
    table[1..].iter().map(|row| row[place].clone()).collect()
}
