//! Commands where the system gives few threads, or none beside the first, as in a container.

use std::fs;
use std::os::unix::fs::{MetadataExt, PermissionsExt};
use std::os::unix::process::CommandExt;
use std::process::Command;

use tempfile::TempDir;

use crate::session::example;

/// A user who is not root, whom no limit holds.
const NOBODY: u32 = 65_534;

/// Threads that a user has now.
fn threads_of(user: u32) -> usize {
    let processes = fs::read_dir("/proc").into_iter().flatten().flatten();
    let own = processes.filter(|process| process.metadata().is_ok_and(|metadata| metadata.uid() == user));
    own.map(|process| fs::read_dir(process.path().join("task")).map_or(0, Iterator::count)).sum()
}

#[test]
fn a_series_makes_do_with_few_threads() {
    let session = example().display().to_string();
    let folder = TempDir::new().unwrap();
    fs::set_permissions(folder.path(), fs::Permissions::from_mode(0o777)).unwrap();
    let own = folder.path().metadata().unwrap().uid();
    let user = if own == 0 { NOBODY } else { own };
    for threads in [1, 2, 4, 6, 8] {
        let limit = threads_of(user) + threads;
        let script = format!("umask 0; ulimit -u {limit}; exec \"$0\" \"$@\"");
        let out = format!("series-{threads}");
        // `sh` may know no limit on threads.
        let mut command = Command::new("bash");
        command.args(["-c", &script, env!("CARGO_BIN_EXE_centrical"), "series", &session, "--out", &out, "-q"]);
        if own == 0 {
            command.uid(user).gid(user);
        }
        let run = command.current_dir(folder.path()).output().unwrap();
        assert!(run.status.success(), "{threads}: {}", String::from_utf8_lossy(&run.stderr));
        let table = fs::read(folder.path().join(&out).join("series.csv")).unwrap();
        assert!(table == fs::read(folder.path().join("series-1/series.csv")).unwrap(), "{threads}");
    }
}
