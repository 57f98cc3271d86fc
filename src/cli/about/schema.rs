//! `mechanim schema`: the keys of a scene, or of a list of golden pictures.

use crate::cli::args::SchemaArg;
use crate::cli::io;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::report::schema::keys_schema;
use crate::scene::keys::tables::SCENE;
use crate::snapshot::keys::LIST;
use std::path::Path;

/// Runs the verb.
pub fn print_schema(file: SchemaArg) -> Result<Outcome, Failure> {
    let document = match file {
        SchemaArg::Scene => keys_schema(&SCENE, "Scene of mechanim"),
        SchemaArg::Snapshots => keys_schema(&LIST, "List of golden pictures of mechanim"),
    };
    io::write_document(Path::new("-"), &document)?;
    Ok(Outcome::Done)
}
