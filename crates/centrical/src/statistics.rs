//! Laws of chance, robust statistics, and random numbers.

mod laws;
mod random;
mod robust;
mod rounding;

pub use laws::chi_squared_tail;
pub(crate) use laws::f_tail;
pub(crate) use random::Random;
pub(crate) use robust::{MAD, PIECE, cut, median, spread, watched_median, whole};
pub(crate) use rounding::bias_variance;
