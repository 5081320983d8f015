//! Every parser of the crate: what it begins with and how it is called.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use centrical_session::{
    CalibrationResult, ColumnName, Columns, Error, Laboratory, Session, Truth, WatchState, read_growing_record,
    read_plan, read_plateaus, read_record, read_telemetry,
};
use flate2::Compression;
use flate2::write::GzEncoder;

/// A parser to be tried.
pub struct Parser {
    pub name: &'static str,
    /// Name of the file it is given.
    pub file: &'static str,
    pub seeds: Vec<PathBuf>,
    /// Reads a file; what came of it.
    pub read: fn(&Path) -> String,
}

/// All of them.
pub fn parsers() -> Vec<Parser> {
    let mut parsers: Vec<Parser> = [
        ("text", "record.csv", &["csv", "txt", "tsv"][..]),
        ("gzip", "record.csv.gz", &["gz"]),
        ("zstd", "record.csv.zst", &["zst"]),
        ("parquet", "record.parquet", &["parquet"]),
        ("npy", "record.npy", &["npy"]),
        ("npz", "record.npz", &["npz"]),
        ("mat", "record.mat", &["mat"]),
        ("arrow", "record.arrow", &["arrow", "arrows", "feather"]),
        ("hdf5", "record.h5", &["h5"]),
    ]
    .map(|(name, file, extensions)| Parser { name, file, seeds: data(extensions), read: table })
    .into();
    parsers.push(Parser { name: "packed text", file: "record.csv", seeds: data(&["csv", "txt", "tsv"]), read: packed });
    let example = |name: &str| vec![examples().join("ta-200").join(name)];
    let plans = ["four-positions.toml", "normalised.toml"].map(|name| examples().join("plans").join(name));
    parsers.extend([
        Parser { name: "experiment", file: "experiment.toml", seeds: experiments(), read: session },
        Parser { name: "laboratory", file: "laboratory.toml", seeds: example("laboratory.toml"), read: laboratory },
        Parser { name: "plan", file: "plan.toml", seeds: plans.into(), read: plan },
        Parser { name: "truth", file: "truth.toml", seeds: seeds("truth.toml"), read: truth },
        Parser { name: "result", file: "result.json", seeds: seeds("result.json"), read: result },
        Parser { name: "plateaus", file: "plateaus.csv", seeds: seeds("plateaus.csv"), read: plateaus },
        Parser { name: "watch", file: "state.json", seeds: seeds("state.json"), read: watch },
    ]);
    parsers.retain(|parser| !parser.seeds.is_empty());
    parsers
}

fn manifest() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn examples() -> PathBuf {
    manifest().join("../../examples")
}

fn seeds(name: &str) -> Vec<PathBuf> {
    vec![manifest().join("tests/fuzz/seeds").join(name)]
}

fn experiments() -> Vec<PathBuf> {
    vec![manifest().join("tests/data/experiment.toml"), examples().join("ta-200/experiment.toml")]
}

/// The files of the tests' data with one of those extensions.
fn data(extensions: &[&str]) -> Vec<PathBuf> {
    let files = fs::read_dir(manifest().join("tests/data")).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|file| file.extension().is_some_and(|own| extensions.iter().any(|e| own == *e))).collect()
}

fn outcome<T>(result: Result<T, Error>) -> String {
    result.map_or_else(|error| error.to_string(), |_| "read".to_owned())
}

/// A table as everything that it could be.
fn table(file: &Path) -> String {
    let named = read_record(file, &Columns::default());
    if let Ok(record) = &named {
        assert!(record.t.is_sorted(), "time runs backwards");
        assert!(record.f_z.iter().flatten().all(|f| f.is_finite()), "a reading is no number");
    }
    let mut numbered = Columns::default();
    numbered.time.name = ColumnName::Number(1);
    (0..3).for_each(|j| numbered.f[j].name = ColumnName::Number(j + 2));
    let by_number = outcome(read_record(file, &numbered));
    let growing = outcome(read_growing_record(file, &Columns::default()));
    let telemetry = outcome(read_telemetry(file, &Columns::default()));
    [outcome(named), by_number, growing, telemetry, outcome(read_plateaus(file, 12))].join("; ")
}

/// A text, packed: mutations of packed bytes hardly reach what is behind the packing.
fn packed(file: &Path) -> String {
    let text = fs::read(file).unwrap();
    let mut gzip = GzEncoder::new(Vec::new(), Compression::fast());
    gzip.write_all(&text).unwrap();
    fs::write(file, gzip.finish().unwrap()).unwrap();
    let gzip = table(file);
    fs::write(file, zstd::encode_all(text.as_slice(), 1).unwrap()).unwrap();
    let zstd = table(file);
    assert_eq!(gzip, zstd);
    gzip
}

fn session(file: &Path) -> String {
    [outcome(Session::read(file)), outcome(read_plan(file))].join("; ")
}

fn plan(file: &Path) -> String {
    outcome(read_plan(file))
}

fn laboratory(file: &Path) -> String {
    outcome(Laboratory::read(file))
}

fn truth(file: &Path) -> String {
    outcome(Truth::read(file, &Session::read(&experiments()[1]).unwrap(), 1))
}

fn result(file: &Path) -> String {
    let result = CalibrationResult::read(file);
    if let Ok(result) = &result {
        let _ = result.error_terms();
    }
    outcome(result)
}

fn plateaus(file: &Path) -> String {
    outcome(read_plateaus(file, 12))
}

fn watch(file: &Path) -> String {
    outcome(WatchState::resume(&Session::read(&experiments()[1]).unwrap(), file))
}
