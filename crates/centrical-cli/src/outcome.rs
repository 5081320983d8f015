//! How a command ends.

/// How a command ended that could do its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// Done.
    Done,
    /// Done, but the result is not acceptable; it was said why.
    NotAcceptable,
    /// Done, but some of many failed; it was said which.
    SomeFailed,
}

impl Outcome {
    /// The worst of many.
    pub fn of_series(failed: usize, not_acceptable: usize) -> Self {
        match (failed, not_acceptable) {
            (0, 0) => Self::Done,
            (0, _) => Self::NotAcceptable,
            _ => Self::SomeFailed,
        }
    }

    /// Done, and acceptable or not.
    pub fn acceptable(is_acceptable: bool) -> Self {
        if is_acceptable { Self::Done } else { Self::NotAcceptable }
    }
}
