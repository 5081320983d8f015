//! Laws of chance, robust statistics, and random numbers.

mod laws;
mod random;
mod robust;
mod rounding;

pub(crate) use laws::{chi_squared_quantiles, f_tail, holm, sidak, t_tail};
pub use laws::{chi_squared_tail, family_wise};
pub(crate) use random::Random;
pub(crate) use robust::{MAD, PIECE, cut, median, spread, watched_median, whole};
pub(crate) use rounding::bias_variance;
