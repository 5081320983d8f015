//! Laws of chance, robust statistics, and random numbers.

mod doubtful;
mod laws;
mod random;
mod robust;
mod rounding;

pub(crate) use doubtful::{
    Side, is_tone, longest_run, may_be_longer, may_be_piled_up, piled_up, standing, stuck_on_any_axis, widened,
};
pub use laws::{Test, family_wise};
pub(crate) use laws::{chi_squared_quantiles, chi_squared_tail, f_tail, holm, sidak, t_tail};
pub(crate) use random::Random;
pub(crate) use robust::{MAD, PIECE, cut, median, spread, watched_median, whole};
pub(crate) use rounding::bias_variance;
