//! A simulated session, as a JSON document: schema `centrical-simulation/1`.

use std::path::Path;

use serde::Serialize;

use super::result::Program;
use crate::experiment::{RestTable, Session};

/// Name of the schema's present version.
pub(crate) const SIMULATION_SCHEMA: &str = "centrical-simulation/1";

/// A session that was simulated. The truth is in its `truth.json`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SimulationReport {
    /// `centrical-simulation/1`.
    pub schema: &'static str,
    /// What made it.
    pub program: Program,
    /// Title of the plan.
    pub title: String,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Folder of the session, as it was given.
    pub folder: String,
    /// Mountings.
    pub mountings: usize,
    /// Plateaus of all mountings.
    pub plateaus: usize,
    /// Rests of all tumbles; absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rests: Option<usize>,
}

impl SimulationReport {
    /// The session that `plan` describes, simulated into `folder`; each of its rests is planned.
    pub fn of(plan: &Session, seed: u64, folder: &Path) -> Self {
        let rests: usize = plan.rest_tables.iter().map(RestTable::count).sum();
        Self {
            schema: SIMULATION_SCHEMA,
            program: Program::this(),
            title: plan.title.clone(),
            seed,
            folder: folder.display().to_string(),
            mountings: plan.mountings.len(),
            plateaus: plan.experiment.set_points.len() - rests,
            rests: (!plan.rest_tables.is_empty()).then_some(rests),
        }
    }
}
