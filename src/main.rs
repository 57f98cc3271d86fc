//! The `mechanim` program.

fn main() {
    std::process::exit(mechanim::cli::program::main(std::env::args_os()));
}
