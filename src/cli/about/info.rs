//! `mechanim info`: what a bug report needs to say.

use crate::cli::term::outcome::{Failure, Outcome};
use crate::render::open::list_adapters;
use serde_json::json;
use std::io::Write;

/// Runs the verb.
pub fn print_info(as_json: bool) -> Result<Outcome, Failure> {
    let adapters = list_adapters();
    let cores = crate::jobs::core_count();
    let mut out = std::io::stdout().lock();
    if as_json {
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
        writeln!(out, "{info:#}")?;
    } else {
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
    }
    out.flush()?;
    Ok(Outcome::Done)
}
