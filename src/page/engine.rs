//! The engine of a live page: a file built from `bindings/web`, encoded as text.

use super::packing::packed_text;
use super::wasm_parts::sorted_parts;

/// A mark in the engine's file by which the program recognises a file of its own version.
pub const STAMP: &str = concat!("mechanim-web ", env!("CARGO_PKG_VERSION"), "\n");

/// The first bytes of every WebAssembly file.
const MAGIC: &[u8] = b"\0asm";

/// An engine, encoded for a page.
#[derive(Clone, Debug)]
pub struct PackedEngine {
    pub(super) text: String,
}

impl PackedEngine {
    /// From the contents of a file.
    ///
    /// Errors, as text: not WebAssembly, or not the engine of this version.
    pub fn new(wasm: &[u8]) -> Result<Self, String> {
        if !wasm.starts_with(MAGIC) {
            return Err("it is not WebAssembly".to_owned());
        }
        let stamp = STAMP.as_bytes();
        if !wasm.windows(stamp.len()).any(|part| part == stamp) {
            return Err(format!("it is not the engine `{}`", STAMP.trim_end()));
        }
        let sorted = sorted_parts(wasm);
        let bytes = sorted.as_deref().unwrap_or(wasm);
        let text = packed_text(bytes).map_err(|error| error.to_string())?;
        Ok(Self { text })
    }
}
