//! Damaged and mutated files through every reader of tables.

mod fuzz;
mod mutate;
mod random;
#[path = "../common/record.rs"]
mod record;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use fuzz::{Parser, outcome};
use record::{named, numbered, read_growing_record, read_record};

#[test]
#[ignore = "takes half a minute: a job of its own"]
fn mutated_tables_are_read_or_refused() {
    fuzz::mutate_for(40, parsers());
}

#[test]
fn damaged_tables_are_read_or_refused() {
    fuzz::try_kept(parsers());
}

/// A parser for every format.
fn parsers() -> Vec<Parser> {
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
        ("tdms", "record.tdms", &["tdms"]),
        ("xlsx", "record.xlsx", &["xlsx"]),
    ]
    .map(|(name, file, extensions)| Parser { name, file, seeds: data(extensions), read: table })
    .into();
    parsers.push(Parser { name: "packed text", file: "record.csv", seeds: data(&["csv", "txt", "tsv"]), read: packed });
    parsers
}

/// The files of the tests' data with one of those extensions.
fn data(extensions: &[&str]) -> Vec<PathBuf> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let files = fs::read_dir(data).unwrap().map(|entry| entry.unwrap().path());
    files.filter(|file| file.extension().is_some_and(|own| extensions.iter().any(|e| own == *e))).collect()
}

/// A table by names, by numbers, and while it grows.
fn table(file: &Path) -> String {
    let by_name = read_record(file, &named());
    if let Ok([t, f @ ..]) = &by_name {
        assert!(t.is_sorted(), "time runs backwards");
        assert!(f.iter().flatten().all(|f| f.is_finite()), "a reading is no number");
    }
    [outcome(by_name), outcome(read_record(file, &numbered())), outcome(read_growing_record(file))].join("; ")
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
