//! Robust statistics, and random numbers.

mod random;
mod robust;

pub(crate) use random::Random;
pub(crate) use robust::{MAD, PIECE, cut, median, spread, watched_median, whole};
