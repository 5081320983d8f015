//! A copy of the example session that a test may spoil, and runs of the binary on it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use tempfile::TempDir;

use crate::program;

/// The session in the repository.
pub fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200")
}

/// A copy of the example, and an empty folder for output.
pub struct Copy {
    folder: TempDir,
}

impl Copy {
    pub fn new() -> Self {
        let copy = Self { folder: TempDir::new().unwrap() };
        fs::create_dir(copy.out()).unwrap();
        for part in ["records", "telemetry"] {
            fs::create_dir_all(copy.session().join(part)).unwrap();
            for file in fs::read_dir(example().join(part)).unwrap() {
                let file = file.unwrap();
                fs::copy(file.path(), copy.session().join(part).join(file.file_name())).unwrap();
            }
        }
        fs::copy(example().join("experiment.toml"), copy.session().join("experiment.toml")).unwrap();
        copy
    }

    pub fn session(&self) -> PathBuf {
        self.folder.path().join("session")
    }

    pub fn out(&self) -> PathBuf {
        self.folder.path().join("out")
    }

    /// Changes one file of the session.
    pub fn edit(&self, file: &str, change: impl FnOnce(String) -> String) {
        let path = self.session().join(file);
        let before = fs::read_to_string(&path).unwrap();
        let after = change(before.clone());
        assert_ne!(before, after, "the edit changed nothing");
        fs::write(&path, after).unwrap();
    }

    /// Runs the binary in the output folder.
    pub fn run(&self, arguments: &[&str]) -> Output {
        let mut command = program::centrical();
        command.args(arguments).current_dir(self.out()).output().unwrap()
    }

    /// `centrical calibrate SESSION --out .`, with further arguments.
    pub fn calibrate(&self, arguments: &[&str]) -> Output {
        let session = self.session();
        let mut all = vec!["calibrate", session.to_str().unwrap()];
        all.extend(arguments);
        self.run(&all)
    }

    /// Whatever lies in the output folder and, beside what was put there, in the session folder.
    pub fn left_behind(&self) -> Vec<String> {
        let names =
            |folder: PathBuf| fs::read_dir(folder).unwrap().map(|f| f.unwrap().file_name().into_string().unwrap());
        let known = ["experiment.toml", "records", "telemetry"];
        names(self.out()).chain(names(self.session()).filter(|name| !known.contains(&name.as_str()))).collect()
    }
}

/// What `init` drafts of parts of a session.
pub fn draft(copy: &Copy, parts: &[&str]) -> String {
    let inputs: Vec<String> = parts.iter().map(|part| copy.session().join(part).display().to_string()).collect();
    let arguments: Vec<&str> = std::iter::once("init").chain(inputs.iter().map(String::as_str)).collect();
    let output = copy.run(&arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Each line begins one of the draft.
#[track_caller]
pub fn assert_lines(draft: &str, lines: &[&str]) {
    for line in lines {
        assert!(draft.lines().any(|found| found.starts_with(line)), "{line} in {draft}");
    }
}
