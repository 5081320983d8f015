//! How a command ends.

use std::io::{self, Write};

/// How a command ended that could do its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Done,
    /// Done, but the result is not acceptable; it was said why.
    NotAcceptable,
}

impl Outcome {
    /// Done, and acceptable or not.
    pub fn acceptable(is_acceptable: bool) -> Self {
        if is_acceptable { Self::Done } else { Self::NotAcceptable }
    }
}

/// Prints a text. A reader that has seen enough (`| head`) is no failure.
pub fn print(text: &str) {
    let _ = io::stdout().write_all(text.as_bytes());
}
