//! Ctrl-C and a request to terminate: a command that can end by itself is asked to; any other leaves nothing half done.

use std::process;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use centrical_session::abandon_files;

/// The exit code of a program that Ctrl-C ended, as shells have it: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

/// Raised for a command that ends by itself.
static ASKED: OnceLock<AtomicBool> = OnceLock::new();

/// Prepares for an interruption from now on. Where the system has no such signals nothing is done.
pub fn prepare() {
    let _ = ctrlc::set_handler(|| {
        // Asked once, it is given the time to end; asked again, not.
        let is_first = ASKED.get().is_some_and(|asked| !asked.swap(true, Ordering::Relaxed));
        if !is_first {
            abandon_files();
            process::exit(INTERRUPTED);
        }
    });
}

/// The flag that an interruption raises, for a command that looks at it and ends by itself.
pub fn asked_to_end() -> &'static AtomicBool {
    ASKED.get_or_init(AtomicBool::default)
}
