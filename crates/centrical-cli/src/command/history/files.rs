//! Files that a subcommand writes into a folder.

use std::path::{Path, PathBuf};

use centrical_session::{Error, claim_folder, refuse_inputs, write_whole};

/// Writes texts by their names into a folder, which is made if it is not there, and over none of the `inputs`.
pub fn write_files(folder: &Path, texts: &[(String, String)], inputs: &[PathBuf]) -> Result<(), Error> {
    let files: Vec<PathBuf> = texts.iter().map(|(name, _)| folder.join(name)).collect();
    refuse_inputs(&files, inputs)?;
    let _claim = claim_folder(folder)?;
    for (file, (_, text)) in files.iter().zip(texts) {
        write_whole(file, text.as_bytes())?;
    }
    Ok(())
}
