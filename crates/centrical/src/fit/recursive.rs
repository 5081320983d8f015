//! The recursive method of the source's section 6: a square-root information filter over plateaus.
//!
//! Three readings at a time are rotated into a triangle of the unknowns at work ([`Factor`]). What belongs to a position
//! or a pair is re-initialised when that changes ([`Lives`]), so that the source's experiment takes 30 states instead
//! of 49, and is smoothed at the end ([`Filter`]). A plateau is tested as it comes ([`Filter::innovation`]).
//!
//! [`linear`] is one pass on [K5.3]. [`exact`] relinearises all plateaus at the smoothed estimate and filters again, until
//! nothing moves. Both are the estimates of [`super::linear`] and [`super::exact`] by another way round.
//! [`Follower`] is for the time while the centrifuge turns: after each plateau it stands where a fit of the
//! plateaus so far stands.

mod factor;
mod filter;
mod follower;
mod innovation;
mod lives;
mod snapshot;

pub use factor::Factor;
pub use filter::{Filter, Readings};
pub use follower::{Follower, Progress};
pub use innovation::Innovation;
pub use lives::Lives;
pub use snapshot::{ResumeError, Row, Snapshot};

use nalgebra::DVector;

use super::{Fit, Search, Start, Structure};
use crate::design::{Design, Observation};
use crate::error::FitError;
use crate::measurement::{Linearisation, MeasurementModel};

/// Weighted least squares on the source's linear model [K5.3], one pass of the filter in the order of `observations`.
///
/// # Errors
/// [`FitError`] when an observation cannot be one.
pub fn linear(model: &MeasurementModel, observations: &[Observation]) -> Result<Fit, FitError> {
    let structure = Structure::by(filtered, model, observations)?;
    Ok(Start::new(&structure, filtered, model, observations)?.solve())
}

/// The iterated filter on the exact model, from the linear solution, in the order of `observations`.
///
/// # Errors
/// [`FitError`] when an observation cannot be one.
pub fn exact(model: &MeasurementModel, observations: &[Observation]) -> Result<Fit, FitError> {
    let structure = Structure::by(filtered, model, observations)?;
    Search::from(Start::new(&structure, filtered, model, observations)?, model).run()
}

/// One pass of the filter over all plateaus and the smoothing back; then the priors.
fn filtered(
    x: &[f64],
    model: &MeasurementModel,
    observations: &[Observation],
    linearisations: &[Linearisation],
) -> Result<Design, FitError> {
    let order: Vec<usize> = observations.iter().map(|o| o.set_point).collect();
    let lives = Lives::new(model, &order);
    let data = pass(&lives, observations, linearisations)?.smoothed();
    Ok(data.with_priors(model.priors(), &DVector::from_column_slice(x)))
}

/// One pass of the filter over the first plateaus of an order.
fn pass<'a>(
    lives: &'a Lives,
    observations: &[Observation],
    linearisations: &[Linearisation],
) -> Result<Filter<'a>, FitError> {
    let mut filter = Filter::new(lives);
    for (place, (observation, linearisation)) in observations.iter().zip(linearisations).enumerate() {
        filter.update(place, &Readings::new(observation, linearisation)?)?;
    }
    Ok(filter)
}
