//! The one way to the terminal: what cannot be written is an error, and what comes from files cannot command the terminal.

use std::io::{self, ErrorKind, Write};
use std::path::Path;

use centrical_session::{Error, harmless};

/// Prints a text on standard output. A reader that has seen enough (`| head`) is no failure; a full disk is.
///
/// # Errors
/// [`Error`] when standard output does not take the text.
pub fn print(text: &str) -> Result<(), Error> {
    print_as_it_is(&harmless(text))
}

/// Prints a text that may command the terminal.
///
/// # Errors
/// As [`print`].
pub fn print_as_it_is(text: &str) -> Result<(), Error> {
    let mut output = io::stdout().lock();
    written(output.write_all(text.as_bytes()).and_then(|()| output.flush()))
}

/// What became of writing to standard output.
///
/// # Errors
/// [`Error`] unless it was written or the reader has gone.
pub fn written(outcome: io::Result<()>) -> Result<(), Error> {
    match outcome {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::writing(Path::new("standard output"), error)),
        _ => Ok(()),
    }
}

/// Says something on standard error. If that is closed or full there is nobody to tell; the exit code still does.
pub fn say(text: &str) {
    let _ = io::stderr().lock().write_all(harmless(text).as_bytes());
}
