//! The program as a stranger meets it: commands, messages, hostile files.

mod apngs;
mod bad_scenes;
mod bombs;
mod cli;
mod compared_pages;
mod dyad_verbs;
mod face;
mod interlaced;
mod json_schema;
mod large_texts;
mod live_pages;
mod many_scenes;
#[cfg(target_os = "linux")]
mod memory;
mod mutations;
mod replaced_files;
mod report_pages;
mod report_schema;
mod schema;
mod strangers;
mod third_party;
mod verdicts;
