//! The two passes over files give the bits that records in memory give, whatever the format.

use std::fs;
use std::path::{Path, PathBuf};

use centrical::SetPoint;
use centrical::reduction::{NoiseModel, ReducedMounting, ScheduledPlateau};
use centrical_session::{RecordReader, RecordWriter, Session, reduce_without_inputs, unwatched};
use centrical_table::Extent;
use tempfile::TempDir;

fn example() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/ta-200")
}

/// The example with its records as Parquet.
fn as_parquet(folder: &Path) -> Session {
    let session = Session::read(&example()).unwrap();
    fs::create_dir_all(folder.join("records")).unwrap();
    for files in &session.mountings {
        let file = files.records.first().unwrap();
        let name = file.file_stem().unwrap().to_str().unwrap();
        let mut writer = RecordWriter::create(&folder.join(format!("records/{name}.parquet"))).unwrap();
        writer
            .write(
                RecordReader::open(file, &session.columns)
                    .and_then(|reader| reader.into_record(&unwatched))
                    .unwrap()
                    .as_slice(),
            )
            .unwrap();
        writer.finish().unwrap();
    }
    let text = fs::read_to_string(example().join("experiment.toml")).unwrap();
    let telemetry = example().canonicalize().unwrap().join("telemetry");
    let text = text.replace(".csv\"\ntelemetry", ".parquet\"\ntelemetry");
    let text = text.replace("\"telemetry/", &format!("\"{}/", telemetry.display()));
    fs::write(folder.join("experiment.toml"), text).unwrap();
    Session::read(folder).unwrap()
}

#[test]
fn from_files_as_from_memory() {
    let session = Session::read(&example()).unwrap();
    let experiment = &session.experiment;
    let mounting = |m: usize| -> ReducedMounting {
        let of_mounting = experiment.set_points.iter().filter(|s| s.mounting == m);
        let scheduled = |s: &SetPoint| ScheduledPlateau { omega: s.omega, nominal_z: experiment.nominal(s) };
        let schedule: Vec<ScheduledPlateau> = of_mounting.map(scheduled).collect();
        let telemetry = session.telemetry(m, Extent::Whole).unwrap();
        session.record(m).unwrap().reduce(telemetry.as_ref(), &schedule).unwrap()
    };
    let mountings: Vec<ReducedMounting> = (0..experiment.mountings.len()).map(mounting).collect();
    let noise = NoiseModel::pool(&mountings);
    let means: Vec<_> = mountings.iter().flat_map(|mounting| mounting.means(&noise)).collect();
    let folder = TempDir::new().unwrap();
    for session in [&session, &as_parquet(folder.path())] {
        let (_, reduced) = reduce_without_inputs(session, &unwatched).unwrap();
        assert_eq!(reduced.plateaus.len(), means.len());
        for (from_file, mean) in reduced.plateaus.iter().zip(&means) {
            assert_eq!((from_file.mean, from_file.covariance), (mean.mean, mean.covariance));
            assert_eq!((from_file.window(), from_file.samples), (Some(mean.window), mean.samples as u64));
        }
    }
}
