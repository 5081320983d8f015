//! The program that the tests run.

use std::process::Command;

/// The built binary, on a terminal so wide that no sentence is folded.
pub fn centrical() -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_centrical"));
    command.env("COLUMNS", "1000");
    command
}
