//! The program as a stranger meets it: commands, messages, documents, hostile files.

mod bad_scenes;
mod cli;
mod document_commands;
mod documents;
mod face;
mod mutations;
mod replaced_files;
mod report_schema;
mod schema;
mod strangers;
mod verdicts;
