//! The `gaiter` binary: everything it does is a verb in [`gaiter::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    gaiter::cli::main()
}
