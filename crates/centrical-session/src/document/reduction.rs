//! The plateau means of a session, as a JSON document: schema `centrical-reduction/1`.

use std::path::Path;

use serde::Serialize;

use super::json::rows;
use super::result::Program;
use super::steadiness::LeftOutSummary;
use crate::experiment::{PlateauName, Session};
use crate::reduced::{MountingFindings, Reduced};

/// Name of the schema's present version.
pub(crate) const REDUCTION_SCHEMA: &str = "centrical-reduction/1";

/// A session reduced to its plateau means.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReductionReport {
    /// `centrical-reduction/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title of the session.
    pub title: String,
    /// Folder of the reduced session, as it was given.
    pub folder: String,
    /// Readings of newtonometers 1, 2, 3 that were interpolated to the stamps of another one; none unless each has a file with stamps
    /// of its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interpolated: Option<[u64; 3]>,
    /// Plateaus that a record shows and the schedule does not have.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unscheduled: Vec<UnscheduledPlateau>,
    /// The plateaus, in the order of the schedule.
    pub plateaus: Vec<ReducedPlateauSummary>,
}

/// A plateau that a record shows and the schedule does not have.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UnscheduledPlateau {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// From and to, the record's clock [s].
    pub window: [f64; 2],
}

/// A plateau mean.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReducedPlateauSummary {
    /// Mounting, counted from 1.
    pub mounting: usize,
    /// Plateau of the mounting's schedule, counted from 0.
    pub index: usize,
    /// Speed [rad/s], signed by the sense of rotation: as it was set, or as it was measured where speeds are measured.
    pub speed: f64,
    /// Relative standard uncertainty of a speed that was measured.
    pub speed_uncertainty: Option<f64>,
    /// Carousel angle at rest [rad]; null while spinning.
    pub angle: Option<f64>,
    /// First and last instant used, the record's clock [s]; null for a plateau that came already averaged.
    pub window: Option<[f64; 2]>,
    /// Samples used.
    pub samples: u64,
    /// Samples that are not used, by kind; null for a plateau that came already averaged.
    pub left_out: Option<LeftOutSummary>,
    /// Mean reading [m/s^2].
    pub mean: [f64; 3],
    /// Covariance of the mean from its noise [m^2/s^4].
    pub covariance: [[f64; 3]; 3],
}

impl ReductionReport {
    /// A session that was reduced into `folder`.
    pub fn of(session: &Session, reduced: &Reduced, folder: &Path) -> Self {
        let set_points = &session.experiment.set_points;
        let mut plateaus = Vec::with_capacity(set_points.len());
        let table = reduced.table(session);
        for (n, (row, plateau)) in table.iter().zip(&reduced.plateaus).enumerate() {
            plateaus.push(ReducedPlateauSummary {
                mounting: row.mounting + 1,
                index: PlateauName::of(session, n).plateau - 1,
                speed: row.speed,
                speed_uncertainty: row.speed_uncertainty,
                angle: set_points[n].is_rest().then_some(row.angle),
                window: plateau.window(),
                samples: plateau.samples,
                left_out: plateau.steady().map(|seen| seen.left_out.into()),
                mean: plateau.mean.into(),
                covariance: rows(&plateau.covariance),
            });
        }
        let unscheduled = |(mounting, findings): (usize, &MountingFindings)| -> Vec<UnscheduledPlateau> {
            findings.unscheduled.iter().map(|window| UnscheduledPlateau { mounting, window: *window }).collect()
        };
        Self {
            schema: REDUCTION_SCHEMA,
            program: Program::this(),
            title: session.title.clone(),
            folder: folder.display().to_string(),
            interpolated: reduced.interpolated(),
            unscheduled: (1..).zip(&reduced.mountings).flat_map(unscheduled).collect(),
            plateaus,
        }
    }
}
