//! `mechanim info`: the data needed in a bug report.

use crate::cli::io;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::render::open::list_adapters;
use serde_json::json;
use std::io::Write;
use std::path::Path;

/// Runs the verb.
pub fn print_info(json_file: Option<&Path>) -> Result<Outcome, Failure> {
    let adapters = list_adapters();
    let cores = crate::jobs::core_count();
    if let Some(path) = json_file {
        let adapters: Vec<_> = adapters
            .iter()
            .map(|a| json!({ "name": a.name, "driver": a.driver, "backend": a.backend, "type": a.device_type.to_string() }))
            .collect();
        let info = json!({
            "schema": "mechanim-info/1",
            "version": env!("CARGO_PKG_VERSION"),
            "system": std::env::consts::OS,
            "architecture": std::env::consts::ARCH,
            "cores": cores,
            "gpu_renderer": cfg!(feature = "gpu"),
            "adapters": adapters,
        });
        io::write_document(path, &info)?;
    } else {
        let mut out = std::io::stdout().lock();
        writeln!(out, "mechanim {}", env!("CARGO_PKG_VERSION"))?;
        writeln!(
            out,
            "system    {} {}, {cores} cores",
            std::env::consts::OS,
            std::env::consts::ARCH
        )?;
        writeln!(
            out,
            "renderers cpu{}",
            if cfg!(feature = "gpu") {
                ", gpu"
            } else {
                " (built without gpu)"
            }
        )?;
        for adapter in &adapters {
            writeln!(
                out,
                "adapter   {} | {} | {} | {}",
                adapter.name, adapter.device_type, adapter.backend, adapter.driver
            )?;
        }
        if adapters.is_empty() {
            writeln!(out, "adapter   none (the cpu renderer needs none)")?;
        }
        out.flush()?;
    }
    Ok(Outcome::Done)
}
