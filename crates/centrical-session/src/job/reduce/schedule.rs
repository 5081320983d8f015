//! What a mounting's record should show.

use centrical::Experiment;
use centrical::reduction::ScheduledPlateau;

/// The plateaus of a mounting in their order.
pub(crate) fn schedule(experiment: &Experiment, mounting: usize) -> Vec<ScheduledPlateau> {
    let set_points = experiment.set_points.iter().filter(|set_point| set_point.mounting == mounting);
    set_points.map(|s| ScheduledPlateau { omega: s.omega, nominal_z: experiment.nominal(s) }).collect()
}
