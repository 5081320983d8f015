//! Plots as files.

use std::fmt::Display;
use std::path::{Path, PathBuf};

use centrical_session::{Error, claim_folder, refuse_inputs, write_whole};

use crate::plot::Plot;

/// Writes plots by their names, `NAME.svg`, into a folder, which is made if it is not there, and over none of the `inputs`.
///
/// # Errors
/// [`Error`] when the folder does not take them, or one of them was read.
pub fn write_plots(folder: &Path, plots: &[(impl Display, Plot)], inputs: &[PathBuf]) -> Result<(), Error> {
    let files: Vec<PathBuf> = plots.iter().map(|(name, _)| folder.join(format!("{name}.svg"))).collect();
    refuse_inputs(&files, inputs)?;
    let _claim = claim_folder(folder)?;
    for (file, (_, plot)) in files.iter().zip(plots) {
        write_whole(file, plot.to_svg().as_bytes())?;
    }
    Ok(())
}
