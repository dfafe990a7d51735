//! A verb of `gaiter`, run to its end, and what it said.

#![allow(clippy::unwrap_used)]

use std::env;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// The program: the one that `GAITER_BIN` names, or the one that was built with the tests.
pub fn program() -> PathBuf {
    env::var_os("GAITER_BIN").map_or_else(built_beside, PathBuf::from)
}

/// Cargo puts tests, benches and examples into folders beside the programs of their package.
fn built_beside() -> PathBuf {
    let test = env::current_exe().unwrap();
    test.ancestors().nth(2).unwrap().join("gaiter")
}

/// Runs a verb; it is told nothing.
pub fn gaiter(args: &[&str]) -> Output {
    Command::new(program()).args(args).stdin(Stdio::null()).output().unwrap()
}

/// Runs a verb with a configuration and a line on standard input.
pub fn gaiter_told(config: &Path, args: &[&str], line: &str) -> Output {
    let mut command = Command::new(program());
    command.args(args).arg("--config").arg(config).stdin(Stdio::piped());
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    // A verb that refuses its arguments ends without reading.
    let _ = child.stdin.take().unwrap().write_all(line.as_bytes());
    child.wait_with_output().unwrap()
}

/// Its exit code; none where a signal ended it.
pub fn code(output: &Output) -> Option<i32> {
    output.status.code()
}

/// What it said on standard output.
pub fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// What it said on standard error.
pub fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}
