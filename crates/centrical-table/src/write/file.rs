//! Files that appear whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::Path;

use super::beside::Beside;
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
    let written = Beside::create(file).and_then(|(beside, output)| {
        write(output)?;
        beside.take_place()
    });
    written.map_err(|error| Error::writing(file, error))
}
