//! Arithmetic on many numbers with the widest vectors of the machine; the result is the same on any machine.

pub(crate) mod elementary;
pub(crate) mod lanes;
