//! What is written must not be what is read.

use std::path::{Path, PathBuf};

use same_file::Handle;

use crate::error::{Error, Place};

/// Refuses an output that is one of the inputs, by the identity of the files and not by their names, and two outputs of one
/// name. To be asked before anything is written.
///
/// # Errors
/// [`Error::Content`] with the output.
pub fn refuse_inputs(outputs: &[PathBuf], inputs: &[impl AsRef<Path>]) -> Result<(), Error> {
    Outputs::of(outputs)?.refuse(inputs)
}

/// Outputs that many inputs are held against, some at a time.
pub struct Outputs {
    /// Those that are there, open.
    there: Vec<(PathBuf, Handle)>,
}

impl Outputs {
    /// The outputs as they are now.
    ///
    /// # Errors
    /// [`Error::Content`] for two outputs of one name.
    pub fn of(outputs: &[PathBuf]) -> Result<Self, Error> {
        let names: Vec<PathBuf> = outputs.iter().map(|output| whole_name(output)).collect();
        for (n, output) in outputs.iter().enumerate() {
            if names[..n].contains(&names[n]) {
                return Err(Error::content(output, Place::Whole, "two outputs of this name", "a file for each"));
            }
        }
        Ok(Self { there: outputs.iter().filter_map(|file| Some((file.clone(), identity(file)?))).collect() })
    }

    /// Refuses an output that is one of `inputs`, by the identity of the files.
    ///
    /// # Errors
    /// [`Error::Content`] with the output.
    pub fn refuse(&self, inputs: &[impl AsRef<Path>]) -> Result<(), Error> {
        if self.there.is_empty() {
            return Ok(());
        }
        for input in inputs.iter().map(AsRef::as_ref) {
            let Some(read) = identity(input) else { continue };
            if let Some((output, _)) = self.there.iter().find(|(_, written)| *written == read) {
                let found = format!("an input of the same command ({})", input.display());
                return Err(Error::content(output, Place::Whole, found, "another file for the output"));
            }
        }
        Ok(())
    }
}

/// The identity of a regular file that is there.
fn identity(file: &Path) -> Option<Handle> {
    // To open anything else might wait for ever.
    file.metadata().is_ok_and(|metadata| metadata.is_file()).then(|| Handle::from_path(file).ok())?
}

/// The path of a file that need not be there, its folder without links where that is there.
fn whole_name(file: &Path) -> PathBuf {
    let whole = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    match (whole.parent().and_then(|folder| folder.canonicalize().ok()), whole.file_name()) {
        (Some(folder), Some(name)) => folder.join(name),
        _ => whole,
    }
}
