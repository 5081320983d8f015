//! A small session folder, to be spoiled one key at a time.

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

/// A right experiment file.
pub const EXPERIMENT: &str = include_str!("../fuzz/seeds/experiment.toml");

/// A session folder of its own, with this experiment file.
pub struct Sample {
    folder: TempDir,
}

impl Sample {
    pub fn new(experiment: impl AsRef<[u8]>) -> Self {
        let sample = Self { folder: tempfile::tempdir().unwrap() };
        sample.file("experiment.toml", experiment);
        sample
    }

    /// Writes a file into the folder.
    pub fn file(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        let path = self.folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, content).unwrap();
        path
    }

    pub fn path(&self) -> PathBuf {
        self.folder.path().to_owned()
    }

    /// A message without the place of the folder on this machine.
    pub fn relative(&self, message: &str) -> String {
        message.replace(&format!("{}/", self.folder.path().display()), "")
    }
}
