//! What a watch does when something is wrong: a command of the user's.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

use centrical_report::alarm_text;
use centrical_session::WatchEvent;

use crate::output::say;

/// Runs a command at every alarm.
pub struct Alarm {
    command: Option<String>,
    session: PathBuf,
}

impl Alarm {
    /// With the command of the user, if there is one.
    pub fn new(command: Option<&str>, session: &Path) -> Self {
        Self { command: command.map(str::to_owned), session: session.to_owned() }
    }

    /// Raises an alarm if the event is one.
    pub fn hear(&self, event: &WatchEvent) {
        if let Some((kind, found)) = alarm_text(event) {
            self.raise(kind.name(), &found);
        }
    }

    /// Starts the command and goes on. What files say is in its environment and never in its text.
    fn raise(&self, kind: &str, message: &str) {
        let Some(text) = &self.command else { return };
        let mut command = shell(text);
        command.env("CENTRICAL_ALARM", kind).env("CENTRICAL_MESSAGE", message).env("CENTRICAL_SESSION", &self.session);
        // The output of this program is for its reader alone.
        match command.stdin(Stdio::null()).stdout(Stdio::null()).spawn() {
            Err(error) => say(&format!("--on-alarm: found {error}, expected a command that starts\n")),
            Ok(mut child) => {
                thread::spawn(move || match child.wait() {
                    Ok(status) if status.success() => {}
                    Ok(status) => say(&format!("--on-alarm: found {status}, expected exit code 0\n")),
                    Err(error) => say(&format!("--on-alarm: found {error}, expected its exit code\n")),
                });
            }
        }
    }
}

#[cfg(not(windows))]
fn shell(text: &str) -> Command {
    let mut command = Command::new("sh");
    command.args(["-c", text]);
    command
}

#[cfg(windows)]
fn shell(text: &str) -> Command {
    let mut command = Command::new("cmd");
    command.args(["/C", text]);
    command
}
