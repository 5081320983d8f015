//! Stability analysis of a record: deviations of the Allan family, spectrum, noise terms.
//!
//! The field's words are those of clocks: "frequency" y is the reading (specific force, m/s^2), "phase" x its
//! integral (velocity, m/s), tau0 the sampling interval, tau = m tau0 the averaging time.
//!
//! [`Analysis`] does all of it:
//! - [`Grid`] lays time-stamped readings on a regular grid.
//! - [`leave_out_spikes`] removes errors of transmission.
//! - [`Phase::integrate`] makes the phase, and bridges and counts missing readings ([`BridgedGaps`]).
//! - [`Phase::deviations`] gives any [`Estimator`] of the Allan family with chi^2 confidence intervals.
//! - [`Spectrum`] is the spectral density, [`NoiseTerms`] are the terms of IEEE Std 952 and 1293.
//!
//! Source of the estimators: W. J. Riley, "Handbook of Frequency Stability Analysis", NIST Special Publication 1065,
//! 2008, cited as SP 1065.

mod analysis;
mod degrees_of_freedom;
mod deviation;
mod error;
mod estimator;
mod faults;
mod grid;
mod jump;
mod log_fit;
mod log_moments;
mod phase;
mod power_law;
mod spectrum;
mod spikes;
mod stochastic_terms;
mod terms;
mod total;
mod variance;

pub use analysis::Analysis;
pub use deviation::Deviation;
pub use error::NoiseError;
pub use estimator::Estimator;
pub use phase::{BridgedGaps, Phase};
pub use power_law::PowerLaw;
pub use spectrum::{Spectrum, SpectrumLine};
pub use spikes::leave_out_spikes;
pub use terms::{Coefficient, NoiseTerm, NoiseTerms};
