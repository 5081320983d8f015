//! Files that appear whole or not at all.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;

use crate::error::Error;

/// Writes `bytes` beside `file`, sees them to the disk, then renames: whoever looks sees the old file or the new one, never a
/// part, after a power cut too.
///
/// # Errors
/// [`Error::Io`] if the folder does not take the file; nothing is left behind then.
pub fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_beside(file, |mut output| {
        output.write_all(bytes)?;
        output.sync_data()
    })
}

/// As [`write_whole`], for what is too large to be made before it is written, or is written again and again. Nobody waits for
/// the disk, which would be a third of the time of a simulation: after a power cut the file may be there in part, and what
/// is written like this can be made anew.
///
/// # Errors
/// As [`write_whole`].
pub fn write_stream(file: &Path, write: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>) -> Result<(), Error> {
    write_beside(file, |output| {
        let mut output = BufWriter::new(output);
        write(&mut output)?;
        output.flush()
    })
}

fn write_beside(file: &Path, write: impl FnOnce(File) -> io::Result<()>) -> Result<(), Error> {
    let mut beside = file.as_os_str().to_owned();
    beside.push(".tmp");
    let written = File::create(&beside).and_then(write);
    written.and_then(|()| fs::rename(&beside, file)).map_err(|error| {
        // Best effort: the first error is the one to tell.
        let _ = fs::remove_file(&beside);
        Error::writing(file, error)
    })
}

/// Makes a folder, and those above it, if it is not there.
///
/// # Errors
/// [`Error::Io`] if it cannot be made.
pub fn create_folder(folder: &Path) -> Result<(), Error> {
    fs::create_dir_all(folder).map_err(|error| Error::writing(folder, error))
}
