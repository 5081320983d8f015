//! The documents as others read them: the page in headless Chromium, the certificate by poppler's pdftotext.
//!
//! Needs the programs `chromium` and `pdftotext` (Debian: chromium, poppler-utils); run with `--ignored`.

#[cfg(all(unix, feature = "serve"))]
mod browser;
mod certificate;
mod chromium;
#[cfg(all(unix, feature = "serve"))]
mod live;
mod page;
#[path = "../common/program.rs"]
mod program;
#[cfg(all(unix, feature = "serve"))]
#[path = "../common/served.rs"]
mod served;

use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

fn example(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200").join(name)
}

/// A folder with all documents of the example, the laboratory's data altered by `alter`.
fn documents(language: &str, alter: impl Fn(String) -> String) -> TempDir {
    let folder = TempDir::new().unwrap();
    let laboratory = folder.path().join("laboratory.toml");
    fs::write(&laboratory, alter(fs::read_to_string(example("laboratory.toml")).unwrap())).unwrap();
    let mut command = program::centrical();
    command.arg("calibrate").arg(example("")).arg("--out").arg(folder.path()).args(["--language", language]);
    let run = command.arg("--laboratory").arg(laboratory).output().unwrap();
    // 1 where the altered limits are not kept.
    assert!(matches!(run.status.code(), Some(0 | 1)), "{}", String::from_utf8_lossy(&run.stderr));
    folder
}
