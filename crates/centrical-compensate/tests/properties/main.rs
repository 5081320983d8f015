//! Identities that must hold for any coefficients: round trips, uniqueness, bulk against single readings.

mod bulk;
mod certificate;
mod models;
mod monomial;
mod round_trip;
