//! How long one waits for the compensation of a record from file to file, beside the reader alone.
//!
//! `CENTRICAL_ROWS` sets the length of the record, 2 million rows unless given; 14 million are a GB of text.

use std::path::Path;
use std::sync::OnceLock;

use centrical_compensate::{Compensation, Term};
use centrical_session::{Columns, RecordReader, RecordSlice, RecordWriter, compensate_record, stretch, unwatched};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use tempfile::TempDir;

fn main() {
    divan::main();
}

fn rows() -> usize {
    std::env::var("CENTRICAL_ROWS").ok().and_then(|rows| rows.parse().ok()).unwrap_or(2_000_000)
}

/// A folder with the record as `record.csv` and `record.parquet`.
fn records() -> &'static Path {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let folder = TempDir::new().unwrap();
        for name in ["record.csv", "record.parquet"] {
            let mut writer = RecordWriter::create(&folder.path().join(name)).unwrap();
            for start in (0..rows()).step_by(16 * 1024) {
                let k = || (start..rows().min(start + 16 * 1024)).map(|k| k as f64);
                let t: Vec<f64> = k().map(|k| k / 1e4).collect();
                // Five decimals, as instruments write them.
                let read = |k: f64, a: f64| (1500e5 * (1e-5 * k + a).sin()).round() / 1e5;
                let f = [1.0, 2.0, 3.0].map(|a| k().map(|k| read(k, a)).collect::<Vec<f64>>());
                writer.write(RecordSlice { t: &t, f_z: f.each_ref().map(Vec::as_slice) }).unwrap();
            }
            writer.finish().unwrap();
        }
        folder
    });
    folder.path()
}

/// The source's model with coefficients of ordinary size.
fn kozlov() -> Vec<Term> {
    let mut terms = Vec::new();
    for i in 0..3 {
        terms.push(Term::power(i, i, 0, 0.05));
        terms.extend((0..=i).map(|j| Term::power(i, j, 1, 1e-3)));
        terms.extend((0..3).map(|j| Term::power(i, j, 2, 1e-6)));
        terms.push(Term::power(i, i, 3, 1e-9));
    }
    terms
}

#[divan::bench(sample_count = 3, sample_size = 1, args = ["record.csv", "record.parquet"])]
fn reader_alone(bencher: Bencher, name: &str) {
    let file = records().join(name);
    bencher.counter(ItemsCount::new(rows())).bench_local(|| {
        let mut record = RecordReader::open(&file, &Columns::default()).unwrap();
        while let Some(batch) = record.next_batch().unwrap() {
            for rows in batch {
                black_box(stretch(rows));
            }
        }
    });
}

#[divan::bench(sample_count = 3, sample_size = 1, args = ["csv csv", "csv parquet", "parquet csv", "parquet parquet"])]
fn compensate(bencher: Bencher, from_to: &str) {
    let (from, to) = from_to.split_once(' ').unwrap();
    let (file, out) = (records().join(format!("record.{from}")), records().join(format!("compensated.{to}")));
    let terms = kozlov();
    let compensation = Compensation::new(&terms, 2000.0).unwrap();
    // To a new file: what an old one takes to be given up is not the program's.
    let no_file = || _ = std::fs::remove_file(&out);
    bencher.counter(ItemsCount::new(rows())).with_inputs(no_file).bench_local_values(|()| {
        compensate_record(&compensation, &file, &Columns::default(), &out, &unwatched).unwrap()
    });
}
