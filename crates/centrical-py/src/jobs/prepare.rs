//! What comes before measuring: `init`, `schema`, `observe`, `plan`, `simulate`.

use std::path::PathBuf;

use centrical_report::frontier_plot;
use centrical_session::{
    self as session, InitRequest, ObservabilityReport, PlanRequest, Session, SettingsForm, SimulationReport, Truth,
    USUAL_LEVELS, USUAL_TIMES, available_time, refuse_inputs, settings_schema, simulate_session, subject, subject_of,
    write_whole,
};
use pyo3::prelude::*;

use crate::failure::{exception, guarded};
use crate::given::GivenSession;
use crate::progress::{self, Shown};
use crate::words::{self, Amount, one_of, probability, refused};

/// `centrical-draft/1`.
#[pyfunction]
pub fn init(
    py: Python,
    inputs: Vec<PathBuf>,
    out: Option<PathBuf>,
    positions: Option<&str>,
    tumble: Option<PathBuf>,
) -> PyResult<String> {
    let six_positions = positions.map_or(Ok(false), |word| one_of("positions", word, &[("six", true)]))?;
    progress::run(py, &None, |work| {
        let request = InitRequest { inputs, out, tumble, six_positions };
        let draft = session::init(&request, &|done| work.advance(done))?;
        if let Some(file) = &request.out {
            write_whole(file, draft.text.as_bytes())?;
        }
        draft.report(request.out.as_deref()).to_json()
    })
}

/// The JSON Schema of a file that people write.
#[pyfunction]
pub fn schema(py: Python, form: &str, out: Option<PathBuf>) -> PyResult<String> {
    let forms = [
        ("experiment", SettingsForm::Experiment),
        ("plan", SettingsForm::Plan),
        ("truth", SettingsForm::Truth),
        ("laboratory", SettingsForm::Laboratory),
    ];
    let form = one_of("form", form, &forms)?;
    guarded(|| {
        let schema = settings_schema(form).map_err(|error| exception(py, &error))?;
        if let Some(file) = &out {
            refuse_inputs(std::slice::from_ref(file), &[] as &[PathBuf]).map_err(|error| exception(py, &error))?;
            write_whole(file, schema.as_bytes()).map_err(|error| exception(py, &error.into()))?;
        }
        Ok(schema)
    })
}

/// `centrical-observability/1`.
#[pyfunction]
pub fn observe(py: Python, given: GivenSession, combinations: Vec<String>, shown: Shown) -> PyResult<String> {
    progress::run(py, &shown, |work| {
        let subject = match given {
            GivenSession::Path(file) => subject(&file, &|bytes| work.advance(bytes))?,
            in_memory @ GivenSession::InMemory(..) => subject_of(&in_memory.read()?, &|bytes| work.advance(bytes))?,
        };
        ObservabilityReport::of(&subject, &combinations)?.to_json()
    })
}

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

/// `centrical-simulation/1`.
#[pyfunction]
pub fn simulate(
    py: Python,
    plan: PathBuf,
    truth: PathBuf,
    seed: u64,
    out: PathBuf,
    format: &str,
    shown: Shown,
) -> PyResult<String> {
    let format = words::format(format)?;
    progress::run(py, &shown, |work| {
        let plan = Session::read(&plan)?;
        let truth = Truth::read(&truth, &plan, seed)?;
        let plan = &truth.plan;
        work.expect(plan.planned_records() as u64);
        simulate_session(&truth, seed, format, &out, &|count| work.count(count))?;
        SimulationReport::of(plan, seed, &out).to_json()
    })
}
