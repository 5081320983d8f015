//! Every long job ends with [`Error::Stopped`] when its caller asks for it, and leaves no part of a file.

use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use centrical_session::{
    AssessmentRequest, ColumnName, CompensationRequest, Error, Estimator, Folder, InitRequest, Method, MonteCarloCase,
    MonteCarloRequest, NoiseRequest, PlanRequest, Selection, Session, TableFormat, Truth, add_results, assess,
    calibrate, calibrate_reduced, compensate, init, list_store, noise_of, plan, read_calibrations, reduce,
    select_model, simulate_session, subject, unwatched,
};
use tempfile::TempDir;

/// A caller who stops at the call number `at`, counted from 1.
struct Caller {
    at: usize,
    calls: AtomicUsize,
}

impl Caller {
    fn who_stops_at(at: usize) -> Self {
        Self { at, calls: AtomicUsize::new(0) }
    }

    fn asked<N>(&self, _: N) -> ControlFlow<()> {
        let call = self.calls.fetch_add(1, Ordering::Relaxed) + 1;
        if call >= self.at { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// Calls after the first that stopped the work.
    fn calls_too_many(&self) -> usize {
        self.calls.load(Ordering::Relaxed).saturating_sub(self.at)
    }
}

/// Runs a job for a caller who stops at its first call, half-way, and never.
fn is_stopped<T>(job: impl Fn(&Caller) -> Result<T, Error>) {
    let patient = Caller::who_stops_at(usize::MAX);
    assert!(job(&patient).is_ok());
    let calls = patient.calls.into_inner();
    for at in [1, calls.div_ceil(2)] {
        let caller = Caller::who_stops_at(at);
        let outcome = job(&caller);
        assert!(matches!(outcome, Err(Error::Stopped(_))), "stopped at call {at} of {calls}");
        // One call of each thread may be under way.
        assert!(caller.calls_too_many() < 64, "{} calls after {at} of {calls}", caller.calls_too_many());
    }
}

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

fn session() -> Session {
    Session::read(&example().join("ta-200")).unwrap()
}

#[test]
fn jobs_on_records() {
    let session = session();
    is_stopped(|caller| reduce(&session, &|n| caller.asked(n)));
    is_stopped(|caller| calibrate(&session, &[], Method::Exact, &|n| caller.asked(n)));
    is_stopped(|caller| assess(&session, &AssessmentRequest::default(), &|n| caller.asked(n)));
    is_stopped(|caller| select_model(&session, &|n| caller.asked(n)));
    is_stopped(|caller| subject(&session.file, &|n| caller.asked(n)));
}

/// Between the steps of a fit, where a session has thousands of plateaus.
#[test]
fn a_fit() {
    let session = session();
    let (_, reduced) = reduce(&session, &unwatched).unwrap();
    is_stopped(|caller| calibrate_reduced(&session, &reduced, Method::Exact, &|n| caller.asked(n)));
}

#[test]
fn calibrations_repeated() {
    let case = MonteCarloCase::measured(&session(), &unwatched).unwrap();
    let request = MonteCarloRequest { runs: 300, seed: 1, coverage: 0.95, linear: true };
    is_stopped(|caller| case.run(&request, &|n| caller.asked(n)));
}

#[test]
fn noise_of_a_record() {
    let request = NoiseRequest {
        file: example().join("ta-200/records/m01.csv"),
        folder: Folder::default(),
        plateau: None,
        session: None,
        time: ColumnName::Name("t".to_owned()),
        rate: None,
        readings: vec![ColumnName::Name("f1".to_owned())],
        unit: "m/s^2".to_owned(),
        window: [f64::NEG_INFINITY, f64::INFINITY],
        estimators: Estimator::ALL.to_vec(),
    };
    is_stopped(|caller| noise_of(&request, &|n| caller.asked(n)));
    // After the record is read the caller is asked with no bytes.
    is_stopped(|caller| noise_of(&request, &|n| if n == 0 { caller.asked(n) } else { ControlFlow::Continue(()) }));
}

#[test]
fn a_draft() {
    let request = InitRequest {
        inputs: ["records", "telemetry"].map(|name| example().join("ta-200").join(name)).to_vec(),
        out: None,
        tumble: None,
        six_positions: false,
    };
    is_stopped(|caller| init(&request, &|n| caller.asked(n)));
}

/// Ten results; a store of them has one row group, at which the caller is asked.
#[test]
fn histories() {
    let folder = TempDir::new().unwrap();
    let mut result = calibrate(&session(), &[], Method::Exact, &unwatched).unwrap();
    let mut files = Vec::new();
    for day in 10..20 {
        result.session.date = format!("2026-01-{day}");
        files.push(folder.path().join(format!("{day}.json")));
        result.write(files.last().unwrap()).unwrap();
    }
    let selection = Selection::default();
    is_stopped(|caller| read_calibrations(&files, &selection, &|n| caller.asked(n)));
    let store = folder.path().join("store");
    add_results(&store, &files, true, &unwatched).unwrap();
    is_stopped(|caller| read_calibrations(std::slice::from_ref(&store), &selection, &|n| caller.asked(n)));
    is_stopped(|caller| list_store(&store, selection.clone(), &|n| caller.asked(n)));
}

#[test]
fn a_search_for_a_plan() {
    let request = PlanRequest {
        time: None,
        certify: false,
        frontier: vec![1.0],
        levels: vec![0.0, 1.0],
        coverage: 0.95,
        outputs: Vec::new(),
    };
    is_stopped(|caller| plan(&example().join("03_plan/plan.toml"), &request, &|()| caller.asked(())));
}

#[test]
fn a_simulation_leaves_no_part_of_a_record() {
    let folder = TempDir::new().unwrap();
    let plan = session();
    let truth = folder.path().join("truth.toml");
    fs::write(&truth, "typical = { size = 1.0 }\n[machine]\nplateau = \"2 s\"\nramp = \"1 s\"\n").unwrap();
    let truth = Truth::read(&truth, &plan, 1).unwrap();
    let whole = TempDir::new().unwrap();
    simulate_session(&truth, 1, TableFormat::Csv, whole.path(), &unwatched).unwrap();
    is_stopped(|caller| {
        let out = TempDir::new().unwrap();
        let simulated = simulate_session(&truth, 1, TableFormat::Csv, out.path(), &|n: usize| caller.asked(n));
        assert_eq!(simulated.is_ok(), out.path().join("experiment.toml").exists());
        for entry in fs::read_dir(out.path().join("records")).unwrap() {
            let file = entry.unwrap().path();
            let same = whole.path().join("records").join(file.file_name().unwrap());
            assert!(fs::read(&file).unwrap() == fs::read(&same).unwrap(), "{file:?}");
        }
        simulated
    });
}

#[test]
fn a_compensation_leaves_no_part_of_its_output() {
    let folder = TempDir::new().unwrap();
    let result = folder.path().join("result.json");
    calibrate(&session(), &[], Method::Exact, &unwatched).unwrap().write(&result).unwrap();
    let out = folder.path().join("forces.csv");
    let record = example().join("ta-200/records/m01.csv");
    let request = CompensationRequest {
        result,
        record,
        out: out.clone(),
        session: None,
        range: None,
        within_calibration: false,
        axes: None,
    };
    is_stopped(|caller| {
        let _ = fs::remove_file(&out);
        let compensated = compensate(&request, &|n| caller.asked(n));
        assert_eq!(compensated.is_ok(), out.exists());
        compensated
    });
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}
