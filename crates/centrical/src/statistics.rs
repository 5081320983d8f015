//! Laws of chance, robust statistics, and random numbers.

mod family_wise;
mod laws;
mod random;
mod robust;
mod rounding;

pub use family_wise::family_wise;
pub(crate) use family_wise::{holm, sidak};
pub use laws::chi_squared_tail;
pub(crate) use laws::{chi_squared_quantiles, f_tail, t_tail};
pub(crate) use random::Random;
pub(crate) use robust::{MAD, PIECE, cut, median, spread, watched_median, whole};
pub(crate) use rounding::bias_variance;
