//! Arithmetic on many numbers with the widest vectors of the machine; the result is the same on any machine.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined into the function with the wide vectors is compiled for the narrow ones"
)]

pub(crate) mod elementary;
pub(crate) mod lanes;
