//! The built-in renderer: no driver, no window, the same bytes on every machine.
