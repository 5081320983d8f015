//! Ctrl-C, a request to terminate and a terminal that hangs up: a command that can end by itself is asked to; any other leaves nothing
//! half done.

use std::process;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(unix)]
use std::{fs, thread};

use centrical_session::abandon_files;
#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
#[cfg(unix)]
use signal_hook::iterator::Signals;

/// The exit code of a program that Ctrl-C ended, as shells have it: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

/// Raised for a command that ends by itself.
static ASKED: OnceLock<AtomicBool> = OnceLock::new();

/// Prepares for an interruption from now on. Where the system has no such signals nothing is done.
#[cfg(unix)]
pub fn prepare() {
    // Without the thread the system ends the program.
    let _ = thread::Builder::new().spawn(|| {
        if let Ok(mut signals) = Signals::new(heeded()) {
            signals.forever().for_each(|_| end());
        }
    });
}

/// The same on other systems.
#[cfg(not(unix))]
pub fn prepare() {
    let _ = ctrlc::set_handler(end);
}

/// Asked once, a command that can is given the time to end; asked again, not.
fn end() {
    let is_first = ASKED.get().is_some_and(|asked| !asked.swap(true, Ordering::Relaxed));
    if !is_first {
        abandon_files();
        process::exit(INTERRUPTED);
    }
}

/// The signals that ask for an end. Under `nohup` on Linux, which has the program ignore a terminal that hangs up, that is not one of them.
#[cfg(unix)]
fn heeded() -> impl Iterator<Item = i32> {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    let is_ignored = ignored.is_some_and(|ignored| ignored >> (SIGHUP - 1) & 1 == 1);
    [SIGINT, SIGTERM].into_iter().chain((!is_ignored).then_some(SIGHUP))
}

/// The flag that an interruption raises, for a command that looks at it and ends by itself.
pub fn asked_to_end() -> &'static AtomicBool {
    ASKED.get_or_init(AtomicBool::default)
}
