//! A buffer between an encoder, which owns its writer, and the output, whose errors are the sink's.

use std::io::{self, Write};
use std::sync::{Arc, Mutex, PoisonError};

/// Shared by an encoder and the sink that passes its bytes on.
#[derive(Clone, Default)]
pub(super) struct Spool(Arc<Mutex<Vec<u8>>>);

impl Spool {
    /// What the encoder has written since the last call.
    pub(super) fn take(&self) -> Vec<u8> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// Keeps the memory of `bytes` for what comes next.
    pub(super) fn give_back(&self, mut bytes: Vec<u8>) {
        bytes.clear();
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = bytes;
    }
}

impl Write for Spool {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let mut spool = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        spool.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}
