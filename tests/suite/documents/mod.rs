//! The documents against the program: every command in them is taken and run, what is printed below a command is what it
//! prints, every option is listed with one meaning, links lead somewhere.

mod commands;
mod content;
mod figures;
mod fixtures;
mod key_tables;
mod options;
mod outputs;
mod runs;
mod sources_page;
mod spelling;
mod tables;
mod text;
