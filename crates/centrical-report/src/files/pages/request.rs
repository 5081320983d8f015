//! What is asked of pages.

use std::path::{Path, PathBuf};

/// What the pages of a store show beside its calibrations.
#[derive(Debug, Clone, PartialEq)]
pub struct PagesRequest {
    /// Largest error of a compensated reading [m/s^2], for the due dates.
    pub limit: Option<f64>,
    /// A laboratory's file with limits of parameters, for capability and drawings.
    pub laboratory: Option<PathBuf>,
    /// A table of serial numbers and batches.
    pub batches: Option<PathBuf>,
    /// Acceptable sessions whose values give the limits of control charts.
    pub accepted: usize,
}

impl PagesRequest {
    /// The files that are read.
    pub(super) fn inputs(&self) -> Vec<&Path> {
        self.laboratory.iter().chain(&self.batches).map(PathBuf::as_path).collect()
    }
}

impl Default for PagesRequest {
    fn default() -> Self {
        Self { limit: None, laboratory: None, batches: None, accepted: 20 }
    }
}
