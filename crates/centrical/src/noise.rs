//! Noise of a record: stability deviations, spectrum, noise terms.
//!
//! The field's words are those of clocks: "frequency" y is the reading (specific force, m/s^2), "phase" x its
//! integral (velocity, m/s), tau0 the sampling interval, tau = m tau0 the averaging time.
//!
//! - [`regular_grid`] lays time-stamped readings on a regular grid; [`Phase::integrate`] makes the phase, bridges
//!   what is missing and says how much that was ([`Gaps`]).
//! - [`leave_out_spikes`] takes out what is no noise but an error of transmission.
//! - [`deviations`] gives any [`Estimator`] of the Allan family with chi^2 confidence intervals.
//! - [`time_interval_rms`] and [`maximum_time_interval`] give TIE rms and MTIE.
//! - [`power_spectrum`] gives the spectral density, [`fit_noise_terms`] the terms of IEEE Std 952 and 1293.
//!
//! Source of the estimators: W. J. Riley, "Handbook of Frequency Stability Analysis", NIST Special Publication 1065,
//! 2008, cited as SP 1065.

mod error;
mod estimator;
mod freedom;
mod grid;
mod interval;
mod log_fit;
mod phase;
mod power_law;
mod scatter;
mod spectrum;
mod spikes;
mod stability;
mod terms;
mod total;

pub use error::NoiseError;
pub use estimator::{Estimator, RawVariance};
pub use grid::{Grid, regular_grid};
pub use interval::{maximum_time_interval, time_interval_rms};
pub use phase::{Gaps, Phase};
pub use power_law::PowerLaw;
pub use spectrum::{Spectrum, SpectrumBand, SpectrumLine, power_spectrum};
pub use spikes::leave_out_spikes;
pub use stability::{Deviation, deviations};
pub use terms::{Coefficient, NoiseTerm, NoiseTerms, fit_noise_terms};
