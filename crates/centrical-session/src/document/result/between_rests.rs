//! What differs from rest to rest beside the noise within rests, as the result states it.

use centrical::uncertainty::BetweenRests;
use serde::{Deserialize, Serialize};

/// Standard deviations of what the residuals of rests alone cannot exclude; the uncertainties include both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BetweenRestsSummary {
    /// Scatter of the reading of a rest beside its noise [m/s^2].
    pub scatter: f64,
    /// Change of each bias from the first rest to the last [m/s^2]; zero where the session has or states one.
    pub drift: f64,
}

impl From<BetweenRests> for BetweenRestsSummary {
    fn from(BetweenRests { scatter, drift }: BetweenRests) -> Self {
        Self { scatter, drift }
    }
}
