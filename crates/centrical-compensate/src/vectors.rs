//! Arithmetic that a processor does on many readings at once.

pub(crate) mod fused;
pub(crate) mod lanes;
pub(crate) mod machine;
