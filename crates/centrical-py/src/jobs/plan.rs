//! `plan`: the best schedule for a time, or the shortest for target uncertainties.

use std::path::PathBuf;

use centrical_report::frontier_plot;
use centrical_session::{self as session, PlanRequest, USUAL_LEVELS, USUAL_TIMES, available_time, write_whole};
use pyo3::prelude::*;

use crate::progress::{self, Shown};
use crate::words::{Amount, probability, refused};

/// `centrical-plan/1`.
#[pyfunction]
pub fn plan(
    py: Python,
    file: PathBuf,
    time: Option<Amount>,
    out: Option<PathBuf>,
    frontier: bool,
    svg: Option<PathBuf>,
    levels: Option<Vec<f64>>,
    certify: bool,
    coverage: f64,
    shown: Shown,
) -> PyResult<String> {
    if svg.is_some() && !frontier {
        return Err(refused("svg", "found a file without frontier=True, expected both or neither"));
    }
    let levels = levels.unwrap_or_else(|| USUAL_LEVELS.to_vec()).into_iter().map(PlanRequest::level);
    let levels = levels.collect::<Result<_, _>>().map_err(|wrong| refused("levels", wrong))?;
    let request = PlanRequest {
        time: Amount::checked(time, "time", available_time)?,
        certify,
        frontier: if frontier { USUAL_TIMES.to_vec() } else { Vec::new() },
        levels,
        coverage: probability("coverage", coverage)?,
        outputs: out.iter().chain(&svg).cloned().collect(),
    };
    progress::run(py, &shown, |work| {
        let report = session::plan(&file, &request, &|()| work.advance(0))?;
        if let Some(schedule) = &out {
            write_whole(schedule, report.session_text(&file)?.as_bytes())?;
        }
        if let Some(drawing) = &svg {
            write_whole(drawing, frontier_plot(&report).as_bytes())?;
        }
        report.to_json()
    })
}
