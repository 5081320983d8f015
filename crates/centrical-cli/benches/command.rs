//! What a user waits for: the whole command, as a process.

use std::process::Command;

fn main() {
    divan::main();
}

/// `centrical calibrate` on the example session: 12 mountings, 108 plateaus, 5.4 MB of CSV.
#[divan::bench]
fn calibrate_the_example() {
    let example = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");
    let run = Command::new(env!("CARGO_BIN_EXE_centrical")).args(["calibrate", example, "--json"]).output();
    assert!(run.is_ok_and(|run| run.status.success()));
}
