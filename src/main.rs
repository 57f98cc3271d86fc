//! The `mechanim` program: parse, dispatch, exit code.

fn main() {}
