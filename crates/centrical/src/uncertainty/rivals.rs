//! Rivals: the residuals of a fit are asked for every physical effect that the model leaves out, and the data for what they
//! could not show.
//!
//! Let `Z` be the whitened columns of a rival, `Q` an orthonormal basis of the fitted columns, and `e` the whitened
//! residuals. The part of the rival that no unknown can follow is `s = Z - Q Q^T Z`. Where the rival is absent, `e^T s (s^T s)^+ s^T e` is
//! chi^2 of `rank s` degrees of freedom; `(s^T s)^+ s^T e` estimates its size; and a size `a`, left out, moves the estimates
//! by `R^-1 Q^T Z a`. No refit is needed.

mod catalogue;
pub(super) mod columns;
mod order;
mod power;
mod rests_on;
mod scatter;
mod score;

pub use catalogue::Rivals;
pub(super) use catalogue::Suspect;
pub use rests_on::Unseen;
pub(super) use scatter::{Scatter, chance_of_explaining};
pub use score::{RivalTest, Suspects};
