//! Three recorders on one clock, each with stamps or a rate of its own, calibrate to what one recorder does.

use std::fs;
use std::path::Path;

use centrical_session::{
    CalibrationResult, ColumnName, Folder, Method, NoiseRequest, Session, TableFormat, Truth, calibrate, noise_of,
    reduce_without_inputs, simulate_session, unwatched,
};
use centrical_table::{Decimals, TableWriter};
use nalgebra::{DMatrix, DVector};
use tempfile::TempDir;

const EXAMPLE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/ta-200");

/// Samples a second of the signal; recorders take some of them.
const RATE: usize = 800;

/// A session with known truth, recorded at [`RATE`].
struct Laboratory {
    folder: TempDir,
    session: Session,
    truth: Vec<f64>,
}

impl Laboratory {
    /// The example as a plan, with some noise.
    fn with(sensor: &str, seed: u64) -> Self {
        let folder = TempDir::new().unwrap();
        let plan = Session::read(Path::new(EXAMPLE)).unwrap();
        let file = folder.path().join("truth.toml");
        let machine = "[machine]\nplateau = 8\nramp = 3\nspeed_error = 1e-5\nsettling = 1e-4";
        fs::write(&file, format!("[typical]\nsize = 1.0\n{machine}\n[sensor]\n{sensor}\n[recorder]\nrate = {RATE}\n"))
            .unwrap();
        let truth = Truth::read(&file, &plan, seed).unwrap();
        let whole = folder.path().join("whole");
        simulate_session(&truth, seed, TableFormat::Parquet, &whole, &unwatched).unwrap();
        Self { session: Session::read(&whole).unwrap(), truth: truth.values, folder }
    }

    /// The session in three files a mounting: whether newtonometer `j` has sample `k`.
    fn split(&self, name: &str, has: impl Fn(usize, usize) -> bool) -> Session {
        let folder = self.folder.path().join(name);
        fs::create_dir(&folder).unwrap();
        let whole = self.folder.path().join("whole");
        let mut text = fs::read_to_string(whole.join("experiment.toml")).unwrap();
        for (m, files) in self.session.mountings.iter().enumerate() {
            let record = self.session.record(m).unwrap();
            let names = [0, 1, 2].map(|j: usize| format!("m{m:02}_{j}.parquet"));
            for (j, name) in names.iter().enumerate() {
                let kept = (0..record.t.len()).filter(|k| has(j, *k));
                let (t, f): (Vec<f64>, Vec<f64>) = kept.map(|k| (record.t[k], record.f_z[j][k])).unzip();
                write(&folder.join(name), j, &t, &f);
            }
            let old = relative(files.records.first().unwrap(), &whole);
            assert!(text.contains(&format!("{old:?}")), "{old}");
            text = text.replace(&format!("{old:?}"), &format!("{names:?}"));
        }
        text = text.replace("\"telemetry/", &format!("\"{}/telemetry/", whole.display()));
        fs::write(folder.join("experiment.toml"), text).unwrap();
        Session::read(&folder).unwrap()
    }

    /// The squared error over the stated covariance, and how many parameters there are.
    fn squared_error(&self, result: &CalibrationResult) -> (f64, usize) {
        let error = result.parameters.iter().zip(&self.truth).map(|(p, truth)| p.value.unwrap() - truth);
        (squared(result, &error.collect::<Vec<f64>>()), self.truth.len())
    }
}

fn relative(file: &Path, folder: &Path) -> String {
    file.strip_prefix(folder).unwrap().to_str().unwrap().to_owned()
}

fn write(file: &Path, j: usize, t: &[f64], f: &[f64]) {
    let name = format!("f{}", j + 1);
    let mut table = TableWriter::create(file, &["t", &name], [Decimals::SHORTEST; 2]).unwrap();
    table.write(&[[t, f]]).unwrap();
    table.finish().unwrap();
}

/// A difference of the parameters over the covariance of a result: its weighted square.
fn squared(result: &CalibrationResult, difference: &[f64]) -> f64 {
    let u: Vec<f64> = result.parameters.iter().map(|p| p.standard_uncertainty.unwrap()).collect();
    let n = u.len();
    let correlation = DMatrix::from_fn(n, n, |a, b| result.covariance[a][b].unwrap() / (u[a] * u[b]));
    let scaled = DVector::from_fn(n, |a, _| difference[a] / u[a]);
    correlation.cholesky().unwrap().l().solve_lower_triangular(&scaled).unwrap().norm_squared()
}

fn calibrated(session: &Session) -> CalibrationResult {
    calibrate(session, &[], Method::Exact, &unwatched).unwrap()
}

/// Every eighth sample of all three newtonometers.
fn one_recorder(_: usize, k: usize) -> bool {
    k.is_multiple_of(8)
}

/// 100 Hz each; the second is 3/8 of a step later than the first, the third 5/8.
fn other_phases(j: usize, k: usize) -> bool {
    k % 8 == [0, 3, 5][j]
}

/// 100, 100 and 200 Hz; the second is half a step later than the first.
fn other_rates(j: usize, k: usize) -> bool {
    k % [8, 8, 4][j] == [0, 4, 2][j]
}

/// 99.7, 100 and 100.3 Hz, each sample up to half of 1/800 s from where it should be.
fn near_rates(j: usize, k: usize) -> bool {
    let count = |k: usize| ((k as f64 + 0.5) * [99.7, 100.0, 100.3][j] / RATE as f64).floor();
    k > 0 && count(k) > count(k - 1)
}

type Has = fn(usize, usize) -> bool;
const RECORDERS: [(&str, Has); 3] = [("phases", other_phases), ("rates", other_rates), ("near", near_rates)];

/// Slow noise: recorders that take neighbouring samples see the same signal, and what they differ in is what interpolation does.
#[test]
fn interpolation_moves_no_parameter() {
    let laboratory = Laboratory::with("white = 5e-4\ncoloured = { deviation = 2e-3, time = 0.5 }", 5);
    let one = calibrated(&laboratory.split("one", one_recorder));
    assert!(one.mountings.iter().all(|mounting| mounting.interpolated.is_none()));
    for (name, has) in RECORDERS {
        let three = calibrated(&laboratory.split(name, has));
        let shift = three.parameters.iter().zip(&one.parameters);
        let shift = shift.map(|(a, b)| (a.value.unwrap() - b.value.unwrap()) / b.standard_uncertainty.unwrap());
        let largest = shift.map(f64::abs).fold(0.0, f64::max);
        let (error, parameters) = laboratory.squared_error(&three);
        println!("{name}: largest shift {largest:.3} u, squared error {error:.1} of {parameters}");
        assert!(three.objections().is_empty(), "{name}: {:?}", three.objections());
        // A mean over 8 s has 2e-3 sqrt(2 0.5 / 8) = 7.1e-4 m/s^2 of slow noise, and 5e-4 / sqrt(800) = 1.8e-5 of white noise, which
        // differs between the recorders: by 2.5e-5, 0.035 of the mean's u. Five times that for the largest of 49.
        assert!(largest < 0.18, "{name}: {largest} u");
        // The 99.9 % band of chi^2 with 49 degrees of freedom.
        assert!(parameters == 49 && (20.0..86.0).contains(&error), "{name}: {error}");
        for mounting in &three.mountings {
            let counts = mounting.interpolated.unwrap();
            assert_eq!(counts.map(|count| count > 0), [false, true, true], "{name}: {counts:?}");
        }
    }
}

/// White noise: a mean of two neighbours has less of it than either, and is correlated with the next. The stated uncertainty is that
/// of all samples all the same.
#[test]
fn uncertainties_are_those_of_the_samples() {
    let laboratory = Laboratory::with("white = 2e-2", 6);
    let one = calibrated(&laboratory.split("one", one_recorder));
    for (name, has) in RECORDERS {
        let three = calibrated(&laboratory.split(name, has));
        let (error, _) = laboratory.squared_error(&three);
        let reduced = three.fit.chi_squared / three.fit.degrees_of_freedom as f64;
        println!("{name}: squared error {error:.1} of 49, chi^2 per degree {reduced:.3}");
        assert!(three.objections().is_empty(), "{name}: {:?}", three.objections());
        assert!((20.0..86.0).contains(&error), "{name}: {error}");
        // 275 degrees of freedom: 4 sqrt(2 / 275) = 0.34.
        assert!((reduced - 1.0).abs() < 0.34, "{name}: {reduced}");
        for axis in 0..3 {
            let sum = |result: &CalibrationResult| -> f64 {
                result.plateaus.iter().map(|plateau| plateau.covariance[axis][axis].sqrt()).sum()
            };
            // At 200 Hz there are twice the samples, and each is a neighbour of one stamp.
            let samples = if name == "rates" && axis == 2 { 2.0 } else { 1.0 };
            let ratio = sum(&three) / sum(&one) * f64::sqrt(samples);
            println!("{name}: f{} has {ratio:.3} of the uncertainty of its samples", axis + 1);
            assert!((ratio - 1.0).abs() < 0.1, "{name}, f{}: {ratio}", axis + 1);
        }
    }
}

#[test]
fn lost_samples_and_gaps_stay_gaps() {
    let laboratory = Laboratory::with("white = 2e-3", 7);
    // The second loses some samples one by one, the third half a second every seven seconds.
    let gap = |k: usize| k % (7 * RATE) < RATE / 2;
    let lossy =
        laboratory.split("lossy", move |j, k| other_phases(j, k) && (j != 1 || k % 1000 != 3) && (j != 2 || !gap(k)));
    for m in 0..lossy.mountings.len() {
        let (record, start) = (lossy.record(m).unwrap(), laboratory.session.record(m).unwrap().t[0]);
        assert!(record.f_z.iter().flatten().all(|f| f.is_finite()));
        assert!(record.t.windows(2).all(|pair| pair[0] < pair[1]));
        // Nothing between the third's last sample before a gap and its first one after it.
        let number = |t: &f64| ((t - start) * RATE as f64).round() % (7 * RATE) as f64;
        let inside = record.t.iter().map(number).filter(|k| (8.0..(RATE / 2 - 8) as f64).contains(k));
        assert_eq!(inside.count(), 0);
        // A single lost sample is not a gap.
        assert!(record.t.len() as f64 > 0.92 * laboratory.session.record(m).unwrap().t.len() as f64 / 8.0);
    }
    let result = calibrated(&lossy);
    assert!(result.objections().is_empty(), "{:?}", result.objections());
    let (error, _) = laboratory.squared_error(&result);
    assert!((20.0..86.0).contains(&error), "{error}");
}

/// The same bytes on one thread and on several.
#[test]
fn threads_change_nothing() {
    let laboratory = Laboratory::with("white = 2e-3", 8);
    let session = laboratory.split("near", near_rates);
    let means = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| format!("{:?}", reduce_without_inputs(&session, &unwatched).unwrap().1.plateaus))
    };
    assert_eq!(means(1), means(3));
    // A mean of neighbours has other noise than they have: of noise, the session says nothing.
    let request = NoiseRequest {
        file: session.file.clone(),
        folder: Folder::default(),
        plateau: None,
        session: None,
        time: ColumnName::Number(1),
        rate: None,
        readings: Vec::new(),
        unit: "m/s^2".to_owned(),
        window: [f64::NEG_INFINITY, f64::INFINITY],
        estimators: Vec::new(),
    };
    let refused = noise_of(&request, &unwatched).unwrap_err().to_string();
    let expected = "samples as they were recorded: analyse the file of each newtonometer by itself (noise FILE)";
    assert!(
        refused.ends_with(&format!("found readings interpolated to common stamps, expected {expected}")),
        "{refused}"
    );
}
