//! Robust statistics, and random numbers.

mod random;
mod robust;

pub(crate) use random::Random;
pub(crate) use robust::{MAD, cut, median, whole};
