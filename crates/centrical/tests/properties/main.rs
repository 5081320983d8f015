//! Identities that must hold for any input: Jacobians against differences, round trips, invariance, estimates
//! against their own uncertainty.

#[path = "../common/mod.rs"]
mod common;

mod axes;
mod combination;
mod comparison;
mod consistency;
mod coverage;
mod fit;
mod frame;
mod free_rests;
mod history;
mod invariance;
mod measurement;
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of samples from lengths of time")]
mod mistakes;
mod noise;
mod noise_intervals;
mod noise_source;
mod observability;
mod plan;
mod prior;
mod recursive;
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of samples from lengths of time")]
mod reduction;
mod repeated_rests;
mod rests;
mod rivals;
mod selection;
mod simulate;
mod simulated_noise;
mod simulated_rests;
mod slow_rotation;
mod speeds;
mod stated;
mod steady;
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "counts of samples from lengths of time")]
mod stream;
#[allow(clippy::cast_possible_truncation, reason = "seeds")]
mod tilt;
mod uncertainty;
mod validity;
mod wide_priors;
