//! How a command ends.

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
