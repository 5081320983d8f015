//! The one door by which files are written, whole or not at all: a temporary file beside, of a name of its own, that takes the
//! file's place.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{Builder, TempPath};

use crate::error::Error;

/// Bytes of a file's name that its temporary file repeats: with what is added it stays below the 255 of a name.
const REPEATED: usize = 200;

/// The temporary files that exist now, so that an interrupted program can remove them.
static BEGUN: Mutex<Begun> = Mutex::new(Begun { files: BTreeSet::new(), is_closed: false });

struct Begun {
    files: BTreeSet<PathBuf>,
    /// Whether the program ends: no file is begun or finished any more.
    is_closed: bool,
}

/// A temporary file beside the file whose place it takes in the end. Dropped before, it leaves nothing.
///
/// It is created new, never through a link and never over a file that is there: two processes that write one file make two
/// temporary files, and the last one that takes the place is the whole file.
pub(super) struct Beside {
    file: PathBuf,
    temporary: Option<TempPath>,
}

impl Beside {
    /// Creates the temporary file, to be written.
    pub fn create(file: &Path) -> io::Result<(Self, File)> {
        let before = fs::metadata(file).ok();
        if before.as_ref().is_some_and(|metadata| !metadata.is_file()) || is_of_system(file, folder_of(file)) {
            return Err(io::Error::other("found a path that is not a regular file, expected a file or a free name"));
        }
        if before.as_ref().is_some_and(|metadata| metadata.permissions().readonly()) {
            return Err(io::Error::other(
                "found a file that is protected from writing, expected one that may be replaced",
            ));
        }
        let name = file.file_name().ok_or_else(|| io::Error::other("found no name of a file, expected one"))?;
        let folder = folder_of(file);
        let prefix = prefix(name.to_string_lossy().as_ref());
        let mut begun = begun();
        begun.check()?;
        let mut builder = Builder::new();
        builder.prefix(&prefix).suffix(".tmp").rand_bytes(10);
        // What the user keeps from others stays so.
        let rights = before.map(|before| before.permissions());
        match &rights {
            Some(rights) => builder.permissions(rights.clone()),
            None => readable_as_any_file(&mut builder),
        };
        let (output, temporary) = builder.tempfile_in(folder)?.into_parts();
        if let Some(rights) = rights {
            // Those that the mask took away. Some file systems know no rights: nothing is lost there.
            let _ = fs::set_permissions(&temporary, rights);
        }
        begun.files.insert(temporary.to_path_buf());
        Ok((Self { file: file.to_owned(), temporary: Some(temporary) }, output))
    }

    /// Puts the temporary file in the file's place.
    pub fn take_place(mut self) -> io::Result<()> {
        let Some(temporary) = self.temporary.take() else { return Ok(()) };
        let mut begun = begun();
        begun.check()?;
        begun.files.remove(temporary.as_ref() as &Path);
        temporary.persist(&self.file).map_err(|failed| failed.error)
    }
}

impl Drop for Beside {
    fn drop(&mut self) {
        if let Some(temporary) = self.temporary.take() {
            begun().files.remove(temporary.as_ref() as &Path);
        }
    }
}

impl Begun {
    fn check(&self) -> io::Result<()> {
        if self.is_closed { Err(io::Error::other("the program is being ended")) } else { Ok(()) }
    }
}

/// Writes `bytes` beside `file`, sees them to the disk, then renames: whoever looks sees the old file or the new one, never a
/// part, after a power cut too.
///
/// # Errors
/// [`Error::Io`] if the folder does not take the file; nothing is left behind then.
pub fn write_whole(file: &Path, bytes: &[u8]) -> Result<(), Error> {
    write_beside(file, whole(bytes))
}

/// Writes all of `bytes`, and sees them to the disk.
fn whole(bytes: &[u8]) -> impl FnOnce(File) -> io::Result<()> {
    |mut output| {
        output.write_all(bytes)?;
        output.sync_data()
    }
}

/// Writes files that belong together as [`write_whole`] does, all of them beside before the first takes its place: a program that is killed leaves
/// the old files or the new ones, but for the moment of the renames. A file that cannot be written does not take the others with it.
///
/// # Errors
/// [`Error::Io`] of the first that cannot be written, with the names of the others and what is written.
pub fn write_together(files: &[(PathBuf, Vec<u8>)]) -> Result<(), Error> {
    let begun: Vec<io::Result<Beside>> = files.iter().map(|(file, bytes)| written_beside(file, whole(bytes))).collect();
    let ends = begun.into_iter().map(|begun| begun.and_then(Beside::take_place));
    let mut failed: Vec<_> = files.iter().zip(ends).filter_map(|((file, _), end)| Some((file, end.err()?))).collect();
    if failed.is_empty() {
        return Ok(());
    }
    let names: Vec<_> = failed.iter().filter_map(|(file, _)| file.file_name()?.to_str()).collect();
    let of_all = format!("{} of {} files not written ({})", failed.len(), files.len(), names.join(", "));
    let (file, source) = failed.swap_remove(0);
    Err(Error::writing(file, io::Error::new(source.kind(), format!("{source}; {of_all}"))))
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
    let written = written_beside(file, write).and_then(Beside::take_place);
    written.map_err(|error| Error::writing(file, error))
}

/// The temporary file beside `file`, written.
fn written_beside(file: &Path, write: impl FnOnce(File) -> io::Result<()>) -> io::Result<Beside> {
    let (beside, output) = Beside::create(file)?;
    write(output)?;
    Ok(beside)
}

/// Removes all files in the making, and lets none be begun or finished from now on: for a program that is interrupted.
pub fn abandon_files() {
    let mut begun = begun();
    begun.is_closed = true;
    for temporary in std::mem::take(&mut begun.files) {
        // Best effort: the program ends.
        let _ = fs::remove_file(temporary);
    }
}

fn begun() -> MutexGuard<'static, Begun> {
    // The set is whole whatever a thread that held it did.
    BEGUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Whether a name is a link of the system to an open file, such as `/dev/stdout`. That may be a regular file, but what took the place of the
/// link would be in the way of every other program.
fn is_of_system(file: &Path, folder: &Path) -> bool {
    let is_link = fs::symlink_metadata(file).is_ok_and(|metadata| metadata.is_symlink());
    is_link && folder.canonicalize().is_ok_and(|folder| folder == Path::new("/dev") || folder.starts_with("/proc"))
}

/// The folder of a file.
fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The beginning of the name of a temporary file.
fn prefix(name: &str) -> OsString {
    let end = (0..=REPEATED.min(name.len())).rev().find(|end| name.is_char_boundary(*end)).unwrap_or(0);
    format!("{}.", &name[..end]).into()
}

/// As any new file, the temporary one is what the user's mask allows; the crate's own rule is the owner alone.
#[cfg(unix)]
fn readable_as_any_file<'b, 'p, 's>(builder: &'b mut Builder<'p, 's>) -> &'b mut Builder<'p, 's> {
    use std::os::unix::fs::PermissionsExt;
    builder.permissions(fs::Permissions::from_mode(0o666))
}

/// Other systems give a new file the rights of its folder.
#[cfg(not(unix))]
fn readable_as_any_file<'b, 'p, 's>(builder: &'b mut Builder<'p, 's>) -> &'b mut Builder<'p, 's> {
    builder
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use std::os::fd::AsRawFd;
    use std::os::unix::fs::PermissionsExt;

    use super::*;

    fn mode(file: &Path) -> u32 {
        fs::metadata(file).unwrap().permissions().mode() & 0o777
    }

    #[test]
    fn one_of_several_files_that_fails_leaves_the_others() {
        let folder = tempfile::tempdir().unwrap();
        let names = ["a.json", "missing/b.html", "c.svg", "missing/d.svg"];
        let files = names.map(|name| (folder.path().join(name), name.as_bytes().to_vec()));
        let message = write_together(&files).unwrap_err().to_string();
        assert!(message.contains("missing/b.html: cannot be written: "), "{message}");
        assert!(message.ends_with("; 2 of 4 files not written (b.html, d.svg)"), "{message}");
        let read = |n: usize| fs::read(&files[n].0).ok();
        assert_eq!([read(0), read(2)], [0, 2].map(|n: usize| Some(names[n].as_bytes().to_vec())));
        assert!(read(1).is_none() && fs::read_dir(folder.path()).unwrap().count() == 2, "nothing else is left");
        assert!(begun().files.iter().all(|file| !file.starts_with(folder.path())));
    }

    #[test]
    fn a_link_of_the_system_to_an_open_file_stays() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("caught.txt");
        let open = File::create(&file).unwrap();
        let link = format!("/proc/self/fd/{}", open.as_raw_fd());
        let message = write_whole(Path::new(&link), b"out").unwrap_err().to_string();
        assert!(message.contains("not a regular file"), "{message}");
        assert_eq!(fs::read(&file).unwrap(), b"");
    }

    #[test]
    fn a_file_keeps_its_rights_and_a_protected_one_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("result.json");
        write_whole(&file, b"old").unwrap();
        for rights in [0o600, 0o664] {
            fs::set_permissions(&file, fs::Permissions::from_mode(rights)).unwrap();
            write_whole(&file, b"new").unwrap();
            assert_eq!(mode(&file), rights);
        }
        fs::set_permissions(&file, fs::Permissions::from_mode(0o444)).unwrap();
        let message = write_whole(&file, b"newer").unwrap_err().to_string();
        assert!(message.contains("protected from writing"), "{message}");
        assert_eq!(fs::read(&file).unwrap(), b"new");
    }
}
