//! Commands where the system gives few threads, or none beside the first, as in a container.
//!
//! A thread that asks for a stack of 1 GiB (`RUST_MIN_STACK`) comes into being only where the address space has room
//! for it (`ulimit -v`): the limit on threads itself (`ulimit -u`) does not hold root, and counts what other tests run.

use std::fs;
use std::process::Command;

use tempfile::TempDir;

use crate::session::example;

/// Stack of a thread [KiB].
const STACK: usize = 1 << 20;

#[test]
fn a_series_makes_do_with_few_threads() {
    let session = example().display().to_string();
    let folder = TempDir::new().unwrap();
    for threads in [1, 2, 3, 5, 8] {
        // The program takes less than half a stack.
        let limit = threads * STACK - STACK / 2;
        let script = format!("ulimit -v {limit}; exec \"$0\" \"$@\"");
        let out = format!("series-{threads}");
        let mut command = Command::new("sh");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_centrical"), "series", &session, "--out", &out, "-q"]);
        command.env("RUST_MIN_STACK", (STACK << 10).to_string());
        let run = command.current_dir(folder.path()).output().unwrap();
        assert!(run.status.success(), "{threads}: {}", String::from_utf8_lossy(&run.stderr));
        let table = fs::read(folder.path().join(&out).join("series.csv")).unwrap();
        assert!(table == fs::read(folder.path().join("series-1/series.csv")).unwrap(), "{threads}");
    }
}
